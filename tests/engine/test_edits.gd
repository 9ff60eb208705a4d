extends "edits_harness.gd"
## Tests that edits of regions, masks and ground change only the area that they affect.

## Checks that all changes since `before` are in `areas`, and that the tiles that overlap these areas were regenerated and no others. Tiles that an area
## only touches, within 0.1 m, may be regenerated or not. Returns the number of changes.
func check_local(scatter: TerrainScatter3D, layer: int, before: Dictionary[int, Transform3D], made: Dictionary,
		areas: Array[Rect2], context: String) -> int:
	var changed := changed_places(before, instances(scatter, layer))
	var outside := 0
	for position in changed:
		outside += int(not areas.any(func(area: Rect2) -> bool: return area.grow(FLOATS).has_point(position)))
	check_equal(outside, 0, context + ": instances that changed outside of the edit")
	for tile: Vector2i in scatter.get_shown_tiles(scatter.layers[layer]):
		var rect := tile_rect(scatter, layer, tile)
		if areas.any(func(area: Rect2) -> bool: return rect.intersects(area.grow(-0.1))):
			check(made.has(tile), "%s: tile %s of layer %d is regenerated" % [context, tile, layer])
		elif not areas.any(func(area: Rect2) -> bool: return rect.intersects(area.grow(0.1))):
			check(not made.has(tile), "%s: tile %s of layer %d stays" % [context, tile, layer])
	return changed.size()


## Returns the areas that are not empty, enlarged by `distance` on all sides.
func grown(areas: Array[Rect2], distance: float) -> Array[Rect2]:
	var result: Array[Rect2] = []
	for area in areas:
		if area.has_area():
			result.push_back(area.grow(distance))
	return result


func region_area(region: ScatterRegion3D) -> Rect2:
	var at := Vector2(region.position.x, region.position.z)
	return Rect2(at, Vector2.ZERO).grow(region.radius)


## Makes a random edit. Returns the areas in which oaks and ferns may have changed, in this order.
func edit(scatter: TerrainScatter3D, region: ScatterRegion3D, random: RandomNumberGenerator) -> Array[Array]:
	var at := Vector2(random.randf_range(-60, 60), random.randf_range(-60, 60))
	var areas: Array[Rect2] = []
	var own: Array[Rect2] = []
	match random.randi_range(0, 3):
		0:
			areas.push_back(region_area(region))
			region.position = Vector3(at.x, random.randf_range(-50, 50), at.y)
			region.radius = random.randf_range(2.0, 12.0)
			areas.push_back(region_area(region))
			own = areas
		1:
			areas.push_back(scatter.layers[OAK].mask.paint(at, 6.0, 0.7, 0.3, random.randi_range(0, 1)))
		2:
			var radius := random.randf_range(1.0, 9.0)
			own.push_back(scatter.layers[FERN].mask.paint(at, radius, 0.7, 0.3, random.randi_range(0, 1)))
		3:
			var mound: Mound = scatter.ground
			areas.push_back(mound.area.grow(1.0))
			mound.height = random.randf_range(-3.0, 3.0)
			mound.area = Rect2(at, Vector2(random.randf_range(1, 20), random.randf_range(1, 20)))
			areas.push_back(mound.area.grow(1.0))
			own = areas
			# A rectangle's size may be negative.
			mound.ground_changed.emit(Rect2(areas[0].end - Vector2.ONE, Vector2(2, 2) - areas[0].size))
			mound.ground_changed.emit(mound.area)
	return [grown(areas, 0.0), grown(areas, SPACING) + grown(own, FEATHER)]


func test_random_edits_stay_local() -> void:
	var random := RandomNumberGenerator.new()
	random.seed = 20
	var viewer := make_viewer(Vector3(3.0, 0.0, -5.0))
	var scatter := make_scatter(make_forest(), Mound.new(), viewer)
	var region := make_clearing()
	scatter.add_child(region)
	var shown := Shown.new(scatter)
	await settle(scatter)
	var counts := [0, 0]
	for round in 40:
		var before := [instances(scatter, OAK), instances(scatter, FERN)]
		shown.take()
		var areas := edit(scatter, region, random)
		await settle(scatter)
		var made := shown.take()
		for layer: int in [OAK, FERN]:
			counts[layer] += check_local(scatter, layer, before[layer], made[layer], areas[layer], "round %d" % round)
	check(counts[OAK] > 50 and counts[FERN] > 300, "instances that changed: %s" % [counts])
	var copy := make_scatter(make_forest(), scatter.ground, viewer)
	for layer: int in [OAK, FERN]:
		copy.layers[layer].mask = scatter.layers[layer].mask
	copy.add_child(region.duplicate())
	await settle(copy)
	for layer: int in [OAK, FERN]:
		check(digests(copy, layer) == digests(scatter, layer), "a new node shows the same instances of layer %d" % layer)


