extends "harness.gd"
## An edit changes what it reaches and no more: shapes, masks, ground and layers that know each other by name.

const FLOATS := 0.001 # Metres; how far a float may be off at these distances.
const OAK := 0
const FERN := 1
const SPACING := 3.0
const FEATHER := 2.0

## Hills with a mound that may change; asked on worker threads.
class Mound extends ScatterTerrain:
	var area := Rect2(0, 0, 1, 1)
	var height := 0.0

	func _get_heights(positions: PackedVector2Array) -> PackedFloat32Array:
		var heights := PackedFloat32Array()
		for at in positions:
			heights.push_back(sin(at.x * 0.1) + 2.0 * cos(at.y * 0.07) + (height if area.has_point(at) else 0.0))
		return heights

	func _is_thread_safe() -> bool:
		return true


## Hills on the main thread.
class MainMound extends Mound:
	func _is_thread_safe() -> bool:
		return false


## Which tiles of which layers were shown since the last look.
class Shown:
	var tiles: Array[Dictionary] = [{}, {}, {}]

	func _init(scatter: TerrainScatter3D) -> void:
		scatter.tile_shown.connect(func(layer: int, tile: Vector2i) -> void: tiles[layer][tile] = true)

	func take() -> Array[Dictionary]:
		var taken := tiles
		tiles = [{}, {}, {}]
		return taken


func named_layer(layer_name: String, id: int, radius: float) -> ScatterLayer:
	var layer := make_layer(radius)
	layer.resource_name = layer_name
	layer.layer_id = id
	return layer


func make_mask() -> ScatterMask:
	var mask := ScatterMask.new()
	mask.pixel_size = 0.5
	mask.paint(Vector2(1000, 1000), 1.0, 1.0, 1.0, ScatterMask.MODE_ERASE)
	return mask


func make_forest() -> Array[ScatterLayer]:
	var oak := named_layer("oak", 1, 4.0)
	oak.tile_size = 40.0
	oak.density = 0.8
	var fern := named_layer("fern", 2, 1.5)
	fern.spacing = {"oak": SPACING}
	fern.edge_feather = FEATHER
	oak.mask = make_mask()
	fern.mask = make_mask()
	return [oak, fern]


func tile_rect(scatter: TerrainScatter3D, layer: int, tile: Vector2i) -> Rect2:
	var size := scatter.layers[layer].tile_size
	return Rect2(Vector2(tile) * size, Vector2(size, size))


## What has changed since `before` lies in `areas`, and the tiles that touch them were made anew, no others.
func check_local(scatter: TerrainScatter3D, layer: int, before: Dictionary[int, Transform3D], made: Dictionary,
		areas: Array[Rect2], what: String) -> int:
	var changed := changed_places(before, instances(scatter, layer))
	var outside := 0
	for place in changed:
		outside += int(not areas.any(func(area: Rect2) -> bool: return area.grow(FLOATS).has_point(place)))
	check_equal(outside, 0, what + ": instances that changed outside of the edit")
	for tile: Vector2i in scatter.get_shown_tiles(layer):
		var rect := tile_rect(scatter, layer, tile)
		if areas.any(func(area: Rect2) -> bool: return area.grow(-0.1).has_area() and rect.intersects(area.grow(-0.1))):
			check(made.has(tile), "%s: tile %s of layer %d is made anew" % [what, tile, layer])
		elif not areas.any(func(area: Rect2) -> bool: return rect.intersects(area.grow(0.1))):
			check(not made.has(tile), "%s: tile %s of layer %d stays" % [what, tile, layer])
	return changed.size()


func grown(areas: Array[Rect2], distance: float) -> Array[Rect2]:
	var result: Array[Rect2] = []
	for area in areas:
		result.push_back(area.grow(distance))
	return result


func shape_area(shape: ScatterShape3D) -> Rect2:
	var at := Vector2(shape.position.x, shape.position.z)
	return Rect2(at, Vector2.ZERO).grow(shape.radius)


