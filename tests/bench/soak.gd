extends SceneTree
## Simulates hours of play in minutes and checks that nothing grows. Flies at full speed, teleports, moves the origin, fells and
## plants, queries, saves and loads, while bodies and scenes are added and removed. Prints a line per minute and a verdict. The
## exit code is 1 if anything grew or a result was wrong.
##   export MALLOC_ARENA_MAX=1 MALLOC_MMAP_THRESHOLD_=131072 MALLOC_TRIM_THRESHOLD_=131072
##   tools/godot --headless --path demo_project --script "$PWD/tests/bench/soak.gd" [-- SECONDS [SECONDS A LINE]]
## (without these variables, the amount of free memory that glibc keeps varies; see test_soak.py)
##
## The simulation consists of rounds. At the end of each round, the state is cleared, the viewer is at the origin and
## all requests are finished, so that figures are comparable. The first quarter of the time warms up. Afterward, the
## resident set may deviate from its median by 5 %. The numbers of nodes, orphans, objects and bodies must stay
## constant. After everything is freed, the numbers of nodes, orphans and bodies must return to their initial values.

const DEFAULT_SECONDS := 1200.0
const SECONDS_A_LINE := 60.0
const WARM_UP := 0.25
const FLAT := 0.05
## The minimum number of rounds that fill all caches. It is not a time, because a busy machine simulates fewer rounds
## per second.
const WARM_UP_ROUNDS := 16
const LEAST_SAMPLES := 3
const PATIENCE_SECONDS := 60.0
## The number of frames in a round. They run as fast as possible. Each simulates a sixtieth of a second of flight.
const FRAMES := 200
const METERS_A_FRAME := 1000.0 / 60.0
## The maximum distance of teleports from the world's origin, per axis, in meters.
const FARTHEST := 1.0e6
## The distance from the engine's origin, in meters, beyond which the origin is moved.
const RECENTER := 2048.0
const SAVED := "user://soak.res"

var _scatter: TerrainScatter3D
var _viewer: Node3D
var _walker: Node3D
var _rng := RandomNumberGenerator.new()
var _heading := Vector3.FORWARD
var _planted: Array[int] = []
var _taken: Array[Node3D] = []
var _requests := {} ## The pending requests.
var _done := {"rounds": 0, "frames": 0, "felled": 0, "planted": 0, "answers": 0, "loads": 0, "teleports": 0}
var _samples: Array[Dictionary] = []
var _lines := 0
var _failure := ""


func _initialize() -> void:
	_run.call_deferred()


func _run() -> void:
	var arguments := OS.get_cmdline_user_args()
	var seconds := maxf(5.0, arguments[0].to_float()) if arguments.size() > 0 else DEFAULT_SECONDS
	var line := maxf(1.0, arguments[1].to_float()) if arguments.size() > 1 else SECONDS_A_LINE
	await process_frame
	var at_first := _count()
	_make_world()
	var start := Time.get_ticks_msec()
	var elapsed := 0.0
	while _failure == "" and (elapsed < seconds or _samples.size() < LEAST_SAMPLES):
		await _play_round()
		await _go_home()
		elapsed = (Time.get_ticks_msec() - start) / 1000.0
		if elapsed >= WARM_UP * seconds and _done.rounds > WARM_UP_ROUNDS:
			_samples.append(_count())
		if elapsed >= line * (_lines + 1):
			_lines = int(elapsed / line)
			print(_line(elapsed))
	if _failure == "":
		_judge()
	await _free_world()
	_compare("after everything was freed", _count(), at_first, ["nodes", "orphans", "bodies"])
	print("soak: %s" % ("passed" if _failure == "" else "FAILED: " + _failure))
	quit(0 if _failure == "" else 1)


## Creates trees with bodies and scenes, stones with convex bodies, grass, and stumps that are only placed by hand.
func _make_world() -> void:
	_scatter = TerrainScatter3D.new()
	_scatter.seed = 11
	_scatter.ground = ScatterGroundNoise.new()
	_scatter.ground.noise = FastNoiseLite.new()
	_scatter.layers = [_layer("Tree", 6.0, 128.0), _layer("Stone", 4.0, 64.0), _layer("Grass", 1.2, 32.0),
		_layer("Stump", 2.0, 64.0)]
	_scatter.layers[0].collision_shape = ScatterLayer.COLLISION_CAPSULE
	_scatter.layers[0].scene = _scene()
	_scatter.layers[0].regrowth_time = 3.0
	_scatter.layers[1].collision_shape = ScatterLayer.COLLISION_CONVEX
	_scatter.layers[3].density = 0.0
	_scatter.layers[3].collision_shape = ScatterLayer.COLLISION_CYLINDER
	_scatter.state = ScatterState.new()
	_viewer = Node3D.new()
	_walker = Node3D.new()
	root.add_child(_viewer)
	root.add_child(_walker)
	_walker.add_to_group(&"scatter_interaction")
	root.add_child(_scatter)
	_scatter.viewers = [_scatter.get_path_to(_viewer)]


