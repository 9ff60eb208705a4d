extends "edits_harness.gd"
## Tests colors and variations that depend on height, slope, noise, rank or the distance to a second layer. The tests read the values from
## the buffers and compare them with the instances.

const STRIDE := 20
const STEP := 0.0027 # Tolerance for one step of a gradient with 256 colors, stored in half precision.


## Ground with waves on one side and a plane with a slope of one half on the other.
class Banks extends ScatterGround:
	func _get_heights(positions: PackedVector2Array) -> PackedFloat32Array:
		var heights := PackedFloat32Array()
		for at in positions:
			heights.push_back(-0.5 * at.x if at.x < 0.0 else 4.0 * sin(at.x * 0.1) * cos(at.y * 0.07))
		return heights

	func _is_thread_safe() -> bool:
		return true


## A visible instance: its world position, the red component of its color, and its custom data.
class Seen:
	var place: Vector3
	var color: float
	var custom: Color


## Returns a gradient from black to white, so that a color's components equal the offset on the gradient.
func gray() -> Gradient:
	var gradient := Gradient.new()
	gradient.colors = PackedColorArray([Color.BLACK, Color.WHITE])
	return gradient


func make_colored(radius := 1.5) -> ScatterLayer:
	var layer := named_layer("fern", 2, radius)
	layer.use_colors = true
	layer.use_custom_data = true
	layer.color_value = colored(ScatterValueSource.new())
	return layer


func colored(value: ScatterValueSource) -> ScatterValueSource:
	value.gradient = gray()
	return value


func seen_in(tile: ScatterTile) -> Dictionary[int, Seen]:
	var result: Dictionary[int, Seen] = {}
	for mesh in tile.get_mesh_count():
		var buffer := tile.get_buffer(mesh)
		var ids := tile.get_ids(mesh)
		for index in ids.size():
			var at := index * STRIDE
			var seen := Seen.new()
			seen.place = tile.get_origin() + Vector3(buffer[at + 3], buffer[at + 7], buffer[at + 11])
			seen.color = buffer[at + 12]
			seen.custom = Color(buffer[at + 16], buffer[at + 17], buffer[at + 18], buffer[at + 19])
			result[ids[index]] = seen
	return result


func seen(scatter: TerrainScatter3D, layer: int) -> Dictionary[int, Seen]:
	var result: Dictionary[int, Seen] = {}
	for tile: Vector2i in scatter.get_shown_tiles(scatter.layers[layer]):
		result.merge(seen_in(scatter.get_tile(scatter.layers[layer], tile)))
	return result


## Compares the colors and variations of all instances with `share`, which returns the expected fraction. `slack` is the tolerance.
func check_shares(all: Dictionary[int, Seen], share: Callable, context: String, slack := 0.0) -> void:
	var worst := 0.0
	var minimum := 1.0
	var maximum := 0.0
	for id in all:
		var expected := clampf(share.call(all[id]), 0.0, 1.0)
		worst = maxf(worst, maxf(absf(all[id].color - expected) - STEP, absf(all[id].custom.r - expected) - 0.001))
		minimum = minf(minimum, expected)
		maximum = maxf(maximum, expected)
	check(all.size() > 300, "%s: %d instances" % [context, all.size()])
	check(worst <= slack, "%s: the largest error is %f" % [context, worst])
	check(minimum < 0.1 and maximum > 0.9, "%s: the values range from %f to %f" % [context, minimum, maximum])


func set_source(layer: ScatterLayer, source: ScatterValueSource.Source, from: float, to: float) -> void:
	for property: StringName in [&"color_value", &"variation_value"]:
		var value := colored(ScatterValueSource.new())
		value.source = source
		value.min_value = from
		value.max_value = to
		layer.set(property, value)


func test_sources_of_the_ground_and_of_ranks() -> void:
	var layer := make_colored()
	layer.height_offset = 0.0
	var scatter := make_scatter([layer], Banks.new(), make_viewer())
	set_source(layer, ScatterValueSource.SOURCE_HEIGHT, -3.0, 20.0)
	await settle(scatter)
	check_shares(seen(scatter, 0), func(one: Seen) -> float: return (one.place.y + 3.0) / 23.0, "height", 1e-4)
	layer.height_offset = 2.0
	await settle(scatter)
	check_shares(seen(scatter, 0), func(one: Seen) -> float: return (one.place.y + 1.0) / 23.0, "the ground's height", 1e-4)
	set_source(layer, ScatterValueSource.SOURCE_SLOPE, 2.0, 20.0)
	await settle(scatter)
	var ground := func(one: Seen) -> float:
		var normal := scatter.ground.get_normal(one.place)
		return (rad_to_deg(normal.angle_to(Vector3.UP)) - 2.0) / 18.0
	check_shares(seen(scatter, 0), ground, "slope", 1e-3)
	for one: Seen in seen(scatter, 0).values():
		if one.place.x < -2.0 and one.color < 0.99:
			check(false, "steep at %s: %f" % [one.place, one.color])
	set_source(layer, ScatterValueSource.SOURCE_RANK, 0.25, 1.0)
	await settle(scatter)
	check_shares(seen(scatter, 0), func(one: Seen) -> float: return (one.custom.b - 0.25) / 0.75, "rank", 1e-3)


