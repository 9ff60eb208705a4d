extends "planet_harness.gd"
## Tests mask textures on a planet: an image covers the whole planet as a texture covers a SphereMesh.

const COLUMNS := 8
const ROWS := 4


## Returns an image with a black and a white pixel in turns, like a chessboard.
func make_texture() -> ImageTexture:
	var image := Image.create_empty(COLUMNS, ROWS, false, Image.FORMAT_L8)
	for row in ROWS:
		for column in COLUMNS:
			image.set_pixel(column, row, Color.WHITE if (row + column) % 2 == 0 else Color.BLACK)
	return ImageTexture.create_from_image(image)


## Returns the position on the image in a direction, in pixels.
func on_image(up: Vector3) -> Vector2:
	return Vector2(fposmod(atan2(up.x, up.z) / TAU, 1.0) * COLUMNS, acos(up.y) / PI * ROWS)


## Returns the density in a direction: the image, interpolated between the centers of pixels.
func density_of(image: Image, up: Vector3) -> float:
	var at := on_image(up) - Vector2(0.5, 0.5)
	var corner := Vector2i(at.floor())
	var part := at - at.floor()
	var pixel := func(x: int, y: int) -> float: return image.get_pixel(posmod(corner.x + x, COLUMNS), clampi(corner.y + y, 0, ROWS - 1)).r
	return lerpf(lerpf(pixel.call(0, 0), pixel.call(1, 0), part.x), lerpf(pixel.call(0, 1), pixel.call(1, 1), part.x), part.y)


func make_masked() -> ScatterLayer:
	var layer := make_grower(1.5)
	layer.tile_size = 32.0
	layer.view_distance = 300.0
	layer.mask_texture = make_texture()
	layer.mask_texture_rect = Rect2(0.0, 0.0, 7.0, 3.0) # Has no effect on a planet.
	return layer


## Counts the instances in the middle of each pixel, and compares the counts of black and white pixels. Also checks the mean density.
func check_pixels(scatter: TerrainScatter3D, frame: Transform3D, context: String) -> void:
	var counts := [0, 0]
	var all := instances(scatter, 0)
	for at: Transform3D in all.values():
		var up := (frame.affine_inverse() * at.origin).normalized()
		var place := on_image(up)
		if absf(fposmod(place.x, 1.0) - 0.5) < 0.2 and absf(fposmod(place.y, 1.0) - 0.5) < 0.2:
			counts[(int(place.x) + int(place.y)) % 2] += 1
	var expected := 0.5 * 0.547 / (PI * 0.25 * 1.5 * 1.5) * 4.0 * PI * 1e4
	check(absf(all.size() - expected) < 0.03 * expected, "%s: %d instances, expected about %d" % [context, all.size(), expected])
	check(counts[0] > 1000 and counts[1] < 0.25 * counts[0], "%s: instances in white and in black pixels: %s" % [context, counts])


func test_an_image_covers_the_planet() -> void:
	var arrays := (put_planet(100.0, Vector3.ZERO, 128).mesh as SphereMesh).get_mesh_arrays()
	var off := 0.0
	for index: int in arrays[Mesh.ARRAY_VERTEX].size():
		var up: Vector3 = arrays[Mesh.ARRAY_VERTEX][index].normalized()
		var uv: Vector2 = arrays[Mesh.ARRAY_TEX_UV][index]
		if absf(up.y) < 0.999 and uv.x < 0.999: # The last column is the first one again, and the poles have many columns.
			off = maxf(off, on_image(up).distance_to(uv * Vector2(COLUMNS, ROWS)))
	check(off < 1e-3, "a SphereMesh has the same texture coordinates: %f pixels off" % off)
	var layer := make_masked()
	viewer = make_viewer()
	var scatter := make_scatter([layer], make_ground(100.0), viewer)
	await settle(scatter)
	check_pixels(scatter, Transform3D.IDENTITY, "at the origin")
	var before := instances(scatter, 0)
	layer.mask_texture_rect = Rect2(50.0, 0.0, 100.0, 100.0)
	layer.mask_texture_edge = ScatterLayer.MASK_EDGE_REPEAT
	await settle(scatter)
	check_equal(instances(scatter, 0) == before, true, "the rectangle and the edge have no effect")
	layer.mask_texture = null
	await settle(scatter)
	check(instances(scatter, 0).size() > 1.9 * before.size(), "without the image, %d instead of %d instances" % [instances(scatter, 0).size(), before.size()])


