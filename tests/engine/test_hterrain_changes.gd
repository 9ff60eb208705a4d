extends "hterrain_harness.gd"
## Tests HTerrain's ground while it is in use: edits, new data, movements, and nodes that are added later or removed.

func kinds() -> Dictionary[String, HTerrainDataDouble]:
	return {"1.8": HTerrain18Data.new(), "master": HTerrainMasterData.new()}


func test_sculpting_regenerates_its_tiles() -> void:
	var datas := kinds()
	for kind: String in datas:
		var node := make_hterrain(datas[kind])
		var data := node.get_data()
		var scatter := make_on(node)
		await settle(scatter)
		for step in 3: # The first edit copies the image, which is still shared. The second and third edits change parts of the copy.
			var sculpt := func() -> void:
				for column in range(56, 59):
					for row in range(56, 59):
						data.set_post(column, row, 12.0 + step)
				data.notify_region_change(Rect2i(56, 56, 3, 3), CHANNEL_HEIGHT)
			var regenerated_tiles := await regenerated_by(scatter, sculpt)
			check_equal(regenerated_tiles, [Vector2i(1, 1)] as Array[Vector2i], "%s, step %d: tiles" % [kind, step])
			check_ground(scatter, node, "%s, step %d" % [kind, step])
		var nothing := await regenerated_by(scatter, func() -> void: data.notify_region_change(Rect2i(0, 0, 65, 65), CHANNEL_HEIGHT))
		check_equal(nothing.size(), 0, "%s: tiles regenerated without a change" % kind)
		var odd := func() -> void:
			for rect: Rect2i in [Rect2i(-5, -5, 3, 3), Rect2i(60, 60, 50, 50), Rect2i(3, 3, 0, 0), Rect2i(5, 5, -2, 4)]:
				data.notify_region_change(rect, CHANNEL_HEIGHT)
			data.notify_region_change(Rect2i(0, 0, 65, 65), 4)
			data.notify_region_change(Rect2i(0, 0, 65, 65), 99)
		check_equal((await regenerated_by(scatter, odd)).size(), 0, "%s: tiles regenerated for invalid rects" % kind)
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
		check_equal(all_transforms(scatter).size(), 0, "%s: no ground has texture 6" % kind)
		splat.fill_rect(Rect2i(10, 10, 45, 45), Color(0.0, 0.0, 1.0, 0.0))
		data.notify_region_change(Rect2i(10, 10, 45, 45), CHANNEL_SPLAT, 1)
		await settle(scatter)
		var painted := all_transforms(scatter).size()
		check(painted > 300, "%s: %d instances on texture 6" % [kind, painted])
		colors.fill_rect(Rect2i(0, 0, 65, 32), Color(1.0, 1.0, 1.0, 0.0))
		data.notify_region_change(Rect2i(0, 0, 65, 32), CHANNEL_COLOR)
		await settle(scatter)
		var stand := all_transforms(scatter)
		check(stand.size() < 0.6 * painted and stand.size() > 0.3 * painted, "%s: %d outside of the hole" % [kind, stand.size()])
		check(stand.all(func(one: Transform3D) -> bool: return one.origin.z > -2.0), "%s: no instances in the hole" % kind)
		scatter.free()
		node.free()


func test_the_node_is_moved_and_scaled() -> void:
	var node := make_hterrain()
	var scatter := make_on(node)
	await settle(scatter)
	var act := func(change: Callable, context: String) -> void:
		change.call()
		await frames(2)
		await settle(scatter)
		check_ground(scatter, node, context)
	await act.call(func() -> void: node.position = Vector3(7.0, 30.0, -12.0), "moved")
	await act.call(func() -> void: node.rotation.y = 1.1, "rotated")
	await act.call(func() -> void: node.map_scale = Vector3(1.0, 2.0, 1.5), "scaled")
	await act.call(func() -> void: node.centered = false, "not centered")


