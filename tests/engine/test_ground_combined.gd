extends "combined_harness.gd"
## ScatterGroundCombined: the highest of several grounds, all levels for layers on surfaces, changes to one ground, and lists that scripts
## change at any time.

## A script that may only be called on the main thread, and acts once.
class MainScript extends ScatterGround:
	var height := -3.0
	var action := Callable()

	func _get_heights(positions: PackedVector2Array) -> PackedFloat32Array:
		if action.is_valid():
			var once := action
			action = Callable()
			once.call()
		var heights := PackedFloat32Array()
		heights.resize(positions.size())
		heights.fill(height)
		return heights


class HalfPlane extends Node3D:
	func get_height(at: Vector3) -> float:
		return 2.0 if at.x > 0.0 else NAN


func test_the_top_layer_grows_on_the_highest_ground() -> void:
	put_bridge()
	var terrain := make_terrain()
	var ground := combine([terrain, make_bridges()])
	var scatter := make_scatter([make_dense()], ground, make_viewer())
	await settle(scatter)
	var counts := [0, 0]
	for at: Transform3D in instances(scatter, 0).values():
		var above := is_on_bridge(at.origin)
		counts[int(above)] += 1
		var height := HEIGHT if above else terrain.get_height(at.origin)
		if not check(absf(at.origin.y - height) < 1e-3, "an instance at %s, expected height %f" % [at.origin, height]):
			break
	check(counts[0] > 2000 and counts[1] > 120, "on the terrain and on the bridge: %s" % [counts])
	check_equal(scatter.get_problems().size(), 0, "problems: %s" % scatter.get_problems())
	check_equal(ground.get_height(Vector3(2.0, 0.0, 3.0)), HEIGHT, "the height of the bridge")
	check_equal(ground.get_height(Vector3(20.0, 0.0, 3.0)), terrain.get_height(Vector3(20.0, 0.0, 3.0)), "the height next to the bridge")
	check(is_nan(ground.get_height(Vector3(200.0, 0.0, 3.0))), "no ground outside")
	check_equal(ground.get_normal(Vector3(2.0, 0.0, 3.0)), Vector3.UP, "the normal of the bridge")
	var found := scatter.query_rect(Rect2(-4.0, -4.0, 8.0, 8.0))
	check(found.ids.size() > 20, "a query finds the instances on the bridge")
	for position in found.positions:
		check_equal(position.y, HEIGHT, "its height")


func test_all_levels_and_the_area_of_slopes() -> void:
	put_bridge(2.0 * SIDE)
	var scatter := make_scatter([make_dense(true)], combine([make_terrain(1.0), make_bridges()]), make_viewer())
	await settle(scatter)
	var below := 0
	var counts := [0, 0]
	for at: Transform3D in instances(scatter, 0).values():
		var above := at.origin.y > SIDE
		counts[int(above)] += 1
		below += int(not above and is_on_bridge(at.origin))
		if not check(absf(at.origin.y - (2.0 * SIDE if above else at.origin.x)) < 1e-3, "an instance at %s" % at.origin):
			break
	for case: Array in [[counts[0], SIDE * SIDE * sqrt(2.0), "the slope"], [below, BRIDGE * BRIDGE * sqrt(2.0), "the slope below the bridge"],
			[counts[1], BRIDGE * BRIDGE, "the bridge"]]:
		var expected: float = case[1] * DENSITY
		check(absf(case[0] - expected) < 0.1 * expected + 10.0, "%s has %d instances, expected about %d" % [case[2], case[0], expected])
	check_equal(scatter.get_problems().size(), 0, "problems: %s" % scatter.get_problems())


