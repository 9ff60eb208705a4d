extends "harness.gd"
## Tests bad input. It causes one error that names the property and the value. The last valid value is kept, and nothing crashes.

## Ground that returns the wrong number of heights or normals, or values that are not finite.
class BrokenGround extends ScatterGround:
	var extra := 0
	var threaded := false
	var fill := 0.0
	var normals := -1

	func _get_heights(positions: PackedVector2Array) -> PackedFloat32Array:
		var heights := PackedFloat32Array()
		heights.resize(positions.size() + extra if positions else 0)
		heights.fill(fill)
		return heights

	func _get_normals(positions: PackedVector2Array) -> PackedVector3Array:
		var result := PackedVector3Array()
		result.resize(positions.size() if normals < 0 else normals)
		result.fill(Vector3.UP if normals < 0 else Vector3(NAN, 1.0, 0.0))
		return result

	func _is_thread_safe() -> bool:
		return threaded


const SPOT := "user://thicket_test.r16"


func refuse(object: Object, property: StringName, value: Variant, word := "got") -> void:
	var good: Variant = object.get(property)
	var assignment := "%s = %s" % [property, value]
	object.set(property, value)
	var messages := errors.take()
	if check(messages.size() == 1, "%s: expected one error, got %s" % [assignment, messages]):
		for expected: String in [object.get_class() + "." + property, word]:
			check(expected in messages[0], "%s: expected '%s' in '%s'" % [assignment, expected, messages[0]])
		var named := messages[0].get_slice("got ", 1).get_slice(". ", 0)
		check(is_equal_approx(number(named), value) or named == str(value), "%s: the error names %s" % [assignment, named])
	check_equal(object.get(property), good, assignment + " is ignored")


func test_surface_layers() -> void:
	var layer := make_layer()
	layer.surface_layers = ["Stones"]
	check_no_error("a name")
	var too_many := []
	too_many.resize(17)
	too_many.fill("Stones")
	layer.surface_layers = too_many
	check_error(["ScatterLayer.surface_layers", "17", "16"], "too many entries")
	for value: Variant in [null, 2.5, Node]:
		layer.surface_layers = ["Stones", value]
		check_error(["ScatterLayer.surface_layers", "Pass a ScatterLayer or its name"], "an entry of %s" % value)
	layer.surface_layers = [layer]
	check_error(["ScatterLayer.surface_layers", "cycle"], "a layer without a name on itself")
	check_equal(layer.surface_layers, ["Stones"], "the last valid list is kept")


func number(text: String) -> float:
	return text.to_float() if text.is_valid_float() else INF


func accept(object: Object, property: StringName, value: Variant) -> void:
	object.set(property, value)
	check_no_error("%s = %s" % [property, value])
	check_equal(object.get(property), value, str(property))


## Checks that every float property of a resource rejects NAN, infinity and 1e300.
func check_numbers(resource: Resource, expected: int) -> void:
	var numbers := 0
	for property in ClassDB.class_get_property_list(resource.get_class()): # Lists the class's properties, because a new resource hides some of them.
		if property["type"] != TYPE_FLOAT or not property["usage"] & PROPERTY_USAGE_EDITOR:
			continue
		numbers += 1
		for value: float in [NAN, INF, -INF]:
			refuse(resource, property["name"], value, "must be finite, ")
		refuse(resource, property["name"], 1e300, "must be between ")
		refuse(resource, property["name"], -1e300)
	check_equal(numbers, expected, "numbers of a " + resource.get_class())


func test_value_source_numbers() -> void:
	check_numbers(ScatterValueSource.new(), 3)


func test_row_numbers() -> void:
	check_numbers(ScatterRows.new(), 8)


func test_layer_numbers() -> void:
	var layer := ScatterLayer.new()
	check_numbers(layer, 39)
	for property in ["radius", "tile_size", "proximity_distance", "min_scale", "max_scale", "lod_bias"]:
		refuse(layer, property, 0.0, "must be between 0.")
		refuse(layer, property, -3.0, "must be between 0.")
	for property in ["density", "align_to_normal"]:
		refuse(layer, property, 1.5, "must be between 0 and 1, got 1.5. The last valid value is kept")
		refuse(layer, property, -0.5, "must be between 0 and 1, got -0.5. ")
	refuse(layer, "max_slope_degrees", 181.0, "must be between 0 and 180, ")
	refuse(layer, "view_distance", -1.0, "must be between 0 and ")
	refuse(layer, "radius", 1e-7, "must be between 0.001 and ")
	accept(layer, "density", 0.0)
	accept(layer, "min_height", -1000.0)


