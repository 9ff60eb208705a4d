extends "scenes_harness.gd"
## Scenes that scripts take, free and fell, and bad ones: nothing crashes, nothing is left.

var meddled: TerrainScatter3D


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


func test_nothing_is_left() -> void:
	var nodes: Array[float] = []
	var orphans: Array[float] = []
	for round in 3:
		await show_walk_and_free()
		await frames(3)
		nodes.push_back(Performance.get_monitor(Performance.OBJECT_NODE_COUNT))
		orphans.push_back(Performance.get_monitor(Performance.OBJECT_ORPHAN_NODE_COUNT))
	check_equal(nodes[2], nodes[0], "nodes")
	check_equal(orphans[2], 0.0, "orphans")


func test_out_of_the_tree() -> void:
	var scatter := make_garden([make_plants()])
	await settle(scatter)
	check(not standing_scenes.is_empty(), "scenes")
	standing_scenes.clear()
	root.remove_child(scatter)
	check_equal(scatter.get_stats()["scenes"], 0, "scenes outside of the tree")
	check_equal(scatter.get_child_count(true), 0, "children")
	check(hidden.is_empty(), "nobody is told")
	root.add_child(scatter)
	await settle(scatter)
	check(not standing_scenes.is_empty(), "scenes again")
	scatter.ground = null # The node stays, so scenes leave as ever: step by step, each with its signal.
	await settle(scatter)
	check_equal(scatter.get_child_count(true), 0, "children without ground")
	check_equal(standing_scenes.size(), 0, "scenes without ground, by their signals")


func test_felled_and_taken() -> void:
	var scatter := make_garden([make_plants()])
	await settle(scatter)
	var near: PackedInt64Array = scatter.query_sphere(Vector3.ZERO, 15.0).ids
	var everything := everything_of(scatter)
	var scene: Plant = scatter.get_scene(near[0])
	check(scatter.remove_instance(near[0]), "felled")
	check(scatter.get_scene(near[0]) == null, "gone at once")
	await process_frame
	check(not scene.is_inside_tree() and scene.times_hidden == 1 and hidden[near[0]] == 1, "back in the pool")
	everything.erase(near[0])
	check_once(scatter, everything, "felled")

	var taken: Array[Node3D] = []
	for turn in 2:  # Taken and felled, in either order.
		var id := near[1 + turn]
		var before: Transform3D = scatter.get_scene(id).global_transform
		if turn == 1:
			scatter.remove_instance(id)
		taken.push_back(scatter.take_scene(id))
		if turn == 0:
			scatter.remove_instance(id)
		check(taken[turn] is Plant and taken[turn].is_inside_tree(), "in the tree")
		check(scatter.take_scene(id) == null and scatter.get_scene(id) == null, "once")
		taken[turn].reparent(root)
		check(taken[turn].global_transform.is_equal_approx(before), "where it was")
		check(not taken[turn].top_level, "an ordinary node")
		everything.erase(id)
		for frame in 3:
			await process_frame
			check_once(scatter, everything, "taken")
		check_equal((taken[turn] as Plant).times_hidden, 0, "not told to hide")
		check(not hidden.has(id), "no signal")

	var kept := scatter.take_scene(near[3])  # Taken, and the instance stands.
	standing_scenes.erase(near[3])
	for frame in 3:
		await process_frame
		check(drawn(scatter).has(near[3]) and scatter.get_scene(near[3]) == null, "its mesh is back")
	kept.free()
	viewer.position.x = 200.0
	await settle(scatter)
	viewer.position.x = 0.0
	await settle(scatter)
	check(scatter.get_scene(near[3]) != null, "a scene again, after it was out of range")
	check(scatter.get_scene(near[1]) == null, "a felled one stays away when its tile comes again")
	scatter.restore_instance(near[1])
	standing_scenes.erase(near[1])
	await settle(scatter)
	check(scatter.get_scene(near[1]) != null, "a restored one gets a scene")
	everything[near[1]] = true
	check_once(scatter, everything, "in the end")
	check(scatter.take_scene(0) == null and scatter.get_scene(-5) == null, "no such id")


