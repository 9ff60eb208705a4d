extends "terrain_harness.gd"
## Tests ground from images and raw files of every bit depth, with holes and textures.

func make_heights(format: Image.Format, size := Vector2i(5, 4)) -> Image:
	var image := Image.create_empty(size.x, size.y, false, format)
	for x in size.x:
		for y in size.y:
			image.set_pixel(x, y, Color((x + 0.5 * y) / 8.0, 0.3, 0.6, 1.0))
	return image


func test_heightmap_formats() -> void:
	for format: Image.Format in [Image.FORMAT_L8, Image.FORMAT_R8, Image.FORMAT_RGB8, Image.FORMAT_RGBA8,
			Image.FORMAT_R16, Image.FORMAT_RGBA16, Image.FORMAT_RH, Image.FORMAT_RGBAH, Image.FORMAT_RF,
			Image.FORMAT_RGBF, Image.FORMAT_RGBAF]:
		var terrain := ScatterGroundHeightmap.new()
		terrain.rect = Rect2(-10.0, 5.0, 40.0, 30.0)
		terrain.min_height = 100.0
		terrain.max_height = 900.0
		terrain.image = make_heights(format)
		var coarse := 4.0 if format in [Image.FORMAT_L8, Image.FORMAT_R8, Image.FORMAT_RGB8, Image.FORMAT_RGBA8] else \
				0.5 if format in [Image.FORMAT_RH, Image.FORMAT_RGBAH] else 0.02
		for x in 5:
			for y in 4:
				if format == Image.FORMAT_L8:
					continue # Skip luminance, which combines all channels.
				var height := terrain.get_height(Vector3(-10.0 + 10.0 * x, 0.0, 5.0 + 10.0 * y))
				var expected := 100.0 + 100.0 * (x + 0.5 * y)
				check(absf(height - expected) < coarse, "format %d, sample %d, %d: %f" % [format, x, y, height])
		check(is_finite(terrain.get_height(Vector3(0.0, 0.0, 10.0))), "format %d has ground" % format)
		check_no_error("format %d" % format)


func test_heightmap_in_meters_with_holes() -> void:
	var image := Image.create_empty(33, 33, false, Image.FORMAT_RF)
	for x in 33:
		for y in 33:
			image.set_pixel(x, y, Color(NAN if x > 20 and x < 24 else -250.0 + 1.25 * x, 0.0, 0.0))
	var terrain := ScatterGroundHeightmap.new()
	terrain.rect = Rect2(-64.0, -64.0, 128.0, 128.0)
	terrain.heights_in_meters = true
	terrain.image = image
	check_equal(terrain.get_height(Vector3(-64.0, 0.0, 3.0)), -250.0, "height")
	check(is_nan(terrain.get_height(Vector3(24.0, 0.0, 0.0))), "a hole")
	var scatter := make_scatter([make_layer()], terrain, make_viewer())
	await settle(scatter)
	var stand := all_transforms(scatter)
	check(stand.size() > 1000, "instances: %d" % stand.size())
	var in_hole := stand.filter(func(one: Transform3D) -> bool: return one.origin.x > 16.0 and one.origin.x < 32.0)
	check_equal(in_hole.size(), 0, "instances in the hole")
	var before := digests(scatter, 0)
	for value: float in [INF, 2e6]:
		var bad := image.duplicate() as Image
		bad.set_pixel(0, 0, Color(value, 0.0, 0.0))
		terrain.image = bad
		await settle(scatter)
		check_error(["ScatterGroundHeightmap."], "a height of %s" % value)
		check_equal(digests(scatter, 0), before, "the instances do not change")
	terrain.image = ImageTexture.create_from_image(image)
	await settle(scatter)
	check_equal(digests(scatter, 0), before, "tiles with a texture instead of an image")
	terrain.heights_in_meters = false
	await settle(scatter)
	check_error(["ScatterGroundHeightmap.image", "-250"], "meters read as 0 to 1")


func test_heightmap_exr() -> void:
	var image := make_heights(Image.FORMAT_RF, Vector2i(9, 7))
	var path := "user://thicket_test.exr"
	check_equal(image.save_exr(path, true), OK, "saved")
	var terrain := ScatterGroundHeightmap.new()
	terrain.rect = Rect2(0.0, 0.0, 8.0, 6.0)
	terrain.heights_in_meters = true
	terrain.image = Image.load_from_file(path)
	for x in 9:
		for y in 7:
			check(absf(terrain.get_height(Vector3(x, 0.0, y)) - (x + 0.5 * y) / 8.0) < 1e-6, "sample %d, %d" % [x, y])
	DirAccess.remove_absolute(path)


