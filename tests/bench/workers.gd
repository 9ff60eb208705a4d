extends "bench.gd"
## Measures the speed of workers from the request for a tile to buffers that are ready for upload. The values are points per
## second of one worker, on several grounds and with several rules. Prints rows of a Markdown table.
##   tools/godot --headless --path demo_project --script tests/bench/workers.gd [-- ROUNDS [SAMPLER]]
##
## All sampled points are counted, even if the rules remove them. Times are the wall time of the workers only. SAMPLER is the
## path of `bench_sampler`. If it is given, that program measures the sampler alone just before each case, and additional
## rows print a worker's speed relative to the sampler alone.

const DEFAULT_ROUNDS := 5
const SECONDS_ALONE := "0.5"

var _viewer := Node3D.new()


func run() -> String:
	var rounds := rounds_or(DEFAULT_ROUNDS)
	var heightmap := demo_terrain()
	var noise := ScatterGroundNoise.new()
	noise.noise = FastNoiseLite.new()
	var cases := {
		"flat ground": [ScatterGroundFlat.new(), {}],
		"a heightmap": [heightmap, {}],
		"a heightmap, with a slope limit": [heightmap, {&"max_slope_degrees": 30.0, &"slope_falloff_degrees": 5.0}],
		"a heightmap, with an edge that thins out": [heightmap, {&"max_slope_degrees": 30.0, &"edge_feather": 8.0}],
		"flat ground, with a noise": [ScatterGroundFlat.new(), {&"noise": noise.noise}],
		"the ground of a noise": [noise, {}],
		"the ground of a noise, along its normals": [noise, {&"align_to_normal": 1.0}],
	}
	var rates := {}
	var shares := {}
	make_scatter(heightmap, [], _viewer)
	for round in rounds:
		for label: String in cases:
			var alone := _sampler_alone()
			var failure := await _fill(cases[label][0], cases[label][1])
			if failure != "":
				return label + ": " + failure
			var stats := scatter.get_stats()
			var rate: float = float(stats.points_sampled) / stats.worker_usec
			(rates.get_or_add(label, []) as Array).push_back(rate)
			if alone > 0.0:
				(shares.get_or_add(label, []) as Array).push_back(rate / alone)
	for label: String in cases:
		row("a worker's points, on " + label, rates[label], "M points/s", 2)
		if label in shares:
			row("a worker's points over the sampler's alone, on " + label, shares[label], "times", 3)
	return ""


## Returns million points per second of the sampler alone on one core; 0 if no path was passed.
func _sampler_alone() -> float:
	var arguments := OS.get_cmdline_user_args()
	if arguments.size() < 2:
		return 0.0
	var printed := []
	OS.execute(arguments[1], ["1", SECONDS_ALONE, "alone"], printed)
	return "".join(printed).get_slice("|", 2).to_float()


## Fills a view with tiles of 64 r. The stats are reset when the node enters the tree.
func _fill(ground: ScatterGround, rules: Dictionary) -> String:
	var layer := ScatterLayer.new()
	layer.radius = 1.0
	layer.tile_size = 64.0
	layer.view_distance = 700.0
	layer.meshes = [BoxMesh.new()]
	for rule: StringName in rules:
		layer.set(rule, rules[rule])
	root.remove_child(scatter)
	scatter.ground = ground
	scatter.layers = [layer]
	root.add_child(scatter)
	return await idle()
