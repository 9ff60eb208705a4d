extends "biomes_harness.gd"
## Tests water: layers have a range of water depths, and the node or a biome sets the water level.

## Returns a ground that rises from -12.8 m on the left to 12.8 m on the right, 1 m in 10 m.
func slope() -> ScatterGround:
	var image := Image.create_empty(2, 2, false, Image.FORMAT_RF)
	image.fill_rect(Rect2i(1, 0, 1, 2), Color(1, 0, 0))
	var terrain := ScatterGroundHeightmap.new()
	terrain.image = image
	terrain.rect = EXTENT
	terrain.min_height = -12.8
	terrain.max_height = 12.8
	return terrain


func make_shore() -> TerrainScatter3D:
	var reeds := named("reeds", 2.0)
	reeds.min_water_depth = -0.5
	reeds.max_water_depth = 1.0
	var lilies := named("lilies", 2.0)
	lilies.min_water_depth = 0.5
	lilies.max_water_depth = 2.0
	var kelp := named("kelp", 2.0)
	kelp.min_water_depth = 3.0
	kelp.max_water_depth = 1e6
	return make_scatter([named("grass", 2.0), reeds, lilies, kelp], slope(), make_viewer())


## Returns the lowest and the highest ground height, as x and y, of a layer's instances.
func heights(scatter: TerrainScatter3D, layer: String) -> Vector2:
	var range := Vector2(INF, -INF)
	for at: Vector2 in places_in(scatter, layer, Rect2(-100, -60, 200, 120)).values():
		range = Vector2(minf(range.x, at.x / 10), maxf(range.y, at.x / 10))
	return range


func check_heights(scatter: TerrainScatter3D, layer: String, least: float, greatest: float) -> void:
	var found := heights(scatter, layer)
	check(found.x >= least - 1e-3 and found.y <= greatest + 1e-3, "%s must be within %s to %s m, got %s" % [layer, least, greatest, found])
	check(found.x < least + 0.3 and found.y > greatest - 0.3, "%s must cover the whole range of %s to %s m, got %s" % [layer, least, greatest, found])


func test_without_water_nothing_changes() -> void:
	var scatter := make_shore()
	await settle(scatter)
	check_equal(scatter.water_enabled, false, "no water by default")
	var everywhere := places_in(scatter, "grass", EXTENT)
	check(everywhere.values().any(func(at: Vector2) -> bool: return at.x < -100), "without water, grass grows at any height")
	for layer in ["reeds", "lilies", "kelp"]:
		check_equal(places_in(scatter, layer, EXTENT).size(), 0, layer + " need water to grow")
	check_equal(scatter.get_problems().size(), 3, "a problem for each layer that needs water: %s" % scatter.get_problems())
	check("water_enabled" in scatter.get_problems()[0], scatter.get_problems()[0])
	scatter.water_enabled = true
	scatter.water_level = -12.8
	check_equal(places_in(scatter, "grass", EXTENT), everywhere, "grass above the water is unchanged")
	check(scatter.get_problems().is_empty(), "no problems: %s" % scatter.get_problems())


func test_layers_stay_within_their_depth_when_the_level_changes() -> void:
	var scatter := make_shore()
	scatter.water_enabled = true
	for level: float in [0.0, 2.0, -4.0]:
		scatter.water_level = level
		await settle(scatter)
		check_heights(scatter, "grass", level, 10.0)
		check_heights(scatter, "reeds", level - 1.0, level + 0.5)
		check_heights(scatter, "lilies", level - 2.0, level - 0.5)
		check_heights(scatter, "kelp", -10.0, level - 3.0)
		var shown := places(scatter, "reeds")
		check(all_within(shown, func(at: Vector2) -> bool: return absf(at.x / 10 - level + 0.25) < 0.76), "visible reeds are near the water level")


func test_remaining_instances_keep_their_ids() -> void:
	var scatter := make_shore()
	await settle(scatter)
	var dry := places_in(scatter, "grass", EXTENT)
	scatter.water_enabled = true
	scatter.water_level = 1.0
	var left := places_in(scatter, "grass", EXTENT)
	check(left.size() < dry.size(), "water removes instances")
	check(left.keys().all(func(id: int) -> bool: return dry[id] == left[id]), "the remaining instances have not moved")


func test_a_falloff_thins_toward_the_limit() -> void:
	var scatter := make_shore()
	scatter.water_enabled = true
	var grass := scatter.layers[0]
	grass.max_water_depth = -1.0
	grass.water_depth_falloff = 4.0
	var counts := [0, 0]
	for at: Vector2 in places_in(scatter, "grass", Rect2(10, -60, 40, 120)).values():
		counts[int((at.x - 10) / 20)] += 1
	check(counts[0] > 20 and counts[0] < 0.5 * counts[1], "there are fewer instances near the water: %s" % [counts])
	check_equal(places_in(scatter, "grass", Rect2(-50, -60, 59.9, 120)).size(), 0, "there are no instances nearer to the water")


