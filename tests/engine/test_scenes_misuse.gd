extends "scenes_harness.gd"
## Tests scripts that take, free or remove scenes, and invalid scenes. Nothing may crash or leak.

var changed_scatter: TerrainScatter3D


func show_walk_and_free() -> void:
	var layer := make_plants()
	layer.min_height = -5.0
	var scatter := make_garden([layer])
	for step in 5:
		viewer.position.x += 11.0
		await settle(scatter)
	scatter.remove_instance(scatter.query_nearest(viewer.position, 20.0).id)
	if viewer.position.z > 0.0:
		scatter.free()
	else:
		scatter.queue_free()
	await clean()


func test_nothing_leaks() -> void:
	var nodes: Array[float] = []
	var orphans: Array[float] = []
	for round in 3:
		await show_walk_and_free()
		await frames(3)
		nodes.push_back(Performance.get_monitor(Performance.OBJECT_NODE_COUNT))
		orphans.push_back(Performance.get_monitor(Performance.OBJECT_ORPHAN_NODE_COUNT))
	check_equal(nodes[2], nodes[0], "nodes")
	check_equal(orphans[2], 0.0, "orphans")


func test_outside_of_the_tree() -> void:
	var scatter := make_garden([make_plants()])
	await settle(scatter)
	check(not standing_scenes.is_empty(), "scenes")
	standing_scenes.clear()
	root.remove_child(scatter)
	check_equal(scatter.get_stats()["scenes"], 0, "scenes outside of the tree")
	check_equal(scatter.get_child_count(true), 0, "children")
	check(hidden.is_empty(), "no signal")
	root.add_child(scatter)
	await settle(scatter)
	check(not standing_scenes.is_empty(), "scenes again")
	scatter.ground = null # The node stays in the tree, so scenes are hidden gradually as usual, each with its signal.
	await settle(scatter)
	check_equal(scatter.get_child_count(true), 0, "children without ground")
	check_equal(standing_scenes.size(), 0, "scenes without ground, according to their signals")


func test_removing_and_taking_scenes() -> void:
	var scatter := make_garden([make_plants()])
	await settle(scatter)
	var near: PackedInt64Array = scatter.query_sphere(Vector3.ZERO, 15.0).ids
	var everything := everything_of(scatter)
	var scene: Plant = scatter.get_scene(near[0])
	check(scatter.remove_instance(near[0]), "remove_instance removes an instance with a scene")
	check(scatter.get_scene(near[0]) == null, "hidden immediately")
	await process_frame
	check(not scene.is_inside_tree() and scene.times_hidden == 1 and hidden[near[0]] == 1, "the scene of a removed instance is back in the pool")
	everything.erase(near[0])
	check_once(scatter, everything, "after the removal")

	var taken: Array[Node3D] = []
	for turn in 2:  # Take the scene and remove the instance, in either order.
		var id := near[1 + turn]
		var before: Transform3D = scatter.get_scene(id).global_transform
		if turn == 1:
			scatter.remove_instance(id)
		taken.push_back(scatter.take_scene(id))
		if turn == 0:
			scatter.remove_instance(id)
		check(taken[turn] is Plant and taken[turn].is_inside_tree(), "a scene that was taken is still in the tree")
		check(scatter.take_scene(id) == null and scatter.get_scene(id) == null, "only once")
		taken[turn].reparent(root)
		check(taken[turn].global_transform.is_equal_approx(before), "a scene that was taken does not move")
		check(not taken[turn].top_level, "a scene that was taken is no longer top_level")
		everything.erase(id)
		for frame in 3:
			await process_frame
			check_once(scatter, everything, "after taking")
		check_equal((taken[turn] as Plant).times_hidden, 0, "calls to _scatter_hidden of a scene that was taken")
		check(not hidden.has(id), "no signal")

	var kept := scatter.take_scene(near[3])  # Take the scene but keep the instance.
	standing_scenes.erase(near[3])
	for frame in 3:
		await process_frame
		check(drawn(scatter).has(near[3]) and scatter.get_scene(near[3]) == null, "the mesh is drawn again after the scene was taken")
	kept.free()
	viewer.position.x = 200.0
	await settle(scatter)
	viewer.position.x = 0.0
	await settle(scatter)
	check(scatter.get_scene(near[3]) != null, "a new scene after it was out of range")
	check(scatter.get_scene(near[1]) == null, "a removed instance has none when its tile returns")
	scatter.restore_instance(near[1])
	standing_scenes.erase(near[1])
	await settle(scatter)
	check(scatter.get_scene(near[1]) != null, "a restored instance gets a scene")
	everything[near[1]] = true
	check_once(scatter, everything, "finally")
	check(scatter.take_scene(0) == null and scatter.get_scene(-5) == null, "no such ID")


func test_hand_placed() -> void:
	var scatter := make_garden([make_plants()])
	await settle(scatter)
	var at := Transform3D(Basis.from_scale(Vector3(3, 3, 3)), Vector3(1, 8, 2))
	var id := scatter.add_instance(scatter.layers[0], at)
	await settle(scatter)
	var scene := scatter.get_scene(id)
	check(scene != null and scene.global_transform.is_equal_approx(at), "a scene at its position")
	check(not drawn(scatter).has(id), "no mesh")
	scatter.remove_instance(id)
	check(scatter.get_scene(id) == null, "removed immediately")
	await process_frame
	check(not drawn(scatter).has(id), "a removed hand-placed instance has no mesh")


