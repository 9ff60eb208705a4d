extends "scenes_harness.gd"
## Runs every action on a node inside every callback from it. Nothing may crash or leak, and only expected errors are printed.

## Ground that runs an action during each query.
class CallingGround extends ScatterGround:
	var action := Callable()

	func _get_heights(positions: PackedVector2Array) -> PackedFloat32Array:
		var heights := PackedFloat32Array()
		heights.resize(positions.size())
		if action.is_valid():
			action.call()
		return heights


const AROUND := Rect2(-20, -20, 40, 40)
const LOCKED := "locked" ## A part of both messages with which the engine refuses to free a node.

## Actions that a script takes inside a callback, by name. Most run in the first callback only, some in the first few.
var actions: Dictionary[String, Callable] = {
	"free": func() -> void: scatter.free(),
	"queue_free": func() -> void: scatter.queue_free(),
	"leave the tree": func() -> void: scatter.get_parent().remove_child(scatter),
	"leave and reenter the tree": func() -> void:
		root.remove_child(scatter)
		root.add_child(scatter),
	"no state": func() -> void: scatter.state = null,
	"a new state": func() -> void: scatter.state = ScatterState.new(),
	"no layers": func() -> void: scatter.layers = [],
	"different layers": func() -> void: scatter.layers = [make_layer(5.0), scatter.layers[0]],
	"no ground": func() -> void: scatter.ground = null,
	"a new ground": func() -> void: scatter.ground = ScatterGroundFlat.new(),
	"a new seed": func() -> void: scatter.seed += 1,
	"regenerate": func() -> void: scatter.regenerate(),
	"remove more": func() -> void: scatter.remove_in_sphere(Vector3.ZERO, 12.0),
	"add": func() -> void: scatter.add_instance(scatter.layers[0], Transform3D(Basis(), Vector3(1, 0, 1))),
	"query": func() -> void:
		scatter.query_rect(AROUND)
		scatter.query_ray(Vector3(-20, 1, 0), Vector3(20, 1, 0))
		scatter.get_tile(scatter.layers[0], Vector2i.ZERO).get_digest(),
	"request": func() -> void: scatter.request_sphere(Vector3(200, 0, 0), 20.0),
	"call again": func() -> void:
		if again.is_valid():
			again.call(),
	"clear the state": func() -> void:
		if scatter.state != null:
			scatter.state.clear(),
	"load the state": func() -> void:
		if scatter.state != null:
			scatter.state.from_bytes(scatter.state.to_bytes()),
	"merge a state": func() -> void:
		if scatter.state != null:
			scatter.state.merge(scatter.state.duplicate()),
	"recenter": func() -> void: scatter.world_offset += Vector3(32, 0, 0),
}
## Calls that trigger each callback, by the callback's name.
var calls: Dictionary[String, Callable] = {
	"instance_removed": func() -> void: scatter.remove_instance(a_near_id()),
	"removed in a sphere": func() -> void: scatter.remove_in_sphere(Vector3.ZERO, 6.0),
	"instance_restored": func() -> void:
		var id := a_near_id()
		scatter.remove_instance(id)
		scatter.restore_instance(id),
	"instance_added": func() -> void: scatter.add_instance(scatter.layers[0], Transform3D(Basis(), Vector3(3, 0, 3))),
	"instance_moved": func() -> void:
		var id := scatter.add_instance(scatter.layers[0], Transform3D(Basis(), Vector3(3, 0, 3)))
		scatter.set_instance_transform(id, Transform3D(Basis(), Vector3(-3, 0, 3))),
	"instance_data_changed": func() -> void: scatter.set_instance_data(a_near_id(), "data"),
	"instances_changed": func() -> void: scatter.remove_instance(a_near_id()),
	"changed": func() -> void: scatter.remove_instance(a_near_id()),
	"diff": func() -> void: scatter.state.apply_diff(a_diff(50)),
	"large diff": func() -> void: scatter.state.apply_diff(a_diff(5000)),
	"regrowth": func() -> void:
		scatter.layers[0].regrowth_time = 0.01
		scatter.remove_in_sphere(Vector3.ZERO, 6.0),
	"tile_shown": func() -> void: scatter.regenerate(),
	"tile_hidden": func() -> void: viewer.position.x += 1000.0,
	"settled": func() -> void: scatter.regenerate(),
	"completed": func() -> void: scatter.request_sphere(Vector3(50, 0, 0), 10.0).completed.connect(handler1),
	"canceled": func() -> void:
		var request := scatter.request_sphere(Vector3(50, 0, 0), 10.0)
		request.completed.connect(handler1)
		request.cancel(),
	"predicate of query_rect": func() -> void: scatter.query_rect(AROUND, [], accept),
	"predicate of query_nearest": func() -> void: scatter.query_nearest(Vector3.ZERO, 20.0, [], accept),
	"predicate of query_ray": func() -> void: scatter.query_ray(Vector3(-20, 1, 0), Vector3(20, 1, 0), [], accept),
	"predicate of remove_in_sphere": func() -> void: scatter.remove_in_sphere(Vector3.ZERO, 9.0, [], accept),
	"ground in a query": func() -> void: scatter.query_rect(Rect2(900, 900, 30, 30)),
	"ground in build_rect": func() -> void: scatter.build_rect(scatter.layers[0], Rect2(900, 900, 30, 30)),
	"ground in a frame": func() -> void: viewer.position.x += 1000.0,
	"scene_shown": func() -> void: scatter.layers[0].scene = pack(Plant.new()),
	"scene_hidden": func() -> void: viewer.position.x += 1000.0,
	"_scatter_shown": func() -> void: scatter.layers[0].scene = pack(Plant.new()),
	"_scatter_hidden": func() -> void: viewer.position.x += 1000.0,
}
var scatter: TerrainScatter3D
var ground: CallingGround
var action := ""
var again := Callable() ## The call that triggered the callback.
var times := 0 ## The number of callbacks so far.


