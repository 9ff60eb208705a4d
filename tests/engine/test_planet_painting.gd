extends "planet_harness.gd"
## Tests painted masks and biome maps on a planet: both cover all of its sides.

const RADIUS := 100.0
## Directions to the poles, to the seam of images, to edges and corners between the faces of a mask, and others.
const SIDES: Array[Vector3] = [
	Vector3(0.0, 1.0, 0.0), Vector3(0.0, -1.0, 0.0), Vector3(0.0, 0.1, 1.0), Vector3(1.0, -1.0, 0.0), Vector3(-1.0, -1.0, 1.0), Vector3(0.3, -0.5, -0.9),
]


func make_painted(center := Vector3.ZERO) -> TerrainScatter3D:
	put_planet(RADIUS, center, 128)
	var layer := make_grower(1.5)
	layer.tile_size = 32.0
	layer.view_distance = 300.0
	layer.mask = ScatterMask.new()
	layer.mask.background = 0.0
	viewer = make_viewer()
	return make_scatter([layer], make_ground(RADIUS, center), viewer)


## Returns the positions of all instances relative to the planet's center.
func positions_of(scatter: TerrainScatter3D, index := 0) -> Array:
	return instances(scatter, index).values().map(func(at: Transform3D) -> Vector3: return at.origin)


func test_dabs_on_all_sides() -> void:
	var scatter := make_painted()
	var mask: ScatterMask = scatter.layers[0].mask
	await settle(scatter)
	check_equal(positions_of(scatter).size(), 0, "no instances before painting")
	var expected := 0
	for side in SIDES:
		var up := side.normalized()
		check(mask.paint_on_planet(RADIUS, side, 12.0, 1.0, 1.0), "painted toward %s" % side)
		await settle(scatter)
		var near := positions_of(scatter).filter(func(at: Vector3) -> bool: return at.distance_to(up * RADIUS) < 13.5) # Pixels are 1 m wide.
		# 0.547 of the ground is covered by disks with a radius of 0.75 m.
		var full := 0.547 * 12.0 * 12.0 / (0.75 * 0.75)
		check(absf(near.size() - full) < 0.15 * full, "toward %s: %d instances, expected about %d" % [side, near.size(), full])
		var mean: Vector3 = near.reduce(func(sum: Vector3, at: Vector3) -> Vector3: return sum + at, Vector3.ZERO) / near.size()
		check(mean.angle_to(up) * RADIUS < 1.0, "toward %s: the middle of the instances is %f m off" % [side, mean.angle_to(up) * RADIUS])
		expected += near.size()
		check_equal(positions_of(scatter).size(), expected, "toward %s: no other instances" % side)


func test_undo_and_erase() -> void:
	var scatter := make_painted()
	var mask: ScatterMask = scatter.layers[0].mask
	for side in SIDES:
		mask.paint_on_planet(RADIUS, side, 15.0)
	await settle(scatter)
	var before := instances(scatter, 0)
	var data := mask.data
	for side in SIDES:
		var rects := mask.get_pixel_rects_on_planet(RADIUS, side, 9.0)
		check(rects.size() > 0 and rects.size() <= 3, "toward %s: pixels of %d faces" % [side, rects.size()])
		var pixels := rects.map(func(rect: Rect2i) -> PackedByteArray: return mask.get_pixels(rect))
		var areas: Array[Rect2] = []
		mask.area_changed.connect(areas.append, CONNECT_ONE_SHOT)
		mask.paint_on_planet(RADIUS, side, 9.0, 1.0, 1.0, ScatterMask.MODE_ERASE)
		check_equal(areas, [Rect2()] as Array[Rect2], "toward %s: the signal's rectangle" % side)
		await settle(scatter)
		var left := instances(scatter, 0)
		var erased := before.keys().filter(func(id: int) -> bool: return not left.has(id))
		check(erased.size() > 50 and erased.all(func(id: int) -> bool: return before[id].origin.distance_to(side.normalized() * RADIUS) < 10.0), "toward %s: %d erased" % [side, erased.size()])
		for index in rects.size():
			mask.set_pixels(rects[index], pixels[index])
		check(mask.data == data, "toward %s: the pixels are restored" % side)
		await settle(scatter)
		check(instances(scatter, 0) == before, "toward %s: all instances are back" % side)
	mask.data = data
	check_equal(mask.sample_on_planet(RADIUS, SIDES[1]), 1.0, "a loaded mask has the same densities")


