extends "terrain3d_harness.gd"
## Tests Terrain3D's ground while it is in use: edits of all kinds, and nodes that are added later, removed or replaced.

## Returns the 32 m tiles that a change to the height samples in a rectangle affects. Samples are 1 m apart.
func tiles_of(rect: Rect2) -> Array[Vector2i]:
	var tiles: Array[Vector2i] = []
	var grown := rect.grow(3.5)
	for x in range(floori(grown.position.x / 32.0), ceili(grown.end.x / 32.0)):
		for y in range(floori(grown.position.y / 32.0), ceili(grown.end.y / 32.0)):
			tiles.push_back(Vector2i(x, y))
	return tiles


func check_regenerated(made: Array[Vector2i], rect: Rect2, context: String) -> void:
	var expected := tiles_of(rect)
	check(not made.is_empty() and made.size() <= expected.size(), "%s: %d tiles regenerated, at most %d" % [context, made.size(), expected.size()])
	for tile in made:
		check(tile in expected, "%s: tile %s is outside of the edit" % [context, tile])


func test_a_stroke_in_the_editor() -> void:
	var node := make_terrain3d()
	var scatter := make_on(node)
	await settle(scatter)
	var rect := Rect2(40.0, 40.0, 6.0, 6.0)
	var stroke := func() -> void:
		for step in 3:
			for x in 6:
				for z in 6:
					node.data.set_height(Vector3(40.5 + x, 0.0, 40.5 + z), 20.0 + step)
			node.data.height_maps_changed.emit()
			node.data.maps_edited.emit(AABB(Vector3(40.0, 0.0, 40.0), Vector3(6.0, 50.0, 6.0)))
	check_regenerated(await regenerated_by(scatter, stroke), rect, "a stroke")
	check_ground(scatter, node, "a stroke")


func test_a_game_script() -> void:
	var node := make_terrain3d()
	var scatter := make_on(node)
	await settle(scatter)
	var act := func(edit: Callable, rect: Rect2, context: String) -> void:
		check_regenerated(await regenerated_by(scatter, edit), rect, context)
		check_ground(scatter, node, context)
	await act.call(func() -> void:
		node.data.set_height(Vector3(-20.5, 0.0, 45.5), 9.0)
		node.data.update_maps(HEIGHT), Rect2(-21.0, 45.0, 1.0, 1.0), "a height")
	await act.call(func() -> void:
		for step in 8:
			node.data.set_control(Vector3(10.5 + step, 0.0, 44.5), HOLE)
		node.data.update_maps(CONTROL), Rect2(10.0, 44.0, 8.0, 1.0), "a hole")
	await act.call(func() -> void:
		node.data.set_height(Vector3(-12.5, 0.0, -45.5), -5.0)
		node.data.regions[Vector2i(-1, -1)].edited = true
		node.data.update_maps(HEIGHT, false), Rect2(-13.0, -46.0, 1.0, 1.0), "an edited region")
	var nothing := await regenerated_by(scatter, func() -> void: node.data.update_maps())
	check_equal(nothing.size(), 0, "tiles regenerated without a change")


func test_textures_that_are_painted() -> void:
	var node := make_terrain3d()
	var layer := make_layer()
	layer.ground_textures = PackedInt32Array([4])
	var scatter := make_on(node, false, layer)
	await settle(scatter)
	check_equal(all_transforms(scatter).size(), 0, "no ground has texture 4")
	for x in 20:
		for z in 20:
			node.data.set_control(Vector3(0.5 + x, 0.0, 0.5 + z), control_of(4, 0, 0))
	node.data.update_maps(CONTROL)
	await settle(scatter)
	var stand := all_transforms(scatter)
	check(stand.size() > 20, "%d instances" % stand.size())
	check(stand.all(func(one: Transform3D) -> bool: return Rect2(0, 0, 20, 20).has_point(Vector2(one.origin.x, one.origin.z))), "all instances are on the painted area")


func test_regions_are_added_and_removed() -> void:
	var node := make_terrain3d()
	var scatter := make_on(node)
	await settle(scatter)
	var before := by_id(scatter)
	var region := node.data.regions[Vector2i(0, -1)]
	var regenerated_tiles := await regenerated_by(scatter, func() -> void: node.data.remove_region(region))
	check(regenerated_tiles.all(func(tile: Vector2i) -> bool: return tile in tiles_of(Rect2(0.0, -64.0, 64.0, 64.0))), "removing a region regenerates only its tiles: %s" % [regenerated_tiles])
	check_ground(scatter, node, "removed")
	check(by_id(scatter).size() < 0.85 * before.size(), "the instances of the removed region are missing")
	await regenerated_by(scatter, func() -> void: node.data.add_region(region))
	check_equal(by_id(scatter), before, "adding the region again restores the instances")
	var higher := func() -> void:
		for at in node.data.regions:
			fill_region(node.data.regions[at], func(post: Vector2i) -> float: return 5.0 + hill(post))
		node.data.update_maps()
	await regenerated_by(scatter, higher)
	check_ground(scatter, node, "imported")
	check(all_transforms(scatter)[0].origin.y > 0.0, "the ground has the new heights")