func test_a_heightmap_alone_has_surfaces_too() -> void:
	var terrain := make_terrain()
	(terrain.image as Image).set_pixel(32, 32, Color(NAN, 0.0, 0.0))
	var scatter := make_scatter([make_dense(true)], terrain, make_viewer())
	await settle(scatter)
	var standing := instances(scatter, 0)
	check(standing.size() > 2500, "%d instances" % standing.size())
	for at: Transform3D in standing.values():
		check(absf(at.origin.x) >= 1.0 or absf(at.origin.z) >= 1.0, "no instance in the hole: %s" % at.origin)
		if not check(absf(at.origin.y - terrain.get_height(at.origin)) < 0.2, "an instance at %s" % at.origin):
			break
	check_equal(scatter.get_problems().size(), 0, "problems: %s" % scatter.get_problems())
	var before := instances(scatter, 0)
	(terrain.image as Image).fill_rect(Rect2i(5, 5, 4, 4), Color(3.0, 0.0, 0.0))
	terrain.update_region(Rect2i(5, 5, 4, 4))
	await settle(scatter)
	var edited := Rect2(5.0 - SIDE / 2.0, 5.0 - SIDE / 2.0, 4.0, 4.0).grow(12.0)
	var changed := changed_places(before, instances(scatter, 0))
	check(changed.size() > 10, "an edit moves instances")
	for point in changed:
		check(edited.has_point(point), "an edit moves no instance far away: %s" % point)


func test_a_moved_mesh_changes_only_its_surroundings() -> void:
	var bridge := put_bridge()
	var layers: Array[ScatterLayer] = [make_dense(), make_dense(true)]
	layers[1].layer_id = 5
	var scatter := make_scatter(layers, combine([make_terrain(), make_bridges()]), make_viewer())
	await settle(scatter)
	var before := [instances(scatter, 0), instances(scatter, 1)]
	await regenerated_by(scatter, func() -> void:
		bridge.position = Vector3(8.0, HEIGHT, 0.0)
		await until(func() -> bool: return not scatter.is_settled(), "the ground is updated"))
	var area := Rect2(-BRIDGE / 2.0, -BRIDGE / 2.0, BRIDGE + 8.0, BRIDGE)
	for index in 2:
		var changed := changed_places(before[index], instances(scatter, index))
		check(changed.size() > 100, "layer %d changes" % index)
		for point in changed:
			check(area.grow(12.0 * index + 1.0).has_point(point), "layer %d changes at %s" % [index, point])
	var unchanged := 0
	for tile: Vector2i in scatter.get_shown_tiles(scatter.layers[0]):
		unchanged += int(not Rect2(Vector2(tile) * 16.0, Vector2(16.0, 16.0)).intersects(area.grow(2.0)))
	var regenerated_tiles := await regenerated_by(scatter, func() -> void:
		bridge.position = Vector3(0.0, HEIGHT, 0.0)
		await until(func() -> bool: return not scatter.is_settled(), "the ground is updated"))
	check(regenerated_tiles.size() <= 2 * scatter.get_shown_tiles(scatter.layers[0]).size() - unchanged, "%d tiles regenerated" % regenerated_tiles.size())


func test_the_order_has_no_effect() -> void:
	put_bridge()
	put_bridge(0.4)
	var flat := ScatterGroundFlat.new()
	flat.height = 0.4
	var grounds: Array[ScatterGround] = [make_terrain(), make_bridges(), flat]
	var layers: Array[ScatterLayer] = [make_dense(), make_dense(true)]
	layers[1].layer_id = 5
	var ground := combine(grounds)
	var scatter := make_scatter(layers, ground, make_viewer())
	await settle(scatter)
	var expected := [digests(scatter, 0), digests(scatter, 1)]
	for order: Array in [[2, 1, 0], [1, 2, 0], [0, 2, 1]]:
		ground.grounds = order.map(func(index: int) -> ScatterGround: return grounds[index])
		await settle(scatter)
		check_equal([digests(scatter, 0), digests(scatter, 1)], expected, "the order %s" % [order])
	var nested := combine([combine([grounds[0], flat]), grounds[1]])
	scatter.ground = nested
	await settle(scatter)
	check_equal([digests(scatter, 0), digests(scatter, 1)], expected, "nested")


