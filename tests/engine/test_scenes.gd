extends "scenes_harness.gd"
## Tests scenes that replace meshes: they are shown and hidden at the right time, and each instance is visible exactly once.

func test_swap_at_the_distance() -> void:
	var scatter := make_garden([make_plants()], Vector3(-60, 0, 3))
	scatter.frame_budget_usec = 1000000
	await settle(scatter)
	var forest := scatter.query_rect(Rect2(-90, -40, 160, 80))
	var ids: PackedInt64Array = forest["ids"]
	var points: PackedVector3Array = forest["positions"]
	check(ids.size() > 1000, "%d instances" % ids.size())
	var near: Dictionary[int, bool] = {}
	var shown_ids: Dictionary[int, int] = {}
	for step in 132:
		viewer.global_position.x = -60.0 + (step if step <= 90 else 180 - step)
		await frames(1)
		await settle(scatter)
		for index in ids.size():
			var away := viewer.global_position.distance_to(points[index])
			var is_near := away <= (LEAVE if near.has(ids[index]) else ENTER)
			if is_near and not near.has(ids[index]):
				near[ids[index]] = true
				shown_ids[ids[index]] = shown_ids.get(ids[index], 0) + 1
			elif not is_near:
				near.erase(ids[index])
			if (scatter.get_scene(ids[index]) != null) != near.has(ids[index]):
				check(false, "step %d: %d at %f m has %s" % [step, ids[index], away, scatter.get_scene(ids[index])])
				return
		check_equal(scatter.get_stats()["scenes"], near.size(), "scenes")
	check(shown_ids.values().max() == 2 and shown_ids.size() > 200, "the walk shows some scenes twice: %d scenes" % shown_ids.size())
	check_equal(shown, shown_ids, "shown scenes")
	for id in shown:
		check_equal(hidden.get(id, 0), shown[id] - (1 if near.has(id) else 0), "hidden scenes")


func test_a_scene_has_its_instances_transform() -> void:
	var layer := make_plants()
	var scatter := make_garden([null, layer])
	scatter.position = Vector3(5, 6, 7)  # The node's transform must not move instances.
	scatter.scale = Vector3(2, 2, 2)
	await settle(scatter)
	var near := scatter.query_sphere(Vector3.ZERO, 10.0)
	for id: int in near["ids"]:
		var scene: Plant = scatter.get_scene(id)
		if not check(scene != null and scene.get_parent() == scatter, "the scatter has a child for instance %d" % id):
			continue
		var expected: Transform3D = scatter.get_instance(id).transform
		check(scene.global_transform.is_equal_approx(expected), "%s is at %s" % [scene.global_transform, expected])
		check_equal(scene.layer, scatter.layers[1], "layer")
		check_equal(scene.data, null, "data")
	check(near["ids"].size() > 50, "many scenes")
	check_equal(scatter.get_child_count(), 0, "children that are not internal")
	scatter.position = Vector3(9, 9, 9)
	await frames(2)
	var id: int = near["ids"][0]
	check(scatter.get_scene(id).global_transform.is_equal_approx(scatter.get_instance(id).transform), "it does not move with the node")
	scatter.set_instance_data(id, {"age": 70})
	viewer.position.x = 1000.0
	await settle(scatter)
	check(scatter.get_scene(id) == null, "an instance out of range has no scene")
	viewer.position.x = 0.0
	await settle(scatter)
	check_equal((scatter.get_scene(id) as Plant).data, {"age": 70}, "data of the instance")


