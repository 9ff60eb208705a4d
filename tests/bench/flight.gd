extends "bench.gd"
## Measures the cost of a wide view on the main thread: 1.2 million visible instances in about 860 tiles of three layers with
## spacing, while the viewer flies over the demo's ground. Prints rows of a Markdown table.
##   tools/godot --headless --path demo_project --script tests/bench/flight.gd [-- SECONDS]
##
## The viewer's position depends on the wall clock, so there is more to do in a frame after a slow one.

const SPEEDS: Array[float] = [100.0, 1000.0] ## Speeds of the viewer in meters per second.
const FRAMES_PER_SECOND := 60
const EYE := 150.0
const START := Vector2(-9000.0, 6000.0)
const DIRECTION := Vector2(0.8, -0.6)
const DEFAULT_SECONDS := 20

var _viewer := Node3D.new()


func run() -> String:
	var seconds := rounds_or(DEFAULT_SECONDS)
	make_scatter(demo_terrain(), _layers(), _viewer)
	for speed in SPEEDS:
		_fly(speed, 0.0)
		var failure := await idle()
		if failure != "":
			return failure
		if speed == SPEEDS[0]:
			_tell_view()
		await _measure(speed, seconds)
	return ""


func _tell_view() -> void:
	var shown: Dictionary = scatter.get_stats()
	exact_row("a wide view: visible", "%d tiles, %d instances" % [shown.tiles, shown.instances])
	exact_row("a wide view: main memory per instance, without the renderer's buffers",
			"%.1f bytes" % (float(shown.instance_bytes) / shown.instances))


func _layers() -> Array[ScatterLayer]:
	var layers: Array[ScatterLayer] = []
	for numbers: Array in [[6.0, 128.0, 1200.0], [1.5, 64.0, 600.0], [0.52, 32.0, 330.0]]:
		var layer := ScatterLayer.new()
		layer.resource_name = "radius %s" % numbers[0]
		layer.radius = numbers[0]
		layer.tile_size = numbers[1]
		layer.view_distance = numbers[2]
		layer.meshes = [BoxMesh.new()]
		var spacing := {}
		for other in layers:
			spacing[other.resource_name] = 0.25 * other.radius
		layer.spacing = spacing
		layers.push_back(layer)
	return layers


func _fly(speed: float, seconds: float) -> void:
	var point := START + DIRECTION * speed * seconds
	_viewer.global_position = Vector3(point.x, EYE, point.y)


func _measure(speed: float, seconds: float) -> void:
	Engine.max_fps = FRAMES_PER_SECOND
	var spent := PackedFloat64Array()
	var longest := {}
	var longest_waited := 0
	var start := Time.get_ticks_usec()
	var elapsed := 0.0
	while elapsed < seconds:
		elapsed = (Time.get_ticks_usec() - start) / 1e6
		_fly(speed, elapsed)
		var waited := thread_times().y
		await process_frame
		var stats: Dictionary = scatter.get_stats()
		spent.push_back(stats.frame_usec)
		if longest.is_empty() or stats.frame_usec > longest.frame_usec:
			longest = stats
			longest_waited = thread_times().y - waited
	Engine.max_fps = 0
	spent.sort()
	var count := spent.size()
	var flight := "a wide view, flight at %.0f m/s: main thread per frame" % speed
	var extremes := [spent[0], spent[-1], count]
	print("| %s, median | %.0f µs | %.0f to %.0f µs | %d frames |" % ([flight, spent[count / 2]] + extremes))
	print("| %s, p99 | %.0f µs | %.0f to %.0f µs | %d frames |" % ([flight, spent[ceili(0.99 * count) - 1]] + extremes))
	# The time that the main thread waited for a CPU in the whole frame, including the engine's part. The system does
	# not report when in the frame it waited.
	var details := [parts_text(longest.get("frame_parts", {})), longest_waited]
	print("| %s, the longest | %.0f µs | %s; waited %d for a processor | %d frames |" % ([flight, spent[-1]] + details + [count]))
