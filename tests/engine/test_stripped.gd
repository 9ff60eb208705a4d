extends "models_harness.gd"
## Tests exports for dedicated servers, which contain placeholders instead of meshes and textures. Collision, masks, heights and biomes must
## not change.

const AREA := Rect2(-64, -64, 128, 128)


func stripes(horizontal: bool) -> ImageTexture:
	var image := Image.create_empty(64, 64, false, Image.FORMAT_RGB8)
	for at in 64 * 64:
		var stripe := (at / 64 if horizontal else at % 64) / 8 % 2
		image.set_pixel(at % 64, at / 64, Color(stripe, 0, 0))
	return ImageTexture.create_from_image(image)


func rock() -> ArrayMesh:
	var mesh := ArrayMesh.new()
	mesh.add_surface_from_arrays(Mesh.PRIMITIVE_TRIANGLES, SphereMesh.new().get_mesh_arrays())
	return mesh


func solid_layer(entry: Resource, shape: ScatterLayer.CollisionShape) -> ScatterLayer:
	var layer := make_layer(4.0)
	layer.meshes = [entry]
	layer.collision_shape = shape
	layer.collision_distance = 40.0
	return layer


## Replaces a layer's meshes, those in its scenes, and its mask texture with placeholders, as the engine's export does.
func strip(layer: ScatterLayer) -> void:
	for index in layer.meshes.size():
		if layer.meshes[index] is Mesh:
			layer.meshes[index] = (layer.meshes[index] as Mesh).create_placeholder()
		elif layer.meshes[index] is PackedScene:
			var scene := (layer.meshes[index] as PackedScene).instantiate()
			for shown: MeshInstance3D in scene.find_children("*", "MeshInstance3D", true, false):
				shown.mesh = shown.mesh.create_placeholder()
			layer.meshes[index] = pack(scene)
	if layer.mask_texture:
		layer.mask_texture = layer.mask_texture.create_placeholder()


## Casts a ray from above on each instance near the origin. Returns the heights of the hits in centimeters, or -1 for a ray that hits
## nothing.
func hit_heights(scatter: TerrainScatter3D) -> PackedInt64Array:
	await settle(scatter)
	await physics_frame
	await physics_frame
	var near := scatter.query_sphere(Vector3.ZERO, 30.0)
	var heights := PackedInt64Array()
	for index in near.size():
		var top := near.get_position(index) + Vector3(0.3, 9.0, 0.2)
		var hit := root.world_3d.direct_space_state.intersect_ray(PhysicsRayQueryParameters3D.create(top, top + Vector3.DOWN * 9.5))
		heights.append(roundi(hit["position"].y * 100.0) if hit else -1)
	return heights


## Checks that rays hit the same heights for a layer and for a copy that was stripped, saved and loaded.
func check_same(layer: ScatterLayer, context: String) -> void:
	var scatter := make_scatter([layer], ScatterGroundFlat.new(), make_viewer())
	var before := await hit_heights(scatter)
	check(before.size() > 20 and before.count(-1) < before.size(), "%s: %d instances, %d not hit" % [context, before.size(), before.count(-1)])
	var exported := layer.duplicate() as ScatterLayer
	exported.embed_stripped_data()
	strip(exported)
	ResourceSaver.save(exported, "user://exported.res")
	scatter.layers = [ResourceLoader.load("user://exported.res", "", ResourceLoader.CACHE_MODE_IGNORE)]
	check_equal(await hit_heights(scatter), before, context + ": rays hit the same heights")
	check_equal(scatter.get_problems(), PackedStringArray(), context + ": no problems")
	scatter.free()


func test_shapes_of_models_stay() -> void:
	await check_same(solid_layer(pack(make_tree()), ScatterLayer.COLLISION_MODEL), "model")


func test_convex_hulls_are_stored() -> void:
	await check_same(solid_layer(rock(), ScatterLayer.COLLISION_CONVEX), "mesh")
	await check_same(solid_layer(pack(make_tree()), ScatterLayer.COLLISION_CONVEX), "scene")


func test_the_image_of_a_mask_is_stored() -> void:
	var layer := solid_layer(BoxMesh.new(), ScatterLayer.COLLISION_BOX)
	layer.mask_texture = stripes(false)
	layer.mask_texture_rect = AREA
	await check_same(layer, "mask")


func test_images_of_grounds_and_biomes_replace_textures() -> void:
	var ground := ScatterGroundHeightmap.new()
	ground.image = stripes(true)
	ground.weight_image = stripes(false)
	check(ground.embed_stripped_data(), "the ground stores its images")
	check(ground.image is Image and ground.weight_image is Image, "both are images")
	check(not ground.embed_stripped_data(), "there is no stripped data left to embed")
	var map := ScatterBiomeMap.new()
	map.map_image = stripes(true)
	check(map.embed_stripped_data() and map.map_image is Image, "the biome map stores its image")


func test_missing_data_is_a_problem() -> void:
	var convex := solid_layer(rock(), ScatterLayer.COLLISION_CONVEX)
	var masked := solid_layer(BoxMesh.new(), ScatterLayer.COLLISION_BOX)
	masked.mask_texture = stripes(false)
	strip(convex)
	strip(masked)
	var ground := ScatterGroundHeightmap.new()
	ground.image = PlaceholderTexture2D.new()
	var scatter := make_scatter([convex, masked], ground, make_viewer())
	await frames(3)
	var problems := "\n".join(scatter.get_problems())
	for words: String in ["ScatterGroundHeightmap.image was stripped", "ScatterLayer.meshes[0] was stripped", "ScatterLayer.mask_texture was stripped"]:
		check(words in problems, "reported: %s, got %s" % [words, problems])
	check_no_error("no errors, because only a dedicated server prints a warning")
