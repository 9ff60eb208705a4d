extends SceneTree
## What bodies cost: gives some thousand instances around a viewer a body each, for every shape, at once and under the usual budget of a
## frame, and lets the viewer move among them. Prints rows of a Markdown table.
##   tools/godot --headless --path demo_project --script tests/bench/collision.gd
##
## Times are what the node spends on the main thread in its frames, the search for what is near included. No body of the game is
## there, so nothing of it is the work of the physics server's own steps.

const SHAPES := {
	"capsules": ScatterLayer.COLLISION_CAPSULE,
	"cylinders": ScatterLayer.COLLISION_CYLINDER,
	"boxes": ScatterLayer.COLLISION_BOX,
	"convex": ScatterLayer.COLLISION_CONVEX,
}
const DISTANCE := 80.0 ## Metres.
const ROUNDS := 5
const USUAL_BUDGET := 500    ## Microseconds a frame.
const WHOLE_BUDGET := 100000 ## Enough for all at once.
const WALK := 5.0 ## Metres a second.
const DRIVE := 50.0
const FLIGHT := 1000.0
const SECONDS := 4.0
const PATIENCE_SECONDS := 120.0

var _scatter: TerrainScatter3D
var _layer: ScatterLayer
var _viewer := Node3D.new()


func _initialize() -> void:
	_run.call_deferred()


func _run() -> void:
	_make_scene()
	if not await _idle():
		return _end("not idle after %.0f s" % PATIENCE_SECONDS)
	print("Physics: %s, %d cores." % [ProjectSettings.get_setting("physics/3d/physics_engine"), OS.get_processor_count()])
	print("| Collision bodies | created a millisecond | removed a millisecond | bodies |")
	print("|---|---|---|---|")
	for title: String in SHAPES:
		var row := await _measure_shape(SHAPES[title])
		if row.is_empty():
			return _end("bodies did not come")
		print("| %s | %.0f | %.0f | %d |" % [title, row["created"], row["removed"], row["bodies"]])
	_layer.collision_shape = ScatterLayer.COLLISION_CYLINDER
	_layer.collision_distance = 40.0
	print("| A frame of a viewer among cylinders, 40 m around | median | 99 % | longest |")
	print("|---|---|---|---|")
	for speed: float in [0.0, WALK, DRIVE, FLIGHT]:
		await _report_moving(speed)
	_end("")


func _make_scene() -> void:
	_layer = ScatterLayer.new()
	_layer.radius = 2.0
	_layer.tile_size = 32.0
	_layer.view_distance = 160.0
	_layer.min_scale = 0.6
	_layer.max_scale = 1.6
	_layer.collision_distance = DISTANCE
	_layer.meshes = [PrismMesh.new(), BoxMesh.new()]
	root.add_child(_viewer)
	_scatter = TerrainScatter3D.new()
	_scatter.terrain = ScatterTerrainFlat.new()
	_scatter.layers = [_layer]
	_scatter.upload_budget_usec = WHOLE_BUDGET
	root.add_child(_scatter)
	_scatter.viewers = [_scatter.get_path_to(_viewer)]
	Engine.max_fps = 60


func _idle() -> bool:
	var limit := Time.get_ticks_msec() + int(PATIENCE_SECONDS * 1000.0)
	await process_frame
	await process_frame
	while not _scatter.is_idle():
		if Time.get_ticks_msec() > limit:
			return false
		await process_frame
	return true


## The median rates of some rounds: bodies come and go all at once.
func _measure_shape(shape: ScatterLayer.CollisionShape) -> Dictionary:
	var created: PackedFloat64Array = []
	var removed: PackedFloat64Array = []
	var bodies := 0
	for round in ROUNDS:
		for kind: ScatterLayer.CollisionShape in [shape, ScatterLayer.COLLISION_NONE]:
			var before: int = _scatter.get_stats()["bodies"]
			_layer.collision_shape = kind
			var usec := 0.0
			var changed := 0
			var limit := Time.get_ticks_msec() + int(PATIENCE_SECONDS * 1000.0)
			while changed == 0 or not _scatter.is_idle():
				await process_frame
				usec += _scatter.get_stats()["frame_usec"]
				changed = absi(_scatter.get_stats()["bodies"] - before)
				if Time.get_ticks_msec() > limit:
					return {}
			if kind == shape:
				bodies = changed
				created.push_back(changed * 1000.0 / usec)
			else:
				removed.push_back(changed * 1000.0 / usec)
	created.sort()
	removed.sort()
	@warning_ignore("integer_division")
	return {"created": created[ROUNDS / 2], "removed": removed[ROUNDS / 2], "bodies": bodies}


func _report_moving(speed: float) -> void:
	_viewer.position = Vector3.ZERO
	_scatter.upload_budget_usec = WHOLE_BUDGET
	await _idle()
	_scatter.upload_budget_usec = USUAL_BUDGET
	for frame in 3:
		await process_frame # What is told is the frame before.
	var times: PackedFloat64Array = []
	for frame in int(SECONDS * 60.0):
		_viewer.position.x += speed / 60.0
		await process_frame
		times.push_back(_scatter.get_stats()["frame_usec"])
	times.sort()
	@warning_ignore("integer_division")
	print("| %.0f m/s, the tiles that come included | %.0f µs | %.0f µs | %.0f µs |" % [
			speed, times[times.size() / 2], times[times.size() * 99 / 100], times[-1]])


func _end(problem: String) -> void:
	if problem:
		printerr("collision: " + problem)
	quit(1 if problem else 0)
