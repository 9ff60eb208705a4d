extends "bench.gd"
## Measures the speedup of all cores over one core for a large rectangle, for its points alone and for its instances. Prints rows
## of a Markdown table.
##   tools/godot --headless --path demo_project --script tests/bench/rectangles.gd [-- ROUNDS]
##
## Each measurement uses a separate engine, which may be limited to one core. Linux only.

const DEFAULT_ROUNDS := 5
const RECT := Rect2(-500.0, -500.0, 1000.0, 1000.0)
const MEASURE := "measure"

var _calls := {
	"PoissonSampler.sample": _sample, "sample_domain, METHOD_TILES": _sample_domain, "build_rect on a heightmap": _build_rect,
}


func run() -> String:
	if OS.get_cmdline_user_args().has(MEASURE):
		return await _measure()
	var times := {}
	for round in rounds_or(DEFAULT_ROUNDS):
		for cores: String in ["all cores", "one core"]:
			for call: String in _calls:
				var seconds := seconds_in_another_engine([MEASURE, call], cores == "one core")
				if seconds <= 0.0:
					return "%s on %s printed no time" % [call, cores]
				(times.get_or_add([call, cores], []) as Array).push_back(1e3 * seconds)
	for call: String in _calls:
		var ratios := []
		for round: int in times[[call, "one core"]].size():
			ratios.push_back(times[[call, "one core"]][round] / times[[call, "all cores"]][round])
		for cores: String in ["all cores", "one core"]:
			row("%s, 10^6 square meters, radius 1 m, %s" % [call, cores], times[[call, cores]], "ms", 1)
		row("%s: all cores over one" % call, ratios, "times", 2)
	return ""


## Measures in this separate engine and prints the median of three times.
func _measure() -> String:
	var layer := ScatterLayer.new()
	layer.radius = 1.0
	layer.meshes = [BoxMesh.new()]
	make_scatter(demo_terrain(), [layer], Node3D.new())
	scatter.viewers = []
	await process_frame
	var call: Callable = _calls[OS.get_cmdline_user_args()[-1]]
	var times := []
	for time in 4: # The first of the four calls warms up.
		times.push_back(time_of(call))
	times = times.slice(1)
	times.sort()
	print_seconds(times[1] / 1e6)
	return ""


func _sample() -> void:
	PoissonSampler.new().sample(RECT)


func _sample_domain() -> void:
	var sampler := PoissonSampler.new()
	sampler.method = PoissonSampler.METHOD_TILES
	sampler.sample_domain(RECT)


func _build_rect() -> void:
	scatter.build_rect(scatter.layers[0], RECT)
