extends "hterrain_harness.gd"
## Tests HTerrain's ground: the library copies its heights, holes and textures instead of querying single positions.

func test_heights() -> void:
	for format: Image.Format in [Image.FORMAT_RF, Image.FORMAT_RH, Image.FORMAT_RGB8]:
		for scaled: Vector3 in [Vector3.ONE, Vector3(2.0, 0.5, 3.5)]:
			var node := make_hterrain(HTerrainMasterData.new(format))
			node.map_scale = scaled
			node.position = Vector3(14.0, -3.0, 22.0)
			node.rotation.y = 0.7
			node.centered = scaled == Vector3.ONE
			var scatter := make_on(node)
			var random := RandomNumberGenerator.new()
			random.seed = 3
			var wrong := 0
			var hits := 0
			for i in 1500:
				var at := node.get_internal_transform() * Vector3(random.randf_range(-3.0, 67.0), 0.0, random.randf_range(-3.0, 67.0))
				var expected := node.ground_at(at)
				var height := scatter.ground.get_height(at)
				wrong += int(is_nan(height) != is_nan(expected) or absf(height - expected) > 1e-3)
				hits += int(not is_nan(height))
			check_equal(wrong, 0, "format %d, scale %s: heights that differ" % [format, scaled])
			check(hits > 800, "%d positions on the map" % hits)
			scatter.free()
			node.free()


func test_normals() -> void:
	var node := make_hterrain()
	node.get_data().fill(func(column: int, _row: int) -> float: return 0.5 * column)
	node.map_scale = Vector3(2.0, 3.0, 2.0)
	node.rotation.y = 0.5
	var scatter := make_on(node)
	var along := node.global_basis.x
	var expected := Vector3(-0.75 * along.x, 1.0, -0.75 * along.z).normalized()
	for at: Vector3 in [Vector3.ZERO, Vector3(31.3, 0.0, -12.8), Vector3(-40.0, 0.0, 3.0)]:
		check(scatter.ground.get_normal(at).distance_to(expected) < 1e-4, "normal at %s" % at)


func test_the_copy_makes_no_calls_for_single_positions() -> void:
	for data: HTerrainDataDouble in [HTerrain18Data.new(), HTerrainMasterData.new()]:
		var node := make_hterrain(data)
		var scatter := make_on(node)
		await settle(scatter)
		check_ground(scatter, node, "copied")
		check_equal(node.get_data().point_calls, 0, "calls for single positions")
		var terrain: ScatterGroundNode = scatter.ground
		for word: String in ["HTerrain", "65 x 65", "no textures"]:
			check(word in terrain.recognized, "expected '%s' in '%s'" % [word, terrain.recognized])
		check_equal(scatter.get_problems().size(), 0, "no problems: %s" % [scatter.get_problems()])
		scatter.free()
		node.free()


func count_on(node: HTerrainDouble, textures: Array) -> Array[Transform3D]:
	var layer := make_layer()
	layer.ground_textures = PackedInt32Array(textures)
	var scatter := make_on(node, false, layer)
	await settle(scatter)
	var stand := all_transforms(scatter)
	scatter.free()
	return stand


func test_holes() -> void:
	var node := make_hterrain()
	var colors := node.get_data().add_map(CHANNEL_COLOR, Image.FORMAT_RGBA8, Color.WHITE)
	var all := (await count_on(node, [])).size()
	colors.fill_rect(Rect2i(20, 0, 10, 65), Color(1.0, 1.0, 1.0, 0.0))
	var stand := await count_on(node, [])
	var in_hole := stand.filter(func(one: Transform3D) -> bool: return one.origin.x > -24.9 and one.origin.x < -5.1)
	check_equal(in_hole.size(), 0, "instances in the hole")
	check(stand.size() > 0.7 * all and stand.size() < 0.95 * all, "%d of %d remain" % [stand.size(), all])


func test_textures_of_splat_maps() -> void:
	var node := make_hterrain()
	var first := node.get_data().add_map(CHANNEL_SPLAT, Image.FORMAT_RGBA8, Color(0.0, 0.0, 0.0, 0.0))
	var second := node.get_data().add_map(CHANNEL_SPLAT, Image.FORMAT_RGBA8, Color(0.0, 0.0, 0.0, 0.0))
	first.fill_rect(Rect2i(0, 0, 65, 33), Color(0.0, 1.0, 0.0, 0.0))
	second.fill_rect(Rect2i(0, 33, 65, 32), Color(0.0, 0.0, 0.0, 1.0))
	var all := (await count_on(node, [])).size()
	var near := await count_on(node, [1])
	check(near.size() > 100 and near.all(func(one: Transform3D) -> bool: return one.origin.z < 2.1), "texture 1 covers only the front half")
	check((await count_on(node, [7])).size() > 100, "texture 7 has instances")
	check_equal((await count_on(node, [1, 7])).size(), all, "textures 1 and 7 together cover everything")
	check_equal((await count_on(node, [0, 2, 3, 4, 5, 6, 8])).size(), 0, "textures that do not occur")


