extends "hterrain_harness.gd"
## What becomes of HTerrain while its ground is in use: edits, other data, moves, and nodes that come late or go.

func kinds() -> Dictionary[String, HTerrainDataDouble]:
	return {"1.8": HTerrain18Data.new(), "master": HTerrainMasterData.new()}


func test_sculpting_makes_its_tiles_anew() -> void:
	var datas := kinds()
	for kind: String in datas:
		var node := make_hterrain(datas[kind])
		var data := node.get_data()
		var scatter := make_on(node)
		await settle(scatter)
		for step in 3: # The first is of an image that is still shared; the next are of patches.
			var sculpt := func() -> void:
				for column in range(56, 59):
					for row in range(56, 59):
						data.set_post(column, row, 12.0 + step)
				data.notify_region_change(Rect2i(56, 56, 3, 3), CHANNEL_HEIGHT)
			var made := await regenerated_by(scatter, sculpt)
			check_equal(made, [Vector2i(1, 1)] as Array[Vector2i], "%s, step %d: tiles" % [kind, step])
			check_ground(scatter, node, "%s, step %d" % [kind, step])
		var nothing := await regenerated_by(scatter, func() -> void: data.notify_region_change(Rect2i(0, 0, 65, 65), CHANNEL_HEIGHT))
		check_equal(nothing.size(), 0, "%s: tiles made where nothing has changed" % kind)
		var odd := func() -> void:
			for rect: Rect2i in [Rect2i(-5, -5, 3, 3), Rect2i(60, 60, 50, 50), Rect2i(3, 3, 0, 0), Rect2i(5, 5, -2, 4)]:
				data.notify_region_change(rect, CHANNEL_HEIGHT)
			data.notify_region_change(Rect2i(0, 0, 65, 65), 4)
			data.notify_region_change(Rect2i(0, 0, 65, 65), 99)
		check_equal((await regenerated_by(scatter, odd)).size(), 0, "%s: tiles made for odd rects" % kind)
		check_no_error(kind)
		scatter.free()
		node.free()


func test_holes_and_textures_that_are_painted() -> void:
	var datas := kinds()
	for kind: String in datas:
		var node := make_hterrain(datas[kind])
		var data := node.get_data()
		var colors := data.add_map(CHANNEL_COLOR, Image.FORMAT_RGBA8, Color.WHITE)
		data.add_map(CHANNEL_SPLAT, Image.FORMAT_RGBA8, Color(1.0, 0.0, 0.0, 0.0))
		var splat := data.add_map(CHANNEL_SPLAT, Image.FORMAT_RGBA8, Color(0.0, 0.0, 0.0, 0.0))
		var layer := make_layer()
		layer.ground_textures = PackedInt32Array([6])
		var scatter := make_on(node, false, layer)
		await settle(scatter)
		check_equal(all_transforms(scatter).size(), 0, "%s: nothing is of texture 6" % kind)
		splat.fill_rect(Rect2i(10, 10, 45, 45), Color(0.0, 0.0, 1.0, 0.0))
		data.notify_region_change(Rect2i(10, 10, 45, 45), CHANNEL_SPLAT, 1)
		await settle(scatter)
		var painted := all_transforms(scatter).size()
		check(painted > 300, "%s: %d instances on texture 6" % [kind, painted])
		colors.fill_rect(Rect2i(0, 0, 65, 32), Color(1.0, 1.0, 1.0, 0.0))
		data.notify_region_change(Rect2i(0, 0, 65, 32), CHANNEL_COLOR)
		await settle(scatter)
		var stand := all_transforms(scatter)
		check(stand.size() < 0.6 * painted and stand.size() > 0.3 * painted, "%s: %d beside the hole" % [kind, stand.size()])
		check(stand.all(func(one: Transform3D) -> bool: return one.origin.z > -2.0), "%s: none in it" % kind)
		scatter.free()
		node.free()


func test_it_moves_and_is_stretched() -> void:
	var node := make_hterrain()
	var scatter := make_on(node)
	await settle(scatter)
	var act := func(change: Callable, what: String) -> void:
		change.call()
		await frames(2)
		await settle(scatter)
		check_ground(scatter, node, what)
	await act.call(func() -> void: node.position = Vector3(7.0, 30.0, -12.0), "moved")
	await act.call(func() -> void: node.rotation.y = 1.1, "turned")
	await act.call(func() -> void: node.map_scale = Vector3(1.0, 2.0, 1.5), "stretched")
	await act.call(func() -> void: node.centered = false, "not centered")


func test_other_data() -> void:
	var node := make_hterrain()
	var scatter := make_on(node)
	await settle(scatter)
	var old := node.get_data()
	var other := HTerrain18Data.new()
	other.fill(func(column: int, row: int) -> float: return 20.0 + HTerrainDataDouble.hill(row, column))
	node.set_data(other) # Nobody is told.
	await frames(2)
	await settle(scatter)
	check_ground(scatter, node, "other data")
	var made := await regenerated_by(scatter, func() -> void: old.notify_region_change(Rect2i(0, 0, 65, 65), CHANNEL_HEIGHT))
	check_equal(made.size(), 0, "the old data is not followed")
	other.resolution = 129
	other.maps[CHANNEL_HEIGHT] = [Image.create_empty(129, 129, false, Image.FORMAT_RF)]
	other.fill()
	other.resolution_changed.emit()
	await frames(2)
	await settle(scatter)
	check_ground(scatter, node, "another resolution")
	other.maps[CHANNEL_HEIGHT] = [other.maps[CHANNEL_HEIGHT][0].duplicate()]
	check_equal((await regenerated_by(scatter, func() -> void: other.map_changed.emit(CHANNEL_HEIGHT, 0))).size(), 0, "an equal image")
	other.maps[CHANNEL_HEIGHT] = [Image.create_empty(129, 129, false, Image.FORMAT_RF)]
	other.map_changed.emit(CHANNEL_HEIGHT, 0)
	await settle(scatter)
	check_ground(scatter, node, "another image")
	check_no_error("other data")