## Scales depend on the ground and on other layers, follow edits, and are also the scales that queries and custom data report.
func test_scale_value() -> void:
	var oak := named_layer("oak", 1, 9.0)
	var fern := make_colored()
	fern.min_scale = 0.5
	fern.max_scale = 2.5
	fern.height_offset = 0.0
	var value := ScatterValueSource.new()
	value.source = ScatterValueSource.SOURCE_HEIGHT
	value.min_value = -3.0
	value.max_value = 20.0
	fern.scale_value = value
	var scatter := make_scatter([oak, fern], Banks.new(), make_viewer())
	await settle(scatter)
	var scale_at := func(one: Seen) -> float: return 0.5 + 2.0 * clampf((one.place.y + 3.0) / 23.0, 0.0, 1.0)
	var wrong := seen(scatter, 1).values().filter(func(one: Seen) -> bool: return absf(one.custom.a - scale_at.call(one)) > 2e-3)
	check_equal(wrong.size(), 0, "instances whose scale does not match the height")
	check(seen(scatter, 1).size() > 300, "%d instances" % seen(scatter, 1).size())
	var nearest: ScatterInstance = scatter.query_nearest(Vector3.ZERO, 20.0, fern)
	var expected: float = seen(scatter, 1)[nearest.id].custom.a
	check(absf(nearest.transform.basis.get_scale().y - expected) < 2e-3, "a query reports the scale %f: %s" % [expected, nearest.transform])
	value.max_value = 60.0
	await settle(scatter)
	scale_at = func(one: Seen) -> float: return 0.5 + 2.0 * clampf((one.place.y + 3.0) / 63.0, 0.0, 1.0)
	wrong = seen(scatter, 1).values().filter(func(one: Seen) -> bool: return absf(one.custom.a - scale_at.call(one)) > 2e-3)
	check_equal(wrong.size(), 0, "instances whose scale does not match the height after an edit")
	value.source = ScatterValueSource.SOURCE_DISTANCE
	value.layer = "oak"
	value.min_value = 0.0
	value.max_value = 8.0
	await settle(scatter)
	var oaks := map_positions(scatter, 0)
	wrong = seen(scatter, 1).values().filter(func(one: Seen) -> bool:
		if Vector2(one.place.x, one.place.z).length() > 40.0:
			return false
		var away := 8.0
		for place in oaks:
			away = minf(away, place.distance_to(Vector2(one.place.x, one.place.z)))
		return absf(one.custom.a - (0.5 + 2.0 * away / 8.0)) > 5e-3)
	check_equal(wrong.size(), 0, "instances whose scale does not match the distance to oaks")
	oak.resource_name = "elm"
	await settle(scatter)
	check_equal(value.layer, "elm", "the reference refers to the renamed layer")
	check_equal(scatter.get_problems(), PackedStringArray(), "problems")


func test_noise() -> void:
	var layer := make_colored()
	var scatter := make_scatter([layer], ScatterGroundFlat.new(), make_viewer())
	set_source(layer, ScatterValueSource.SOURCE_NOISE, 0.3, 0.7)
	await settle(scatter)
	var random := seen(scatter, 0)
	check("there is no noise" in "\n".join(scatter.get_problems()), "get_problems reports the missing noise: %s" % scatter.get_problems())
	var noise := FastNoiseLite.new()
	noise.frequency = 0.03
	layer.color_value.noise = noise
	layer.variation_value.noise = noise
	await settle(scatter)
	var share := func(one: Seen) -> float:
		return (0.5 + 0.5 * noise.get_noise_2d(one.place.x, one.place.z) - 0.3) / 0.4
	check_shares(seen(scatter, 0), share, "noise", 1e-4)
	check_equal(scatter.get_problems(), PackedStringArray(), "no problems")
	var before := digests(scatter, 0)
	noise.frequency = 0.05
	await settle(scatter)
	check_shares(seen(scatter, 0), share, "after an edit of the noise", 1e-4)
	check(digests(scatter, 0) != before, "new colors")
	layer.color_value.noise = null
	layer.variation_value.noise = null
	await settle(scatter)
	var again := seen(scatter, 0)
	for id in random:
		if again[id].color != random[id].color:
			check(false, "random colors have changed")
			break