func test_textures_by_index() -> void:
	var node := make_hterrain()
	node.get_data().add_map(CHANNEL_SPLAT, Image.FORMAT_RGBA8, Color(1.0, 0.0, 0.0, 0.0)) # HTerrain always has this map. The library must ignore it.
	node.shader_type = "Array"
	root.add_child(node)
	var scatter := make_on(node)
	scatter.layers[0].ground_textures = PackedInt32Array([12])
	await settle(scatter)
	check("ground_textures has no effect" in "\n".join(scatter.get_problems()), "a problem is reported without an index map: %s" % [scatter.get_problems()])
	scatter.free()
	var indices := node.get_data().add_map(CHANNEL_SPLAT_INDEX, Image.FORMAT_RGB8, Color8(12, 5, 40))
	indices.fill_rect(Rect2i(0, 0, 33, 65), Color8(3, 3, 3))
	node.get_data().add_map(CHANNEL_SPLAT_WEIGHT, Image.FORMAT_RG8, Color8(51, 102, 0))
	var all := (await count_on(node, [])).size()
	check_equal((await count_on(node, [0, 1, 2])).size(), 0, "textures that do not occur")
	var left := await count_on(node, [3])
	check(left.all(func(one: Transform3D) -> bool: return one.origin.x < 2.1), "texture 3 covers only the left half")
	check(absf(left.size() - 0.5 * all) < 0.08 * all, "it covers half of the ground: %d of %d" % [left.size(), all])
	var some := (await count_on(node, [12])).size()
	check(absf(some - 0.1 * all) < 0.03 * all, "a fifth of the rest: %d of %d" % [some, all])
	check_equal((await count_on(node, [3, 5, 12, 40])).size(), all, "all textures together cover everything")


## In a game, HTerrain keeps an image of the heights only, and textures of all other maps.
func test_maps_that_a_game_has_loaded() -> void:
	var data := HTerrain18Data.new()
	data.add_map(CHANNEL_COLOR, Image.FORMAT_RGBA8, Color.WHITE).fill_rect(Rect2i(20, 0, 10, 65), Color(1.0, 1.0, 1.0, 0.0))
	data.add_map(CHANNEL_SPLAT, Image.FORMAT_RGBA8, Color(1.0, 0.0, 0.0, 0.0)).fill_rect(Rect2i(0, 0, 65, 33), Color(0.0, 1.0, 0.0, 0.0))
	data.add_map(CHANNEL_SPLAT_INDEX, Image.FORMAT_RGB8, Color8(12, 5, 40)).fill_rect(Rect2i(0, 0, 33, 65), Color8(3, 3, 3))
	data.add_map(CHANNEL_SPLAT_WEIGHT, Image.FORMAT_RGB8, Color8(255, 0, 0)) # PNG files store this two-channel map as RGB8.
	var node := make_hterrain(data)
	var expected: Array[Dictionary] = []
	for loaded: bool in [false, true]:
		if loaded:
			data.become_loaded()
			check(data.get_image(CHANNEL_COLOR) == null and data.get_image(CHANNEL_HEIGHT) != null, "only the heights are stored as an image")
		for case: Array in [["Classic4", []], ["Classic4", [1]], ["Array", [3]], ["Array", [12]]]:
			node.shader_type = case[0]
			var layer := make_layer()
			layer.layer_id = 4
			layer.ground_textures = PackedInt32Array(case[1])
			var scatter := make_on(node, false, layer)
			await settle(scatter)
			check_equal(scatter.get_problems().size(), 0, "%s: no problems: %s" % [case, scatter.get_problems()])
			var found := by_id(scatter)
			check(found.size() > 100, "%s: %d instances" % [case, found.size()])
			if loaded:
				check_equal(found, expected.pop_front(), "%s: the count is the same as with images" % [case])
			else:
				expected.push_back(found)
			scatter.free()


