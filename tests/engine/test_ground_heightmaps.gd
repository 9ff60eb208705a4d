extends "terrain_harness.gd"
## Tests heightmaps that change: only tiles under a change are regenerated, a worker reads large maps, and errors name invalid height samples.

const SIDE := 257 ## Height samples along each axis, 1 m apart.


func make_image(side := SIDE, format := Image.FORMAT_RF) -> Image:
	return Image.create_empty(side, side, false, format)


## Returns a settled scatter with 8 m tiles around the middle of the map.
func make_on_map(image: Resource, meters := true) -> TerrainScatter3D:
	var terrain := ScatterGroundHeightmap.new()
	terrain.heights_in_meters = meters
	terrain.rect = Rect2(-128.0, -128.0, 256.0, 256.0)
	terrain.max_height = 50.0
	terrain.image = image
	var layer := make_layer(1.0)
	layer.tile_size = 8.0
	var scatter := make_scatter([layer], terrain, make_viewer())
	await settle(scatter)
	return scatter


## Returns the tiles whose ground depends on the samples in a region.
func tiles_under(region: Rect2i, post_spacing := 1.0) -> Array[Vector2i]:
	var area := Rect2(Vector2(region.position) - Vector2(2.0, 2.0), Vector2(region.size) + Vector2(3.0, 3.0))
	area = Rect2(area.position * post_spacing - Vector2(128.0, 128.0), area.size * post_spacing).grow(1.0)
	var result: Array[Vector2i] = []
	for x in range(-16, 16):
		for z in range(-16, 16):
			if area.intersects(Rect2(x * 8.0, z * 8.0, 8.0, 8.0), true):
				result.push_back(Vector2i(x, z))
	return result


func check_regenerated(scatter: TerrainScatter3D, region: Rect2i, context: String, edit: Callable) -> void:
	var under := tiles_under(region)
	await check_regenerated_under(scatter, under, not under.is_empty(), context, edit)


## Checks that all plants are at the heights of an image, which a new heightmap reads with samples 1 m apart.
func check_on(scatter: TerrainScatter3D, image: Image, context: String, scale := 1.0) -> void:
	var new_ground := ScatterGroundHeightmap.new()
	new_ground.heights_in_meters = scatter.ground.heights_in_meters
	new_ground.rect = scatter.ground.rect
	new_ground.max_height = scatter.ground.max_height
	new_ground.image = image
	var wrong := 0
	var stand := all_transforms(scatter)
	for one in stand:
		wrong += int(absf(one.origin.y - new_ground.get_height(one.origin)) > 1e-3)
	check(stand.size() > 500 and wrong == 0, "%s: %d of %d plants are off the ground" % [context, wrong, stand.size()])


func test_setting_the_same_image_again() -> void:
	for format: Image.Format in [Image.FORMAT_RF, Image.FORMAT_L8, Image.FORMAT_RGBAH]:
		var image := make_image(SIDE, format)
		var scatter := await make_on_map(image, false)
		var region := Rect2i(140, 120, 16, 16)
		await check_regenerated(scatter, region, "edited, format %d" % format, func() -> void:
				image.fill_rect(region, Color(0.25, 0.25, 0.25))
				scatter.ground.image = image)
		check_on(scatter, image, "edited, format %d" % format)
		var regenerated_tiles := await regenerated_by(scatter, func() -> void: scatter.ground.image = image.duplicate())
		check_equal(regenerated_tiles.size(), 0, "the same heights in another image")
		scatter.ground.image = image
		await settle(scatter)
		await check_regenerated(scatter, Rect2i(130, 128, 2, 3), "refresh_ground, format %d" % format, func() -> void:
				image.fill_rect(Rect2i(130, 128, 2, 3), Color(0.75, 0.75, 0.75))
				scatter.refresh_ground())
		image.fill_rect(Rect2i(100, 100, 4, 4), Color(0.5, 0.5, 0.5))
		image.fill_rect(Rect2i(150, 150, 4, 4), Color(0.5, 0.5, 0.5))
		regenerated_tiles = await regenerated_by(scatter, func() -> void: scatter.ground.image = image)
		var under := tiles_under(Rect2i(100, 100, 4, 4)) + tiles_under(Rect2i(150, 150, 4, 4))
		check(not regenerated_tiles.is_empty() and regenerated_tiles.all(func(tile: Vector2i) -> bool: return under.has(tile)), "two regions: %s" % [regenerated_tiles])
		check_on(scatter, image, "two regions, format %d" % format)
		scatter.free()
	check_no_error("images that are set again")