## Returns a scatter of oaks, and of ferns whose colors depend on the distance to oaks.
func make_followed(terrain: ScatterGround) -> TerrainScatter3D:
	var oak := named_layer("oak", 1, 9.0)
	oak.density = 0.7
	oak.view_distance = 100.0
	oak.mask = make_mask()
	var fern := make_colored(3.0)
	set_source(fern, ScatterValueSource.SOURCE_DISTANCE, 1.0, 8.0)
	fern.color_value.layer = "oak"
	fern.variation_value.layer = "oak"
	return make_scatter([oak, fern], terrain, make_viewer())


func distance_share(oaks: PackedVector2Array) -> Callable:
	return func(one: Seen) -> float: return (nearest(Vector2(one.place.x, one.place.z), oaks) - 1.0) / 7.0


func test_the_distance_to_a_second_layer() -> void:
	var all_digests: Array[Dictionary] = []
	for terrain: ScatterGround in [Mound.new(), MainMound.new()]:
		var scatter := make_followed(terrain)
		await settle(scatter)
		check_equal(scatter.get_problems(), PackedStringArray(), "no problems")
		var oaks := map_positions(scatter, OAK)
		check_shares(seen(scatter, FERN), distance_share(oaks), "distance", 1e-4)
		all_digests.push_back(digests(scatter, FERN))
		# Rectangles from build_rect, and tiles of a different size, have the same colors.
		var built := seen_in(scatter.build_rect(scatter.layers[FERN], Rect2(-17.0, 3.0, 40.0, 21.0)))
		var shown := seen(scatter, FERN)
		scatter.layers[FERN].tile_size = 21.0
		await settle(scatter)
		var small := seen(scatter, FERN)
		for id in built:
			if built[id].color != shown[id].color or small[id].color != shown[id].color or small[id].custom != shown[id].custom:
				check(false, "a window has different colors: %f, %f, %f" % [built[id].color, small[id].color, shown[id].color])
				break
		check(built.size() > 40, "%d instances in the window" % built.size())
		scatter.free()
	check(all_digests[0] == all_digests[1], "both kinds of ground have the same tiles")


func test_an_edit_of_the_second_layer_stays_local() -> void:
	var scatter := make_followed(Mound.new())
	var fern := scatter.layers[FERN]
	var shown := Shown.new(scatter)
	await settle(scatter)
	for spot: Vector2 in [Vector2(10, 12), Vector2(-33, 20), Vector2(0, -31)]:
		var before := digests(scatter, FERN)
		shown.take()
		var area := scatter.layers[OAK].mask.paint(spot, 7.0, 1.0, 1.0, ScatterMask.MODE_ERASE)
		await settle(scatter)
		var made: Dictionary = shown.take()[FERN]
		for tile: Vector2i in scatter.get_shown_tiles(scatter.layers[FERN]):
			check_equal(made.has(tile), tile_rect(scatter, FERN, tile).intersects(area.grow(8.0)), "tile %s is regenerated" % tile)
			if not made.has(tile):
				check_equal(scatter.get_tile(scatter.layers[FERN], tile).get_digest(), before[tile], "tile %s" % tile)
		check_shares(seen(scatter, FERN), distance_share(map_positions(scatter, OAK)), "after an edit", 1e-4)
	var whole := digests(scatter, FERN)
	scatter.layers[OAK].min_scale = 0.5
	await settle(scatter)
	check(shown.take()[FERN].is_empty() and digests(scatter, FERN) == whole, "the look of the oaks has no effect")
	fern.color_value.source = ScatterValueSource.SOURCE_RANDOM
	fern.variation_value.source = ScatterValueSource.SOURCE_RANDOM
	await settle(scatter)
	shown.take()
	scatter.layers[OAK].mask.paint(Vector2.ZERO, 7.0, 1.0, 1.0, ScatterMask.MODE_ERASE)
	scatter.layers[OAK].density = 0.5
	fern.color_value.min_value = 2.0
	fern.color_value.randomness = 0.5
	await settle(scatter)
	check(shown.take()[FERN].is_empty(), "oaks that no source uses have no effect, and neither does an unused range")