func make_clearing() -> ScatterShape3D:
	var shape := ScatterShape3D.new()
	shape.kind = ScatterShape3D.KIND_CYLINDER
	shape.ignore_height = true
	shape.exclude = true
	shape.falloff = 3.0
	shape.radius = 8.0
	return shape


## One random edit. Returns where each of the two layers may have changed.
func edit(scatter: TerrainScatter3D, shape: ScatterShape3D, random: RandomNumberGenerator) -> Array[Array]:
	var at := Vector2(random.randf_range(-60, 60), random.randf_range(-60, 60))
	var areas: Array[Rect2] = []
	var own: Array[Rect2] = []
	match random.randi_range(0, 3):
		0:
			areas.push_back(shape_area(shape))
			shape.position = Vector3(at.x, random.randf_range(-50, 50), at.y)
			shape.radius = random.randf_range(2.0, 12.0)
			areas.push_back(shape_area(shape))
			own = areas
		1:
			areas.push_back(scatter.layers[OAK].mask.paint(at, 6.0, 0.7, 0.3, random.randi_range(0, 1)))
		2:
			own.push_back(scatter.layers[FERN].mask.paint(at, random.randf_range(1.0, 9.0), 0.7, 0.3, random.randi_range(0, 1)))
		3:
			var mound: Mound = scatter.terrain
			areas.push_back(mound.area.grow(1.0))
			mound.height = random.randf_range(-3.0, 3.0)
			mound.area = Rect2(at, Vector2(random.randf_range(1, 20), random.randf_range(1, 20)))
			areas.push_back(mound.area.grow(1.0))
			own = areas
			# A rectangle may be given from any of its corners.
			mound.terrain_changed.emit(Rect2(areas[0].end - Vector2.ONE, Vector2(2, 2) - areas[0].size))
			mound.terrain_changed.emit(mound.area)
	var fern := grown(areas, SPACING) + grown(own, FEATHER)
	fern = fern.filter(func(area: Rect2) -> bool: return area.size.x > 2.0 * SPACING or not areas.has(area.grow(-SPACING)))
	return [areas, fern]


func test_random_edits_stay_local() -> void:
	var random := RandomNumberGenerator.new()
	random.seed = 20
	var viewer := make_viewer(Vector3(3.0, 0.0, -5.0))
	var scatter := make_scatter(make_forest(), Mound.new(), viewer)
	var shape := make_clearing()
	scatter.add_child(shape)
	var shown := Shown.new(scatter)
	await settle(scatter)
	var counts := [0, 0]
	for round in 40:
		var before := [instances(scatter, OAK), instances(scatter, FERN)]
		shown.take()
		var areas := edit(scatter, shape, random)
		await settle(scatter)
		var made := shown.take()
		for layer: int in [OAK, FERN]:
			var local: Array[Rect2] = []
			local.assign(areas[layer].filter(func(area: Rect2) -> bool: return area.has_area()))
			counts[layer] += check_local(scatter, layer, before[layer], made[layer], local, "round %d" % round)
	check(counts[OAK] > 50 and counts[FERN] > 300, "instances that changed: %s" % [counts])
	var copy := make_scatter(make_forest(), scatter.terrain, viewer)
	for layer: int in [OAK, FERN]:
		copy.layers[layer].mask = scatter.layers[layer].mask
	copy.add_child(shape.duplicate())
	await settle(copy)
	for layer: int in [OAK, FERN]:
		check(digests(copy, layer) == digests(scatter, layer), "a new node shows the same of layer %d" % layer)