func test_vertex_spacing() -> void:
	var node := make_terrain3d()
	var scatter := make_on(node)
	await settle(scatter)
	for spacing: float in [2.0, 0.7]:
		await regenerated_by(scatter, func() -> void: node.vertex_spacing = spacing)
		check_ground(scatter, node, "a spacing of %s m" % spacing)


func test_changed_auto_shader_settings_are_read_again() -> void:
	var node := make_terrain3d()
	var layer := make_layer()
	layer.ground_textures = PackedInt32Array([9])
	for at in node.data.regions:
		node.data.regions[at].maps[CONTROL].fill(Color(as_float(AUTO), 0.0, 0.0))
	var scatter := make_on(node, false, layer)
	await settle(scatter)
	check_equal(all_transforms(scatter).size(), 0, "no texture 9")
	node.material.parameters["auto_overlay_texture"] = 9
	scatter.regenerate()
	await settle(scatter)
	check(all_transforms(scatter).size() > 100, "level ground has texture 9")


func test_it_is_added_late() -> void:
	for how: String in ["joins", "replaces", "is reparented", "gets data"]:
		var terrain := ScatterGroundNode.new()
		terrain.node = ^"../Ground"
		var node := make_terrain3d()
		node.name = "Ground"
		if how == "replaces":
			root.add_child(node)
		elif how == "gets data":
			node.data.free()
			node.late = true
			root.add_child(node)
		var scatter := make_scatter([make_layer()], terrain, make_viewer())
		await settle(scatter)
		match how:
			"joins", "is reparented":
				check("../Ground" in "\n".join(scatter.get_problems()), "%s: reported" % how)
				check_error(["../Ground"], how)
				if how == "is reparented":
					var elsewhere := Node3D.new()
					root.add_child(elsewhere)
					elsewhere.add_child(node)
					await frames(3)
					check_equal(scatter.get_stats()["instances"], 0, "no instances before the node is found")
					node.reparent(root)
				else:
					root.add_child(node)
			"replaces":
				check_ground(scatter, node, "before")
				node.free()
				node = make_terrain3d()
				node.data.set_height(Vector3(3.5, 0.0, 3.5), 12.0)
				node.name = "Ground"
				root.add_child(node)
			"gets data":
				check("get_height" in "\n".join(scatter.get_problems()), "%s: reported: %s" % [how, scatter.get_problems()])
				check_error(["Ground"], how)
				node.make_data()
				var region := Terrain3DRegionDouble.new()
				fill_region(region)
				node.data.add_region(region)
		# No signal reports the new data, but the next frame finds it.
		await settle(scatter)
		await settle(scatter)
		check_equal(scatter.get_problems().size(), 0, "%s: no problems: %s" % [how, scatter.get_problems()])
		check_ground(scatter, node, how)
		check_no_error(how)
		scatter.free()
		node.free()


func test_get_problems_does_not_hide_a_new_node() -> void:
	var terrain := ScatterGroundNode.new()
	terrain.node = ^"../Ground"
	var scatter := make_scatter([make_layer()], terrain, make_viewer())
	await settle(scatter)
	check_error(["../Ground"], "a missing node")
	var node := make_terrain3d()
	node.name = "Ground"
	root.add_child(node)
	check_equal(scatter.get_problems().size(), 0, "the new node is found immediately")
	await settle(scatter)
	await settle(scatter)
	check_ground(scatter, node, "found by get_problems")


func test_it_leaves_and_reenters_the_tree() -> void:
	var node := make_terrain3d()
	var scatter := make_on(node)
	await settle(scatter)
	var before := by_id(scatter)
	root.remove_child(node)
	await settle(scatter)
	check_error(["ScatterGroundNode.node"], "the node left the tree")
	check_equal(by_id(scatter), before, "the instances do not change")
	node.data.set_height(Vector3(3.5, 0.0, 3.5), 12.0)
	root.add_child(node)
	await settle(scatter)
	check_no_error("back")
	check_ground(scatter, node, "changed while it was outside of the tree")


func test_it_is_freed_and_edited_while_workers_generate_tiles() -> void:
	for round in 12:
		var node := make_terrain3d()
		var layer := make_layer(0.4)
		var scatter := make_on(node, round % 2 == 0, layer)
		await frames(1 + round % 4)
		for step in 6:
			var region := Terrain3DRegionDouble.new(Vector2i(step % 2, -1))
			fill_region(region, func(_post: Vector2i) -> float: return step)
			if step % 3 == 0:
				node.data.remove_region(node.data.regions[Vector2i(step % 2, -1)], false)
			else:
				node.data.add_region(region)
			node.data.regions[Vector2i(0, 0)].maps[HEIGHT].fill(Color(step, 0.0, 0.0))
			node.data.update_maps()
			if step % 2:
				await process_frame
		node.free()
		await frames(2)
		check_error(["ScatterGroundNode.node"], "round %d" % round)
		scatter.free()
		check_no_error("round %d" % round)


func test_a_recenter_without_the_node() -> void:
	var node := make_terrain3d()
	var scatter := make_on(node)
	await settle(scatter)
	var before := all_transforms(scatter).size()
	scatter.world_offset = Vector3(64.0, 3.0, 0.0)
	await settle(scatter)
	await settle(scatter)
	check(all_transforms(scatter).size() > 0.6 * before, "most instances remain")
	check_equal(off_the_ground(scatter, node), 0, "instances off the ground, which did not move")
