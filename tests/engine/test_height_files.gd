extends "terrain_harness.gd"
## Heightmaps from files of all kinds, and their summaries. tests/helpers/height_files.py writes some of the files into the folder that is
## the first argument.

const SPOT := "user://thicket_heights"


func folder() -> String:
	return arguments[0]


## Returns a ground with samples 1 m apart, on which a 16-bit value is a height in meters.
func make_ground(path: String, count: Vector2i) -> ScatterGroundHeightmap:
	var ground := ScatterGroundHeightmap.new()
	ground.rect = Rect2(Vector2.ZERO, Vector2(count - Vector2i.ONE))
	ground.max_height = 65535.0
	ground.heightmap_path = path
	return ground


func write(path: String, bytes: PackedByteArray) -> void:
	FileAccess.open(path, FileAccess.WRITE).store_buffer(bytes)


## Returns a summary once a worker has read the ground, without any other call.
func summary_of(ground: ScatterGroundHeightmap) -> Dictionary:
	await until(func() -> bool: return ground.get_summary().has("size"), "a summary")
	return ground.get_summary()


func test_png_files() -> void:
	var listed: Array = JSON.parse_string(FileAccess.get_file_as_string(folder().path_join("files.json")))
	check_equal(listed.size(), 10, "files")
	for file: Dictionary in listed:
		var path := folder().path_join(file["name"])
		var count := Vector2i(file["columns"], file["rows"])
		var ground := make_ground(path, count)
		ground.post_count = Vector2i(9, 9) # Has no effect.
		var expected := FileAccess.get_file_as_bytes(path + ".expected")
		var wrong := 0
		var heights := {}
		for y in count.y:
			for x in count.x:
				var height := ground.get_height(Vector3(x, 0, y))
				heights[height] = true
				wrong += int(height != expected.decode_u16(2 * (y * count.x + x)))
		check_equal(wrong, 0, "wrong heights of " + file["name"])
		if file["name"] == "ramp.png":
			check_equal(heights.size(), 65536, "different heights")
		var summary := ground.get_summary()
		check_equal(summary["size"], count, "size of " + file["name"])
		check_equal(summary["format"], file["format"], "format of " + file["name"])
		check_equal(summary["problem"], "", "problem of " + file["name"])
	check_no_error("PNG files")


func test_rejected_files() -> void:
	var ground := make_ground(folder().path_join("ramp.png"), Vector2i(256, 256))
	check_equal(ground.get_height(Vector3(1, 0, 1)), 257.0, "a good file")
	for file: Array in [["palette.png", "palette"], ["truncated.png", "ends too early"], ["ramp.tif", "gdal_translate"], ["none.png", "exists"]]:
		var path := folder().path_join(file[0])
		ground.heightmap_path = path
		check_equal(ground.get_height(Vector3(1, 0, 1)), 257.0, "the last good ground stays after " + file[0])
		check_error(["ScatterGroundHeightmap.heightmap_path", file[1], path], file[0])
		check(file[1] in ground.get_summary()["problem"], "the problem with " + file[0])
		check_equal(ground.get_summary()["size"], Vector2i(256, 256), "the summary of the last good ground")
	# In an exported game, only the import of a file is left.
	write("res://lost.png.import", "[remap]\nimporter=\"texture\"\ntype=\"CompressedTexture2D\"\npath=\"res://lost.ctex\"\n".to_utf8_buffer())
	ground.heightmap_path = "res://lost.png"
	check_equal(ground.get_height(Vector3(1, 0, 1)), 257.0, "the last good ground stays")
	check_error(["ScatterGroundHeightmap.heightmap_path", "Keep File", "res://lost.png"], "a file that was not exported")
	DirAccess.remove_absolute("res://lost.png.import")
	write(SPOT, PackedByteArray([0x76, 0x2f, 0x31, 0x01, 2, 0, 0, 0]))
	ground.heightmap_path = SPOT
	ground.get_height(Vector3.ZERO)
	var messages := errors.take() # The engine prints an error first.
	check("ScatterGroundHeightmap.heightmap_path" in messages[-1] and "cannot read this EXR" in messages[-1], "a bad EXR file: %s" % messages)
	write(SPOT, PackedByteArray([1, 2, 3]))
	ground.heightmap_path = SPOT
	check_equal(ground.get_height(Vector3(1, 0, 1)), 257.0, "the last good ground stays")
	check_error(["ScatterGroundHeightmap.heightmap_path", "wrong size", "got 3", "post_count", SPOT], "a raw file that is not square")


func test_exr_files() -> void:
	for format: Image.Format in [Image.FORMAT_RF, Image.FORMAT_RH, Image.FORMAT_RGBF, Image.FORMAT_RGBAH]:
		var image := Image.create_empty(9, 7, false, format)
		for y in 7:
			for x in 9:
				image.set_pixel(x, y, Color(-100.0 + x * 16.0 + y * 0.25, 5.0, 6.0))
		var half := format in [Image.FORMAT_RH, Image.FORMAT_RGBAH]
		write(SPOT, image.save_exr_to_buffer())
		var ground := make_ground(SPOT, Vector2i(9, 7))
		ground.heights_in_meters = true
		for y in 7:
			for x in 9:
				check_equal(ground.get_height(Vector3(x, 0, y)), image.get_pixel(x, y).r, "format %d, sample %d, %d" % [format, x, y])
		check_equal(ground.get_summary()["format"], "16-bit EXR" if half else "32-bit EXR", "format")
		check_equal(ground.get_summary()["lowest"], -100.0, "lowest")
	check_no_error("EXR files")


