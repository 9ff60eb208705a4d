extends "terrain_likes_harness.gd"
## Tests ground from nodes that resemble Terrain3D or HTerrain, which the library queries point by point.

func check_terrain3d_like(scatter: TerrainScatter3D, node: Terrain3DLike, context: String) -> void:
	var stand := all_transforms(scatter)
	var wrong := 0
	for one in stand:
		var height := node.data.get_height(one.origin)
		wrong += int(is_nan(height) or absf(height - one.origin.y) > 0.01)
	check(stand.size() > 1000, "%s: %d instances" % [context, stand.size()])
	check_equal(wrong, 0, context + ": instances off the ground or in a hole")


func test_terrain3d_like() -> void:
	var node := Terrain3DLike.new()
	var slow := make_on(node)
	var fast := make_on(node, true)
	await settle(slow)
	await settle(fast)
	check_terrain3d_like(slow, node, "on the main thread")
	check_equal(digests(slow, 0), digests(fast, 0), "the instances are the same on workers")
	var terrain: ScatterGroundNode = slow.ground
	check(is_nan(terrain.get_height(Vector3(3.0, 0.0, 3.0))), "a hole has no height")
	check(absf(terrain.get_height(Vector3(20.0, 0.0, 0.0)) - 4.0) < 1e-5, "height")
	var normal := Vector3(-0.2, 1.0, -0.3).normalized()
	check(terrain.get_normal(Vector3(20.0, 5.0, 0.0)).distance_to(normal) < 1e-5, "normal")
	var rects: Array[Rect2] = []
	terrain.ground_changed.connect(func(rect: Rect2) -> void: rects.push_back(rect))
	node.data.maps_edited.emit(AABB(Vector3(1.0, -5.0, 2.0), Vector3(3.0, 50.0, 4.0)))
	check_equal(rects, [Rect2(1.0, 2.0, 3.0, 4.0)] as Array[Rect2], "the edited area")


func test_edits_of_sparse_terrain3d_like() -> void:
	var node := SparseTerrain3DLike.new()
	var scatter := make_on(node)
	await settle(scatter)
	var rects: Array[Rect2] = []
	scatter.ground.ground_changed.connect(func(rect: Rect2) -> void: rects.push_back(rect))
	node.data.maps_edited.emit(AABB(Vector3(1.0, -5.0, 2.0), Vector3(3.0, 50.0, 4.0)))
	check_equal(rects, [Rect2(-7.0, -6.0, 19.0, 20.0)] as Array[Rect2], "the edited area and two samples around it")
	var count := digests(scatter, 0).size()
	node.data.lift = 3.0
	var regenerated_tiles := await regenerated_by(scatter, func() -> void: node.data.maps_changed.emit())
	check_equal(regenerated_tiles.size(), count, "a change without an area regenerates everything")


func test_textures_of_terrain3d_like() -> void:
	var counts: Array[int] = []
	for textures: Array in [[3], [0], [0, 3], [9]]:
		var node := Terrain3DLike.new()
		var layer := make_layer()
		layer.ground_textures = PackedInt32Array(textures)
		var scatter := make_on(node, true, layer)
		await settle(scatter)
		var stand := all_transforms(scatter)
		counts.push_back(stand.size())
		if textures == [0]:
			check(stand.all(func(one: Transform3D) -> bool: return one.origin.x < 0.0), "texture 0 covers only the left half")
		node.free()
		scatter.free()
		errors.take()
	check_equal(counts[3], 0, "instances on a texture that does not occur")
	check(counts[2] > counts[0] and counts[0] > counts[1] and counts[1] > 100, "instances by texture: %s" % [counts])
	# The overlay has a weight of 0.25 on the left and of 1 on the right. The density must match it.
	check(absf(counts[0] - (0.25 * 0.5 + 0.5) * counts[2]) < 0.06 * counts[2], "a quarter of the instances remain on the left: %s" % [counts])


func test_hterrain_like() -> void:
	var node := HTerrainLike.new()
	node.position = Vector3(10.0, -4.0, 6.0)
	node.rotation.y = 0.5
	var slow := make_on(node)
	var fast := make_on(node, true)
	await settle(slow)
	await settle(fast)
	check_equal(digests(slow, 0), digests(fast, 0), "the instances are the same on workers")
	var to_map := node.get_internal_transform().affine_inverse()
	var stand := all_transforms(slow)
	var wrong := 0
	for one in stand:
		var on_map := to_map * one.origin
		var inside := on_map.x >= -0.01 and on_map.x <= 64.01 and on_map.z >= -0.01 and on_map.z <= 64.01
		wrong += int(not inside or absf(on_map.y - 0.5 * on_map.x) > 0.01)
	check(stand.size() > 500, "instances: %d" % stand.size())
	check_equal(wrong, 0, "instances off the map or off the ground")
	var terrain: ScatterGroundNode = slow.ground
	check(is_nan(terrain.get_height(Vector3(200.0, 0.0, 0.0))), "there is no ground outside of the map")
	var along := node.global_basis.x
	var steep := Vector3(along.x * 0.75, -1.0, along.z * 0.75).normalized()
	check(terrain.get_normal(node.position).distance_to(-steep) < 1e-3, "normal")
	var rects: Array[Rect2] = []
	terrain.ground_changed.connect(func(rect: Rect2) -> void: rects.push_back(rect))
	node.get_data().region_changed.emit(32, 32, 4, 4, 0)
	if check_equal(rects.size(), 1, "an edit"):
		for corner: Vector3 in [Vector3(32, 0, 32), Vector3(36, 0, 32), Vector3(32, 0, 36), Vector3(36, 0, 36)]:
			var world := node.get_internal_transform() * corner
			check(rects[0].has_point(Vector2(world.x, world.z)), "%s is in the edited area" % corner)
		check(rects[0].size.x < 30.0, "the edited area is small: %s" % rects[0])
	node.position.y = 50.0
	node.transform_changed.emit(node.get_internal_transform())
	await settle(slow)
	check(all_transforms(slow)[0].origin.y > stand[0].origin.y + 40.0, "the ground moves with the node")


