extends "threads_harness.gd"
## Tests calls on threads other than the main thread. Each method follows the threading rule that the class reference states, and no script
## can crash the engine.

## Sample arguments by type.
var samples := {
	TYPE_BOOL: true, TYPE_INT: 1, TYPE_FLOAT: 1.0, TYPE_STRING: "x", TYPE_STRING_NAME: &"x", TYPE_NODE_PATH: NodePath("x"),
	TYPE_VECTOR2: Vector2.ONE, TYPE_VECTOR2I: Vector2i.ONE, TYPE_RECT2: Rect2(0, 0, 8, 8), TYPE_RECT2I: Rect2i(0, 0, 2, 2),
	TYPE_VECTOR3: Vector3.ONE, TYPE_TRANSFORM3D: Transform3D(), TYPE_COLOR: Color.RED, TYPE_RID: RID(),
}


## Creates an object of each class. If `in_scene` is true, nodes in the tree use them.
func make_objects(in_scene: bool) -> Array[Object]:
	var layer := make_layer(6.0)
	layer.mask = ScatterMask.new()
	var model := ScatterModel.new()
	model.lods = [ScatterLod.new()]
	layer.meshes = [BoxMesh.new(), model]
	var biome := ScatterBiome.new()
	biome.layers = [make_layer(9.0)]
	var map := ScatterBiomeMap.new()
	map.biomes = [biome]
	var objects: Array[Object] = [layer, layer.mask, model, model.lods[0], biome, map, biome.layers[0]]
	for type in ClassDB.get_inheriters_from_class("ScatterGround"):
		if type.begins_with("ScatterTerrain"):
			continue # Skips the classes of version 0.2, which a scatter replaces with a warning.
		objects.push_back(ClassDB.instantiate(type))
	var scatters: Array[TerrainScatter3D] = []
	for terrain: ScatterGround in objects.filter(func(object: Object) -> bool: return object is ScatterGround):
		var scatter := TerrainScatter3D.new()
		scatter.ground = terrain
		scatter.state = ScatterState.new()
		scatter.layers = [layer]
		scatter.biomes = map
		var region := ScatterRegion3D.new()
		scatter.add_child(region)
		scatters.push_back(scatter)
		objects.push_back(scatter.state)
		objects.push_back(region)
	for scatter in scatters:
		objects.push_back(scatter)
		if in_scene:
			root.add_child(scatter)
	return objects


## Calls every method of a class on a worker thread. Returns the names of the methods that rejected the call because of the thread.
func refused_methods(object: Object, type: String) -> PackedStringArray:
	var calls: Array[Dictionary] = []
	for method in ClassDB.class_get_method_list(type, true):
		var name: String = method["name"]
		if method["flags"] & METHOD_FLAG_VIRTUAL or name.begins_with("_"):
			continue
		var arguments := []
		var property := name.trim_prefix("set_")
		for argument: Dictionary in method["args"]:
			if property in object and property != name:
				arguments.push_back(object.get(property))
			else:
				arguments.push_back(samples.get(argument["type"], type_convert(null, argument["type"])))
		calls.push_back({"name": name, "arguments": arguments})
	errors.take()
	on_thread(func() -> void:
		for call in calls:
			object.callv(call["name"], call["arguments"]))
	var refused := PackedStringArray()
	for message in errors.take():
		if "worker thread" in message:
			refused.push_back(message.get_slice("()", 0).get_slice(".", 1))
	return refused


func own_classes(object: Object) -> PackedStringArray:
	var types := PackedStringArray([object.get_class()])
	if object is ScatterGround and types[0] != "ScatterGround":
		types.push_back("ScatterGround")
	return types


## Every method allows or rejects calls as the class reference states, whether the scene uses its object or not.
func test_every_method_follows_its_documented_rule() -> void:
	var pages := read_pages()
	for in_scene: bool in [true, false]:
		var objects := make_objects(in_scene)
		await frames(3)
		for object in objects:
			for type in own_classes(object):
				check_rules(object, type, pages[type], in_scene)
		for object in objects:
			if object is TerrainScatter3D:
				(object as Node).free()


func check_rules(object: Object, type: String, page: Dictionary, in_scene: bool) -> void:
	var refused := refused_methods(object, type)
	for method in ClassDB.class_get_method_list(type, true):
		var name: String = method["name"]
		if method["flags"] & METHOD_FLAG_VIRTUAL or name.begins_with("_"):
			continue
		var rule: String = page.get(name, page[""]) # Setters and getters follow the rule for the class's properties.
		if not page.has(name):
			check("may use the properties" in rule, "%s.%s: the class reference page must state a threading rule" % [type, name])
		else:
			check(ANY in rule or MAIN in rule or OWNER in rule, "%s.%s: the class reference page must state a threading rule" % [type, name])
		var expected := MAIN in rule or (in_scene and ("only the main thread" in rule))
		check_equal(refused.has(name), expected, "whether %s.%s is rejected %s" % [type, name, "in the scene" if in_scene else "outside of the scene"])