static func _layer(layer_name: String, radius: float, tile_size: float) -> ScatterLayer:
	var layer := ScatterLayer.new()
	layer.resource_name = layer_name
	layer.radius = radius
	layer.tile_size = tile_size
	layer.view_distance = tile_size * 2.5
	layer.meshes = [BoxMesh.new()]
	return layer


static func _scene() -> PackedScene:
	var tree := MeshInstance3D.new()
	tree.mesh = BoxMesh.new()
	var scene := PackedScene.new()
	scene.pack(tree)
	tree.free()
	return scene


func _play_round() -> void:
	_done.rounds += 1
	_teleport(Vector3(_rng.randf_range(-FARTHEST, FARTHEST), 0.0, _rng.randf_range(-FARTHEST, FARTHEST)))
	_heading = Vector3.FORWARD.rotated(Vector3.UP, _rng.randf() * TAU)
	for frame in FRAMES:
		_fly()
		_change(frame)
		_ask(frame)
		_come_and_go(frame)
		await process_frame
		_done.frames += 1
		if _failure != "":
			return


## Moves the origin and the viewer to a position in the world.
func _teleport(point: Vector3) -> void:
	_done.teleports += 1
	_scatter.world_offset = point.snapped(Vector3(1024.0, 1.0e9, 1024.0))
	_viewer.position = point - _scatter.world_offset
	_walker.position = _viewer.position + Vector3(3.0, 0.0, 2.0)


func _fly() -> void:
	_viewer.position += _heading * METERS_A_FRAME
	_walker.position = _viewer.position + Vector3(3.0, 0.0, 2.0)
	if _viewer.position.length() > RECENTER:
		_teleport(_viewer.position + _scatter.world_offset)


func _change(frame: int) -> void:
	if frame % 7 == 0:
		_done.felled += _scatter.remove_in_sphere(_viewer.position, 25.0, [_scatter.layers[0], _scatter.layers[1], _scatter.layers[2]]).size()
	if frame % 5 == 0:
		var id := _scatter.add_instance(_scatter.layers[3], Transform3D(Basis.IDENTITY, _viewer.position))
		_expect(id != 0 and _scatter.has_instance(id), "a planted stump exists")
		_scatter.set_instance_data(id, {"frame": frame, "by": "soak"})
		_planted.append(id)
		_done.planted += 1
	if frame % 31 == 0 and not _planted.is_empty():
		var id: int = _planted.pop_front()
		_expect(_scatter.get_instance_data(id) != null, "a stump has its data")
		_expect(_scatter.remove_instance(id), "a planted stump can be removed")
		_expect(not _scatter.has_instance(id), "a removed stump is gone")
	if frame % 90 == 89:
		_save_and_load(_done.loads % 2 == 0)


## Saves and loads the state through a file or bytes. The loaded state replaces the old one, so the world does not change.
func _save_and_load(by_file: bool) -> void:
	var digest := _scatter.state.get_digest()
	var loaded_state := ScatterState.new()
	if by_file:
		_expect(ResourceSaver.save(_scatter.state, SAVED) == OK, "the state can be saved")
		loaded_state = ResourceLoader.load(SAVED, "", ResourceLoader.CACHE_MODE_IGNORE) as ScatterState
	else:
		_expect(loaded_state.from_bytes(_scatter.state.to_bytes()) == OK, "the state's bytes can be read")
	_expect(loaded_state != null and loaded_state.get_digest() == digest, "a loaded state equals the saved one")
	_scatter.state = loaded_state
	_done.loads += 1


func _ask(frame: int) -> void:
	var center := _viewer.position
	if frame % 11 == 0:
		var nearby := _scatter.query_sphere(center, 40.0)
		_expect(nearby.ids.size() == nearby.positions.size() and nearby.transforms.size() == 12 * nearby.ids.size(),
				"all arrays of a query result have the same length")
		_done.answers += 1
	if frame % 13 == 0:
		var nearest := _scatter.query_nearest(center, 100.0, _scatter.layers[0], func(_id: int, _layer: ScatterLayer, at: Transform3D) -> bool:
			return at.origin.x > center.x)
		_expect(nearest == null or _scatter.has_instance(nearest.id), "the nearest instance exists")
		_scatter.query_ray(center + Vector3(0.0, 5.0, 0.0), center + _heading * 80.0)
		_done.answers += 2
	if frame % 37 == 0:
		var request := _scatter.request_sphere(center + _heading * 3000.0, 100.0, [_scatter.layers[0], _scatter.layers[1]])
		request.completed.connect(_on_completed.bind(request.get_instance_id()))
		_requests[request.get_instance_id()] = true
	if frame % 111 == 0:
		_scatter.request_rect(Rect2(center.x, center.z, 500.0, 500.0)).cancel()