## A mask turns and moves with a planet, and _to_planet returns the positions to paint.
func test_a_moved_planet() -> void:
	var center := Vector3(10.0, 20.0, 30.0)
	var planet := Node3D.new()
	root.add_child(planet)
	var scatter := make_painted(center)
	get_nodes_in_group(&"ground")[0].reparent(planet, false)
	scatter.reparent(planet, false)
	scatter.local_coords = true
	scatter.viewers = [scatter.get_path_to(viewer)]
	planet.transform = Transform3D(Basis(Vector3(1.0, 2.0, 3.0).normalized(), 1.0), Vector3(300.0, -20.0, 50.0))
	viewer.global_position = planet.transform * center
	await settle(scatter)
	for side in SIDES:
		var at := planet.transform * (center + side.normalized() * RADIUS)
		var place := scatter._to_planet(PackedVector3Array([at]))[0]
		check(place.distance_to(side.normalized() * RADIUS) < 1e-3, "toward %s: the place is %s" % [side, place])
		scatter.layers[0].mask.paint_on_planet(RADIUS, place, 8.0, 1.0, 1.0)
		await settle(scatter)
		check(scatter.query_sphere(at, 8.0).size() > 50, "toward %s: %d instances" % [side, scatter.query_sphere(at, 8.0).size()])


func make_biomes() -> ScatterBiomeMap:
	var map := ScatterBiomeMap.new()
	var image := Image.create_empty(64, 32, false, Image.FORMAT_L8)
	for row in 32:
		for column in 64:
			@warning_ignore("integer_division")
			image.set_pixel(column, row, Color8((column / 8 + row / 8) % 2, 0, 0))
	for index in 2:
		var biome := ScatterBiome.new()
		var layer := make_grower(2.0)
		layer.tile_size = 32.0
		layer.view_distance = 300.0
		biome.layers = [layer] as Array[ScatterLayer]
		map.biomes.append(biome)
	map.map_mode = ScatterBiomeMap.MAP_MODE_INDICES
	map.map_image = image
	map.map_rect = Rect2(5000.0, 0.0, 1.0, 1.0) # Has no effect on a planet.
	map.map_edge = ScatterBiomeMap.MAP_EDGE_NOTHING
	map.border_width = 0.0
	map.border_noise = 3.0
	map.border_noise_size = 10.0
	return map


## Returns the positions of the instances of a biome's layer by ID.
func grown(scatter: TerrainScatter3D, biome: ScatterBiome) -> Dictionary[int, Vector3]:
	var result: Dictionary[int, Vector3] = {}
	var found := scatter.query_sphere(Vector3.ZERO, 1.5 * RADIUS, biome.layers)
	for index in found.size():
		result[found.get_id(index)] = found.get_transform(index).origin
	return result


func test_biomes_cover_the_planet() -> void:
	put_planet(RADIUS, Vector3.ZERO, 128)
	viewer = make_viewer()
	var scatter := make_scatter([], make_ground(RADIUS), viewer)
	var map := make_biomes()
	scatter.biomes = map
	await settle(scatter)
	var total := 0
	for index in 2:
		var found := grown(scatter, map.biomes[index]).values()
		total += found.size()
		check(found.size() > 5000, "biome %d has %d instances" % [index, found.size()])
		check(found.any(func(at: Vector3) -> bool: return at.y < -99.0), "biome %d reaches the pole toward -y" % index)
		var wrong := found.filter(func(at: Vector3) -> bool: return map.get_biome_on_planet(RADIUS, at) != map.biomes[index])
		check(wrong.is_empty(), "biome %d: %d instances are in the other biome" % [index, wrong.size()])
	var expected := 0.547 * 4.0 * RADIUS * RADIUS
	check(absf(total - expected) < 0.04 * expected, "%d instances, expected about %d" % [total, expected])
	var image: Image = map.map_image
	var before := [grown(scatter, map.biomes[0]), grown(scatter, map.biomes[1])]
	var runs := map._planet_disc(RADIUS, Vector3(0.2, -1.0, 0.1), 12.0, image.get_size())
	for run in range(0, runs.size(), 3):
		image.fill_rect(Rect2i(runs[run], runs[run + 1], runs[run + 2], 1), Color8(1, 0, 0))
	map.map_image = image
	await settle(scatter)
	var after := [grown(scatter, map.biomes[0]), grown(scatter, map.biomes[1])]
	check(not after[0].values().any(func(at: Vector3) -> bool: return at.distance_to(Vector3(0.2, -1.0, 0.1).normalized() * RADIUS) < 5.0), "the painted disc has no instances of biome 0")
	check(after[0].size() < before[0].size() and after[1].size() > before[1].size(), "biome 1 has grown")
	var moved := range(2).filter(func(index: int) -> bool:
		return before[index].keys().any(func(id: int) -> bool: return after[index].has(id) and after[index][id] != before[index][id]))
	check(moved.is_empty(), "no instance moves")
	check(map.get_weights_on_planet(RADIUS, Vector3(0.2, -1.0, 0.1)) == PackedFloat32Array([0.0, 1.0]), "the weights there")