func test_references() -> void:
	var scatter := make_followed(ScatterGroundFlat.new())
	var oak := scatter.layers[OAK]
	var fern := scatter.layers[FERN]
	await settle(scatter)
	var followed := digests(scatter, FERN)
	for reference: Variant in [oak, &"oak"]:
		fern.color_value.layer = reference
		fern.variation_value.layer = reference
		await settle(scatter)
		check(digests(scatter, FERN) == followed, "tiles are the same with the reference %s" % [reference])
	oak.resource_name = "elm"
	check_equal([fern.color_value.layer, fern.variation_value.layer], ["elm", "elm"], "the reference refers to the renamed layer")
	check_equal(scatter.get_problems(), PackedStringArray(), "no problems")
	for bad: Variant in [2.5, BoxMesh.new()]:
		fern.color_value.layer = bad
		check_error(["ScatterValueSource.layer", "Pass a ScatterLayer or its name"], "%s" % [bad])
		fern.variation_value.layer = bad
		check_error(["ScatterValueSource.layer", "Pass a ScatterLayer or its name"], "%s" % [bad])
	check_equal(fern.color_value.layer, "elm", "the old reference stays")
	fern.color_value.layer = null
	check_equal(fern.color_value.layer, "", "no layer")
	check("color_value.source is Distance, but names no layer" in "\n".join(scatter.get_problems()), "get_problems reports the missing layer")
	scatter.layers = [fern, oak]
	var problems := "\n".join(scatter.get_problems())
	check("variation_value.layer is \"elm\", which is not before" in problems, "get_problems reports a layer that is not before this one: %s" % problems)
	fern.color_value.layer = "ash"
	check("color_value.layer is \"ash\", and no layer has that name" in "\n".join(scatter.get_problems()), "get_problems reports a name that no layer has")
	fern.resource_name = ""
	fern.color_value.layer = ""
	oak.resource_name = ""
	oak.color_value = ScatterValueSource.new()
	oak.color_value.layer = fern
	fern.variation_value.layer = oak
	check_error(["ScatterValueSource.layer", "cycle"], "layers without names in a cycle")
	fern.variation_value = oak.color_value
	check_error(["ScatterLayer.variation_value", "cycle"], "a value with the layer itself")
	fern.proximity_layer = oak
	check_error(["ScatterLayer.proximity_layer", "cycle"], "a cycle through a value")


func test_invalid_ranges() -> void:
	var scatter := make_followed(ScatterGroundFlat.new())
	var fern := scatter.layers[FERN]
	await settle(scatter)
	var before := digests(scatter, FERN)
	fern.color_value.max_value = 0.5
	await settle(scatter)
	check_error(["layers[1]: ScatterLayer.color_value.max_value", "0.5"], "the end before the start")
	fern.color_value.max_value = 1001.0
	await settle(scatter)
	check_error(["layers[1]: ScatterLayer.color_value.max_value must be between", "1001"], "a distance above the maximum")
	fern.color_value.max_value = 900.0
	scatter.layers[OAK].radius = 0.25
	scatter.layers[OAK].tile_size = 10.0
	scatter.layers[OAK].view_distance = 5.0
	await settle(scatter)
	check_error(["layers[1]: ScatterLayer.color_value.max_value", "points"], "too many oaks in that distance")
	check(digests(scatter, FERN) == before, "the instances do not change")
	scatter.layers[OAK].radius = 9.0
	fern.color_value.max_value = 8.0
	await settle(scatter)
	check(digests(scatter, FERN) == before, "the instances are the same after valid values are restored")
	check_no_error("no error")


## For hand-placed instances, sources use their actual positions.
func test_hand_placed() -> void:
	var layer := make_colored()
	var scatter := make_scatter([layer], ScatterGroundFlat.new(), make_viewer())
	set_source(layer, ScatterValueSource.SOURCE_HEIGHT, 0.0, 10.0)
	await settle(scatter)
	var id := scatter.add_instance(scatter.layers[0], Transform3D(Basis.IDENTITY, Vector3(3.0, 7.5, 4.0)))
	await settle(scatter)
	await frames(3)
	var buffer: PackedFloat32Array = scatter.get_tile(scatter.layers[0], Vector2i.ZERO).get_buffer(0)
	var ids: PackedInt64Array = scatter.get_tile(scatter.layers[0], Vector2i.ZERO).get_ids(0)
	var at := ids.find(id) * STRIDE
	if check(at >= 0, "it exists"):
		check(absf(buffer[at + 12] - 0.75) < STEP and absf(buffer[at + 16] - 0.75) < 0.001, "at 7.5 of 10 m: %f, %f" % [buffer[at + 12], buffer[at + 16]])
	set_source(layer, ScatterValueSource.SOURCE_SLOPE, 0.0, 45.0)
	await settle(scatter)
	var all := seen_in(scatter.get_tile(scatter.layers[0], Vector2i.ZERO))
	check(all[id].color > 0.0 and all.values().all(func(one: Seen) -> bool: return one.color < 0.01 or one == all[id]),
			"a random color on level ground: %f" % all[id].color)