func a_near_id() -> int:
	return scatter.query_nearest(Vector3.ZERO, 30.0).id


func a_diff(count: int) -> PackedByteArray:
	var server := ScatterState.new()
	server.from_bytes(scatter.state.to_bytes())
	var ids := scatter.query_rect(Rect2(-60, -60, 120, 120)).ids
	for id in ids.slice(0, count):
		server.remove(id)
	for index in maxi(0, count - ids.size()):
		server.remove(index << 3) # The first layer's ID is 0.
	return server.diff_since(0)


func act() -> void:
	times += 1
	if times <= (3 if action in ["remove more", "add", "call again"] else 1) and is_instance_valid(scatter):
		actions[action].call()


func handler0() -> void: act()
func handler1(_a: Variant) -> void: act()
func handler2(_a: Variant, _b: Variant) -> void: act()
func handler3(_a: Variant, _b: Variant, _c: Variant) -> void: act()


func accept(_id: int, _layer: ScatterLayer, _at: Transform3D) -> bool:
	act()
	return true


func connect_handler(callback: String) -> void:
	var handlers: Array[Callable] = [handler0, handler1, handler2, handler3]
	match callback:
		"removed in a sphere", "diff", "large diff": scatter.instance_removed.connect(handler3)
		"regrowth": scatter.instance_restored.connect(handler3)
		"instances_changed": scatter.state.instances_changed.connect(handler1)
		"changed": scatter.state.changed.connect(handler0)
		"_scatter_shown", "_scatter_hidden": Plant.hooks[callback] = handler1
		_:
			if callback.begins_with("ground"):
				ground.action = handler0
			for event in scatter.get_signal_list():
				if event["name"] == callback:
					scatter.connect(callback, handlers[event["args"].size()])


## Makes a small forest with bodies and, if requested, scenes.
func make_forest(with_scenes: bool) -> void:
	var layer := make_layer(4.0)
	layer.collision_shape = ScatterLayer.COLLISION_CYLINDER
	layer.collision_distance = 10.0
	if with_scenes:
		layer.scene = pack(Plant.new())
		layer.scene_distance = 8.0
	viewer = make_viewer()
	ground = CallingGround.new()
	scatter = make_scatter([layer], ground, viewer)
	scatter.state = ScatterState.new()
	await settle(scatter)


func run_action_in_callback(callback: String, name: String) -> void:
	await make_forest(callback.contains("scene") or callback.contains("_scatter"))
	action = name
	times = 0
	again = calls[callback]
	connect_handler(callback)
	calls[callback].call()
	for frame in 6:
		await process_frame
	if callback in ["regrowth", "tile_shown", "settled", "completed", "ground in a frame"] and times == 0:
		await until(func() -> bool: return times > 0 or not is_instance_valid(scatter), "%s is called" % callback)
	check(times > 0, "%s is called, with the action %s" % [callback, name])
	for message in errors.take():
		# The engine refuses to free a node that emits a signal.
		var refused := name == "free" and LOCKED in message
		# The node rejects calls without ground or layers, and a state that belongs to a different seed.
		var bare := "is missing" in message or "No layer is named" in message or "a different seed" in message
		check(refused or bare, "%s, %s: the engine printed: %s" % [callback, name, message])
	Plant.hooks.clear()
	ground.action = Callable()
	ground = null
	again = Callable()
	if is_instance_valid(scatter):
		scatter.free()
	await clean()


func objects_left() -> Array:
	return [Performance.get_monitor(Performance.OBJECT_ORPHAN_NODE_COUNT)]


func test_every_action_in_every_callback() -> void:
	var only := arguments.slice(1)
	for callback in calls:
		for name in actions:
			if only.is_empty() or (callback == only[0] and (only.size() < 2 or name == only[1])):
				if not only.is_empty():
					print("%s: %s" % [callback, name])
				await run_action_in_callback(callback, name)
	check_equal(objects_left(), [0.0], "orphans")