func test_raw_squares() -> void:
	for file: Array in [["", 2, "16-bit raw"], ["", 4, "32-bit raw"], [".r8", 1, "8-bit raw"], [".R16", 2, "16-bit raw"], [".f32", 4, "32-bit raw"]]:
		var path: String = SPOT + file[0]
		var bytes := PackedByteArray()
		bytes.resize(4 * 4 * file[1])
		write(path, bytes)
		var ground := make_ground(path, Vector2i(4, 4))
		check_equal(ground.get_height(Vector3(3, 0, 3)), 0.0, path)
		check_equal(ground.get_summary()["format"], file[2], path)
		check_equal(ground.get_summary()["size"], Vector2i(4, 4), path)
		DirAccess.remove_absolute(path)
	check_no_error("raw squares")


## A summary without a host lets a worker read the ground, over several frames.
func test_summary() -> void:
	var bytes := PackedByteArray()
	bytes.resize(2 * 16)
	for post in 16:
		bytes.encode_u16(2 * post, 1000 * post)
	write(SPOT, bytes)
	var ground := ScatterGroundHeightmap.new()
	check_equal(ground.get_summary().keys(), ["problem"], "the summary of nothing")
	check("heightmap_path" in ground.get_summary()["problem"], "the problem of nothing")
	check_no_error("a summary of nothing")
	ground.rect = Rect2(-10, -20, 30, 60)
	ground.min_height = 100.0
	ground.max_height = 755.35
	ground.heightmap_path = SPOT
	var summary: Dictionary = await summary_of(ground)
	check_equal(summary["size"], Vector2i(4, 4), "size")
	check_equal(summary["spacing"], Vector2(10, 20), "spacing")
	check_equal(summary["lowest"], 100.0, "lowest")
	check(absf(summary["highest"] - 250.0) < 1e-9, "highest: %f" % summary["highest"])
	check_equal(summary["format"], "16-bit raw", "format")
	var thumbnail: Image = summary["thumbnail"]
	check_equal(thumbnail.get_size(), Vector2i(4, 4), "thumbnail")
	for post in 16:
		check_equal(thumbnail.get_pixel(post % 4, post / 4), Color8(17 * post, 17 * post, 17 * post), "pixel %d" % post)
	var image := Image.create_empty(300, 200, false, Image.FORMAT_RF)
	image.fill(Color(0.5, 0, 0))
	image.set_pixel(0, 0, Color(NAN, 0, 0))
	ground.image = image
	check(is_nan(ground.get_height(Vector3(-10, 0, -20))), "a hole")
	summary = ground.get_summary()
	check_equal(summary["format"], "32-bit image", "format of an image")
	check_equal(summary["thumbnail"].get_size(), Vector2i(128, 85), "thumbnail of an image")
	image.fill_rect(Rect2i(5, 5, 9, 9), Color(1, 0, 0))
	ground.update_region(Rect2i(5, 5, 9, 9))
	ground.get_height(Vector3.ZERO)
	check(absf(ground.get_summary()["highest"] - 755.35) < 1e-4, "highest after an edit")
	for format: Array in [[Image.FORMAT_L8, "8-bit image"], [Image.FORMAT_RH, "16-bit image"], [Image.FORMAT_R16, "16-bit image"]]:
		ground.image = Image.create_empty(4, 4, false, format[0])
		ground.get_height(Vector3.ZERO)
		check_equal(ground.get_summary()["format"], format[1], "format of an image")
	image = Image.create_empty(8, 8, false, Image.FORMAT_RGB8)
	check_equal(image.compress(Image.COMPRESS_S3TC), OK, "compressed")
	ground.image = image
	ground.get_height(Vector3.ZERO)
	check_equal(ground.get_summary()["format"], "compressed image", "format of a compressed image")
	DirAccess.remove_absolute(SPOT)
	check_no_error("summaries")


## The inspector sets the ID of an imported file. The path remains valid if the file's import is turned off.
func test_ids_of_files() -> void:
	write("res://hills.png", FileAccess.get_file_as_bytes(folder().path_join("hills")))
	var id := ResourceUID.create_id()
	ResourceUID.add_id(id, "res://hills.png")
	var ground := make_ground(ResourceUID.id_to_text(id), Vector2i(70, 90))
	check_equal(ground.heightmap_path, "res://hills.png", "the path")
	check(ground.get_height(Vector3(1, 0, 1)) > 0.0, "the file is read")
	ground.heightmap_path = "uid://c4f3"
	check_equal(ground.heightmap_path, "uid://c4f3", "an unknown ID")
	DirAccess.remove_absolute("res://hills.png")
	check_no_error("IDs")