func test_later_hterrain_like() -> void:
	var node := HTerrainLike.new()
	node._data = LaterHTerrainLikeData.new()
	var scatter := make_on(node)
	await settle(scatter)
	var rects: Array[Rect2] = []
	scatter.ground.ground_changed.connect(func(rect: Rect2) -> void: rects.push_back(rect))
	node._data.region_changed.emit(Rect2i(32, 32, 4, 4), 0, 0)
	if check_equal(rects.size(), 1, "an edit"):
		var world := node.get_internal_transform() * Vector3(34, 0, 34)
		check(rects[0].has_point(Vector2(world.x, world.z)), "%s is in %s" % [world, rects[0]])
		check(rects[0].size.x > 8.0 and rects[0].size.x < 30.0, "the edited area is small: %s" % rects[0])


func test_a_node_with_new_data_is_read_again() -> void:
	for how: String in ["regenerate", "ground_changed"]:
		var node := HTerrainLike.new()
		var scatter := make_on(node)
		await settle(scatter)
		var before := all_transforms(scatter)
		node._data = LaterHTerrainLikeData.new()
		if how == "regenerate":
			scatter.regenerate()
		else:
			scatter.ground.ground_changed.emit(Rect2())
		await settle(scatter)
		var after := all_transforms(scatter)
		var higher := after[0].origin.y - before[0].origin.y
		check(after.size() == before.size() and absf(higher - 7.0 * node.map_scale.y) < 0.01, "%s: %f m higher" % [how, higher])
		scatter.free()
		node.free()


func test_holes_and_textures_of_hterrain_like() -> void:
	var node := HTerrainLike.new()
	var size := HTerrainLikeData.SIZE
	var colors := Image.create_empty(size, size, false, Image.FORMAT_RGBA8)
	colors.fill(Color.WHITE)
	colors.fill_rect(Rect2i(20, 0, 10, size), Color(1.0, 1.0, 1.0, 0.0))
	var splats: Array[Image] = []
	for index in 2:
		splats.push_back(Image.create_empty(size, size, false, Image.FORMAT_RGBA8))
		splats[index].fill(Color(0.0, 0.0, 0.0, 0.0))
	splats[0].fill_rect(Rect2i(0, 0, size, 33), Color(0.0, 1.0, 0.0, 0.0))
	splats[1].fill_rect(Rect2i(0, 33, size, 32), Color(0.0, 0.0, 0.0, 1.0))
	node.get_data().maps = {HTerrainLikeData.CHANNEL_COLOR: [colors], HTerrainLikeData.CHANNEL_SPLAT: splats}
	var counts := {}
	for textures: Array in [[], [1], [7], [1, 7], [0, 2, 3, 4, 5, 6, 8]]:
		var layer := make_layer()
		layer.ground_textures = PackedInt32Array(textures)
		var scatter := make_on(node, false, layer)
		await settle(scatter)
		var stand := all_transforms(scatter)
		counts[textures] = stand.size()
		var in_hole := stand.filter(func(one: Transform3D) -> bool: return one.origin.x > -23.5 and one.origin.x < -5.5)
		check_equal(in_hole.size(), 0, "instances in the hole")
		if textures == [1]:
			check(stand.all(func(one: Transform3D) -> bool: return one.origin.z < 2.0), "texture 1 covers only the front half")
		scatter.free()
	check(counts[[]] > 500, "instances: %d" % counts[[]])
	check_equal(counts[[1, 7]], counts[[]], "both textures cover everything")
	check(counts[[1]] > 100 and counts[[7]] > 100, "each texture covers about half: %s" % counts)
	check_equal(counts[[0, 2, 3, 4, 5, 6, 8]], 0, "textures that do not occur")
	var on := make_on(node)
	await settle(on)
	var before := all_transforms(on).size()
	colors.fill(Color.WHITE)
	node.get_data().region_changed.emit(20, 0, 10, size, HTerrainLikeData.CHANNEL_COLOR)
	on.regenerate()
	await settle(on)
	check(all_transforms(on).size() > before, "the hole is filled")
