extends SceneTree
## Measures the cost of streaming on the main thread. Flies over the demo's forest in a straight line, and measures the scatter's
## time in each frame. Prints rows of a Markdown table.
##   tools/godot --headless --path demo_project --script tests/bench/streaming.gd [-- SECONDS]
##   tools/godot --xvfb ...     the same with a software renderer, whose uploads are copies by the CPU
##
## The viewer's position depends on the wall clock, so there is more to do in a frame after a slow one. The renderer draws nothing, because software
## rendering would dominate the measurement. It still receives buffers, which is the main thread's cost of an upload.

const SPEED := 100.0
const FRAMES_PER_SECOND := 60
const EYE := 150.0
const START := Vector2(-9000.0, 6000.0)
const DIRECTION := Vector2(0.8, -0.6)
const DEFAULT_SECONDS := 60.0
const PATIENCE_SECONDS := 180.0

var _scatter: Node
var _viewer := Node3D.new()


func _initialize() -> void:
	_run.call_deferred()


func _run() -> void:
	RenderingServer.render_loop_enabled = false
	var seconds := DEFAULT_SECONDS
	var arguments := OS.get_cmdline_user_args()
	if arguments.size() > 0:
		seconds = maxf(1.0, arguments[0].to_float())
	if not _take_scatter():
		return _end("no TerrainScatter3D in the demo")
	root.add_child(_viewer)
	_fly(0.0)
	_scatter.set(&"viewers", [_scatter.get_path_to(_viewer)])
	var limit := Time.get_ticks_msec() + int(PATIENCE_SECONDS * 1000.0)
	for frame in 3:
		await process_frame
	while not _scatter.call(&"is_settled"):
		if Time.get_ticks_msec() > limit:
			return _end("not idle after %.0f s" % PATIENCE_SECONDS)
		await process_frame
	_report(await _measure(seconds))
	_end("")


## Takes the scatter from the demo's scene, with its layers and ground, but without the demo's scripts. Returns false if
## there is none.
func _take_scatter() -> bool:
	var demo := (load(ProjectSettings.get_setting("application/run/main_scene")) as PackedScene).instantiate()
	for node in demo.find_children("*", "TerrainScatter3D", true, false):
		_scatter = node
		_scatter.owner = null
		_scatter.get_parent().remove_child(_scatter)
		break
	demo.free()
	if _scatter != null:
		root.add_child(_scatter)
	return _scatter != null


## Moves the viewer to its position after this many seconds. Its height is constant, because it has no effect.
func _fly(seconds: float) -> void:
	var point := START + DIRECTION * SPEED * seconds
	_viewer.global_position = Vector3(point.x, EYE, point.y)


## Returns the stats of each frame of the flight.
func _measure(seconds: float) -> Array[Dictionary]:
	var frames: Array[Dictionary] = []
	Engine.max_fps = FRAMES_PER_SECOND
	var start := Time.get_ticks_usec()
	var elapsed := 0.0
	while elapsed < seconds:
		elapsed = (Time.get_ticks_usec() - start) / 1e6
		_fly(elapsed)
		await process_frame
		frames.push_back(_scatter.call(&"get_stats"))
	return frames


func _report(frames: Array[Dictionary]) -> void:
	var spent := PackedFloat64Array()
	var most_waiting := 0
	for stats in frames:
		spent.push_back(float(stats.frame_usec))
		most_waiting = maxi(most_waiting, int(stats.waiting) + int(stats.pending))
	spent.sort()
	var last := frames[-1]
	var drawing_mode := "headless" if DisplayServer.get_name() == "headless" else "drawn in software"
	var flight := "flight at %.0f m/s, budget %d µs, %s" % [SPEED, _scatter.get(&"frame_budget_usec"), drawing_mode]
	var count := frames.size()
	var row := "| %s: main thread per frame, %s | %.0f µs | %.0f to %.0f µs | %d frames |"
	print(row % [flight, "median", spent[count / 2], spent[0], spent[-1], count])
	print(row % [flight, "p99", spent[ceili(0.99 * count) - 1], spent[0], spent[-1], count])
	print("| %s: visible at the end | %d tiles, %d instances | exact | 1 |" % [flight, last.tiles, last.instances])
	print("| %s: tiles not yet shown, at most | %d | exact | 1 |" % [flight, most_waiting])


func _end(failure: String) -> void:
	if failure != "":
		printerr("streaming: " + failure)
	if _scatter != null:
		_scatter.queue_free()
	RenderingServer.render_loop_enabled = true
	quit(0 if failure == "" else 1)
