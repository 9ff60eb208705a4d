extends "bench.gd"
## Measures the cost of bodies. For each shape, creates bodies for several thousand instances around a viewer in one step. Then moves
## the viewer among several hundred bodies with the default frame budget. Finally, moves the node with several thousand bodies. Prints
## rows of a Markdown table.
##   tools/godot --headless --path demo_project --script tests/bench/collision.gd [-- ROUNDS]
##
## The project setting selects the physics server. Times are the node's time on the main thread per frame. They include
## the search for near instances, but not the steps of the physics server. A busy machine increases them.

const SHAPES := {
	"capsules": ScatterLayer.COLLISION_CAPSULE,
	"cylinders": ScatterLayer.COLLISION_CYLINDER,
	"boxes": ScatterLayer.COLLISION_BOX,
	"convex": ScatterLayer.COLLISION_CONVEX,
}
const DISTANCE := 80.0 ## Distance in meters within which instances get bodies.
const DEFAULT_ROUNDS := 9
const USUAL_BUDGET := 500    ## The default frame budget, in microseconds per frame.
const WHOLE_BUDGET := 100000 ## Enough microseconds for all bodies in one frame.
const WALK := 5.0            ## Walking speed in meters per second.
const DRIVE := 50.0          ## The speed of a car.
const FLIGHT := 1000.0       ## Faster than in any game.
const SECONDS := 4.0

var _layer: ScatterLayer
var _viewer := Node3D.new()


func run() -> String:
	var rounds := rounds_or(DEFAULT_ROUNDS)
	_make_scene()
	var failure := await idle()
	if failure != "":
		return failure
	var physics := _physics_name()
	for title: String in SHAPES:
		var rates := await _measure_shape(SHAPES[title], rounds)
		if rates.is_empty():
			return "the bodies were not created in time"
		row("collision %s created per millisecond, %s, 3 700 at once" % [title, physics], rates[0])
		row("collision %s removed per millisecond, %s" % [title, physics], rates[1])
	_layer.collision_shape = ScatterLayer.COLLISION_CYLINDER
	_layer.collision_distance = 40.0
	for speed: float in [0.0, WALK, DRIVE, FLIGHT]:
		var frames := await _measure_moving(speed)
		row("a frame among 920 bodies at %.0f m/s, tiles included, %s" % [speed, physics], frames, "µs")
	_layer.collision_distance = DISTANCE
	row("a frame that moves 3 700 bodies with their node, %s" % physics, await _measure_ride(), "µs")
	return ""


func _make_scene() -> void:
	_layer = ScatterLayer.new()
	_layer.radius = 2.0
	_layer.tile_size = 32.0
	_layer.view_distance = 160.0
	_layer.min_scale = 0.6
	_layer.max_scale = 1.6
	_layer.collision_distance = DISTANCE
	_layer.meshes = [PrismMesh.new(), BoxMesh.new()]
	make_scatter(ScatterGroundFlat.new(), [_layer], _viewer)
	scatter.frame_budget_usec = WHOLE_BUDGET
	Engine.max_fps = 60


func _physics_name() -> String:
	var setting: String = ProjectSettings.get_setting("physics/3d/physics_engine")
	return "GodotPhysics" if setting == "DEFAULT" else setting


## Creates and removes all bodies in one step in each round. Returns the numbers of bodies created and removed per millisecond of
## the node's time, one per round. The lists are empty if that takes too long.
func _measure_shape(shape: ScatterLayer.CollisionShape, rounds: int) -> Array[PackedFloat64Array]:
	var created: PackedFloat64Array = []
	var removal_times: PackedFloat64Array = []
	for round in rounds:
		for kind: ScatterLayer.CollisionShape in [shape, ScatterLayer.COLLISION_NONE]:
			var before: int = scatter.get_stats()["bodies"]
			_layer.collision_shape = kind
			var usec := 0.0
			var changed_count := 0
			var limit := Time.get_ticks_msec() + int(PATIENCE_SECONDS * 1000.0)
			while changed_count == 0 or not scatter.is_settled():
				await process_frame
				usec += scatter.get_stats()["frame_usec"]
				changed_count = absi(scatter.get_stats()["bodies"] - before)
				if Time.get_ticks_msec() > limit:
					return []
			(created if kind == shape else removal_times).push_back(changed_count * 1000.0 / usec)
	return [created, removal_times]


## Returns the microseconds of each frame while the viewer moves.
func _measure_moving(speed: float) -> PackedFloat64Array:
	_viewer.position = Vector3.ZERO
	scatter.frame_budget_usec = WHOLE_BUDGET
	await idle()
	scatter.frame_budget_usec = USUAL_BUDGET
	for frame in 3:
		await process_frame # The stats describe the previous frame.
	var times: PackedFloat64Array = []
	for frame in int(SECONDS * 60.0):
		_viewer.position.x += speed / 60.0
		await process_frame
		times.push_back(scatter.get_stats()["frame_usec"])
	return times


## Returns the microseconds of each frame while the node moves with all of its instances and with the viewer.
func _measure_ride() -> PackedFloat64Array:
	_viewer.position = Vector3.ZERO
	scatter.local_coords = true
	scatter.frame_budget_usec = WHOLE_BUDGET
	await idle()
	scatter.frame_budget_usec = USUAL_BUDGET
	for frame in 3:
		await process_frame
	var times: PackedFloat64Array = []
	for frame in int(SECONDS * 60.0):
		scatter.position.x += WALK / 60.0
		_viewer.position = scatter.position
		await process_frame
		times.push_back(scatter.get_stats()["frame_usec"])
	scatter.local_coords = false
	return times
