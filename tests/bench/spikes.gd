extends "bench.gd"
## Measures the longest main-thread frame after single events, until everything is up to date again. The events are bodies that
## come near many instances, a very large number of changes, a jump, and a changed layer. Prints rows of a Markdown table.
##   tools/godot --headless --path demo_project --script tests/bench/spikes.gd [-- ROUNDS]
##
## The lowest of several rounds is used, because a busy machine makes single frames longer.

const DEFAULT_ROUNDS := 3
const MILLION := 1000000
const BODIES := 64

var _viewer := Node3D.new()
var _group: Array[Node3D] = []
var _near: ScatterLayer
var _call_usec := 0.0
var _beyond_idle_usec := 0.0
var _under_way := false ## True while a thread applies a diff.


func run() -> String:
	var rounds := rounds_or(DEFAULT_ROUNDS)
	make_scatter(demo_terrain(), _layers(), _viewer)
	_viewer.position = Vector3(310.0, 100.0, -270.0)
	var failure := await idle()
	var far_state := _far_state()
	var events := {
		"%d bodies added far apart" % BODIES: [_add_bodies, _remove_bodies],
		"a diff of 10^6 changes": [_apply.bind(far_state.diff_since(0)), _forget],
		"a diff of 10^6 changes, apply_diff_async": [_apply_async.bind(far_state.diff_since(0)), _forget],
		"a new state of 10^6 removals": [_take.bind(far_state), _forget],
		"a jump of 10 km": [_jump.bind(10000.0), _jump.bind(-10000.0)],
		"a changed rule of a layer": [_change.bind(0.5), _change.bind(1.0)],
	}
	for label: String in events:
		var longest := []
		var calls := []
		var frames_over := []
		var parts := {}
		for round in rounds:
			for way: int in [0, 1]:
				var stats: Dictionary = await _watch(events[label][way])
				if way == 0:
					if longest.is_empty() or stats.frame_usec < longest.min():
						parts = stats.frame_parts
					longest.push_back(stats.frame_usec)
					frames_over.push_back(_beyond_idle_usec)
					calls.push_back(_call_usec)
		row(label + ": the call", [calls.min()], "µs")
		row(label + ": all of the main thread's processor time in a frame, beyond that of an idle frame", [frames_over.min()], "µs")
		print("| %s: the longest frame | %d µs | %s | %d |" % [label, longest.min(), parts_text(parts), rounds])
	return failure


func _layers() -> Array[ScatterLayer]:
	var layers: Array[ScatterLayer] = []
	for numbers: Array in [[4.0, 64.0, 400.0], [1.0, 32.0, 200.0], [0.45, 32.0, 120.0]]:
		var layer := ScatterLayer.new()
		layer.radius = numbers[0]
		layer.tile_size = numbers[1]
		layer.view_distance = numbers[2]
		layer.instance_radius = 0.1
		layer.instance_height = 1.0
		layer.meshes = [BoxMesh.new()]
		layers.push_back(layer)
	_near = layers[1]
	_near.collision_shape = ScatterLayer.COLLISION_CYLINDER
	_near.collision_distance = 20.0
	return layers


## Returns the stats of the longest frame from an event until everything is up to date.
func _watch(event: Callable) -> Dictionary:
	await idle()
	var idle_frames := []
	for frame in 60:
		idle_frames.push_back(await _frame_processor_time())
	idle_frames.sort()
	_call_usec = time_of(event)
	_beyond_idle_usec = 0.0
	var longest := {}
	var quiet := 0
	while quiet < 5:
		_beyond_idle_usec = maxf(_beyond_idle_usec, await _frame_processor_time() - idle_frames[30])
		quiet = quiet + 1 if scatter.is_settled() and not _under_way else 0
		var stats := scatter.get_stats()
		if longest.is_empty() or stats.frame_usec > longest.frame_usec:
			longest = stats
	return longest


## Returns the main thread's CPU time in microseconds until the next frame, including the engine's work, or 0 if the system
## does not report it.
func _frame_processor_time() -> float:
	var start := _processor_time()
	await process_frame
	return _processor_time() - start


func _add_bodies() -> void:
	for index in BODIES:
		var body := Node3D.new()
		@warning_ignore("integer_division")
		body.position = Vector3(index % 8 * 500.0 - 1750.0, 0.0, index / 8 * 500.0 - 1750.0)
		body.add_to_group("scatter_interaction")
		root.add_child(body)
		_group.push_back(body)


func _remove_bodies() -> void:
	for body in _group:
		body.queue_free()
	_group.clear()


## Returns a state with removals all over a layer, only a few of which are near the viewer.
func _far_state() -> ScatterState:
	var state := ScatterState.new()
	var tree_id: int = scatter.query_rect(Rect2(300.0, -280.0, 20.0, 20.0), scatter.layers[1]).ids[0]
	for index in MILLION:
		state.remove((tree_id & ~0xffffffffffff) | (index * 7919 << 3))
	return state


func _apply(diff: PackedByteArray) -> void:
	scatter.state = ScatterState.new()
	scatter.state.apply_diff(diff)


func _apply_async(diff: PackedByteArray) -> void:
	scatter.state = ScatterState.new()
	_under_way = true
	scatter.state.apply_diff_async(diff, func(error: Error) -> void: _under_way = error != OK)


func _take(far_state: ScatterState) -> void:
	scatter.state = far_state


func _forget() -> void:
	scatter.state = null


func _jump(way: float) -> void:
	_viewer.position.x += way


func _change(density: float) -> void:
	_near.density = density