func test_layer_integers_and_arrays() -> void:
	var layer := ScatterLayer.new()
	for levels: int in [0, 9, 1 << 40]:
		refuse(layer, "progressive_levels", levels, "must be between 1 and 8, ")
	for number: int in [-2, 32768, 65535]:
		refuse(layer, "layer_id", number, "must be between -1 and 32767, ")
	refuse(layer, "cast_shadow", 4, "must be between 0 and 3, ")
	layer.mesh_weights = PackedFloat32Array([1.0, -2.0])
	check_error(["ScatterLayer.mesh_weights", "-2"], "negative weight")
	layer.mesh_weights = PackedFloat32Array([NAN])
	check_error(["ScatterLayer.mesh_weights", "finite"], "NAN weight")
	check_equal(layer.mesh_weights.size(), 0, "weights after invalid ones")
	var many := PackedStringArray()
	many.resize(257)
	layer.mesh_density_expressions = many
	check_error(["ScatterLayer.mesh_density_expressions must be at most 256 (entries), got 257. Remove the entries beyond those of meshes"], "257 expressions")
	layer.mesh_density_expressions = ["1", "noise(1, 2)"]
	check_error(["ScatterLayer.mesh_density_expressions[1]: \"noise(1, 2)\", column 1: noise must have 1 argument, got 2. "], "an invalid expression")
	check_equal(layer.mesh_density_expressions.size(), 0, "expressions after invalid lists")


func test_sampler() -> void:
	var sampler := PoissonSampler.new()
	for value: float in [0.0, -1.0]:
		refuse(sampler, "radius", value, "must be positive")
	for value: float in [NAN, INF, -INF]:
		refuse(sampler, "radius", value, "must be finite")
	refuse(sampler, "progressive_levels", 0, "must be between 1 and 8, ")
	refuse(sampler, "progressive_levels", 99, "must be between 1 and 8, ")
	check(sampler.sample(Rect2(-5, -5, 9, 9)).ids.size() > 10, "points before the invalid rects")
	for rect: Rect2 in [Rect2(0, 0, -5, 5), Rect2(0, 0, 5, -5), Rect2(0, 0, NAN, 5), Rect2(INF, 0, 5, 5),
			Rect2(-1e30, -1e30, 3e30, 3e30), Rect2(0, 0, 1e6, 1e6)]:
		check_equal(sampler.sample(rect).ids.size(), 0, "points in %s" % rect)
		check_error(["PoissonSampler.rect"], str(rect))
	for sides: Array in [[1.0, 0.0, 0.0, 1.0], [NAN, 0.0, 1.0, 1.0], [0.0, 0.0, INF, 1.0],
			[9e15, 0.0, 9e15 + 4.0, 4.0]]:
		check_equal((sampler.sample_exact.callv(sides) as PoissonPoints).size(), 0, "points in %s" % [sides])
		check_error(["PoissonSampler.rect"], str(sides))
	check_equal(sampler.sample(Rect2(3, 3, 0, 5)).ids.size(), 0, "points in an empty rect")
	check_no_error("an empty rect")
	check(sampler.sample(Rect2(-5, -5, 9, 9)).ids.size() > 10, "points after the invalid rects")


func test_tiny_radius_for_the_tile() -> void:
	var layer := make_layer()
	var scatter := make_scatter([layer], ScatterGroundFlat.new(), make_viewer())
	await settle(scatter)
	var before := digests(scatter, 0)
	layer.radius = 0.002
	await settle(scatter)
	check_error(["layers[0]: ScatterLayer.tile_size must be at most", "points per tile", "got 32"], "a tile of 10^8 points")
	check_equal(digests(scatter, 0), before, "instances after a tiny radius")
	layer.radius = 2.0
	await settle(scatter)
	check_equal(digests(scatter, 0), before, "instances after the old radius")


func test_inverted_ranges_keep_the_instances() -> void:
	for range_name: String in ["height", "water_depth", "slope_degrees", "scale", "yaw_degrees"]:
		var layer := make_layer()
		var scatter := make_scatter([layer], ScatterGroundFlat.new(), make_viewer())
		await settle(scatter)
		var before := digests(scatter, 0)
		layer.set("min_" + range_name, 80.0)
		layer.set("max_" + range_name, 20.0)
		check_no_error("setting both ends of " + range_name)
		await settle(scatter)
		check_error(["ScatterLayer.", range_name, "20"], "inverted " + range_name)
		check_equal(digests(scatter, 0), before, "instances after an inverted " + range_name)
		check(scatter.get_problems()[0].contains(range_name), "a warning for " + range_name)
		layer.set("max_" + range_name, 85.0)
		await settle(scatter)
		check_no_error("a valid range")
		check(digests(scatter, 0) != before, "%s has an effect again" % range_name)
		scatter.queue_free()


func test_view_distance_beyond_the_limit() -> void:
	var layer := make_layer()
	var scatter := make_scatter([layer], ScatterGroundFlat.new(), make_viewer())
	await settle(scatter)
	var before := digests(scatter, 0)
	layer.view_distance = 100000.0
	await settle(scatter)
	check_error(["ScatterLayer.view_distance", "100000"], "a view of 3000 tiles")
	check_equal(digests(scatter, 0), before, "instances")


