extends "../engine/harness.gd"
## Prints digests of points, tiles, queries and states, one per line, so that a test can compare two engines. All input is exact: the heights are
## fractions with few bits, and the meshes have flat sides, because an engine's own sines and noise may differ in their last bit.

const FAR := Vector2i(250000, -200000)


func report(what: String, value: int) -> void:
	check(value != 0, what + " is not empty")
	print("digest of %s: %d" % [what, value])


func digest_of(value: Variant) -> int:
	return hash(var_to_bytes(value))


## Reports the tiles of a layer, of which at least one must have instances.
func report_tiles(what: String, scatter: TerrainScatter3D, layer: ScatterLayer, tiles: Array[Vector2i]) -> void:
	await settle(scatter)
	for tile in tiles:
		report("tile %s of %s" % [tile, what], scatter.build_tile(layer, tile).get_digest())


## Returns a layer that uses most of the rules and placement properties.
func make_rich_layer() -> ScatterLayer:
	var layer := make_layer(1.5)
	layer.progressive_levels = 3
	layer.meshes = [BoxMesh.new(), PrismMesh.new()]
	layer.density_expression = "lerp(0.4, 0.9, height < 20) * noise(30)"
	layer.max_slope_degrees = 40.0
	layer.slope_falloff_degrees = 10.0
	layer.clump_size = 12.0
	layer.min_scale = 0.5
	layer.max_scale = 1.5
	layer.max_tilt_degrees = 8.0
	layer.align_to_normal = 0.5
	layer.use_colors = true
	layer.use_custom_data = true
	return layer


func make_hills() -> ScatterGroundHeightmap:
	var image := Image.create(65, 65, false, Image.FORMAT_RF)
	for x in 65:
		for y in 65:
			image.set_pixel(x, y, Color((x * x + 3 * x * y + 7 * y) % 257 * 0.125, 0.0, 0.0))
	var ground := ScatterGroundHeightmap.new()
	ground.rect = Rect2(-128.0, -128.0, 256.0, 256.0)
	ground.image = image
	ground.heights_in_meters = true
	return ground


## Adds a box of ground.
func put_box(size: Vector3) -> void:
	var box := MeshInstance3D.new()
	box.mesh = BoxMesh.new()
	(box.mesh as BoxMesh).size = size
	box.add_to_group(&"ground")
	root.add_child(box)


func test_points() -> void:
	var sampler := PoissonSampler.new()
	sampler.seed = 5
	report("points", digest_of(sampler.sample(Rect2(-40.0, 30.0, 150.0, 120.0)).positions))
	sampler.progressive_levels = 4
	report("progressive points", digest_of(sampler.sample(Rect2(-40.0, 30.0, 150.0, 120.0)).positions))
	var box := BoxMesh.new()
	box.size = Vector3(20.0, 12.0, 16.0)
	report("points on a box", digest_of(sampler.sample_surface(box).positions))
	report("points in a domain", digest_of(sampler.sample_domain(Rect2(0.0, 0.0, 60.0, 40.0))))


func test_flat_ground() -> void:
	var layer := make_rich_layer()
	var scatter := make_scatter([layer], ScatterGroundFlat.new(), make_viewer())
	await report_tiles("flat ground", scatter, layer, [Vector2i.ZERO, Vector2i(-1, 2), FAR])


func test_hills_and_queries() -> void:
	var layer := make_rich_layer()
	var scatter := make_scatter([layer], make_hills(), make_viewer())
	await report_tiles("hills", scatter, layer, [Vector2i.ZERO, Vector2i(-2, 1), Vector2i(2, -3)])
	report("instances in a sphere", digest_of(scatter.query_sphere(Vector3(5.0, 10.0, 3.0), 30.0).ids))
	scatter.remove_in_sphere(Vector3(5.0, 10.0, 3.0), 20.0)
	report("a state", scatter.state.get_digest())


func test_layers_that_depend_on_each_other() -> void:
	var oaks := make_layer(4.0)
	oaks.resource_name = "oak"
	oaks.density = 0.5
	var birches := make_layer(3.0)
	birches.resource_name = "birch"
	birches.spacing = {"oak": 3.5}
	birches.spacing_fills = true
	var ferns := make_layer(1.0)
	ferns.resource_name = "fern"
	ferns.proximity_layer = "oak"
	var scatter := make_scatter([oaks, birches, ferns], make_hills(), make_viewer())
	for layer: ScatterLayer in scatter.layers:
		await report_tiles(layer.resource_name, scatter, layer, [Vector2i.ZERO, Vector2i(1, 1)])


func test_surfaces() -> void:
	put_box(Vector3(48.0, 24.0, 40.0))
	var ground := ScatterGroundMeshes.new()
	ground.group = &"ground"
	var layer := make_rich_layer()
	layer.on_surfaces = true
	layer.max_slope_degrees = 180.0
	layer.density_expression = ""
	var scatter := make_scatter([layer], ground, make_viewer())
	await report_tiles("a box", scatter, layer, [Vector2i.ZERO, Vector2i(-1, -1)])