## An image turns and moves with a planet.
func test_an_image_on_a_moved_planet() -> void:
	var planet := Node3D.new()
	root.add_child(planet)
	put_planet(100.0, Vector3(10.0, 20.0, 30.0), 128).reparent(planet, false)
	viewer = make_viewer()
	var scatter := make_scatter([make_masked()], make_ground(100.0, Vector3(10.0, 20.0, 30.0)), viewer)
	scatter.reparent(planet, false)
	scatter.local_coords = true
	scatter.viewers = [scatter.get_path_to(viewer)]
	planet.transform = Transform3D(Basis(Vector3(1.0, 2.0, 3.0).normalized(), 1.0), Vector3(300.0, -20.0, 50.0))
	viewer.global_position = planet.transform * Vector3(10.0, 20.0, 30.0)
	await settle(scatter)
	var found := scatter.query_sphere(viewer.global_position, 120.0)
	var image := make_texture().get_image()
	var low := 0
	for index in found.size():
		var up := (planet.transform.affine_inverse() * found.get_transform(index).origin - Vector3(10.0, 20.0, 30.0)).normalized()
		low += int(density_of(image, up) < 0.25)
	check(found.size() > 10000 and low < 0.1 * found.size(), "%d of %d instances are where the image is dark" % [low, found.size()])


## Explanations and the colors on the ground use the same densities as the instances.
func test_explanations_and_colors() -> void:
	put_planet(100.0, Vector3.ZERO, 128)
	var layer := make_masked()
	viewer = make_viewer()
	var scatter := make_scatter([layer], make_ground(100.0), viewer)
	await settle(scatter)
	var image := make_texture().get_image()
	for index in 60:
		var up := Vector3(sin(1.7 * index), cos(0.9 * index), sin(2.3 * index + 1.0)).normalized()
		var explanation := scatter.explain_position(scatter._hit_surface(up * 150.0, up * 50.0)[0], layer)[0]
		var expected := density_of(image, up)
		check(absf(explanation.density - expected) < 0.02, "toward %s: a density of %f, expected %f" % [up, explanation.density, expected])
		var rules := range(explanation.get_rule_count()).map(func(rule: int) -> StringName: return explanation.get_rule_name(rule))
		check(rules.has(&"mask_texture"), "toward %s: the rules are %s" % [up, rules])
	var size := Vector2i(16, 16)
	var rect := Rect2(-30.0, -30.0, 60.0, 60.0)
	var densities := scatter.get_density_map(layer, rect, size)
	for index in densities.size():
		@warning_ignore("integer_division")
		var place := rect.position + rect.size * (Vector2(index % size.x, index / size.x) + Vector2(0.5, 0.5)) / Vector2(size)
		var up := scatter._hit_surface(Vector3(place.x, 150.0, place.y), Vector3(place.x, 50.0, place.y))[0].normalized()
		check(absf(densities[index] - density_of(image, up)) < 0.02, "the color at %s: %f, expected %f" % [place, densities[index], density_of(image, up)])


## An expression of a layer's density uses a channel of the image on all sides of the planet.
func test_an_expression_uses_the_image() -> void:
	put_planet(100.0, Vector3.ZERO, 128)
	var layer := make_masked()
	layer.mask_texture_channel = ScatterLayer.MASK_CHANNEL_NONE
	layer.density_expression = "mask_red"
	viewer = make_viewer()
	var scatter := make_scatter([layer], make_ground(100.0), viewer)
	await settle(scatter)
	check_pixels(scatter, Transform3D.IDENTITY, "with an expression")
	var before := instances(scatter, 0)
	layer.density_expression = "mask_red * 1"
	await settle(scatter)
	check_equal(instances(scatter, 0) == before, true, "an expression with the same value")
	layer.density_expression = "1 - mask_red"
	await settle(scatter)
	check(instances(scatter, 0).keys().all(func(id: int) -> bool: return not before.has(id) or density_of(layer.mask_texture.get_image(), before[id].origin.normalized()) < 0.999), "the opposite expression")
	check(absf(instances(scatter, 0).size() - before.size()) < 0.06 * before.size(), "%d instances, then %d with the opposite expression" % [before.size(), instances(scatter, 0).size()])