func test_grounds_are_added_and_removed() -> void:
	put_bridge()
	var terrain := make_terrain()
	var bridges := make_bridges()
	var ground := combine([terrain])
	var scatter := make_scatter([make_dense()], ground, make_viewer())
	await settle(scatter)
	var alone := digests(scatter, 0)
	ground.grounds.append(bridges)
	await settle(scatter)
	var together := digests(scatter, 0)
	check(together != alone, "an appended ground is used")
	ground.grounds = [terrain]
	await settle(scatter)
	check_equal(digests(scatter, 0), alone, "a removed ground is not used")
	ground.grounds = [null, bridges, terrain, bridges]
	await settle(scatter)
	check_equal(digests(scatter, 0), together, "empty and repeated entries are ignored")
	check("grounds[0] is empty" in str(scatter.get_problems()), str(scatter.get_problems()))
	ground.grounds = [bridges, terrain, bridges]
	check("grounds[2] has no effect" in str(scatter.get_problems()), str(scatter.get_problems()))
	ground.grounds.clear()
	await settle(scatter)
	check(instances(scatter, 0).is_empty(), "an emptied list has no ground")
	check("grounds is empty" in str(scatter.get_problems()), str(scatter.get_problems()))
	ground.grounds = [terrain, bridges]
	await settle(scatter)
	check_equal(digests(scatter, 0), together, "both again")
	bridges.group = &"nothing"
	await settle(scatter)
	check_equal(digests(scatter, 0), alone, "a changed property of a ground has an effect")
	check("grounds[1]: ScatterGroundMeshes.group" in str(scatter.get_problems()), str(scatter.get_problems()))
	var explained := scatter.explain_position(Vector3(3.0, 0.0, 3.0))[0]
	check(not "ScatterGroundMeshes" in str(explained.reason), "the other ground is still explained: %s" % explained.reason)
	ground.grounds = [bridges]
	await settle(scatter)
	explained = scatter.explain_position(Vector3(3.0, 0.0, 3.0))[0]
	check("ScatterGroundMeshes" in str(explained.reason), "without a usable ground, its problem is: %s" % explained.reason)


func test_cycles_are_rejected() -> void:
	var flat := ScatterGroundFlat.new()
	var inner := combine([flat])
	var outer := combine([inner])
	inner.grounds = [flat, inner]
	check_error(["ScatterGroundCombined.grounds[1]", "itself", "Assign"], "itself")
	inner.grounds = [outer]
	check_error(["ScatterGroundCombined.grounds[0]", "contain", "Assign"], "a cycle")
	check_equal(inner.grounds, [flat] as Array[ScatterGround], "the list is kept")
	var scatter := make_scatter([make_layer()], outer, make_viewer())
	await settle(scatter)
	inner.grounds.append(outer)
	await settle(scatter)
	check_error(["ScatterGroundCombined.grounds[1]", "contain"], "a cycle by append")
	check_equal(outer.get_height(Vector3.ZERO), 0.0, "the other ground is used")
	check("grounds[1] has no effect" in str(scatter.get_problems()), str(scatter.get_problems()))
	inner.grounds.clear() # Otherwise, the two would keep each other alive.
	await settle(scatter)


func test_textures_apply_to_the_ground_that_has_them() -> void:
	put_bridge()
	var terrain := make_terrain()
	var weights := Image.create_empty(2, 2, false, Image.FORMAT_RG8)
	weights.fill(Color(1.0, 0.0, 0.0))
	terrain.weight_image = weights
	var layer := make_dense()
	layer.ground_textures = [1]
	var scatter := make_scatter([layer], combine([terrain, make_bridges()]), make_viewer())
	await settle(scatter)
	var standing := instances(scatter, 0)
	check(standing.size() > 120, "%d instances on the bridge, which has no textures" % standing.size())
	for at: Transform3D in standing.values():
		check(is_on_bridge(at.origin), "no instance is on the terrain, which has another texture: %s" % at.origin)
	layer.ground_textures = [0]
	await settle(scatter)
	check(instances(scatter, 0).size() > 2000, "instances are on both grounds if the terrain has the texture")
	check_equal(scatter.get_problems().size(), 0, "problems: %s" % scatter.get_problems())