func test_bad_scenes() -> void:
	var layer := make_plants()
	layer.scene = pack(Node.new())
	var scatter := make_garden([layer])
	await settle(scatter)
	check_error(["Plants", "Node3D"], "a root that is not a Node3D")
	check_equal(scatter.get_stats()["scenes"], 0, "no scene")
	var everything := drawn(scatter)
	check(everything.size() > 1000, "meshes")
	viewer.position.x = 5.0
	await settle(scatter)
	check_no_error("one error")
	layer.scene = PackedScene.new()
	await settle(scatter)
	check_error(["Plants", "Node3D"], "an empty scene")
	layer.scene = pack(Plant.new())
	await settle(scatter)
	check(scatter.get_stats()["scenes"] > 100, "a valid scene")
	var fresh := pack(Node3D.new())
	layer.scene = fresh
	await settle(scatter)
	check(scatter.get_stats()["scenes"] > 100, "a scene without a script")


func count_of(scatter: TerrainScatter3D) -> int:
	return scatter.get_stats()["scenes"]


func test_scenes_that_free_themselves() -> void:
	var scatter := make_garden([make_plants()])
	await settle(scatter)
	var everything := everything_of(scatter)
	var ids := standing_scenes.keys()
	standing_scenes[ids[0]].free()
	standing_scenes[ids[1]].queue_free()
	standing_scenes[ids[2]].reparent(root)
	scatter.remove_child(standing_scenes[ids[3]])
	standing_scenes[ids[3]].queue_free()
	for index in 4:
		standing_scenes.erase(ids[index])
	for frame in 5:
		await process_frame
		check_once(scatter, everything, "after scenes were removed")
		for index in 4:
			check(drawn(scatter).has(ids[index]), "the mesh of a freed scene is drawn again")
	viewer.position.x += 500.0
	Plant.hooks[&"_scatter_shown"] = func(plant: Plant) -> void: plant.queue_free()
	await settle(scatter)
	standing_scenes.clear()
	for frame in 5:
		await process_frame
		check_once(scatter, drawn(scatter), "after scenes freed themselves")
	check_equal(count_of(scatter), 0, "no scene is left")


func test_scenes_that_change_the_node() -> void:
	var near := func() -> PackedInt64Array: return changed_scatter.query_sphere(viewer.position, 18.0).ids
	var actions: Array[Callable] = [
		func(plant: Plant) -> void: changed_scatter.remove_instance(plant.id),
		func(_plant: Plant) -> void: changed_scatter.remove_instance(near.call()[0]),
		func(_plant: Plant) -> void: changed_scatter.remove_in_sphere(viewer.position, 30.0),
		func(plant: Plant) -> void:
			var taken := changed_scatter.take_scene(plant.id)
			if taken != null:
				taken.reparent(root),
		func(plant: Plant) -> void: plant.queue_free(),
		func(_plant: Plant) -> void: changed_scatter.layers = [],
		func(_plant: Plant) -> void: changed_scatter.ground = null,
		func(_plant: Plant) -> void: changed_scatter.layers[0].scene = null,
		func(_plant: Plant) -> void: root.remove_child(changed_scatter),
		func(_plant: Plant) -> void: changed_scatter.queue_free(),
		func(_plant: Plant) -> void: changed_scatter.free(),
	]
	for hook: StringName in [&"_init", &"_ready", &"_scatter_shown", &"_scatter_hidden"]:
		for action in actions.size():
			if hook == &"_ready" and action in [8, 10]:
				continue  # The engine cannot remove a parent while a child enters the tree.
			changed_scatter = TerrainScatter3D.new()
			changed_scatter.seed = 7
			changed_scatter.layers = [make_plants(4.0)]
			changed_scatter.ground = ScatterGroundFlat.new()
			root.add_child(changed_scatter)
			viewer = make_viewer()
			changed_scatter.viewers = [changed_scatter.get_path_to(viewer)]
			var calls := [0]
			Plant.hooks[hook] = func(plant: Plant) -> void:
				calls[0] += 1
				if calls[0] == 5 and is_instance_valid(changed_scatter):
					actions[action].call(plant)
			for frame in 40:
				if frame == 20 and hook == &"_scatter_hidden":
					viewer.position.x += 400.0
				await process_frame
			Plant.hooks.clear()
			var kept := was_kept_from_being_freed()
			check(not kept or action == 10, "%s: action %d: the engine refuses to free the node" % [hook, action])
			if is_instance_valid(changed_scatter):
				check_once(changed_scatter, {}, "%s: after action %d" % [hook, action])
			check(calls[0] >= 5, "%s: action %d is done" % [hook, action])
			if is_instance_valid(changed_scatter):
				changed_scatter.free()
			await clean()
	check_equal(Performance.get_monitor(Performance.OBJECT_ORPHAN_NODE_COUNT), 0.0, "orphans")