## During a walk with jumps, ground edits, removals and thinning, each instance is visible exactly once in every frame.
func test_each_instance_is_visible_once_in_every_frame() -> void:
	var layer := make_plants(3.0)
	layer.view_distance = 48.0
	var scatter := make_garden([layer])
	scatter.frame_budget_usec = 1500
	await settle(scatter)
	var random := RandomNumberGenerator.new()
	random.seed = 3
	var felled: PackedInt64Array = []
	var speed := Vector3(0.7, 0, 0.3)
	for step in 300:
		speed = speed.rotated(Vector3.UP, random.randf_range(-0.3, 0.3))
		viewer.global_position += speed
		match random.randi_range(0, 30):
			0: viewer.global_position = Vector3(random.randf_range(-100, 100), 0, random.randf_range(-100, 100))
			1: scatter.regenerate()
			2: layer.max_scale = random.randf_range(1.0, 3.0)
			3: scatter.quality = random.randf_range(0.5, 1.0)
			4, 5, 6:
				var near := scenes_of(scatter).keys()
				if not near.is_empty():
					felled.push_back(near[random.randi_range(0, near.size() - 1)])
					check(scatter.remove_instance(felled[-1]), "felled")
			7:
				if not felled.is_empty():
					check(scatter.restore_instance(felled[-1]), "restored")
					felled.resize(felled.size() - 1)
		await process_frame
		check_once(scatter, {}, "step %d" % step)
		var tiles := scatter.get_shown_tiles(scatter.layers[0])
		var standing: Dictionary[int, bool] = {}
		for tile: Vector2i in tiles:
			for id: int in scatter.query_rect(Rect2(Vector2(tile) * 32.0, Vector2(32, 32)))["ids"]:
				standing[id] = true
		check_once(scatter, standing, "step %d, all instances" % step)
		for id in felled:
			check(scatter.get_scene(id) == null and not scenes_of(scatter).has(id), "a removed instance has no scene")
	check(shown.size() > 200, "%d scenes were shown" % shown.size())
	await settle(scatter)
	check_equal(scatter.get_stats()["scenes"], standing_scenes.size(), "scenes according to their signals")


func test_budget_and_order() -> void:
	var scatter := make_garden([make_plants()], Vector3(5000, 0, 0))
	await settle(scatter)
	scatter.frame_budget_usec = 1
	var positions: Dictionary[int, Vector3] = {}
	var order: Array[int] = []
	scatter.scene_shown.connect(func(id: int, scene: Node3D) -> void:
		order.push_back(id)
		positions[id] = scene.global_position)
	viewer.position.x += 15.0
	var before_frame := -1
	while before_frame < 0 or not scatter.is_settled():
		before_frame = shown.size() + hidden.size()
		await process_frame
		check(shown.size() + hidden.size() - before_frame <= 1, "at most one scene is shown or hidden per frame")
	check(order.size() > 50, "%d scenes were shown" % order.size())
	for index in range(1, order.size()):
		var before := positions[order[index - 1]].distance_to(viewer.position)
		check(positions[order[index]].distance_to(viewer.position) >= before - 1e-3, "the nearest scenes are shown first")


func test_pool() -> void:
	var layer := make_plants()
	var scatter := make_garden([layer])
	await settle(scatter)
	var at_once: int = scatter.get_stats()["scenes"]
	check_equal(Plant.made, at_once, "made")
	check(at_once > 100, "more than the pool can contain")
	viewer.position.x = 500.0
	await settle(scatter)
	check(Plant.made <= 2 * at_once, "some scenes are reused")
	layer.scene_distance = 3.0
	await settle(scatter)
	check_equal(scatter.get_stats()["scenes_pooled"], 64, "scenes in the full pool")
	var made := Plant.made
	var often := 0
	for step in 20:
		viewer.position.x += 7.0
		await settle(scatter)
		for plant: Plant in scenes_of(scatter).values():
			often = maxi(often, plant.times_shown)
			check_equal(plant.times_hidden, plant.times_shown - 1, "a visible scene was hidden once less often than it was shown")
	check_equal(Plant.made, made, "nothing is created while the pool has scenes")
	check(often > 5, "a scene is reused many times: %d" % often)
	layer.scene = pack(Plant.new())
	await settle(scatter)
	check_equal(scatter.get_stats()["scenes_pooled"], 0, "scenes of another kind are freed")
	check(Plant.made > made + 1 and scatter.get_stats()["scenes"] > 0, "scenes of the new kind are created")
	layer.scene = null
	await settle(scatter)
	check_equal(scatter.get_stats()["scenes"], 0, "no scene")
	check_once(scatter, drawn(scatter), "meshes instead")