func test_data_comes_later() -> void:
	var node := HTerrainDouble.new()
	var scatter := make_on(node)
	await settle(scatter)
	check_error(["HTerrain", "has no data yet"], "no data")
	check("has no data yet" in "\n".join(scatter.get_problems()), "said")
	var data := HTerrainMasterData.new()
	data.fill()
	node.set_data(data)
	await frames(2)
	await settle(scatter)
	check_equal(scatter.get_problems().size(), 0, "nothing to say: %s" % [scatter.get_problems()])
	check_ground(scatter, node, "with data")
	var before := by_id(scatter)
	node.set_data(null)
	await frames(2)
	await settle(scatter)
	check_error(["HTerrain", "has no data yet"], "no data again")
	check_equal(by_id(scatter), before, "what stands stays")


func test_it_comes_late_and_is_replaced() -> void:
	var terrain := ScatterGroundNode.new()
	terrain.node = ^"../Ground"
	var scatter := make_scatter([make_layer()], terrain, make_viewer())
	await settle(scatter)
	check_error(["../Ground"], "not there")
	for round in 3:
		var node := make_hterrain()
		node.name = "Ground"
		node.position.y = 10.0 * round
		root.add_child(node)
		await frames(2)
		await settle(scatter)
		check_no_error("round %d" % round)
		check_equal(scatter.get_problems().size(), 0, "round %d: nothing to say" % round)
		check_ground(scatter, node, "round %d" % round)
		node.free()
		if round == 0:
			await frames(2)
			check_error(["../Ground"], "freed")
		# Otherwise another one is there in the same frame.
	scatter.free()


func test_it_is_freed_and_edited_while_workers_make_tiles() -> void:
	for round in 12:
		var node := make_hterrain()
		var data := node.get_data()
		var scatter := make_on(node, round % 2 == 0, make_layer(0.4))
		await frames(1 + round % 4)
		for step in 6:
			data.get_image(CHANNEL_HEIGHT).fill_rect(Rect2i(step, step, 40, 40), Color(step, 0.0, 0.0))
			data.notify_region_change(Rect2i(step, step, 40, 40), CHANNEL_HEIGHT)
			if step == 3:
				data.maps[CHANNEL_HEIGHT] = [Image.create_empty(65, 65, false, Image.FORMAT_RF)]
			if step % 2:
				await process_frame
		node.free()
		data = null
		await frames(2)
		check_error(["ScatterGroundNode.node"], "round %d" % round)
		scatter.free()
		check_no_error("round %d" % round)


func test_a_recenter_that_it_follows_makes_nothing() -> void:
	var node := make_hterrain()
	var viewer := make_viewer()
	root.add_child(node)
	var terrain := ScatterGroundNode.new()
	var scatter := make_scatter([make_layer()], terrain, viewer)
	terrain.node = scatter.get_path_to(node)
	await settle(scatter)
	var before := digests(scatter, 0)
	var shift := Vector3(256.0, 16.0, -512.0)
	var made := await regenerated_by(scatter, func() -> void:
		viewer.global_position -= shift
		node.global_position -= shift
		scatter.world_offset = shift)
	check_equal(made.size(), 0, "tiles made")
	check_equal(digests(scatter, 0), before, "digests")
	check_ground(scatter, node, "recentered")
	scatter.world_offset = Vector3.ZERO # Now it has stayed where it is.
	viewer.global_position = node.global_position
	await frames(2)
	await settle(scatter)
	check_ground(scatter, node, "moved in the world")


## An edit has the map read that was edited, and no other.
func test_edits_read_their_map_alone() -> void:
	var datas := kinds()
	for kind: String in datas:
		var data := datas[kind]
		data.add_map(CHANNEL_COLOR, Image.FORMAT_RGBA8, Color.WHITE)
		var node := make_hterrain(data)
		var scatter := make_on(node)
		await settle(scatter)
		var before := data.read.duplicate()
		check(before[CHANNEL_COLOR] > 0 and before[CHANNEL_HEIGHT] > 0, "%s: maps that are read: %s" % [kind, before])
		data.set_post(57, 57, 30.0)
		data.notify_region_change(Rect2i(57, 57, 1, 1), CHANNEL_HEIGHT)
		await settle(scatter)
		check_ground(scatter, node, kind)
		check_equal(data.read[CHANNEL_COLOR], before[CHANNEL_COLOR], "%s: the colors were read" % kind)
		check(data.read[CHANNEL_HEIGHT] > before[CHANNEL_HEIGHT], "%s: the heights were read" % kind)
		scatter.free()
		node.free()