func test_several_edits_in_one_frame() -> void:
	var scatter := make_scatter(make_forest(), Mound.new(), make_viewer())
	var shown := Shown.new(scatter)
	var shape := make_clearing()
	scatter.add_child(shape)
	await settle(scatter)
	shown.take()
	var before := [digests(scatter, OAK), digests(scatter, FERN)]
	# There and back again is no edit at all.
	var mask := scatter.layers[FERN].mask
	var pixels := mask.get_pixel_rect(Rect2(-30, -30, 20, 20))
	var untouched := mask.get_pixels(pixels)
	var area := mask.paint(Vector2(-20, -20), 5.0, 1.0, 0.5, ScatterMask.MODE_ERASE)
	check(area.has_area(), "painted")
	mask.set_pixels(pixels, untouched)
	shape.position.x += 10.0
	shape.position.x -= 10.0
	await settle(scatter)
	check(shown.take()[FERN].is_empty(), "tiles made anew for nothing")
	mask.paint(Vector2(-20, -20), 5.0, 1.0, 0.5, ScatterMask.MODE_ERASE)
	shape.position.x += 10.0
	await settle(scatter)
	check(digests(scatter, FERN) != before[FERN], "ferns have changed")
	shape.position.x -= 10.0
	mask.set_pixels(pixels, untouched)
	await settle(scatter)
	for layer: int in [OAK, FERN]:
		check(digests(scatter, layer) == before[layer], "taken back, layer %d is as it was" % layer)


func test_old_tiles_stay_until_new_ones_are_there() -> void:
	var scatter := make_scatter(make_forest(), Mound.new(), make_viewer())
	var shape := make_clearing()
	scatter.add_child(shape)
	await settle(scatter)
	var tiles := scatter.get_shown_tiles(FERN)
	scatter.tile_hidden.connect(func(layer: int, tile: Vector2i) -> void: check(false, "%d %s is hidden" % [layer, tile]))
	for round in 30:
		shape.position.x = 2.0 * round
		await frames(1)
		check_equal(scatter.get_shown_tiles(FERN), tiles, "tiles on show while the shape is dragged")
	await settle(scatter)
	var dragged := digests(scatter, FERN)
	scatter.regenerate()
	await settle(scatter)
	check(digests(scatter, FERN) == dragged, "after dragging all is up to date")


func test_first_and_last_including_shape() -> void:
	var scatter := make_scatter([make_layer()], ScatterTerrainFlat.new(), make_viewer())
	var shown := Shown.new(scatter)
	await settle(scatter)
	var tiles := scatter.get_shown_tiles(0).size()
	var before := digests(scatter, 0)
	shown.take()
	var shapes: Array[ScatterShape3D] = []
	for x: float in [-30.0, 30.0]:
		var shape := make_clearing()
		shape.exclude = false
		shape.position.x = x
		scatter.add_child(shape)
		shapes.push_back(shape)
		await settle(scatter)
		check_equal(shown.take()[0].size() == tiles, x < 0.0, "all tiles are made anew")
	check(instances(scatter, 0).size() > 20, "something stands within")
	for shape in shapes:
		shape.free()
		await settle(scatter)
		check_equal(shown.take()[0].size() == tiles, shape == shapes[1], "all tiles are made anew")
	check(digests(scatter, 0) == before, "as if there had been none")


func test_one_layer_changed() -> void:
	var scatter := make_scatter(make_forest(), Mound.new(), make_viewer())
	var shown := Shown.new(scatter)
	await settle(scatter)
	var oaks := instances(scatter, OAK)
	var ferns := instances(scatter, FERN)
	shown.take()
	scatter.layers[FERN].density = 0.5
	await settle(scatter)
	check(shown.take()[OAK].is_empty(), "a later layer does not matter to an earlier one")
	scatter.layers[FERN].density = 1.0
	await settle(scatter)
	check(instances(scatter, FERN) == ferns, "the same ferns again")
	shown.take()
	scatter.layers[OAK].max_scale = 2.0
	await settle(scatter)
	check(shown.take()[FERN].is_empty(), "how oaks look does not matter to ferns")
	scatter.layers[OAK].max_scale = 1.0
	scatter.layers[OAK].density = 0.5
	await settle(scatter)
	var felled := changed_places(oaks, instances(scatter, OAK))
	var changed := changed_places(ferns, instances(scatter, FERN))
	check(felled.size() > 20 and changed.size() > 50, "%d oaks and %d ferns changed" % [felled.size(), changed.size()])
	var far := 0
	for place in changed:
		# Oaks beyond the view reach in, too.
		var near_edge := maxf(absf(place.x), absf(place.y)) > 60.0
		far += int(not near_edge and nearest(place, felled) > SPACING + FLOATS)
	check_equal(far, 0, "ferns that changed far from any oak that did")