func test_replaced_data() -> void:
	var node := make_hterrain()
	var scatter := make_on(node)
	await settle(scatter)
	var old := node.get_data()
	var other := HTerrain18Data.new()
	other.fill(func(column: int, row: int) -> float: return 20.0 + HTerrainDataDouble.hill(row, column))
	node.set_data(other) # This method emits no signal.
	await frames(2)
	await settle(scatter)
	check_ground(scatter, node, "new data")
	var regenerated_tiles := await regenerated_by(scatter, func() -> void: old.notify_region_change(Rect2i(0, 0, 65, 65), CHANNEL_HEIGHT))
	check_equal(regenerated_tiles.size(), 0, "changes to the old data are ignored")
	other.resolution = 129
	other.maps[CHANNEL_HEIGHT] = [Image.create_empty(129, 129, false, Image.FORMAT_RF)]
	other.fill()
	other.resolution_changed.emit()
	await frames(2)
	await settle(scatter)
	check_ground(scatter, node, "a new resolution")
	other.maps[CHANNEL_HEIGHT] = [other.maps[CHANNEL_HEIGHT][0].duplicate()]
	check_equal((await regenerated_by(scatter, func() -> void: other.map_changed.emit(CHANNEL_HEIGHT, 0))).size(), 0, "tiles regenerated for an equal image")
	other.maps[CHANNEL_HEIGHT] = [Image.create_empty(129, 129, false, Image.FORMAT_RF)]
	other.map_changed.emit(CHANNEL_HEIGHT, 0)
	await settle(scatter)
	check_ground(scatter, node, "a new image")
	check_no_error("new data")


func test_data_is_set_later() -> void:
	var node := HTerrainDouble.new()
	var scatter := make_on(node)
	await settle(scatter)
	check_error(["HTerrain", "has no data yet"], "no data")
	check("has no data yet" in "\n".join(scatter.get_problems()), "the missing data is among the problems")
	var data := HTerrainMasterData.new()
	data.fill()
	node.set_data(data)
	await frames(2)
	await settle(scatter)
	check_equal(scatter.get_problems().size(), 0, "no problems: %s" % [scatter.get_problems()])
	check_ground(scatter, node, "with data")
	var before := by_id(scatter)
	node.set_data(null)
	await frames(2)
	await settle(scatter)
	check_error(["HTerrain", "has no data yet"], "no data again")
	check_equal(by_id(scatter), before, "the instances do not change")


func test_it_is_added_late_and_replaced() -> void:
	var terrain := ScatterGroundNode.new()
	terrain.node = ^"../Ground"
	var scatter := make_scatter([make_layer()], terrain, make_viewer())
	await settle(scatter)
	check_error(["../Ground"], "a missing node")
	for round in 3:
		var node := make_hterrain()
		node.name = "Ground"
		node.position.y = 10.0 * round
		root.add_child(node)
		await frames(2)
		await settle(scatter)
		check_no_error("round %d" % round)
		check_equal(scatter.get_problems().size(), 0, "round %d: no problems" % round)
		check_ground(scatter, node, "round %d" % round)
		node.free()
		if round == 0:
			await frames(2)
			check_error(["../Ground"], "freed")
		# In the other rounds, a new node replaces the old one in the same frame.
	scatter.free()


func test_it_is_freed_and_edited_while_workers_generate_tiles() -> void:
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


func test_a_recenter_with_the_node_regenerates_nothing() -> void:
	var node := make_hterrain()
	var viewer := make_viewer()
	root.add_child(node)
	var terrain := ScatterGroundNode.new()
	var scatter := make_scatter([make_layer()], terrain, viewer)
	terrain.node = scatter.get_path_to(node)
	await settle(scatter)
	var before := digests(scatter, 0)
	var shift := Vector3(256.0, 16.0, -512.0)
	var regenerated_tiles := await regenerated_by(scatter, func() -> void:
		viewer.global_position -= shift
		node.global_position -= shift
		scatter.world_offset = shift)
	check_equal(regenerated_tiles.size(), 0, "regenerated tiles")
	check_equal(digests(scatter, 0), before, "digests of the instances")
	check_ground(scatter, node, "recentered")
	scatter.world_offset = Vector3.ZERO # This time, the node stays in place when the world offset changes.
	viewer.global_position = node.global_position
	await frames(2)
	await settle(scatter)
	check_ground(scatter, node, "moved in the world")


## An edit reads only the edited map.
func test_edits_read_only_their_map() -> void:
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
		check_equal(data.read[CHANNEL_COLOR], before[CHANNEL_COLOR], "%s: the color map was not read" % kind)
		check(data.read[CHANNEL_HEIGHT] > before[CHANNEL_HEIGHT], "%s: the heights were read" % kind)
		scatter.free()
		node.free()
