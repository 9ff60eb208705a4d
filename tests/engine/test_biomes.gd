extends "biomes_harness.gd"
## Tests biomes: layers grow where the map allows them, and a change to the map regenerates only the affected tiles.

func test_layers_appear_in_their_biomes() -> void:
	var scatter := make_world(three_biomes(), [named("rock", 6.0)])
	await settle(scatter)
	var all := scatter.get_all_layers()
	check_equal(all.size(), 5, "layers")
	check_equal(all[0], scatter.layers[0], "the layers of the node come first")
	check_equal(all[2], scatter.biomes.biomes[1].layers[0], "layers of biomes come after them")
	var grass := places(scatter, "grass")
	check(grass.size() > 200 and all_within(grass, func(at: Vector2) -> bool: return at.x < 0 and at.y < 64), "grass")
	for tree in ["oak", "fern"]:
		var trees := places(scatter, tree)
		check(trees.size() > 50 and all_within(trees, func(at: Vector2) -> bool: return at.x >= 0 and at.y < 64), tree)
	var reed := places(scatter, "reed")
	check(reed.size() > 50 and all_within(reed, func(at: Vector2) -> bool: return at.y >= 64), "reed")
	var rocks := places(scatter, "rock")
	check(rocks.values().any(func(at: Vector2) -> bool: return at.x < 0), "rocks on the left")
	check(rocks.values().any(func(at: Vector2) -> bool: return at.y >= 64), "rocks in the swamp")
	check(scatter.get_problems().is_empty(), "no problems: %s" % scatter.get_problems())


func test_layers_of_biomes_are_accepted_everywhere() -> void:
	var scatter := make_world(three_biomes())
	await settle(scatter)
	var fern := scatter.biomes.biomes[1].layers[1]
	var found := scatter.query_rect(Rect2(0, 0, 30, 30), fern)
	check(found.size() > 10, "found: %d" % found.size())
	check_equal(found.layers, [fern], "all instances found are ferns")
	check_equal(content_of(scatter.query_rect(Rect2(0, 0, 30, 30), "fern")), content_of(found), "by name")
	check_equal(scatter.query_rect(Rect2(-40, 0, 30, 30), fern).size(), 0, "ferns in the meadow")
	check(scatter.remove_instance(found.ids[0]), "removed")
	check(not scatter.has_instance(found.ids[0]), "gone")
	check(scatter.add_instance("reed", Transform3D(Basis(), Vector3(5, 0, 5))) != 0, "planted")
	var clearing := ScatterRegion3D.new()
	clearing.shape = ScatterRegion3D.SHAPE_CYLINDER
	clearing.radius = 20.0
	clearing.ignore_height = true
	clearing.exclude = true
	clearing.layers = ["oak"]
	clearing.position = Vector3(20, 0, 20)
	scatter.add_child(clearing)
	await settle(scatter)
	check(all_within(places(scatter, "oak"), func(at: Vector2) -> bool: return at.distance_to(Vector2(20, 20)) >= 20), "a region excludes oaks")


func test_assigning_a_biome_replaces_its_layers() -> void:
	var scatter := make_world(three_biomes())
	await settle(scatter)
	var before := digests_by_name(scatter)
	var indices := [index_of(scatter, "grass"), index_of(scatter, "reed")]
	var burnt := make_biome(FOREST, [named("stump", 4.0), named("ash", 2.5), named("nettle", 3.5)])
	var visible_tiles := await shown_by(scatter, func() -> void: scatter.biomes.biomes[1] = burnt)
	check(not visible_tiles.has("grass") and not visible_tiles.has("reed"), "tiles of other biomes are not regenerated: %s" % [visible_tiles.keys()])
	var after := digests_by_name(scatter)
	check_equal([after["grass"], after["reed"]], [before["grass"], before["reed"]], "instances in the other biomes are unchanged")
	check_equal([index_of(scatter, "grass"), index_of(scatter, "reed")], indices, "indices of the other biomes' layers are unchanged")
	check(not after.has("oak") and not after.has("fern"), "the old layers are gone")
	for layer in ["stump", "ash", "nettle"]:
		var found := places(scatter, layer)
		check(found.size() > 50 and all_within(found, func(at: Vector2) -> bool: return at.x >= 0 and at.y < 64), layer)
	var new_scatter := make_world(scatter.biomes)
	await settle(new_scatter)
	check_equal(digests_by_name(new_scatter), after, "a new node with this map generates the same tiles")