func test_hand_placed() -> void:
	var scatter := make_garden([make_plants()])
	await settle(scatter)
	var at := Transform3D(Basis.from_scale(Vector3(3, 3, 3)), Vector3(1, 8, 2))
	var id := scatter.add_instance(0, at)
	await settle(scatter)
	var scene := scatter.get_scene(id)
	check(scene != null and scene.global_transform.is_equal_approx(at), "a scene where it was placed")
	check(not drawn(scatter).has(id), "and no mesh")
	scatter.remove_instance(id)
	check(scatter.get_scene(id) == null, "gone at once")
	await process_frame
	check(not drawn(scatter).has(id), "all of it")


func test_bad_scenes() -> void:
	var layer := make_plants()
	layer.scene = pack(Node.new())
	var scatter := make_garden([layer])
	await settle(scatter)
	check_error(["Plants", "Node3D"], "a root that is no Node3D")
	check_equal(scatter.get_stats()["scenes"], 0, "no scene")
	var everything := drawn(scatter)
	check(everything.size() > 1000, "meshes")
	viewer.position.x = 5.0
	await settle(scatter)
	check_no_error("said once")
	layer.scene = PackedScene.new()
	await settle(scatter)
	check_error(["Plants", "Node3D"], "an empty scene")
	layer.scene = pack(Plant.new())
	await settle(scatter)
	check(scatter.get_stats()["scenes"] > 100, "a good one")
	var fresh := pack(Node3D.new())
	layer.scene = fresh
	await settle(scatter)
	check(scatter.get_stats()["scenes"] > 100, "one without a script")


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
		check_once(scatter, everything, "scenes that were taken away")
		for index in 4:
			check(drawn(scatter).has(ids[index]), "its mesh is back")
	viewer.position.x += 500.0
	Plant.hooks[&"_scatter_shown"] = func(plant: Plant) -> void: plant.queue_free()
	await settle(scatter)
	standing_scenes.clear()
	for frame in 5:
		await process_frame
		check_once(scatter, drawn(scatter), "scenes that are gone again")
	check_equal(count_of(scatter), 0, "no scene is left")


func test_meddling_scenes() -> void:
	var near := func() -> PackedInt64Array: return meddled.query_sphere(viewer.position, 18.0).ids
	var deeds: Array[Callable] = [
		func(plant: Plant) -> void: meddled.remove_instance(plant.id),
		func(_plant: Plant) -> void: meddled.remove_instance(near.call()[0]),
		func(_plant: Plant) -> void: meddled.remove_in_sphere(viewer.position, 30.0),
		func(plant: Plant) -> void:
			var taken := meddled.take_scene(plant.id)
			if taken != null:
				taken.reparent(root),
		func(plant: Plant) -> void: plant.queue_free(),
		func(_plant: Plant) -> void: meddled.layers = [],
		func(_plant: Plant) -> void: meddled.ground = null,
		func(_plant: Plant) -> void: meddled.layers[0].scene = null,
		func(_plant: Plant) -> void: root.remove_child(meddled),
		func(_plant: Plant) -> void: meddled.queue_free(),
		func(_plant: Plant) -> void: meddled.free(),
	]
	for place: StringName in [&"_init", &"_ready", &"_scatter_shown", &"_scatter_hidden"]:
		for deed in deeds.size():
			if place == &"_ready" and deed in [8, 10]:
				continue  # No parent may go while a child enters the tree.
			meddled = TerrainScatter3D.new()
			meddled.seed = 7
			meddled.layers = [make_plants(4.0)]
			meddled.ground = ScatterGroundFlat.new()
			root.add_child(meddled)
			viewer = make_viewer()
			meddled.viewers = [meddled.get_path_to(viewer)]
			var calls := [0]
			Plant.hooks[place] = func(plant: Plant) -> void:
				calls[0] += 1
				if calls[0] == 5 and is_instance_valid(meddled):
					deeds[deed].call(plant)
			for frame in 40:
				if frame == 20 and place == &"_scatter_hidden":
					viewer.position.x += 400.0
				await process_frame
			Plant.hooks.clear()
			var kept := was_kept_from_being_freed()
			check(not kept or deed == 10, "%s: deed %d: kept from being freed" % [place, deed])
			if is_instance_valid(meddled):
				check_once(meddled, {}, "%s: after deed %d" % [place, deed])
			check(calls[0] >= 5, "%s: deed %d is done" % [place, deed])
			if is_instance_valid(meddled):
				meddled.free()
			await clean()
	check_equal(Performance.get_monitor(Performance.OBJECT_ORPHAN_NODE_COUNT), 0.0, "orphans")