func test_results_may_be_read_on_any_thread() -> void:
	var scatter := make_wood(make_viewer())
	await settle(scatter)
	var pages := read_pages()
	var results: Array[RefCounted] = [scatter.query_sphere(Vector3.ZERO, 30.0), scatter.query_nearest(Vector3.ZERO, 60.0),
			scatter.build_rect(scatter.layers[0], Rect2(0, 0, 32, 32)), scatter.explain_position(Vector3.ZERO)[0], PoissonSampler.new(),
			PoissonSampler.new().sample(Rect2(0, 0, 9, 9)), ScatterTileGrid.new(), ScatterImpostorBaker.new(), scatter.make_snapshot(),
			scatter.request_sphere(Vector3.ZERO, 9.0)]
	for result in results:
		check_rules(result, result.get_class(), pages[result.get_class()], false)
	check_rules(scatter.get_tile(scatter.layers[0], scatter.get_shown_tiles(scatter.layers[0])[0]), "ScatterTile", pages["ScatterTile"], true)
	await frames(3)


## Internal methods must not crash on any thread, because they are connected to signals that any thread may emit.
func test_internal_methods_are_harmless() -> void:
	var objects := make_objects(true)
	await frames(3)
	var count: Array[int] = [0]
	on_thread(func() -> void:
		for object in objects:
			for type in own_classes(object):
				for method in ClassDB.class_get_method_list(type, true):
					var name: String = method["name"]
					if name.begins_with("_") and not method["flags"] & METHOD_FLAG_VIRTUAL:
						object.callv(name, method["args"].map(func(argument: Dictionary) -> Variant:
							return samples.get(argument["type"], type_convert(null, argument["type"]))))
						count[0] += 1)
	check(count[0] > 50, "%d calls" % count[0])
	await frames(5)
	errors.take()
	for object in objects:
		if object is TerrainScatter3D:
			check(not (object as TerrainScatter3D).get_stats().is_empty(), "the node still works")


func test_errors_name_the_rule_and_the_fix() -> void:
	var scatter := make_wood(make_viewer())
	var state := ScatterState.new()
	scatter.state = state
	await settle(scatter)
	var found: ScatterInstances = on_thread(func() -> ScatterInstances: return scatter.query_sphere(Vector3.ZERO, 20.0))
	check_error(["TerrainScatter3D.query_sphere()", "worker thread", "main thread", "make_snapshot()", "request_sphere()"], "a query")
	check_equal(found.size(), 0, "the result is empty, not null")
	on_thread(func() -> bool: return state.remove(5))
	check_error(["ScatterState.remove()", "while the scene tree uses", "call_deferred()"], "a state in use")
	check_equal(state.get_removed_count(), 0, "the state is unchanged")
	check_equal(on_thread(func() -> Error: return state.from_bytes(PackedByteArray())), ERR_BUSY, "the call returns an error code")
	errors.take()
	scatter.state = null
	check_equal(on_thread(func() -> bool: return state.remove(5)), true, "a state that the scene no longer uses can be changed")


func test_resources_of_a_layer_in_use() -> void:
	var scatter := make_wood(make_viewer())
	var layer := scatter.layers[0]
	var mask := ScatterMask.new()
	var read := func() -> float: return mask.sample(Vector2.ZERO)
	check_equal(on_thread(read), 1.0, "before the layer uses it")
	layer.mask = mask
	check_equal(on_thread(read), 0.0, "a mask of a layer in use")
	check_error(["ScatterMask.sample()", "scene tree uses"], "a mask of a layer in use")
	scatter.layers = [scatter.layers[1]]
	check_equal(on_thread(read), 1.0, "after the layer was removed")
	scatter.layers = [layer]
	check_equal(on_thread(read), 0.0, "after the layer was added again")
	check_error(["ScatterMask.sample()"], "after the layer was added again")
	scatter.layers.clear()
	await frames(2)
	check_equal(on_thread(read), 1.0, "after the list was changed in place")
	scatter.layers = [layer]
	root.remove_child(scatter)
	check_equal(on_thread(read), 1.0, "after the node left the tree")
	on_thread(func() -> void: scatter.seed = 12)
	check_equal(scatter.seed, 12, "the node itself can be changed, too")
	scatter.free()


## Two worker threads and the main thread make calls at the same time, as users' scripts may.
func test_threads_that_call_objects_in_use() -> void:
	var scatter := make_wood(make_viewer())
	var layer := scatter.layers[0]
	var mask := ScatterMask.new()
	layer.mask = mask
	var state := ScatterState.new()
	scatter.state = state
	var viewer := scatter.get_node(scatter.viewers[0]) as Node3D
	await settle(scatter)
	var at := func() -> Vector3: return Vector3(randf() * 300.0, 0.0, 0.0)
	var works: Dictionary[String, Callable] = {
		"query_sphere": func() -> void: scatter.query_sphere(at.call(), 20.0),
		"remove_in_sphere": func() -> void: scatter.remove_in_sphere(at.call(), 3.0),
		"remove": func() -> void: state.remove(randi()),
		"to_bytes": func() -> void: state.to_bytes(),
		"paint": func() -> void: mask.paint(Vector2(randf() * 100.0, 0.0), 10.0),
		"set_density": func() -> void: layer.density = randf(),
		"explain_position": func() -> void: scatter.explain_position(at.call()),
		"build_rect": func() -> void: scatter.build_rect("trees", Rect2(randf() * 300.0, 0.0, 50.0, 50.0)),
	}
	var removed := scatter.remove_in_sphere(Vector3.ZERO, 10.0).size()
	for name in works:
		var calls := await on_threads_for(250, [works[name], works[name]], func() -> void:
			viewer.position.x += 2.0
			scatter.query_sphere(at.call(), 5.0))
		check(calls > 2, "%s: %d calls" % [name, calls])
		check_only_errors(["worker thread"], name)
	check_equal(scatter.state.get_removed_count(), removed, "the state is unchanged")
	check_equal(layer.density, 1.0, "the layer is unchanged")