func test_a_restored_biome_is_unchanged() -> void:
	var scatter := make_world(three_biomes())
	await settle(scatter)
	var before := digests_by_name(scatter)
	var forest := scatter.biomes.biomes[1]
	scatter.biomes.biomes[1] = make_biome(FOREST, [named("stump")])
	await settle(scatter)
	var ids := [forest.layers[0].layer_id, forest.layers[1].layer_id, scatter.biomes.biomes[1].layers[0].layer_id]
	check(ids[2] not in [ids[0], ids[1]], "a new layer has a new id: %s" % [ids])
	scatter.biomes.biomes[1] = forest
	await settle(scatter)
	check_equal(digests_by_name(scatter), before, "the tiles after the biome was restored")
	var map := scatter.biomes
	scatter.biomes = null
	await settle(scatter)
	check_equal(scatter.get_all_layers().size(), 0, "layers of a map without biomes")
	scatter.biomes = map
	await settle(scatter)
	check_equal(digests_by_name(scatter), before, "the tiles after the map was restored")


func test_a_pixel_changes_only_its_surroundings() -> void:
	var scatter := make_world(three_biomes())
	scatter.biomes.border_width = 4.0
	scatter.biomes.border_noise = 3.0
	await settle(scatter)
	var before := digests_by_name(scatter)
	var visible_tiles := await shown_by(scatter, func() -> void:
		scatter.biomes.map_image.fill_rect(Rect2i(40, 40, 2, 2), MEADOW) # Covers 32 to 40 m on both axes.
		scatter.biomes.map_image.emit_changed())
	var touched := Rect2(32, 32, 8, 8).grow(5.1)
	var after := digests_by_name(scatter)
	for layer: String in before:
		for tile: Vector2i in before[layer]:
			var rect := Rect2(32.0 * tile, Vector2(32, 32))
			if not rect.intersects(touched):
				check(not visible_tiles.get(layer, {}).has(tile), "%s %s stays" % [layer, tile])
				check_equal(after[layer][tile], before[layer][tile], "%s %s is unchanged" % [layer, tile])
	check(visible_tiles["grass"].has(Vector2i(1, 1)), "the tile with the pixel is regenerated")
	check(not visible_tiles.has("reed"), "the swamp is unaffected")
	check(places(scatter, "grass").values().any(func(at: Vector2) -> bool: return touched.has_point(at)), "grass in the forest")


func test_a_texture_as_map() -> void:
	var scatter := make_world(three_biomes())
	await settle(scatter)
	var before := digests_by_name(scatter)
	var texture := ImageTexture.create_from_image(scatter.biomes.map_image)
	scatter.biomes.map_image = null
	await settle(scatter)
	check("first biome is everywhere" in scatter.get_problems()[0], "get_problems reports the missing image: %s" % scatter.get_problems())
	check(places(scatter, "grass").values().any(func(at: Vector2) -> bool: return at.x > 0), "grass of the first biome also grows outside its area")
	check_equal(places(scatter, "oak").size(), 0, "oaks of the second biome")
	scatter.biomes.map_image = texture
	await settle(scatter)
	check_equal(digests_by_name(scatter), before, "tiles with a texture as the map")


func test_indices_as_map() -> void:
	var scatter := make_world(three_biomes())
	await settle(scatter)
	var before := digests_by_name(scatter)
	var image := Image.create_empty(PIXELS, PIXELS, false, Image.FORMAT_R8)
	image.fill_rect(Rect2i(32, 0, 32, PIXELS), Color8(1, 0, 0))
	image.fill_rect(Rect2i(0, 48, PIXELS, 16), Color8(2, 0, 0))
	scatter.biomes.map_mode = ScatterBiomeMap.MAP_MODE_INDICES
	scatter.biomes.map_image = image
	for biome in scatter.biomes.biomes:
		biome.color = Color.WHITE
	await settle(scatter)
	check_equal(digests_by_name(scatter), before, "tiles with a map of indices")
	image.fill_rect(Rect2i(0, 0, 32, PIXELS), Color8(200, 0, 0))
	image.emit_changed()
	await settle(scatter)
	check_equal(places(scatter, "grass").size(), 0, "grass where no biome has the pixel's index")
	check(scatter.biomes.get_biome_at(Vector2(-20, 0)) == null, "get_biome_at returns null there")