func test_heightmap_raw_depths() -> void:
	var path := "user://thicket_test.raw"
	for depth: int in [1, 2, 4]:
		var bytes := PackedByteArray()
		bytes.resize(6 * depth)
		for post in 6:
			match depth:
				1: bytes.encode_u8(post, post * 51)
				2: bytes.encode_u16(2 * post, post * 13107)
				4: bytes.encode_float(4 * post, post / 5.0)
		FileAccess.open(path, FileAccess.WRITE).store_buffer(bytes)
		var terrain := ScatterGroundHeightmap.new()
		terrain.heightmap_path = path
		terrain.post_count = Vector2i(3, 2)
		terrain.rect = Rect2(0.0, 0.0, 2.0, 1.0)
		terrain.max_height = 50.0
		for post in 6:
			var height := terrain.get_height(Vector3(post % 3, 0.0, post / 3))
			check(absf(height - 10.0 * post) < 1e-4, "%d bytes, sample %d: %f" % [depth, post, height])
	DirAccess.remove_absolute(path)
	var none := ScatterGroundHeightmap.new()
	none.post_count = Vector2i(3, 4)
	none.post_count = Vector2i.ZERO
	check_no_error("a post_count of zero")
	check_equal(none.post_count, Vector2i.ZERO, "post_count")
	none.post_count = Vector2i(0, 5)
	check_error(["ScatterGroundHeightmap.post_count"], "a post_count with one zero")


func test_heightmap_weights() -> void:
	var terrain := ScatterGroundHeightmap.new()
	terrain.rect = Rect2(-64.0, -64.0, 128.0, 128.0)
	terrain.image = make_heights(Image.FORMAT_RF)
	var image := Image.create_empty(2, 1, false, Image.FORMAT_RGB8)
	image.set_pixel(0, 0, Color(1.0, 0.0, 0.0))
	image.set_pixel(1, 0, Color(0.0, 0.0, 1.0))
	terrain.weight_image = image
	var counts: Array[int] = []
	for textures: Array in [[], [0], [2], [0, 2], [1], [3]]:
		var layer := make_layer()
		layer.ground_textures = PackedInt32Array(textures)
		var scatter := make_scatter([layer], terrain, make_viewer())
		await settle(scatter)
		counts.push_back(all_transforms(scatter).size())
		if textures == [0]:
			var left := all_transforms(scatter).filter(func(one: Transform3D) -> bool: return one.origin.x < 0.0).size()
			check(left > 0.7 * counts[1], "texture 0 is on the left: %d of %d" % [left, counts[1]])
		scatter.free()
	check_equal(counts[3], counts[0], "instances on both textures together")
	for half: int in counts.slice(1, 3):
		check(absf(half - 0.5 * counts[0]) < 0.1 * counts[0], "each texture covers half of the ground: %s" % [counts])
	check_equal(counts.slice(4), [0, 0] as Array[int], "textures that do not occur")
	terrain.weight_image = Image.new()
	check_error(["ScatterGroundHeightmap.weight_image", "wrong size"], "an empty image")
	check_equal(terrain.weight_image, image, "the old image stays")
	terrain.weight_image = BoxMesh.new()
	check_error(["ScatterGroundHeightmap.weight_image", "missing"], "a mesh")
	terrain.image = BoxMesh.new()
	check_error(["ScatterGroundHeightmap.image", "missing"], "a mesh")


func test_heightmaps_do_not_depend_on_tiles() -> void:
	var terrain := ScatterGroundHeightmap.new()
	terrain.rect = Rect2(-64.0, -64.0, 128.0, 128.0)
	terrain.image = make_heights(Image.FORMAT_RF, Vector2i(40, 30))
	terrain.heights_in_meters = true
	await check_tiling(terrain, "a heightmap")


## Changing the height limits does not read the file again.
func test_a_heightmap_is_read_once() -> void:
	var path := "user://thicket_test_once.raw"
	var bytes := PackedByteArray()
	bytes.resize(4)
	bytes.fill(255)
	FileAccess.open(path, FileAccess.WRITE).store_buffer(bytes)
	var terrain := ScatterGroundHeightmap.new()
	terrain.heightmap_path = path
	terrain.post_count = Vector2i(2, 2)
	terrain.rect = Rect2(0.0, 0.0, 1.0, 1.0)
	terrain.max_height = 50.0
	check_equal(terrain.get_height(Vector3(0.5, 0.0, 0.5)), 50.0, "height")
	DirAccess.remove_absolute(path)
	terrain.max_height = 60.0
	terrain.rect = Rect2(0.0, 0.0, 4.0, 4.0)
	check_equal(terrain.get_height(Vector3(3.5, 0.0, 3.5)), 60.0, "height without the file")
	check_no_error("a new rect and new heights")