func test_textures_are_read_only_once() -> void:
	var data := HTerrainMasterData.new()
	data.add_map(CHANNEL_COLOR, Image.FORMAT_RGBA8, Color.WHITE).fill_rect(Rect2i(20, 0, 10, 65), Color(1.0, 1.0, 1.0, 0.0))
	data.become_loaded()
	var node := make_hterrain(data)
	var scatter := make_on(node)
	await settle(scatter)
	var count_in_hole := func() -> int:
		var left := node.get_internal_transform()
		return all_transforms(scatter).filter(func(one: Transform3D) -> bool:
			var column := (left.affine_inverse() * one.origin).x
			return column > 19.6 and column < 29.4).size()
	check_equal(count_in_hole.call(), 0, "instances in the hole")
	for step in 3:
		node.position.x += 10.0
		await frames(2)
		await settle(scatter)
		check_ground(scatter, node, "moved %d times" % step)
		check_equal(count_in_hole.call(), 0, "moved %d times: instances in the hole" % step)
	var closed := Image.create_empty(65, 65, false, Image.FORMAT_RGBA8)
	closed.fill(Color.WHITE)
	data.textures[CHANNEL_COLOR] = [HTerrainDataDouble.imported(closed)] # Replaces the texture as HTerrainData.reload() does.
	data.map_changed.emit(CHANNEL_COLOR, 0)
	await settle(scatter)
	check(count_in_hole.call() > 50, "the closed hole has instances")


func test_maps_without_pixels_are_reported() -> void:
	var data := HTerrainMasterData.new()
	data.add_map(CHANNEL_COLOR, Image.FORMAT_RGBA8, Color.WHITE)
	data.become_loaded()
	var texture: Texture2D = data.textures[CHANNEL_COLOR][0]
	data.textures[CHANNEL_COLOR] = [PlaceholderTexture2D.new()] # Dedicated server exports contain such placeholders.
	var node := make_hterrain(data)
	var scatter := make_on(node)
	await settle(scatter)
	check("without pixels" in "\n".join(scatter.get_problems()), "reported: %s" % [scatter.get_problems()])
	check_ground(scatter, node, "without holes")
	data.textures[CHANNEL_COLOR] = [texture]
	data.map_changed.emit(CHANNEL_COLOR, 0)
	await settle(scatter)
	check_equal(scatter.get_problems().size(), 0, "no problems: %s" % [scatter.get_problems()])


func test_errors_name_invalid_maps() -> void:
	var wrong: Dictionary[String, Callable] = {
		"format other than": func(data: HTerrainDataDouble) -> void:
			data.maps[CHANNEL_HEIGHT][0] = Image.create_empty(65, 65, false, Image.FORMAT_RGBAF),
		"33 x 33 pixels": func(data: HTerrainDataDouble) -> void:
			data.maps[CHANNEL_HEIGHT][0] = Image.create_empty(33, 33, false, Image.FORMAT_RF),
		"color map": func(data: HTerrainDataDouble) -> void:
			data.maps[CHANNEL_COLOR] = [Image.create_empty(33, 33, false, Image.FORMAT_RGBA8)],
	}
	for words: String in wrong:
		var node := make_hterrain()
		wrong[words].call(node.get_data())
		var scatter := make_on(node)
		await frames(3)
		var problems := "\n".join(scatter.get_problems())
		check(words in problems and "position by position" in problems, "%s: %s" % [words, problems])
		node.get_data().maps = HTerrainMasterData.new().maps
		node.get_data().fill()
		scatter.regenerate()
		await settle(scatter)
		check_equal(scatter.get_problems().size(), 0, "valid again: %s" % [scatter.get_problems()])
		check_ground(scatter, node, "valid again")
		scatter.free()
		node.free()
		errors.take()


func test_a_tilted_node_is_reported() -> void:
	var node := make_hterrain()
	node.rotation = Vector3(0.3, 0.5, 0.0)
	var scatter := make_on(node)
	await settle(scatter)
	check("tilted" in "\n".join(scatter.get_problems()), "reported: %s" % [scatter.get_problems()])
	node.rotation = Vector3(0.0, 0.5, 0.0)
	await settle(scatter)
	check_equal(scatter.get_problems().size(), 0, "upright: %s" % [scatter.get_problems()])


func test_layers_grow_on_its_surface() -> void:
	var node := make_hterrain()
	node.rotation.y = 0.5
	var layer := make_layer()
	layer.on_surfaces = true
	var scatter := make_on(node, false, layer)
	await settle(scatter)
	check_equal(scatter.get_problems().size(), 0, "problems: %s" % scatter.get_problems())
	var standing := all_transforms(scatter)
	check(standing.size() > 1500, "%d instances" % standing.size())
	for at in standing:
		var height := scatter.ground.get_height(at.origin)
		if not check(is_nan(height) or absf(height - at.origin.y) < 0.5, "an instance at %s, the ground at %f" % [at.origin, height]):
			break