func test_border_noise() -> void:
	var scatter := make_world(three_biomes())
	scatter.biomes.border_noise = 10.0
	scatter.biomes.border_noise_size = 30.0
	await settle(scatter)
	var north := func(found: Dictionary[int, Vector2]) -> Array: return found.values().filter(
			func(at: Vector2) -> bool: return at.y < 54)
	var grass: Array = north.call(places(scatter, "grass"))
	var ferns: Array = north.call(places(scatter, "fern"))
	check(grass.any(func(at: Vector2) -> bool: return at.x > 2), "grass beyond the border")
	check(ferns.any(func(at: Vector2) -> bool: return at.x < -2), "ferns beyond the border")
	check(grass.all(func(at: Vector2) -> bool: return at.x < 10), "grass stays within the border noise")
	check(ferns.all(func(at: Vector2) -> bool: return at.x > -10), "ferns stay within the border noise")
	var mixed := 0
	for at: Vector2 in grass:
		mixed += int(scatter.biomes.get_biome_at(at) != scatter.biomes.biomes[0])
	check_equal(mixed, 0, "grass grows only where get_biome_at returns its biome")
	scatter.biomes.border_seed = 1
	await settle(scatter)
	check(north.call(places(scatter, "grass")) != grass, "a new seed moves the border")


func test_border_width_blends_biomes() -> void:
	var scatter := make_world(three_biomes())
	scatter.biomes.border_width = 40.0
	await settle(scatter)
	var weights := scatter.biomes.get_weights_at(Vector2(-9.8, 0))
	check_equal(weights.size(), 3, "a weight for each biome")
	check(absf(weights[0] - 0.75) < 0.07 and absf(weights[0] + weights[1] - 1.0) < 1e-6, "weights: %s" % weights)
	var counts := [0, 0, 0]
	for at: Vector2 in places(scatter, "grass").values():
		if absf(at.x) < 30 and absf(at.y) < 40:
			counts[int((at.x + 30) / 20)] += 1
	check(counts[0] > 1.5 * counts[1] and counts[1] > 1.2 * counts[2] and counts[2] > 0, "grass thins out across the border: %s" % [counts])


func test_results_do_not_depend_on_tiles() -> void:
	var scatter := make_world(three_biomes())
	scatter.biomes.border_width = 12.0
	scatter.biomes.border_noise = 9.0
	await settle(scatter)
	for layer in ["grass", "fern", "reed"]:
		var whole := places_in(scatter, layer, EXTENT)
		var parts: Dictionary[int, Vector2] = {}
		for x in range(-128, 128, 64):
			for y in range(-128, 128, 16):
				parts.merge(places_in(scatter, layer, Rect2(x, y, 64, 16)))
		check(whole.size() > 100, "%s: %d" % [layer, whole.size()])
		var ids := whole.keys()
		ids.sort()
		var of_parts := parts.keys()
		of_parts.sort()
		check_equal(of_parts, ids, layer + " in strips")


func test_queries_beyond_the_visible_area_respect_biomes() -> void:
	var map := three_biomes()
	map.map_edge = ScatterBiomeMap.MAP_EDGE_CLAMP
	var scatter := make_world(map)
	await settle(scatter)
	var far := Rect2(2000, -900, 60, 60)
	check_equal(scatter.query_rect(far, "grass").size(), 0, "no meadow on this side")
	var found := scatter.query_rect(far, "fern")
	check_equal(found.size(), places_in(scatter, "fern", far).size(), "ferns found beyond the visible area")
	check(found.size() > 100, "ferns: %d" % found.size())
	map.map_edge = ScatterBiomeMap.MAP_EDGE_NOTHING
	check_equal(scatter.query_rect(far, "fern").size(), 0, "ferns beyond the map")