## Explanations and the values for colors on the ground use the densities of the side that they show.
func test_explanations_and_colors() -> void:
	var scatter := make_painted()
	var layer := scatter.layers[0]
	for index in 150:
		layer.mask.paint_on_planet(RADIUS, Vector3(sin(1.7 * index), cos(0.9 * index), sin(2.3 * index + 1.0)), 25.0, 0.6)
	await settle(scatter)
	for side in SIDES:
		var up := side.normalized()
		var grid := PackedVector2Array()
		for index in 49:
			@warning_ignore("integer_division")
			grid.append(Vector2(index % 7 - 3, index / 7 - 3) * 6.0)
		var ground := scatter._planet_ground(up * RADIUS, grid)
		var densities := scatter._densities_at(layer, ground)
		var slopes := scatter._slopes_at(ground)
		check_equal([ground.size(), densities.size(), slopes.size()], [49, 49, 49], "toward %s: the numbers of values" % side)
		check(ground[24].distance_to(up * RADIUS) < 0.5, "toward %s: the middle is %s" % [side, ground[24]])
		var values := {}
		for index in 49:
			check(absf(ground[index].length() - RADIUS) < 0.5, "toward %s: on the ground" % side)
			check(slopes[index] < 3.0, "toward %s: a slope of %f" % [side, slopes[index]])
			var density := layer.mask.sample_on_planet(RADIUS, ground[index])
			check(absf(densities[index] - density) < 1e-3, "toward %s: %f, expected %f" % [side, densities[index], density])
			values[snappedf(density, 0.01)] = true
		check(values.size() > 3, "toward %s: different densities: %s" % [side, values.keys()])
		var explanation := scatter.explain_position(ground[10], layer)[0]
		check(absf(explanation.density - densities[10]) < 1e-3, "toward %s: the explanation: %f, expected %f" % [side, explanation.density, densities[10]])
	var size := Vector2i(8, 8)
	var map := scatter.get_density_map(layer, Rect2(-40.0, -40.0, 80.0, 80.0), size)
	for index in map.size():
		@warning_ignore("integer_division")
		var at := Vector2(index % 8, index / 8) * 10.0 - Vector2(35.0, 35.0)
		var top := scatter._hit_surface(Vector3(at.x, 150.0, at.y), Vector3(at.x, 0.0, at.y))[0]
		check(absf(map[index] - layer.mask.sample_on_planet(RADIUS, top)) < 1e-3, "the map from above at %s" % at)


func test_bad_input() -> void:
	var mask := ScatterMask.new()
	for bad: Array in [
		[0.0, Vector3.UP, 1.0, "planet_radius"], [INF, Vector3.UP, 1.0, "planet_radius"], [1e7, Vector3.UP, 1.0, "planet_radius"],
		[100.0, Vector3.ZERO, 1.0, "from_center"], [100.0, Vector3(NAN, 0.0, 0.0), 1.0, "from_center"], [100.0, Vector3.UP, 0.0, "radius"],
	]:
		check(not mask.paint_on_planet(bad[0], bad[1], bad[2]), "painted: %s" % [bad])
		check_error(["ScatterMask", bad[3]], "paint_on_planet: %s" % [bad])
		check_equal(mask.get_pixel_rects_on_planet(bad[0], bad[1], bad[2]).size(), 0, "pixels: %s" % [bad])
		check_error(["ScatterMask", bad[3]], "get_pixel_rects_on_planet: %s" % [bad])
		if bad[3] != "radius":
			check_equal(mask.sample_on_planet(bad[0], bad[1]), 0.0, "density: %s" % [bad])
			check_error(["ScatterMask", bad[3]], "sample_on_planet: %s" % [bad])
	check_equal(mask.data.size(), 0, "nothing is painted")
	var map := make_biomes()
	check(map.get_biome_on_planet(-1.0, Vector3.UP) == null, "no biome without a planet")
	check_error(["ScatterBiomeMap", "planet_radius"], "get_biome_on_planet")
	check_equal(map.get_weights_on_planet(NAN, Vector3.UP).size(), 0, "no weights without a planet")
	check_error(["ScatterBiomeMap", "planet_radius"], "get_weights_on_planet")
	for direction: Vector3 in [Vector3.ZERO, Vector3(INF, 0.0, 0.0), Vector3(0.0, NAN, 0.0)]:
		check(map.get_biome_on_planet(100.0, direction) == null, "no biome toward %s" % direction)
		check_error(["ScatterBiomeMap", "from_center"], "get_biome_on_planet toward %s" % direction)
		check_equal(map.get_weights_on_planet(100.0, direction).size(), 0, "no weights toward %s" % direction)
		check_error(["ScatterBiomeMap", "from_center"], "get_weights_on_planet toward %s" % direction)