func test_grounds_that_only_the_main_thread_may_sample() -> void:
	put_bridge()
	var shape := CollisionShape3D.new()
	shape.shape = BoxShape3D.new()
	(shape.shape as BoxShape3D).size = Vector3(10.0, 2.0, 10.0)
	var body := StaticBody3D.new()
	body.position = Vector3(20.0, 11.0, 20.0)
	body.add_child(shape)
	root.add_child(body)
	var script := MainScript.new()
	var terrain := make_terrain()
	var layer := make_layer()
	layer.view_distance = 40.0
	var ground := combine([terrain, make_bridges(), script])
	var scatter := make_scatter([layer], ground, make_viewer())
	await settle(scatter)
	check_heights(scatter, func(at: Vector3) -> float:
		return HEIGHT if is_on_bridge(at) else maxf(terrain.get_height(at), -3.0) if absf(at.x) < SIDE / 2.0 and absf(at.z) < SIDE / 2.0 else -3.0)
	script.height = 20.0
	await until(func() -> bool: return instances(scatter, 0).values().any(func(at: Transform3D) -> bool: return at.origin.y == 20.0),
			"a re-check finds the change to the script")
	await settle(scatter)
	check_heights(scatter, func(_at: Vector3) -> float: return 20.0)
	ground.grounds = [terrain, ScatterGroundColliders.new()]
	await until(func() -> bool: return instances(scatter, 0).values().any(func(at: Transform3D) -> bool: return absf(at.origin.y - 12.0) < 0.01),
			"the body is ground")
	await settle(scatter)
	check_heights(scatter, func(at: Vector3) -> float:
		return 12.0 if absf(at.x - 20.0) < 5.0 and absf(at.z - 20.0) < 5.0 else terrain.get_height(at))
	var lift := AnimatableBody3D.new()
	lift.position = Vector3(-20.0, 11.0, 20.0)
	lift.add_child(shape.duplicate())
	root.add_child(lift)
	var before := digests(scatter, 0)
	for frame in 40:
		await physics_frame
	check_equal(digests(scatter, 0), before, "a moving body that hides the ground has no effect")
	layer.on_surfaces = true
	await settle(scatter)
	check("on_surfaces" in str(scatter.get_problems()), "no surfaces: %s" % scatter.get_problems())


func test_a_missing_node_leaves_everything_unchanged() -> void:
	put_bridge()
	var node := HalfPlane.new()
	root.add_child(node)
	var by_node := ScatterGroundNode.new()
	var ground := combine([by_node, make_bridges()])
	var scatter := make_scatter([make_layer()], ground, make_viewer())
	by_node.node = scatter.get_path_to(node)
	await settle(scatter)
	var before := digests(scatter, 0)
	check_heights(scatter, func(at: Vector3) -> float: return HEIGHT if is_on_bridge(at) else 2.0)
	root.remove_child(node)
	await frames(5)
	check_equal(digests(scatter, 0), before, "the tiles without the node")
	check("grounds[0]: ScatterGroundNode.node" in str(scatter.get_problems()), str(scatter.get_problems()))
	errors.take()
	root.add_child(node)
	scatter.regenerate()
	await settle(scatter)
	check_equal(digests(scatter, 0), before, "the tiles after the node has returned")


func test_grounds_are_shared_and_used_alone() -> void:
	var bridge := put_bridge()
	var terrain := make_terrain()
	var bridges := make_bridges()
	var combined := combine([terrain, bridges])
	var scatters: Array[TerrainScatter3D] = []
	for ground: ScatterGround in [combined, combined, terrain, bridges, combine([bridges])]:
		scatters.push_back(make_scatter([make_dense()], ground, make_viewer()))
	for scatter in scatters:
		await settle(scatter)
	check_equal(digests(scatters[0], 0), digests(scatters[1], 0), "two nodes with one ground")
	check_equal(digests(scatters[3], 0), digests(scatters[4], 0), "a ground alone and in a list")
	var before := digests(scatters[0], 0)
	scatters[0].free()
	scatters[3].free()
	bridge.position.y = 20.0
	await until(func() -> bool: return digests(scatters[1], 0) != before, "the remaining nodes are updated with the scene")
	await settle(scatters[1])
	await settle(scatters[4])
	check_equal(combined.get_height(Vector3.ZERO), 20.0, "the new height")
	check(instances(scatters[4], 0).values().all(func(at: Transform3D) -> bool: return at.origin.y == 20.0), "the other list also uses the new height")