func test_spacing_across_biomes() -> void:
	var map := three_biomes()
	map.border_width = 20.0
	var scatter := make_world(map)
	map.biomes[1].layers[0].spacing = {"grass": 4.0}
	await settle(scatter)
	var grass := places(scatter, "grass").values()
	var near := 0
	for at: Vector2 in places(scatter, "oak").values():
		near += int(grass.any(func(other: Vector2) -> bool: return other.distance_to(at) < 4.0 - 1e-3))
	check_equal(near, 0, "oaks that are too close to grass")
	check(scatter.get_problems().is_empty(), "no problems: %s" % scatter.get_problems())


func test_one_layer_in_several_biomes() -> void:
	var shared := named("shared")
	var map := make_map([make_biome(MEADOW, [shared]), make_biome(FOREST, [shared, named("oak", 5.0)])])
	map.border_width = 10.0
	var alone := make_world(null, [shared])
	await settle(alone)
	var everywhere := places_in(alone, "shared", Rect2(-50, -50, 100, 100))
	var scatter := make_world(map)
	await settle(scatter)
	check_equal(scatter.get_all_layers().size(), 2, "one layer, once")
	check_equal(places_in(scatter, "shared", Rect2(-50, -50, 100, 100)), everywhere, "positions of a layer that is in both biomes")
	map.biomes[1].density = 0.5
	await settle(scatter)
	var right := places_in(scatter, "shared", Rect2(20, -50, 30, 100)).size()
	var left := places_in(scatter, "shared", Rect2(-50, -50, 30, 100)).size()
	check(right < 0.7 * left and right > 0.3 * left, "the biome with a lower density has fewer instances: %d and %d" % [right, left])
	scatter.layers = [shared]
	await settle(scatter)
	check("is also in a biome" in str(scatter.get_problems()), "get_problems reports the layer: %s" % scatter.get_problems())
	check_equal(places_in(scatter, "shared", Rect2(-50, -50, 100, 100)), everywhere, "a layer of the node is not limited to biomes")


func test_lists_changed_in_place() -> void:
	var scatter := make_world(three_biomes(), [named("rock")])
	await settle(scatter)
	var swamp := scatter.biomes.biomes[2]
	swamp.layers.push_back(named("lily"))
	await settle(scatter)
	check(all_within(places(scatter, "lily"), func(at: Vector2) -> bool: return at.y >= 64), "lilies grow only in the swamp")
	var lily := swamp.layers.pop_back() as ScatterLayer
	scatter.biomes.biomes[0].layers.push_back(lily)
	await settle(scatter)
	check(all_within(places(scatter, "lily"), func(at: Vector2) -> bool: return at.x < 0 and at.y < 64), "lilies grow only in the meadow")
	scatter.layers.push_back(named("boulder"))
	await settle(scatter)
	check_equal(index_of(scatter, "boulder"), 1, "layers of the node come before layers of biomes")
	check(places(scatter, "grass").size() > 100 and places(scatter, "lily").size() > 20, "the other layers keep their instances")
	scatter.biomes.biomes.push_back(null)
	scatter.biomes.biomes.remove_at(0)
	await settle(scatter)
	check_equal([index_of(scatter, "grass"), index_of(scatter, "lily")], [-1, -1], "layers disappear with their biome")
	check(places(scatter, "reed").size() > 20, "the swamp keeps its reeds")


func test_bad_input_has_no_effect() -> void:
	var scatter := make_world(three_biomes())
	await settle(scatter)
	var before := digests_by_name(scatter)
	var map := scatter.biomes
	for bad: Array in [["border_width", -1.0], ["border_width", NAN], ["border_noise", 1e5], ["border_noise_size", 0.5],
			["map_mode", 2], ["map_edge", -1], ["map_rect", Rect2(0, 0, 0, 10)], ["map_rect", Rect2(NAN, 0, 1, 1)]]:
		var old: Variant = map.get(bad[0])
		map.set(bad[0], bad[1])
		check_error(["ScatterBiomeMap." + bad[0]], str(bad))
		check_equal(map.get(bad[0]), old, str(bad))
	map.map_image = BoxMesh.new()
	check_error(["ScatterBiomeMap.map_image"], "no image")
	var many: Array[ScatterBiome] = []
	many.resize(33)
	map.biomes = many
	check_error(["ScatterBiomeMap", "biomes", 33], "too many biomes")
	for bad: Array in [["density", 1.5], ["density", NAN], ["water_mode", 3], ["water_level", INF], ["color", Color(2, 0, 0)]]:
		map.biomes[0].set(bad[0], bad[1])
		check_error(["ScatterBiome." + bad[0]], str(bad))
	await settle(scatter)
	var wide := Image.create_empty(8193, 1, false, Image.FORMAT_R8)
	map.map_image = wide
	await settle(scatter)
	check_error(["ScatterBiomeMap", "map_image", 8193], "an image that is too large")
	check_equal(digests_by_name(scatter), before, "tiles after the invalid input")
	check("8193" in str(scatter.get_problems()), "a problem: %s" % scatter.get_problems())
	map.biomes[1].color = MEADOW
	map.map_image = make_image()
	await settle(scatter)
	check("same color" in str(scatter.get_problems()), "a problem: %s" % scatter.get_problems())


