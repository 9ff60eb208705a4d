extends "bench.gd"
## Measures the startup cost of the add-on: the time from the engine's start until the first tile of the demo is visible, compared
## with the same scene without a scatter. Prints rows of a Markdown table.
##   tools/godot --headless --path demo_project --script tests/bench/load.gd [-- ROUNDS]

const DEFAULT_ROUNDS := 5
const SCENE := "scene"


func run() -> String:
	if OS.get_cmdline_user_args().has(SCENE):
		return await _start_scene()
	var with_scatter := PackedFloat64Array()
	var without_scatter := PackedFloat64Array()
	for round in rounds_or(DEFAULT_ROUNDS):
		for scattered: bool in [true, false]:
			var arguments: Array[String] = [SCENE] # Runs in a separate engine, which has nothing loaded yet.
			if not scattered:
				arguments.push_back("bare")
			var seconds := seconds_in_another_engine(arguments)
			if seconds < 0.0:
				return "an engine that was started printed no time"
			(with_scatter if scattered else without_scatter).push_back(seconds)
	row("from the engine's start to the first tile of the demo, headless", with_scatter, "s", 2)
	row("from the engine's start to the scene's second frame, without the scatter", without_scatter, "s", 2)
	return ""


func _start_scene() -> String:
	var demo := (load(ProjectSettings.get_setting("application/run/main_scene")) as PackedScene).instantiate()
	for node in demo.find_children("*", "TerrainScatter3D", true, false):
		scatter = node
	if OS.get_cmdline_user_args().has("bare"):
		scatter.free()
		scatter = null
	root.add_child(demo)
	var limit := Time.get_ticks_msec() + int(PATIENCE_SECONDS * 1000.0)
	await process_frame
	await process_frame
	while scatter != null and scatter.get_stats().instances == 0:
		if Time.get_ticks_msec() > limit:
			return "no tile after %.0f s" % PATIENCE_SECONDS
		await process_frame
	print_seconds(Time.get_ticks_usec() / 1e6)
	scatter = null # The scatter is freed with its scene.
	demo.queue_free()
	await process_frame
	return ""