func test_the_scene_may_be_recentered() -> void:
	var bridge := put_bridge()
	var scatter := make_scatter([make_dense()], combine([make_terrain(), make_bridges()]), make_viewer())
	await settle(scatter)
	var before := instances(scatter, 0)
	bridge.position -= Vector3(100.0, 0.0, 50.0)
	(scatter.get_node(scatter.viewers[0]) as Node3D).position -= Vector3(100.0, 0.0, 50.0)
	scatter.world_offset = Vector3(100.0, 0.0, 50.0)
	await frames(40)
	await settle(scatter)
	check_equal(instances(scatter, 0).keys().size(), before.keys().size(), "instances after the scene was recentered")


func test_scripts_may_do_anything_in_signals_and_callbacks() -> void:
	for action: String in ["clear", "replace", "free", "other"]:
		var bridge := put_bridge()
		var terrain := make_terrain()
		var script := MainScript.new()
		var bridges := make_bridges()
		var ground := combine([terrain, bridges, script])
		var scatter := make_scatter([make_layer()], ground, make_viewer())
		var act := func() -> void:
			match action:
				"clear": ground.grounds.clear()
				"replace": ground.grounds = [bridges]
				"free": scatter.queue_free()
				"other": scatter.ground = ScatterGroundFlat.new()
		script.action = act
		await frames(20)
		if is_instance_valid(scatter):
			scatter.ground = ground
			ground.grounds = [terrain, bridges]
			await settle(scatter)
			ground.ground_changed.connect(act.unbind(1), CONNECT_ONE_SHOT)
			bridge.position.y += 3.0
			await frames(60)
			if action != "free":
				ground.grounds = [terrain, bridges]
				scatter.ground = ground
				await settle(scatter)
				check_equal(ground.get_height(Vector3.ZERO), HEIGHT + 3.0, "after '%s', the ground works" % action)
		await clean()
	check_no_error("no action prints an error")


func test_signals_of_other_threads_arrive_late() -> void:
	put_bridge()
	var terrain := make_terrain()
	var bridges := make_bridges()
	var ground := combine([terrain, bridges])
	var scatter := make_scatter([make_layer()], ground, make_viewer())
	await settle(scatter)
	var emit := func() -> void: terrain.ground_changed.emit(Rect2(20.0, 20.0, 2.0, 2.0))
	var emit_on_thread := func() -> void:
		var thread := Thread.new()
		thread.start(emit)
		thread.wait_to_finish()
	check(not (await regenerated_by(scatter, emit_on_thread)).is_empty(), "the signal arrives")
	emit_on_thread.call()
	ground.grounds = [bridges]
	await settle(scatter)
	check_no_error("a signal of a ground that has since been removed")


func test_a_saved_list_is_the_same() -> void:
	var flat := ScatterGroundFlat.new()
	flat.height = 3.0
	check_equal(ResourceSaver.save(combine([flat, null, make_bridges()]), "user://combined.tres"), OK, "saved")
	var loaded: ScatterGroundCombined = ResourceLoader.load("user://combined.tres", "", ResourceLoader.CACHE_MODE_IGNORE)
	check_equal(loaded.grounds.size(), 3, "its entries")
	check_equal(loaded.get_height(Vector3.ZERO), 3.0, "its height")
	check(loaded.grounds[1] == null and loaded.grounds[2] is ScatterGroundMeshes, "an empty entry and the meshes")