func test_scenes_with_biomes_are_small_and_save_identically() -> void:
	var map := three_biomes()
	check_equal(ResourceSaver.save(map.map_image, "user://biomes.res"), OK, "the image is saved")
	map.map_image.take_over_path("user://biomes.res")
	var scatter := make_world(map)
	scatter.water_enabled = true
	scatter.water_level = -3.0
	await settle(scatter)
	scatter.viewers = []
	var before := places_in(scatter, "fern", Rect2(0, 0, 60, 60))
	scatter.name = "Scatter"
	var id_of_file := RegEx.create_from_string("1_[a-z0-9]{5}") # The engine generates new IDs on each save.
	var files: PackedStringArray = []
	for round in 2:
		var scene := PackedScene.new()
		scene.pack(scatter)
		check_equal(ResourceSaver.save(scene, "user://biomes.tscn"), OK, "saved")
		files.push_back(id_of_file.sub(FileAccess.get_file_as_string("user://biomes.tscn"), "1", true))
		var loaded: PackedScene = ResourceLoader.load("user://biomes.tscn", "", ResourceLoader.CACHE_MODE_IGNORE)
		scatter.free()
		scatter = loaded.instantiate()
		root.add_child(scatter)
	check(files[0] == files[1], "both saves have the same bytes")
	check(files[0].length() < 6000, "small: %d characters" % files[0].length())
	check_equal(places_in(scatter, "fern", Rect2(0, 0, 60, 60)), before, "ferns after loading")


func test_handlers_may_free_the_node() -> void:
	var scatter := make_world(three_biomes())
	await settle(scatter)
	var map := scatter.biomes
	map.changed.connect(func() -> void:
		scatter.free(), CONNECT_ONE_SHOT)
	map.biomes[1] = null
	await frames(3)
	check(not is_instance_valid(scatter) or was_kept_from_being_freed(), "the signal handler has freed the node")
	var other := make_world(map)
	check(other.query_rect(Rect2(-30, -30, 20, 20), "grass").size() > 0, "the map still works")


func test_a_map_that_two_nodes_share() -> void:
	var map := three_biomes()
	map.border_noise = 8.0
	var first := make_world(map)
	var second := make_world(map)
	second.seed = 99
	await settle(first)
	await settle(second)
	map.biomes[2] = make_biome(SWAMP, [named("lily")])
	await settle(first)
	await settle(second)
	for scatter: TerrainScatter3D in [first, second]:
		var lilies := places(scatter, "lily")
		check(lilies.size() > 30, "lilies")
		check(all_within(lilies, func(at: Vector2) -> bool: return map.get_biome_at(at) == map.biomes[2]), "lilies in their biome only")


## The map reads a painted image again only when the image emits `changed`, not after other changes.
func test_an_image_is_read_when_it_emits_changed() -> void:
	var scatter := make_world(three_biomes())
	await settle(scatter)
	var map := scatter.biomes
	var before := map.get_biome_at(Vector2(36.0, 36.0))
	map.map_image.fill_rect(Rect2i(0, 0, 100, 100), MEADOW)
	map.border_width = 3.0
	check_equal(map.get_biome_at(Vector2(36.0, 36.0)), before, "the biome before the image emits changed")
	map.map_image.emit_changed()
	check(map.get_biome_at(Vector2(36.0, 36.0)) != before, "the biome changes once the image has emitted changed")