func nearest(place: Vector2, others: PackedVector2Array) -> float:
	var least := INF
	for other in others:
		least = minf(least, place.distance_squared_to(other))
	return sqrt(least)


func places(scatter: TerrainScatter3D, layer: int) -> PackedVector2Array:
	var result: PackedVector2Array
	for at: Transform3D in instances(scatter, layer).values():
		result.push_back(on_map(at))
	return result


## The least distance from any instance of a layer near the middle to any of another.
func gap(scatter: TerrainScatter3D, layer: int, other: int) -> float:
	var least := INF
	var others := places(scatter, other)
	for place in places(scatter, layer):
		if place.length() < 50.0:
			least = minf(least, nearest(place, others))
	return least


func test_spacing_across_tiles_and_by_order() -> void:
	var a := named_layer("a", 11, 3.0)
	var b := named_layer("b", 12, 2.0)
	var c := named_layer("c", 13, 1.0)
	a.tile_size = 48.0
	b.tile_size = 20.0
	a.view_distance = 90.0
	b.view_distance = 90.0
	a.spacing = {"b": 2.5}
	b.spacing = {"a": 1.0, "c": 1.25}
	c.spacing = {"a": 1.75}
	b.density = 0.15 # So sparse that all find room in any order.
	c.density = 0.05
	var alone: Array[Dictionary] = []
	for layer: ScatterLayer in [a, b, c]:
		var scatter := make_scatter([layer], ScatterTerrainFlat.new(), make_viewer())
		await settle(scatter)
		alone.push_back(instances(scatter, 0))
		scatter.free()
	for order: Array in [[a, b, c], [c, b, a]]:
		var list: Array[ScatterLayer] = []
		list.assign(order)
		var scatter := make_scatter(list, ScatterTerrainFlat.new(), make_viewer())
		await settle(scatter)
		var at := [order.find(a), order.find(b), order.find(c)]
		for index in 3:
			var stands := instances(scatter, at[index])
			check_equal(stands == alone[index], at[index] == 0, "layer %d of %s is complete" % [index, order])
			for id in stands:
				check(alone[index].has(id), "who gives way goes, and nobody comes")
		check(gap(scatter, at[1], at[0]) >= 2.5 - FLOATS, "the larger of two distances: %f" % gap(scatter, at[1], at[0]))
		check(gap(scatter, at[2], at[1]) >= 1.25 - FLOATS, "one names the other: %f" % gap(scatter, at[2], at[1]))
		check(gap(scatter, at[2], at[0]) >= 1.75 - FLOATS, "the other way round: %f" % gap(scatter, at[2], at[0]))
		check(gap(scatter, at[2], at[0]) < 1.8, "and no more than that: %f" % gap(scatter, at[2], at[0]))
		check_equal(scatter.get_problems(), PackedStringArray(), "problems")
		scatter.free()


func test_proximity() -> void:
	var scatter := make_scatter(make_forest(), ScatterTerrainFlat.new(), make_viewer())
	var fern := scatter.layers[FERN]
	fern.spacing = {}
	fern.edge_feather = 0.0
	fern.proximity_layer = "oak"
	fern.proximity_distance = 4.0
	scatter.layers[OAK].density = 0.2
	scatter.layers[OAK].view_distance = 90.0
	await settle(scatter)
	var oaks := places(scatter, OAK)
	var counts := [0, 0]
	for place in places(scatter, FERN):
		var distance := nearest(place, oaks)
		check(distance < 4.0 + FLOATS or place.length() > 60.0, "a fern in the open, %f m from an oak" % distance)
		counts[int(distance > 2.0)] += 1
	# The inner part is a third of the outer one, and a straight line is 3/4 against 1/3 on average.
	check(counts[0] > 50 and counts[1] > 50, "ferns near and farther off: %s" % [counts])
	check(3 * counts[0] > counts[1], "they thin out: %s" % [counts])
	scatter.layers = [fern, scatter.layers[OAK]]
	check("before" in "".join(scatter.get_problems()), "proximity to a later layer is warned of")
	await settle(scatter)
	check(places(scatter, 0).size() > 1000, "and has no effect")