func _on_completed(result: ScatterInstances, request: int) -> void:
	_expect(_requests.erase(request), "a request completes once")
	_expect(result.size() == result.ids.size(), "a result has an ID for each instance")
	_done.answers += 1


## Adds a moving body every 60 frames, for a short time. Sometimes a scene is taken from the scatter, as a game does with a
## felled tree.
func _come_and_go(frame: int) -> void:
	if frame % 60 == 0:
		var body := Node3D.new()
		root.add_child(body)
		body.add_to_group(&"scatter_interaction")
		body.position = _viewer.position + _heading * METERS_A_FRAME * 20.0
		create_timer(0.05).timeout.connect(body.queue_free)
	if frame % 45 == 0:
		var nearest := _scatter.query_nearest(_viewer.position, 30.0, _scatter.layers[0])
		var scene := _scatter.take_scene(nearest.id) if nearest != null else null
		if scene != null:
			scene.reparent(root)
			_scatter.remove_instance(nearest.id)
			_taken.append(scene)
	if _taken.size() > 3:
		_taken.pop_front().queue_free()


## Restores the situation in which the figures are recorded.
func _go_home() -> void:
	for scene in _taken:
		scene.queue_free()
	_taken.clear()
	_planted.clear()
	_scatter.state.clear()
	_teleport(Vector3.ZERO)
	var limit := Time.get_ticks_msec() + int(PATIENCE_SECONDS * 1000.0)
	await create_timer(0.1).timeout
	while _failure == "" and not (_scatter.is_settled() and _requests.is_empty()):
		_expect(Time.get_ticks_msec() < limit, "all tiles are visible and all requests completed within %.0f s" % PATIENCE_SECONDS)
		await process_frame
	# Only a few bodies and scenes appear per frame, so the loop waits for them.
	for frame in 60:
		await process_frame


func _free_world() -> void:
	for node: Node in [_scatter, _viewer, _walker]:
		node.queue_free()
	_scatter = null
	await create_timer(0.2).timeout
	DirAccess.remove_absolute(SAVED)


## Returns the current figures. Pooled scenes are subtracted, because they are not a leak: the pool has a limit.
func _count() -> Dictionary:
	var stats := _scatter.get_stats() if _scatter != null else {}
	var pooled: int = stats.get("scenes_pooled", 0)
	return {
		"resident": _resident_bytes(),
		"nodes": int(Performance.get_monitor(Performance.OBJECT_NODE_COUNT)),
		"orphans": int(Performance.get_monitor(Performance.OBJECT_ORPHAN_NODE_COUNT)) - pooled,
		"objects": int(Performance.get_monitor(Performance.OBJECT_COUNT)) - pooled,
		"bodies": stats.get("bodies", 0),
	}


## Returns the resident bytes of the process, or the engine's allocations if the system does not report them.
static func _resident_bytes() -> int:
	var status := FileAccess.open("/proc/self/status", FileAccess.READ)
	while status != null and not status.eof_reached():
		var line := status.get_line()
		if line.begins_with("VmRSS:"):
			return line.to_int() * 1024
	return OS.get_static_memory_usage()


func _judge() -> void:
	var resident := PackedInt64Array()
	for sample in _samples:
		resident.append(sample.resident)
		_compare("in round %d" % _samples.find(sample), sample, _samples[0], ["nodes", "orphans", "objects", "bodies"])
	var range_of := "%.1f to %.1f MB" % [_least(resident) / 1e6, _most(resident) / 1e6]
	var sorted := resident.duplicate()
	sorted.sort()
	var median := float(sorted[sorted.size() / 2])
	_expect(_most(resident) < median * (1.0 + FLAT) and _least(resident) > median * (1.0 - FLAT),
			"the resident set stays near its median, got " + range_of)
	print("| soak: resident set at rest, after the warm-up | %.1f MB | %s | %d |" % [
		median / 1e6, range_of, _samples.size()])


static func _least(values: PackedInt64Array) -> float:
	return Array(values).min()


static func _most(values: PackedInt64Array) -> float:
	return Array(values).max()


func _compare(label: String, got: Dictionary, expected: Dictionary, keys: Array[String]) -> void:
	for key in keys:
		_expect(got[key] == expected[key], "the number of %s %s is %d, expected %d" % [key, label, got[key], expected[key]])


func _line(elapsed: float) -> String:
	var count := _count()
	var flown: float = _done.frames * METERS_A_FRAME / 1000.0
	return "soak: %4.0f s, %d rounds, %.0f km, %d felled, %d planted, %d answers, %d loads, %d teleports; %s" % [
		elapsed, _done.rounds, flown, _done.felled, _done.planted, _done.answers, _done.loads, _done.teleports,
		"%.1f MB, %d nodes, %d objects, %d bodies" % [
			count.resident / 1e6, count.nodes, count.objects, count.bodies]]


func _expect(holds: bool, message: String) -> void:
	if not holds and _failure == "":
		_failure = message
