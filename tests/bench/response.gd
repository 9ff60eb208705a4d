extends "bench.gd"
## Measures the time until a change is visible. Changes the density of one layer with 10^5 visible instances, as a slider does.
## Measures the time until the tiles near the viewer are regenerated, the time until all tiles are regenerated, and the main thread's time per
## frame. Then drags the slider for two seconds, with a change in every frame. Prints rows of a Markdown table.
##   tools/godot --headless --path demo_project --script tests/bench/response.gd [-- ROUNDS]
##
## Times are wall time at 60 frames per second, from the frame in which the property is set. The time of a frame is the
## scatter's time on the main thread, including the comparison of all settings. It also includes waiting: for a core on
## a busy machine, and for memory pages from the host on a virtual machine. Therefore, the benchmark also prints the CPU time
## of the whole frame, including the engine, and the waiting time of the longest frame, if the system reports them.

const FRAMES_PER_SECOND := 60
const NEAR := 64.0 ## The distance from the viewer in meters within which tiles count as near.
const INSTANCES := 100000
const DRAG_SECONDS := 2.0
const DEFAULT_ROUNDS := 15
## Allocated and freed before the measurement, because the first access to memory may wait for a host.
const TOUCHED_BYTES := 512 << 20

var _layer: ScatterLayer
var _viewer := Node3D.new()
var _near: Array[Vector2i] = []
var _missing := {} ## The tiles that have not been regenerated since the last change.
var _seen := {}    ## How many times each tile was shown.
var _frames: PackedFloat64Array ## The scatter's microseconds on the main thread in each frame.
var _processor_frames: PackedFloat64Array ## The main thread's CPU time in microseconds in each frame, including the engine's work.
var _processor_usec := 0
var _waits: PackedFloat64Array ## The microseconds in each frame that the main thread was ready to run but had to wait for a core.
var _wait_usec := 0
var _most_pending := 0


func run() -> String:
	var rounds := rounds_or(DEFAULT_ROUNDS)
	var touched := PackedByteArray()
	touched.resize(TOUCHED_BYTES)
	touched.fill(1)
	touched.clear()
	_make_scene()
	var failure := await idle()
	if failure != "":
		return failure
	_find_near()
	Engine.max_fps = FRAMES_PER_SECOND
	var changes := await _measure_changes(rounds)
	var drags := await _measure_drags(maxi(1, rounds / 5))
	if changes.is_empty() or drags.is_empty():
		return "a change did not settle"
	_report(changes, drags)
	return ""


## Creates one layer on the demo's ground.
func _make_scene() -> void:
	_layer = ScatterLayer.new()
	_layer.radius = 1.2
	_layer.tile_size = 32.0
	_layer.view_distance = 256.0
	_layer.min_scale = 0.5
	_layer.align_to_normal = 0.5
	_layer.meshes = [BoxMesh.new(), SphereMesh.new()]
	_viewer.position = Vector3(310.0, 100.0, -270.0)
	make_scatter(demo_terrain(), [_layer], _viewer)
	scatter.tile_shown.connect(_on_tile_shown)


func _frame() -> void:
	await process_frame
	var stats := scatter.get_stats()
	_frames.push_back(float(stats.frame_usec))
	_most_pending = maxi(_most_pending, int(stats.pending))
	var current_times := thread_times()
	_processor_frames.push_back(float(current_times.x - _processor_usec))
	_waits.push_back(float(current_times.y - _wait_usec))
	_processor_usec = current_times.x
	_wait_usec = current_times.y


func _find_near() -> void:
	var at := Vector2(_viewer.global_position.x, _viewer.global_position.z)
	for tile: Vector2i in scatter.get_shown_tiles(scatter.layers[0]):
		var rect := Rect2(Vector2(tile) * _layer.tile_size, Vector2.ONE * _layer.tile_size)
		if at.distance_to(at.clamp(rect.position, rect.end)) <= NEAR:
			_near.push_back(tile)


func _on_tile_shown(_index: int, tile: Vector2i) -> void:
	_missing.erase(tile)
	_seen[tile] = _seen.get(tile, 0) + 1