func test_names() -> void:
	var scatter := make_scatter(make_forest(), ScatterTerrainFlat.new(), make_viewer())
	await settle(scatter)
	check_equal(scatter.get_problems(), PackedStringArray(), "problems of a good forest")
	var spaced := digests(scatter, FERN)
	scatter.layers[OAK].resource_name = "elm"
	check("\"oak\"" in "".join(scatter.get_problems()), "a name that no layer has")
	await settle(scatter)
	check(digests(scatter, FERN) != spaced, "nobody to give way to")
	scatter.layers[OAK].resource_name = "oak"
	await settle(scatter)
	check(digests(scatter, FERN) == spaced, "the oaks are back")
	scatter.layers[FERN].resource_name = "oak"
	check("same name" in "".join(scatter.get_problems()), "two layers of one name")
	await settle(scatter)
	check(digests(scatter, FERN) == spaced, "the first one is meant")
	scatter.layers[FERN].resource_name = "fern"
	scatter.layers = [null, scatter.layers[FERN]]
	await settle(scatter)
	check(digests(scatter, FERN) != spaced, "a layer that is not there")


func test_refused_layers_keep_their_last_good_state() -> void:
	var scatter := make_scatter(make_forest(), ScatterTerrainFlat.new(), make_viewer())
	await settle(scatter)
	var before := [digests(scatter, OAK), digests(scatter, FERN)]
	scatter.layers[OAK].min_slope_degrees = 50.0
	scatter.layers[OAK].max_slope_degrees = 40.0
	await settle(scatter)
	check_error(["layers[0]", "max_slope_degrees", "40"], "a minimum above its maximum")
	var mask := scatter.layers[FERN].mask
	var area := mask.paint(Vector2(10, 10), 4.0, 1.0, 1.0, ScatterMask.MODE_ERASE)
	await settle(scatter)
	check_no_error("the same again")
	check(digests(scatter, OAK) == before[OAK], "oaks stay")
	check(digests(scatter, FERN) != before[FERN], "ferns may be edited")
	check(gap(scatter, FERN, OAK) >= SPACING - FLOATS, "and give way as before")
	mask.paint(area.get_center(), 20.0, 1.0, 1.0, ScatterMask.MODE_PAINT)
	await settle(scatter)
	check(digests(scatter, FERN) == before[FERN], "painted over")
	scatter.layers[OAK].max_slope_degrees = 90.0
	scatter.layers[OAK].min_slope_degrees = 0.0
	scatter.layers[OAK].radius = 0.5
	scatter.layers[FERN].spacing = {"oak": 1000.0}
	scatter.layers[FERN].tile_size = 50.0
	await settle(scatter)
	check_error(["layers[1]", "spacing", "points"], "oaks in a thousand metres around each tile")
	check(digests(scatter, FERN) == before[FERN], "ferns stay")
	scatter.layers[OAK].radius = 4.0
	scatter.layers[FERN].spacing = {"oak": SPACING}
	scatter.layers[FERN].tile_size = 32.0
	await settle(scatter)
	check_no_error("all is well again")
	check([digests(scatter, OAK), digests(scatter, FERN)] == before, "all is as before")


func test_other_tiles_hold_the_same() -> void:
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
			check(after.has(id) and after[id].origin.distance_to(before[id].origin) < FLOATS, "the same fern")
	check(both > 500, "%d ferns in both" % both)
	scatter.layers[FERN].tile_size = 32.0
	await settle(scatter)
	await frames(5)
	check(digests(scatter, FERN) == digest, "to the bit in tiles as before")
	root.remove_child(scatter)
	root.add_child(scatter)
	await settle(scatter)
	check(digests(scatter, FERN) == digest, "and after leaving the tree")