func test_water_of_a_biome() -> void:
	var scatter := make_shore()
	var dry := make_biome(MEADOW, [])
	dry.water_mode = ScatterBiome.WATER_MODE_NONE
	var lake := make_biome(FOREST, [])
	lake.water_mode = ScatterBiome.WATER_MODE_OWN
	lake.water_level = 5.0
	scatter.biomes = make_map([dry, lake, make_biome(SWAMP, [])])
	scatter.water_enabled = true
	scatter.water_level = -2.0
	await settle(scatter)
	var grass := places_in(scatter, "grass", EXTENT).values()
	check(grass.any(func(at: Vector2) -> bool: return at.x < -80 and at.y < 64), "a biome without water has grass below sea level")
	check(not grass.any(func(at: Vector2) -> bool: return at.x > 0 and at.x < 50 and at.y < 64), "a lake above sea level has no grass")
	check(grass.any(func(at: Vector2) -> bool: return at.x > 0 and at.x < 50 and at.y > 64), "the lake ends at its biome's border")
	check(not grass.any(func(at: Vector2) -> bool: return at.x < -20 and at.y > 64), "the sea covers the remaining area")
	var reeds := places_in(scatter, "reeds", EXTENT).values()
	check(reeds.any(func(at: Vector2) -> bool: return absf(at.x - 50) < 6 and at.y < 64), "reeds grow at the shore of the lake")


func test_the_water_of_a_biome_changes_only_that_biome() -> void:
	var scatter := make_shore()
	var lake := make_biome(SWAMP, [])
	scatter.biomes = make_map([make_biome(MEADOW, []), make_biome(FOREST, []), lake])
	await settle(scatter)
	var visible_tiles := await shown_by(scatter, func() -> void:
		lake.water_level = 3.0
		lake.water_mode = ScatterBiome.WATER_MODE_OWN)
	for layer: String in visible_tiles:
		check(visible_tiles[layer].keys().all(func(tile: Vector2i) -> bool: return tile.y >= 1), "%s: %s" % [layer, visible_tiles[layer].keys()])
	check(visible_tiles["grass"].size() > 2, "tiles of the swamp are regenerated")
	check_equal(scatter.get_problems().size(), 0, "no problems once there is water: %s" % scatter.get_problems())


func test_bad_input() -> void:
	var scatter := make_shore()
	for value: float in [NAN, INF, 2e6]:
		scatter.water_level = value
		check_error(["TerrainScatter3D.water_level"], str(value))
		scatter.layers[0].max_water_depth = value
		check_error(["ScatterLayer.max_water_depth"], str(value))
	check_equal(scatter.water_level, 0.0, "the last valid value stays")
	scatter.water_enabled = true
	await settle(scatter)
	var grass := places(scatter, "grass")
	scatter.layers[0].min_water_depth = 1.0
	await settle(scatter)
	check_error(["layers[0]: ScatterLayer.max_water_depth", 0], "a minimum above the maximum")
	check_equal(places(scatter, "grass"), grass, "the instances do not change")


## Explanations include the rules for biomes and water, with their values, and name the rule that rejects an instance.
func test_water_and_biomes_are_explained() -> void:
	var map := three_biomes()
	var scatter := make_world(map)
	scatter.ground = slope()
	scatter.water_enabled = true
	map.biomes[2].layers[0].min_water_depth = 0.5
	map.biomes[2].layers[0].max_water_depth = 2.0
	await settle(scatter)
	var away := scatter.explain_position(Vector3(60, 0, 0), "grass")[0]
	check_equal([away.refused_by, away.reason], [&"biome", "The position is in none of the layer's biomes."], "a position in the forest")
	var dry := scatter.explain_position(Vector3(40, 0, 90), "reed")[0]
	check_equal(dry.refused_by, &"water_depth", "4 m above the water: " + dry.reason)
	check("Water depth is -4" in dry.reason and "0.5 m to 2 m" in dry.reason, dry.reason)
	var rules := range(dry.get_rule_count()).map(dry.get_rule_name)
	check(&"biome" in rules and &"water_depth" in rules, "both rules are listed: %s" % [rules])
	var depth := rules.find(&"water_depth")
	check_equal([dry.get_rule_min(depth), dry.get_rule_max(depth)], [0.5, 2.0], "the explanation contains the required range")
	check(absf(dry.get_rule_value(depth) + 4.0) < 0.01, "the explanation contains the depth: %f" % dry.get_rule_value(depth))
	check_equal(dry.get_rule_density(rules.find(&"biome")), 1.0, "the explanation contains the weight of the swamp")
	var wet := scatter.explain_position(Vector3(-10, 0, 90), "reed")[0]
	check_equal(wet.allowed, true, "1 m deep in the swamp: " + wet.reason)
	map.biomes[2].water_mode = ScatterBiome.WATER_MODE_NONE
	await settle(scatter)
	var none := scatter.explain_position(Vector3(-10, 0, 90), "reed")[0]
	check_equal(none.refused_by, &"water_depth", "without water: " + none.reason)
	check("There is no water here" in none.reason, none.reason)
	map.border_width = 40.0
	await settle(scatter)
	var border := scatter.explain_position(Vector3(0.2, 0, 0), "fern")[0]
	var weight: float = border.get_rule_density(range(border.get_rule_count()).map(border.get_rule_name).find(&"biome"))
	check(absf(weight - map.get_weights_at(Vector2(0.2, 0))[1]) < 1e-4 and weight < 0.7, "at a border, the weight is below 1: %f" % weight)