## Two layers share one value source for both their colors and their variations.
func test_a_shared_value() -> void:
	var first := make_colored()
	var second := make_colored(3.0)
	var value := colored(ScatterValueSource.new())
	value.source = ScatterValueSource.SOURCE_HEIGHT
	value.min_value = -3.0
	value.max_value = 20.0
	for layer: ScatterLayer in [first, second]:
		layer.color_value = value
		layer.variation_value = value
	var scatter := make_scatter([first, second], Banks.new(), make_viewer())
	await settle(scatter)
	for index in 2:
		check_shares(seen(scatter, index), func(one: Seen) -> float: return (one.place.y + 3.0) / 23.0, "layer %d" % index, 1e-4)
	value.max_value = 10.0
	await settle(scatter)
	for index in 2:
		check_shares(seen(scatter, index), func(one: Seen) -> float: return (one.place.y + 3.0) / 13.0, "layer %d, edited" % index, 1e-4)
	first.color_value = null
	value.max_value = 20.0
	await settle(scatter)
	var variations := seen(scatter, 0).values().all(func(one: Seen) -> bool:
		return absf(one.custom.r - clampf((one.place.y + 3.0) / 23.0, 0.0, 1.0)) < 0.0015)
	check(variations, "a change to the shared value still updates the variation")


## A curve remaps the value, both of a source and of random numbers. Editing the curve takes effect.
func test_a_curve() -> void:
	var layer := make_colored()
	var scatter := make_scatter([layer], Banks.new(), make_viewer())
	set_source(layer, ScatterValueSource.SOURCE_HEIGHT, -3.0, 20.0)
	var curve := make_line(Vector2(0, 1), Vector2(1, 0))
	for property: StringName in [&"color_value", &"variation_value"]:
		(layer.get(property) as ScatterValueSource).curve = curve
	await settle(scatter)
	check_shares(seen(scatter, 0), func(one: Seen) -> float: return 1.0 - clampf((one.place.y + 3.0) / 23.0, 0.0, 1.0), "downward", 2e-3)
	curve.clear_points()
	curve.add_point(Vector2.ONE)
	await settle(scatter)
	check(seen(scatter, 0).values().all(func(one: Seen) -> bool: return one.color > 0.99 and one.custom.r == 1.0), "1 everywhere")
	curve = make_line(Vector2.ZERO, Vector2(1, 0.5))
	set_source(layer, ScatterValueSource.SOURCE_RANDOM, 0.0, 1.0)
	await settle(scatter)
	var plain := seen(scatter, 0)
	for property: StringName in [&"color_value", &"variation_value"]:
		(layer.get(property) as ScatterValueSource).curve = curve
	await settle(scatter)
	var halved := seen(scatter, 0)
	for id in plain:
		if absf(halved[id].color - 0.5 * plain[id].color) > 2.0 * STEP or absf(halved[id].custom.r - 0.5 * plain[id].custom.r) > 0.001:
			check(false, "half of %f and %f: %f and %f" % [plain[id].color, plain[id].custom.r, halved[id].color, halved[id].custom.r])
	check_equal(scatter.get_problems(), PackedStringArray(), "no problems")


func test_some_randomness() -> void:
	var layer := make_colored()
	set_source(layer, ScatterValueSource.SOURCE_HEIGHT, -3.0, 20.0)
	layer.color_value.randomness = 0.25
	var scatter := make_scatter([layer], Banks.new(), make_viewer())
	await settle(scatter)
	var offsets := PackedFloat64Array()
	for one: Seen in seen(scatter, 0).values():
		offsets.push_back(one.color - 0.75 * clampf((one.place.y + 3.0) / 23.0, 0.0, 1.0))
	offsets.sort()
	check(offsets[0] > -STEP and offsets[-1] < 0.25 + STEP, "offsets stay between 0 and a quarter: %f to %f" % [offsets[0], offsets[-1]])
	check(absf(offsets[offsets.size() / 2] - 0.125) < 0.02, "uniform: %f" % offsets[offsets.size() / 2])