## Several threads use an object that no scene uses. Each call either succeeds or is rejected.
func test_threads_that_share_an_unused_object() -> void:
	var state := ScatterState.new()
	var mask := ScatterMask.new()
	var sampler := PoissonSampler.new()
	var terrain := ScatterGroundFlat.new()
	var layer := make_layer()
	var works: Array[Callable] = [
		func() -> void:
			state.remove(randi_range(1, 5000))
			state.restore(randi_range(1, 5000))
			state.is_removed(5)
			state.set_instance_data(randi_range(1, 5000), "x".repeat(randi() % 50))
			if randi() % 50 == 0:
				var bytes := state.to_bytes()
				if not bytes.is_empty():
					state.from_bytes(bytes)
			state.get_removed(),
		func() -> void:
			mask.paint(Vector2(randf() * 100.0, 0.0), 10.0)
			mask.sample(Vector2.ONE)
			if randi() % 50 == 0:
				mask.data = mask.data,
		func() -> void:
			sampler.radius = randf_range(1.0, 2.0)
			sampler.sample(Rect2(randf() * 1000.0, 0.0, 20.0, 20.0)),
		func() -> void:
			terrain.height = randf()
			layer.density = randf()
			layer.spacing = {"ferns": randf_range(1.0, 2.0)}
			layer.mask = [null, mask][randi() % 2],
	]
	for work in works:
		var calls := await on_threads_for(400, [work, work, work], work)
		check(calls > 2, "%d calls" % calls)
		for message in take_kinds():
			check("another thread" in message, message)
	check(state.to_bytes().size() > 0 and state.from_bytes(state.to_bytes()) == OK, "the state is valid")


## Methods that only read can run at the same time.
func test_threads_that_read_one_object() -> void:
	var state := ScatterState.new()
	state.remove(5)
	var mask := ScatterMask.new()
	mask.paint(Vector2.ZERO, 10.0)
	var wrong: Array[int] = [0]
	var read := func() -> void:
		if not state.is_removed(5) or state.get_removed_count() != 1 or mask.sample(Vector2.ZERO) != 1.0 or mask.background != 1.0:
			wrong[0] += 1
	await on_threads_for(300, [read, read, read], read)
	check_equal(wrong[0], 0, "wrong results")
	check_no_error("several readers")


class Handler:
	var state: ScatterState
	var depth := 0

	func record(_ids: PackedInt64Array) -> void:
		depth += 1
		if depth < 5:
			state.remove(100 + depth)
			state.is_removed(1)
			state.to_bytes()
		else:
			state = null


## On any thread, signal handlers may call the object that emits the signal and release it.
func test_nested_calls() -> void:
	var removed: int = on_thread(func() -> int:
		var handler := Handler.new()
		handler.state = ScatterState.new()
		var watched: WeakRef = weakref(handler.state)
		handler.state.instances_changed.connect(handler.record)
		handler.state.remove(1)
		return handler.depth if watched.get_ref() == null else -1)
	check_equal(removed, 5, "all calls ran, and the state is freed")
	var scatter := make_wood(make_viewer())
	await settle(scatter)
	var inner: Array[int] = []
	scatter.query_sphere(Vector3.ZERO, 20.0, "trees", func(id: int, _layer: ScatterLayer, _transform: Transform3D) -> bool:
		inner.push_back(scatter.query_sphere(Vector3.ZERO, 5.0).size())
		return scatter.has_instance(id) and scatter.remove_instance(id))
	check(inner.size() > 3, "%d nested queries" % inner.size())


## If a thread changes one of the engine's resources, the main thread applies the change.
func test_changes_reported_by_a_thread() -> void:
	var scatter := make_wood(make_viewer())
	var noise := (scatter.ground as ScatterGroundNoise).noise as FastNoiseLite
	await settle(scatter)
	var before := tile_buffers(scatter, 0, Vector2i.ZERO)
	on_thread(func() -> void: noise.seed = 99)
	check_no_error("a signal on a worker thread")
	await settle(scatter)
	var after := tile_buffers(scatter, 0, Vector2i.ZERO)
	check(before != after, "the ground is updated")
	check_equal(after, buffers_of(scatter.build_tile(scatter.layers[0], Vector2i.ZERO)), "the instances are updated, too")
