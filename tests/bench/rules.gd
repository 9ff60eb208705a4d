extends "bench.gd"
## Measures the time to fill a view with a layer whose density is a property, an expression or a rule script. All thin the layer by slope in
## the same way. Prints rows of a Markdown table.
##   tools/godot --headless --path demo_project --script tests/bench/rules.gd [-- ROUNDS]
##
## Contenders take turns in each round, and ratios are computed within a round, so that a busy machine affects all equally.

const RADIUS := 0.5
const VIEW := 100.0
const DEFAULT_ROUNDS := 9

## Returns clamp((30 - slope) / 20, 0, 1).
class SlopeRule extends ScatterRule:
	var threaded := false

	func _get_densities(positions: PackedVector3Array, _normals: PackedVector3Array, slopes: PackedFloat32Array,
			_texture_weights: PackedFloat32Array) -> PackedFloat32Array:
		var densities := PackedFloat32Array()
		densities.resize(positions.size())
		for index in positions.size():
			densities[index] = clampf((30.0 - slopes[index]) / 20.0, 0.0, 1.0)
		return densities

	func _is_thread_safe() -> bool:
		return threaded


func run() -> String:
	RenderingServer.render_loop_enabled = false
	var rounds := rounds_or(DEFAULT_ROUNDS)
	var contenders: Dictionary[String, Callable] = {
		"max_slope_degrees with a falloff": _by_property, "density_expression": _by_expression,
		"a rule script on threads": _by_script.bind(true), "a rule script on the main thread": _by_script.bind(false),
	}
	await _fill(_by_property) # The first round warms up.
	var times: Dictionary[String, Array] = {}
	for round in rounds:
		for label in contenders:
			times.get_or_add(label, []).push_back(await _fill(contenders[label]))
	for label in times:
		_report(label, times[label], times.values()[0])
	return ""


func _by_property(layer: ScatterLayer) -> void:
	layer.max_slope_degrees = 30.0
	layer.slope_falloff_degrees = 20.0


func _by_expression(layer: ScatterLayer) -> void:
	layer.density_expression = "clamp((30 - slope) / 20, 0, 1)"


func _by_script(layer: ScatterLayer, threaded: bool) -> void:
	var rule := SlopeRule.new()
	rule.threaded = threaded
	layer.density_rules = [rule]


## Returns the seconds until all tiles around the viewer are visible.
func _fill(add_rule: Callable) -> float:
	var ground := ScatterGroundNoise.new()
	ground.noise = FastNoiseLite.new()
	ground.amplitude = 20.0
	var layer := ScatterLayer.new()
	layer.radius = RADIUS
	layer.tile_size = 32.0
	layer.view_distance = VIEW
	layer.meshes = [BoxMesh.new()]
	add_rule.call(layer)
	var viewer := Node3D.new()
	make_scatter(ground, [layer], viewer)
	scatter.frame_budget_usec = 1_000_000
	var start := Time.get_ticks_usec()
	var failure := await idle()
	var seconds := (Time.get_ticks_usec() - start) / 1e6
	if failure != "":
		printerr(failure)
	scatter.free()
	viewer.free()
	return seconds


func _report(label: String, times: Array, base: Array) -> void:
	var ratios: Array[float] = []
	for round in times.size():
		ratios.push_back(times[round] / base[round])
	times = times.duplicate()
	times.sort()
	ratios.sort()
	print("| first fill of a layer with %s | %.2f s | %.2f to %.2f times the property's, median %.2f | %d |" % [
		label, times[floori(times.size() / 2.0)], ratios[0], ratios[-1], ratios[floori(ratios.size() / 2.0)], times.size()])
