extends "bench.gd"
## Measures the rendering cost of the views in the demo's first scene. Visits its stops and counts the triangles and draw calls in
## view, with near tiles divided into cells, and with all tiles drawn as a whole. Prints rows of a Markdown table.
##   tools/godot --xvfb --path demo_project --script tests/bench/views.gd [-- STOP,STOP]
##
## The numbers depend only on the scene, not on the machine. Shadows, ground and sky are not counted, and nothing is
## drawn. With --headless, cross-fading LODs are not counted, because shaders are unknown without a renderer.

const STOPS := ["forest", "walk", "ridge", "overview"]
const SIZE := Vector2i(1920, 1080)

var _demo: Node3D


func run() -> String:
	var user_arguments := OS.get_cmdline_user_args()
	var stop_names: PackedStringArray = user_arguments[0].split(",") if user_arguments.size() > 0 else PackedStringArray(STOPS)
	root.size = SIZE
	root.disable_3d = true
	_demo = (load(ProjectSettings.get_setting("application/run/main_scene")) as PackedScene).instantiate()
	root.add_child(_demo)
	await process_frame
	scatter = _demo.get(&"scatter")
	for stop: Dictionary in _demo.call(&"stops"):
		if stop.name in stop_names:
			_demo.call(&"place", stop)
			var failure := await _compare(stop.name)
			if failure != "":
				return failure
	scatter = null # The scatter is freed with the demo.
	_demo.queue_free()
	return ""


func _compare(stop: String) -> String:
	var max_multimeshes := scatter.max_multimeshes
	for cells: bool in [false, true]:
		scatter.max_multimeshes = max_multimeshes if cells else 0
		var failure := await idle()
		if failure != "":
			return failure
		_print(stop, "in cells" if cells else "whole")
	return ""


func _print(stop: String, how: String) -> void:
	var draw_stats := scatter.get_draw_stats(_demo.get(&"camera"))
	for figure: String in ["triangles", "draw_calls"]:
		exact_row("view %s, tiles %s: %s in sight" % [stop, how, figure.replace("_", " ")], str(draw_stats[figure]))
	exact_row("view %s, tiles %s: visible multimeshes" % [stop, how], str(scatter.get_stats().multimeshes))