func test_node_properties() -> void:
	var scatter := TerrainScatter3D.new()
	for budget: int in [0, -5, 1 << 40]:
		refuse(scatter, "frame_budget_usec", budget, "must be between 1 and 1000000, ")
	for tile: Vector2i in [Vector2i.ZERO, Vector2i(1 << 30, -(1 << 31))]:
		for layer: String in ["", "larch"]:
			check_equal(scatter.get_tile(layer, tile).get_digest(), 0, "digest")
			check_error(["TerrainScatter3D.get_tile", "\"%s\"" % layer], "no layer")
			check_equal(scatter.get_tile(layer, tile).get_mesh_count(), 0, "meshes")
			check_error(["TerrainScatter3D.get_tile", "\"%s\"" % layer], "no layer")
			check(scatter.get_shown_tiles(layer).is_empty(), "tiles")
			check_error(["TerrainScatter3D.get_shown_tiles", "\"%s\"" % layer], "no layer")
	scatter.free()


func test_missing_parts_cause_warnings() -> void:
	var scatter := make_scatter([], null, make_viewer())
	await frames(3)
	check_equal(scatter.get_problems().size(), 2, "warnings without ground and layers")
	scatter.layers = [null, make_layer(), ScatterLayer.new()]
	scatter.ground = ScatterGround.new()
	await settle(scatter)
	var problems := "\n".join(scatter.get_problems())
	for words: String in ["_get_heights", "Layer 0: the entry is empty", "Layer 2: ScatterLayer.meshes"]:
		check(words in problems, "'%s' in: %s" % [words, problems])
	check_equal(scatter.get_stats()["tiles"], 0, "tiles on a base ground")
	scatter.ground = ScatterGroundFlat.new()
	await settle(scatter)
	check(scatter.get_shown_tiles(scatter.layers[1]).size() > 10, "the layer between two invalid ones is visible")
	check_equal(shown_tiles(scatter, 0).size(), 0, "tiles of an empty layer")
	scatter.viewers = [NodePath("nobody"), scatter.get_path_to(root)]
	check_equal(scatter.get_problems().size(), 4, "warnings of two layers and two viewers")
	scatter.layers = [make_layer(), make_layer()]
	scatter.layers[0].layer_id = 1
	check("layer_id" in "\n".join(scatter.get_problems()), "two layers with one id")
	scatter.ground = null
	await frames(3)
	check_equal(scatter.get_stats()["tiles"], 0, "tiles without a ground")


func test_wrong_resources() -> void:
	var terrain := ScatterGroundFlat.new()
	var scatter := make_scatter([make_layer()], terrain, make_viewer())
	await settle(scatter)
	scatter.set("ground", BoxMesh.new())
	scatter.set("layers", [BoxMesh.new(), 5])
	scatter.set("layers", "not a list of layers")
	scatter.set("viewers", [3, BoxMesh.new()])
	await frames(5)
	errors.take() # The engine may print other errors. Only the state is checked here.
	check(scatter.ground == null or scatter.ground == terrain, "the ground is not a mesh")
	scatter.ground = terrain
	scatter.layers = [make_layer()]
	scatter.viewers = [scatter.get_path_to(make_viewer())]
	await settle(scatter)
	check(scatter.get_shown_tiles(scatter.layers[0]).size() > 10, "the layer is visible again")


func test_far_away_viewer() -> void:
	var viewer := make_viewer()
	var scatter := make_scatter([make_layer()], ScatterGroundFlat.new(), viewer)
	await settle(scatter)
	viewer.global_position = Vector3(1e20, 0.0, 0.0)
	await frames(5)
	viewer.global_position = Vector3(NAN, 0.0, INF)
	await frames(5)
	errors.take()
	viewer.global_position = Vector3(2e7, 0.0, 0.0)
	await settle(scatter)
	check_error(["layer 0, tile (", "): rect must be between"], "beyond the last cell")
	viewer.global_position = Vector3.ZERO
	await settle(scatter)
	check(scatter.get_stats()["instances"] > 1000, "the layer is visible again")