func test_update_region() -> void:
	for format: Image.Format in [Image.FORMAT_RF, Image.FORMAT_RGBAF, Image.FORMAT_RH, Image.FORMAT_L8, Image.FORMAT_RGB8, Image.FORMAT_R16]:
		var image := make_image(SIDE, format)
		var scatter := await make_on_map(image, false)
		for region: Rect2i in [Rect2i(140, 120, 16, 16), Rect2i(90, 100, 1, 1), Rect2i(100, 127, 60, 3)]:
			await check_regenerated(scatter, region, "format %d, %s" % [format, region], func() -> void:
					image.fill_rect(region, Color(0.2, 0.2, 0.2, 1.0))
					scatter.ground.update_region(region))
			check_on(scatter, image, "format %d, %s" % [format, region])
		await check_regenerated(scatter, Rect2i(0, 0, 110, 110), "beyond the border", func() -> void:
				image.fill_rect(Rect2i(0, 0, 110, 110), Color(0.3, 0.3, 0.3, 1.0))
				scatter.ground.update_region(Rect2i(-40, -1000, 150, 1110)))
		var regenerated_tiles := await regenerated_by(scatter, func() -> void: scatter.ground.update_region(Rect2i(5000, 0, 10, 10)))
		check_equal(regenerated_tiles.size(), 0, "outside")
		image.fill_rect(Rect2i(150, 150, 4, 4), Color(0.5, 0.5, 0.5))
		scatter.ground.update_region(Rect2i(150, 150, 4, 4))
		var new_height: float = scatter.ground.get_height(Vector3(152.0 - 128.0, 0.0, 152.0 - 128.0))
		check(absf(new_height - 25.0) < 0.2, "a query does not wait: %f" % new_height)
		await settle(scatter)
		check_on(scatter, image, "format %d, finally" % format)
		scatter.free()
	check_no_error("regions")


func test_update_region_rejects() -> void:
	var scatter := await make_on_map(make_image())
	scatter.ground.update_region(Rect2i(10, 10, 0, 5))
	check_error(["ScatterGroundHeightmap.update_region", "positive", "(0, 5)"], "no area")
	var image: Image = scatter.ground.image
	var before := digests(scatter, 0)
	image.set_pixel(131, 122, Color(INF, 0.0, 0.0))
	scatter.ground.update_region(Rect2i(120, 120, 16, 16))
	await settle(scatter)
	check_error(["ScatterGroundHeightmap.image", "column 131", "row 122", "inf", "1000000"], "an infinite sample")
	check_equal(digests(scatter, 0), before, "the instances do not change")
	check("column 131" in "\n".join(scatter.get_problems()), "get_problems names the sample")
	image.set_pixel(131, 122, Color(2.0, 0.0, 0.0))
	scatter.ground.update_region(Rect2i(120, 120, 16, 16))
	await settle(scatter)
	check_equal(scatter.get_problems().size(), 0, "no problem once it is finite")
	check_on(scatter, image, "the sample")


## Large regions are read in steps and take effect after the last step.
func test_a_large_region_is_read_in_steps() -> void:
	var image := make_image(2049)
	var scatter := await make_on_map(image)
	scatter.frame_budget_usec = 1
	var region := Rect2i(0, 0, 2049, 800)
	image.fill_rect(region, Color(3.0, 0.0, 0.0))
	scatter.ground.update_region(region)
	var waited := 0
	var signals := [0]
	scatter.ground.ground_changed.connect(func(_rect: Rect2) -> void: signals[0] += 1)
	while signals[0] == 0 and waited < 1000:
		await process_frame
		waited += 1
	check(waited >= 20, "1.6 million samples took %d frames" % waited)
	check_equal(signals[0], 1, "one signal")
	scatter.frame_budget_usec = 20000
	await settle(scatter)
	check_on(scatter, image, "a large region")