## Sets the density and waits until all tiles are regenerated. Returns the milliseconds until the near tiles and until all
## tiles are regenerated. The list is empty if that takes too long.
func _change(density: float) -> PackedFloat64Array:
	var result := PackedFloat64Array([-1.0, -1.0])
	_missing.clear()
	for tile: Vector2i in scatter.get_shown_tiles(scatter.layers[0]):
		_missing[tile] = true
	var start := Time.get_ticks_usec()
	_layer.density = density
	while _missing.size() > 0 or not scatter.is_settled():
		await _frame()
		var elapsed := (Time.get_ticks_usec() - start) / 1e3
		if result[0] < 0.0 and not _near.any(func(tile: Vector2i) -> bool: return _missing.has(tile)):
			result[0] = elapsed
		result[1] = elapsed
		if elapsed > PATIENCE_SECONDS * 1000.0:
			return PackedFloat64Array()
	return result


## Returns a dictionary of figures, each a list with one value per round. It is empty if a change did not settle.
func _measure_changes(rounds: int) -> Dictionary:
	var figures := _no_figures()
	for round in rounds + 1:
		_begin_round()
		var times := await _change(0.97 if round % 2 == 0 else 1.0)
		if times.is_empty():
			return {}
		if round > 0: # The first round warms up.
			figures.near.push_back(times[0])
			figures.all.push_back(times[1])
			_add_frames(figures)
	return figures


func _no_figures() -> Dictionary:
	return {"near": [], "all": [], "longest": [], "p99": [], "processor": [], "waited": [], "pending": [], "renewed": []}


func _begin_round() -> void:
	_frames.clear()
	_processor_frames.clear()
	_waits.clear()
	var current_times := thread_times()
	_processor_usec = current_times.x
	_wait_usec = current_times.y
	_most_pending = 0


func _add_frames(figures: Dictionary) -> void:
	var sorted := _frames.duplicate()
	sorted.sort()
	figures.longest.push_back(sorted[-1])
	figures.p99.push_back(sorted[ceili(0.99 * sorted.size()) - 1])
	figures.waited.push_back(_waits[_frames.find(sorted[-1])])
	_processor_frames.sort()
	figures.processor.push_back(_processor_frames[-1])
	figures.pending.push_back(float(_most_pending))


func _measure_drags(rounds: int) -> Dictionary:
	var figures := _no_figures()
	for round in rounds:
		_begin_round()
		_seen.clear()
		var steps := int(DRAG_SECONDS * FRAMES_PER_SECOND)
		for step in steps:
			_layer.density = 0.9 + 0.0005 * step
			await _frame()
		var rates := _near.map(func(tile: Vector2i) -> float: return _seen.get(tile, 0) / DRAG_SECONDS)
		figures.renewed.push_back(rates.min())
		var times := await _change(0.8 + 0.01 * round)
		if times.is_empty():
			return {}
		figures.near.push_back(times[0])
		figures.all.push_back(times[1])
		_add_frames(figures)
	return figures


func _report(changes: Dictionary, drags: Dictionary) -> void:
	var stats := scatter.get_stats()
	var label := "slider, %d instances in %d tiles" % [stats.instances, stats.tiles]
	row(label + ": %d tiles within %.0f m regenerated" % [_near.size(), NEAR], changes.near, "ms")
	row(label + ": all tiles regenerated", changes.all, "ms")
	_row_frames(label, changes)
	row(label + ": pending tiles, at most", changes.pending, "")
	var drag := label + ", dragged for %.0f s" % DRAG_SECONDS
	row(drag + ": the last value within %.0f m" % NEAR, drags.near, "ms")
	row(drag + ": the last value everywhere", drags.all, "ms")
	row(drag + ": each tile within %.0f m regenerated meanwhile, at least" % NEAR, drags.renewed, "times per second")
	_row_frames(drag, drags)
	row(drag + ": pending tiles, at most", drags.pending, "")
	if stats.instances < 0.9 * INSTANCES or stats.instances > 1.2 * INSTANCES:
		printerr("response: %d instances are visible, expected about %d" % [stats.instances, INSTANCES])


func _row_frames(label: String, figures: Dictionary) -> void:
	row(label + ": main thread per frame, longest", figures.longest, "µs")
	row(label + ": main thread per frame, p99", figures.p99, "µs")
	if _processor_usec > 0:
		row(label + ": time that the thread waited for a core in that longest frame", figures.waited, "µs")
		row(label + ": processor time of the engine's main thread per frame, longest", figures.processor, "µs")