func test_several_edits_in_one_frame() -> void:
	var scatter := make_scatter(make_forest(), Mound.new(), make_viewer())
	var shown := Shown.new(scatter)
	var region := make_clearing()
	scatter.add_child(region)
	await settle(scatter)
	shown.take()
	var before := [digests(scatter, OAK), digests(scatter, FERN)]
	# An edit that is undone in the same frame regenerates nothing.
	var mask := scatter.layers[FERN].mask
	var pixels := mask.get_pixel_rect(Rect2(-30, -30, 20, 20))
	var untouched := mask.get_pixels(pixels)
	var area := mask.paint(Vector2(-20, -20), 5.0, 1.0, 0.5, ScatterMask.MODE_ERASE)
	check(area.has_area(), "painted")
	mask.set_pixels(pixels, untouched)
	region.position.x += 10.0
	region.position.x -= 10.0
	await settle(scatter)
	check(shown.take()[FERN].is_empty(), "regenerated tiles without a change")
	mask.paint(Vector2(-20, -20), 5.0, 1.0, 0.5, ScatterMask.MODE_ERASE)
	region.position.x += 10.0
	await settle(scatter)
	check(digests(scatter, FERN) != before[FERN], "ferns have changed")
	region.position.x -= 10.0
	mask.set_pixels(pixels, untouched)
	await settle(scatter)
	for layer: int in [OAK, FERN]:
		check(digests(scatter, layer) == before[layer], "layer %d is the same after undoing the edit" % layer)


func test_old_tiles_stay_until_new_ones_are_ready() -> void:
	var scatter := make_scatter(make_forest(), Mound.new(), make_viewer())
	var region := make_clearing()
	scatter.add_child(region)
	await settle(scatter)
	var tiles := scatter.get_shown_tiles(scatter.layers[FERN])
	scatter.tile_hidden.connect(
			func(layer: ScatterLayer, tile: Vector2i) -> void: check(false, "%s %s is hidden" % [layer.resource_name, tile]))
	for round in 30:
		region.position.x = 2.0 * round
		await frames(1)
		check_equal(scatter.get_shown_tiles(scatter.layers[FERN]), tiles, "visible tiles while the region is dragged")
	await settle(scatter)
	var dragged := digests(scatter, FERN)
	scatter.regenerate()
	await settle(scatter)
	check(digests(scatter, FERN) == dragged, "everything is up to date after dragging")


func test_first_and_last_including_region() -> void:
	var scatter := make_scatter([make_layer()], ScatterGroundFlat.new(), make_viewer())
	var shown := Shown.new(scatter)
	await settle(scatter)
	var tiles := scatter.get_shown_tiles(scatter.layers[0]).size()
	var before := digests(scatter, 0)
	shown.take()
	var regions: Array[ScatterRegion3D] = []
	for x: float in [-30.0, 30.0]:
		var region := make_clearing()
		region.exclude = false
		region.position.x = x
		scatter.add_child(region)
		regions.push_back(region)
		await settle(scatter)
		check_equal(shown.take()[0].size() == tiles, x < 0.0, "all tiles are regenerated")
	check(instances(scatter, 0).size() > 20, "there are instances in the regions")
	for region in regions:
		region.free()
		await settle(scatter)
		check_equal(shown.take()[0].size() == tiles, region == regions[1], "all tiles are regenerated")
	check(digests(scatter, 0) == before, "the same as without regions")


func test_a_new_tile_size_keeps_the_instances() -> void:
	var scatter := make_scatter(make_forest(), Mound.new(), make_viewer())
	scatter.add_child(make_clearing())
	await settle(scatter)
	var before := instances(scatter, FERN)
	var digest := digests(scatter, FERN)
	scatter.layers[FERN].tile_size = 17.0
	await settle(scatter)
	await frames(5)
	var after := instances(scatter, FERN)
	var both := 0
	for id in before:
		if on_map(before[id]).length() < 60.0:
			both += 1
			check(after.has(id) and after[id].origin.distance_to(before[id].origin) < FLOATS, "the fern is at the same position with another tile size")
	check(both > 500, "%d ferns are in the tiles of both sizes" % both)
	scatter.layers[FERN].tile_size = 32.0
	await settle(scatter)
	await frames(5)
	check(digests(scatter, FERN) == digest, "bit-identical with the old tile size")
	root.remove_child(scatter)
	root.add_child(scatter)
	await settle(scatter)
	check(digests(scatter, FERN) == digest, "bit-identical after leaving the tree")


func test_ground_everywhere() -> void:
	var mound := Mound.new()
	var scatter := make_scatter(make_forest(), mound, make_viewer())
	var shown := Shown.new(scatter)
	await settle(scatter)
	var tiles := scatter.get_shown_tiles(scatter.layers[FERN]).size()
	for rect: Rect2 in [Rect2(), Rect2(5, 5, 0, 0), Rect2(0, 0, NAN, 1), Rect2(0, 0, INF, 1)]:
		shown.take()
		mound.ground_changed.emit(rect)
		await settle(scatter)
		check_equal(shown.take()[FERN].size(), tiles, "tiles after %s" % rect)
	mound.ground_changed.emit(Rect2(5000, 5000, 10, 10))
	await settle(scatter)
	check(shown.take()[FERN].is_empty(), "regenerated tiles after a change far away")
	scatter.ground = ScatterGroundFlat.new()
	await settle(scatter)
	shown.take()
	mound.ground_changed.emit(Rect2(0, 0, 10, 10))
	await settle(scatter)
	check(shown.take()[FERN].is_empty(), "regenerated tiles after a change to an old ground")