## A worker reads a large map while frames continue. Plants stay on the old ground until it has finished.
func test_a_worker_reads() -> void:
	var image := make_image(4097)
	image.fill(Color(7.0, 0.0, 0.0))
	var scatter := await make_on_map(make_image())
	var shown_count := scatter.get_shown_count(scatter.layers[0])
	scatter.ground.image = image
	var minimum := shown_count
	var frames_until := 0
	while not scatter.is_settled():
		await process_frame
		minimum = mini(minimum, scatter.get_shown_count(scatter.layers[0]))
		frames_until += 1
	check(frames_until > 2, "%d frames continued" % frames_until)
	check(minimum > shown_count / 2, "at least %d of %d plants at any time" % [minimum, shown_count])
	check(all_transforms(scatter).all(func(one: Transform3D) -> bool: return absf(one.origin.y - 7.0) < 1e-4), "plants are on the new map")


func test_errors_name_invalid_samples() -> void:
	var good := make_image()
	var scatter := await make_on_map(good)
	var before := digests(scatter, 0)
	for bad: Array in [[INF, "inf"], [-INF, "-inf"], [3e6, "3000000"]]:
		var image := good.duplicate() as Image
		image.set_pixel(200, 17, Color(bad[0], 0.0, 0.0))
		scatter.ground.image = image
		await settle(scatter)
		check_error(["ScatterGroundHeightmap.image", "column 200", "row 17", bad[1], "-1000000 to 1000000"], "a sample of %s" % bad[0])
		check("column 200" in "\n".join(scatter.get_problems()), "get_problems names the sample")
		check_equal(digests(scatter, 0), before, "the instances do not change")
	scatter.ground.image = good
	await settle(scatter)
	check_equal(scatter.get_problems().size(), 0, "no problems with a valid map")
	var path := "user://thicket_test_posts.raw"
	FileAccess.open(path, FileAccess.WRITE).store_buffer(PackedFloat32Array([0.0, 1.0, 0.5, 0.25, 1.5, 0.0]).to_byte_array())
	var of_file := ScatterGroundHeightmap.new()
	of_file.post_count = Vector2i(3, 2)
	of_file.heightmap_path = path
	check(is_nan(of_file.get_height(Vector3(1.0, 0.0, 1.0))), "no ground")
	check_error(["ScatterGroundHeightmap.heightmap_path", "column 1", "row 1", "1.5", "0 to 1", "heights_in_meters"], "a sample of a file")
	DirAccess.remove_absolute(path)


func test_weights_that_change() -> void:
	var scatter := await make_on_map(make_image())
	var weights := make_image(65, Image.FORMAT_RGBA8)
	weights.fill(Color(1.0, 0.0, 0.0, 0.0))
	scatter.ground.weight_image = weights
	scatter.layers[0].ground_textures = PackedInt32Array([0])
	await settle(scatter)
	weights.fill_rect(Rect2i(34, 33, 3, 2), Color(0.0, 1.0, 0.0, 0.0))
	var regenerated_tiles := await regenerated_by(scatter, func() -> void: scatter.ground.weight_image = weights)
	var under := tiles_under(Rect2i(33 * 4, 32 * 4, 4 * 4 + 1, 3 * 4 + 1))
	check(not regenerated_tiles.is_empty() and regenerated_tiles.all(func(tile: Vector2i) -> bool: return under.has(tile)), "only tiles under the painted pixels are regenerated: %s" % [regenerated_tiles])
	check(not all_transforms(scatter).any(func(one: Transform3D) -> bool: return Rect2(9.0, 5.0, 6.0, 2.0).has_point(Vector2(one.origin.x, one.origin.z))), "nothing grows under the painted pixels")


## Properties that change while a worker reads, or while regions are pending, take effect eventually.
func test_changes_in_quick_succession() -> void:
	var image := make_image(1025)
	var scatter := await make_on_map(image)
	for round in 6:
		var region := Rect2i(500 + 3 * round, 510, 9, 9)
		image.fill_rect(region, Color(1.0 + round, 0.0, 0.0))
		match round % 3:
			0: scatter.ground.update_region(region)
			1: scatter.ground.image = image
			2:
				scatter.ground.rect = Rect2(-128.0 + round, -128.0, 256.0, 256.0)
				scatter.ground.update_region(region)
		await frames(round)
	await settle(scatter)
	check_on(scatter, image, "after all changes")
	scatter.ground.changed.connect(func() -> void: scatter.ground = null, CONNECT_ONE_SHOT)
	scatter.ground.ground_changed.connect(func(_rect: Rect2) -> void: scatter.ground = null)
	image.fill(Color(9.0, 0.0, 0.0))
	scatter.ground.image = image
	await until(func() -> bool: return scatter.ground == null, "a handler releases the ground")
	await frames(5)
	check_no_error("handlers")