func test_regenerated_tiles_keep_their_scenes() -> void:
	var layer := make_plants()
	var scatter := make_garden([layer])
	await settle(scatter)
	var before := scenes_of(scatter)
	var everything := everything_of(scatter)
	scatter.regenerate()
	layer.cast_shadow = GeometryInstance3D.SHADOW_CASTING_SETTING_OFF
	for frame in 30:
		await process_frame
		check_once(scatter, everything, "regenerated")
	await settle(scatter)
	check_equal(scenes_of(scatter), before, "the same scenes")
	check(hidden.is_empty(), "no scene was hidden")
	layer.min_scale = 1.0  # This property changes every instance but moves none.
	layer.max_scale = 1.0
	await settle(scatter)
	check_equal(scenes_of(scatter), before, "still the same scenes")
	for id in before:
		check(before[id].global_transform.is_equal_approx(scatter.get_instance(id).transform), "the scene moves with its instance")
		if before[id].global_transform != before[id].ready_at:
			break
	check(hidden.is_empty(), "no scene was hidden")
	layer.density = 0.5
	await settle(scatter)
	check(not hidden.is_empty() and shown.size() == before.size(), "scenes of removed instances are hidden")
	check_once(scatter, {}, "half of the instances")


func test_recentered() -> void:
	var scatter := make_garden([make_plants()], Vector3(40, 0, 0))
	await settle(scatter)
	var before := scenes_of(scatter)
	var shown_ids := shown.size()
	var positions: Dictionary[int, Vector3] = {}
	for id in before:
		positions[id] = before[id].global_position
	var shift := Vector3(256, 16, -1024)
	viewer.global_position -= shift
	scatter.world_offset = shift
	for id in before:
		check(before[id].global_position.distance_to(positions[id] - shift) < 1e-3, "moved immediately")
	await settle(scatter)
	check_equal(scenes_of(scatter), before, "the same scenes")
	check(hidden.is_empty() and shown.size() == shown_ids, "no scene was shown or hidden")
	viewer.global_position.x += 30.0
	await settle(scatter)
	check(shown.size() > shown_ids, "new scenes are shown")
	for id in standing_scenes:
		check(standing_scenes[id].global_transform.is_equal_approx(scatter.get_instance(id).transform), "the scene is at its instance")
	check_once(scatter, everything_of(scatter), "at a new position")


func test_around_bodies() -> void:
	var scatter := make_garden([make_plants()])
	await settle(scatter)
	var body := make_viewer(Vector3(50, 0, 0))
	body.add_to_group(scatter.interaction_group)
	await frames(2)
	await settle(scatter)
	for at: Vector3 in [Vector3.ZERO, body.position]:
		var near := scatter.query_nearest(at, 10.0)
		check(scatter.get_scene(near["id"]) != null, "a scene at %s" % at)
	body.free()
	await frames(2)
	await settle(scatter)
	check(scatter.get_scene(scatter.query_nearest(Vector3(50, 0, 0), 10.0).id) == null, "no scene without a viewer")


## If a state is replaced, the scenes of the instances that the new state removes disappear at once. All others stay.
func test_a_replaced_state_removes_scenes() -> void:
	var scatter := make_garden([make_plants()])
	scatter.state = ScatterState.new()
	await settle(scatter)
	var near := scenes_of(scatter)
	check(near.size() > 50, "%d scenes" % near.size())
	var felled: int = near.keys()[3]
	var other := ScatterState.new()
	check(scatter.remove_instance(felled), "removed")
	check_equal(other.from_bytes(scatter.state.to_bytes()), OK, "loaded")
	check(scatter.restore_instance(felled), "restored")
	await settle(scatter)
	near = scenes_of(scatter)
	check(near.has(felled), "the restored instance has a scene")
	scatter.state = other
	check(scatter.get_scene(felled) == null, "its scene disappears at once")
	near.erase(felled)
	await settle(scatter)
	check_equal(scenes_of(scatter) == near, true, "the other scenes stay")