func test_ground_everywhere() -> void:
	var mound := Mound.new()
	var scatter := make_scatter(make_forest(), mound, make_viewer())
	var shown := Shown.new(scatter)
	await settle(scatter)
	var tiles := scatter.get_shown_tiles(FERN).size()
	for rect: Rect2 in [Rect2(), Rect2(5, 5, 0, 0), Rect2(0, 0, NAN, 1), Rect2(0, 0, INF, 1)]:
		shown.take()
		mound.terrain_changed.emit(rect)
		await settle(scatter)
		check_equal(shown.take()[FERN].size(), tiles, "tiles after %s" % rect)
	mound.terrain_changed.emit(Rect2(5000, 5000, 10, 10))
	await settle(scatter)
	check(shown.take()[FERN].is_empty(), "far away")
	scatter.terrain = ScatterTerrainFlat.new()
	await settle(scatter)
	shown.take()
	mound.terrain_changed.emit(Rect2(0, 0, 10, 10))
	await settle(scatter)
	check(shown.take()[FERN].is_empty(), "a terrain that is no longer used")


func test_build_rect() -> void:
	for ground: Mound in [Mound.new(), MainMound.new()]:
		var scatter := make_scatter(make_forest(), ground, make_viewer())
		scatter.layers[FERN].meshes = [BoxMesh.new(), null, SphereMesh.new()]
		scatter.add_child(make_clearing())
		var first := scatter.build_rect(FERN, Rect2(32, 0, 32, 32))
		await settle(scatter)
		var tile := Vector2i(1, 0)
		var built := scatter.build_rect(FERN, tile_rect(scatter, FERN, tile))
		check_equal(built["origin"], scatter.get_tile_origin(FERN, tile), "origin")
		check(built["buffers"] == scatter.get_tile_buffers(FERN, tile), "buffers are those of the tile")
		check(built["ids"] == scatter.get_tile_ids(FERN, tile), "ids are those of the tile")
		for index in 3:
			check((built["meshes"] as Array[Mesh])[index] == scatter.layers[FERN].meshes[index], "mesh %d" % index)
		check(first["ids"] == built["ids"], "asked before the first frame")
		check((built["ids"] as Array)[0].size() > 10, "%d instances" % (built["ids"] as Array)[0].size())
		check(built["buffers"] is Array[PackedFloat32Array] and built["ids"] is Array[PackedInt64Array], "typed arrays")
		check((scatter.build_rect(OAK, Rect2(9000, -9000, 64, 48))["ids"] as Array)[0].size() > 20, "far from any viewer")
		scatter.free()


func test_build_rect_refuses() -> void:
	var layers: Array[ScatterLayer] = [make_layer(), null]
	var scatter := make_scatter(layers, ScatterTerrainFlat.new(), make_viewer())
	for rect: Rect2 in [Rect2(0, 0, -5, 5), Rect2(0, 0, NAN, 5), Rect2(0, 0, 1e6, 1e6)]:
		check_equal(scatter.build_rect(0, rect)["buffers"].size(), 0, "buffers in %s" % rect)
		check_error(["TerrainScatter3D.rect"], "a bad rectangle")
	for layer: int in [-1, 1, 2, 70000]:
		check_equal(scatter.build_rect(layer, Rect2(0, 0, 5, 5))["ids"].size(), 0, "ids of layer %d" % layer)
		check_error(["TerrainScatter3D.layer", str(layer)], "no such layer")
	check_equal(scatter.build_rect(0, Rect2(3, 3, 0, 5))["ids"].size(), 1, "meshes in an empty rectangle")
	check_no_error("an empty rectangle")
	scatter.terrain = null
	check(scatter.build_rect(0, Rect2(0, 0, 5, 5))["meshes"].is_empty(), "no ground")
	check_error(["terrain", "missing"], "no ground")
	await frames(1)