func test_broken_scripts() -> void:
	for threaded: bool in [false, true]:
		for extra: int in [-1, 1, 1000]:
			var ground := BrokenGround.new()
			ground.threaded = threaded
			ground.extra = extra
			var layer := make_layer()
			layer.align_to_normal = 1.0 # Otherwise no normals are queried.
			var scatter := make_scatter([layer], ground, make_viewer())
			await settle(scatter)
			check_error(["_get_heights()", "wrong size"], "%+d heights" % extra)
			check_equal(scatter.get_stats()["instances"], 0, "instances")
			ground.extra = 0
			scatter.regenerate()
			await settle(scatter)
			check_no_error("the right number of heights")
			check(scatter.get_stats()["instances"] > 1000, "instances are visible again")
			ground.normals = 7
			scatter.regenerate()
			await settle(scatter)
			check_error(["_get_normals()", "wrong size", "7"], "7 normals")
			ground.normals = -1
			ground.fill = NAN
			scatter.regenerate()
			await settle(scatter)
			check_equal(scatter.get_stats()["instances"], 0, "instances on NAN heights")
			ground.fill = INF
			scatter.regenerate()
			await settle(scatter)
			check_equal(scatter.get_stats()["instances"], 0, "instances on infinite heights")
			scatter.free()


func write_posts(count: int) -> void:
	var bytes := PackedByteArray()
	bytes.resize(2 * count)
	var file := FileAccess.open(SPOT, FileAccess.WRITE)
	file.store_buffer(bytes)


func test_heightmap_properties() -> void:
	var terrain := ScatterGroundHeightmap.new()
	for count: Vector2i in [Vector2i(1, 5), Vector2i(5, -1), Vector2i(1 << 20, 5)]:
		terrain.post_count = count
		check_error(["ScatterGroundHeightmap.post_count"], str(count))
	for rect: Rect2 in [Rect2(0, 0, 0, 5), Rect2(0, 0, 5, -1), Rect2(0, 0, NAN, 5), Rect2(INF, 0, 5, 5)]:
		terrain.rect = rect
		check_error(["ScatterGroundHeightmap.rect"], str(rect))
	check_equal(terrain.rect, Rect2(0, 0, 1000, 1000), "rect")
	for value: float in [NAN, INF, 1e9]:
		refuse(terrain, "min_height", value)
		refuse(terrain, "max_height", value)
	terrain.image = Image.new()
	check_error(["ScatterGroundHeightmap.image", "wrong size"], "an empty image")
	check(terrain.image == null, "no image")


func test_heightmap_files() -> void:
	var terrain := ScatterGroundHeightmap.new()
	check(is_nan(terrain.get_height(Vector3.ZERO)), "no height before a file")
	check_error(["ScatterGroundHeightmap.heightmap_path", "missing"], "no file")
	terrain.post_count = Vector2i(4, 3)
	terrain.heightmap_path = "user://no_such_file.r16"
	check(is_nan(terrain.get_height(Vector3.ZERO)), "no height")
	check_error(["ScatterGroundHeightmap.heightmap_path"], "a missing file")
	terrain.rect = Rect2(0, 0, 500, 500)
	check(is_nan(terrain.get_height(Vector3.ZERO)), "no height on another rect either")
	check_error(["ScatterGroundHeightmap.heightmap_path"], "a file that is still missing")
	write_posts(11)
	terrain.heightmap_path = SPOT
	check(is_nan(terrain.get_height(Vector3.ZERO)), "no height")
	check_error(["ScatterGroundHeightmap.heightmap_path", "wrong size", "22"], "a short file")
	check(terrain.get_height(Vector3.ZERO) != 0.0, "still no height")
	check_no_error("querying twice")
	write_posts(12)
	terrain.heightmap_path = SPOT
	terrain.min_height = 5.0
	check_equal(terrain.get_height(Vector3(10.0, 0.0, 10.0)), 5.0, "height")
	terrain.max_height = -5.0
	check_equal(terrain.get_height(Vector3(10.0, 0.0, 10.0)), 5.0, "height of the last valid state")
	check_error(["ScatterGroundHeightmap.max_height", "-5"], "inverted heights")
	DirAccess.remove_absolute(SPOT)


func test_heightmap_images() -> void:
	var terrain := ScatterGroundHeightmap.new()
	terrain.rect = Rect2(0, 0, 3, 2)
	terrain.min_height = 100.0
	terrain.max_height = 200.0
	var image := Image.create_empty(4, 3, false, Image.FORMAT_RF)
	image.set_pixel(1, 1, Color(0.5, 0.0, 0.0))
	terrain.image = image
	check(absf(terrain.get_height(Vector3(1.0, 0.0, 1.0)) - 150.0) < 0.01, "height at a sample")
	check(absf(terrain.get_height(Vector3(1.5, 0.0, 1.0)) - 125.0) < 0.01, "height between samples")
	check(is_nan(terrain.get_height(Vector3(3.1, 0.0, 1.0))), "no height outside")
	for value: float in [INF, 2.0, -0.5]:
		var bad := image.duplicate() as Image
		bad.set_pixel(2, 2, Color(value, 0.0, 0.0))
		terrain.image = bad
		check(absf(terrain.get_height(Vector3(1.0, 0.0, 1.0)) - 150.0) < 0.01, "height of the last valid image")
		check_error(["ScatterGroundHeightmap.image"], "an image with %s" % value)
