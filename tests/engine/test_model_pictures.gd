extends "models_harness.gd"
## Tests that scattered scenes look like the scenes themselves. Compares screenshots of both, so it needs a renderer.

## The maximum fraction of pixels that may differ, because edges may fall on the other side of a sample.
const MOST_DIFFERENT := 0.004


func take_picture() -> Image:
	await frames(4)
	await RenderingServer.frame_post_draw
	return root.get_texture().get_image()


## Returns the fraction of pixels whose color differs visibly, by more than 0.05 over all channels.
func difference(a: Image, b: Image) -> float:
	var differ := 0
	for x in a.get_width():
		for y in a.get_height():
			var from := a.get_pixel(x, y)
			var to := b.get_pixel(x, y)
			differ += int(absf(from.r - to.r) + absf(from.g - to.g) + absf(from.b - to.b) > 0.05)
	return differ / float(a.get_width() * a.get_height())


## Creates a sun, a ground and a camera that overlooks a few trees.
func make_stage() -> Camera3D:
	root.size = Vector2i(320, 180)
	var sun := DirectionalLight3D.new()
	sun.rotation_degrees = Vector3(-40, 30, 0)
	sun.shadow_enabled = true
	root.add_child(sun)
	var floor := put_mesh(PlaneMesh.new(), "Floor", root, null)
	(floor.mesh as PlaneMesh).size = Vector2(200, 200)
	var camera := Camera3D.new()
	root.add_child(camera)
	camera.look_at_from_position(Vector3(-14, 9, -14), Vector3(0, 2, 0))
	camera.make_current()
	return camera


func make_wood(packed: PackedScene, camera: Camera3D) -> TerrainScatter3D:
	var layer := make_layer(7.0)
	layer.meshes = [packed]
	layer.min_scale = 0.7
	layer.max_scale = 1.3
	layer.min_tilt_degrees = 0.0
	layer.max_tilt_degrees = 15.0
	layer.view_distance = 40.0
	return make_scatter([layer], ScatterGroundFlat.new(), camera)


func shown_instances(scatter: TerrainScatter3D) -> Array[Transform3D]:
	var result: Array[Transform3D] = []
	for tile: Vector2i in scatter.get_shown_tiles(scatter.layers[0]):
		for id in tile_ids(scatter, 0, tile)[0]:
			result.append(scatter.get_instance(id).transform)
	return result


## Returns a tree with only the first LOD, so that LOD changes do not affect the comparison.
func near_tree() -> PackedScene:
	var tree := make_tree()
	tree.get_node("LOD1").free()
	tree.get_node("LOD2").free()
	return pack(tree)


func test_a_wood_of_scenes_and_a_wood_of_models() -> void:
	await compare(near_tree())


## The shadow mesh differs from the drawn mesh: leaves cast no shadow, and a large sheet casts only a shadow.
func test_shadows_match_the_scene() -> void:
	var tree := make_tree()
	tree.get_node("LOD1").free()
	tree.get_node("LOD2").free()
	(tree.get_node("LOD0/Crown/Leaves") as MeshInstance3D).cast_shadow = GeometryInstance3D.SHADOW_CASTING_SETTING_OFF
	var sheet := put_mesh(box(Vector3(4.0, 0.1, 4.0), null), "Sheet", tree, tree, Transform3D(Basis(), Vector3(0.0, 5.0, 0.0)))
	sheet.cast_shadow = GeometryInstance3D.SHADOW_CASTING_SETTING_SHADOWS_ONLY
	var plain: Image = await compare(near_tree())
	await clean()
	var other: Image = await compare(pack(tree))
	check(difference(plain, other) > 0.02, "different shadows: %f" % difference(plain, other))


## Returns a layer of small boxes, far enough to be drawn with their second LOD, which looks like the first.
func make_meadow(radius: float, lod_distance: float, shadow: ScatterLod.CastShadow) -> TerrainScatter3D:
	var camera := make_stage()
	camera.look_at_from_position(Vector3(-4, 9, -4), Vector3.ZERO)
	var mesh := box(Vector3(0.4, 0.6, 0.4), null)
	var model := ScatterModel.new()
	var near := ScatterLod.new()
	near.mesh = mesh
	var far := ScatterLod.new()
	far.mesh = mesh
	far.distance = lod_distance
	far.cast_shadow = shadow
	model.lods = [near, far]
	var layer := make_layer(radius)
	layer.meshes = [model]
	layer.view_distance = 20.0
	return make_scatter([layer], ScatterGroundFlat.new(), camera)


## Returns the fraction of the image that changes with the shadows of the meadow that make_meadow returns.
func shadow_of_meadow(radius: float, lod_distance: float, shadow: ScatterLod.CastShadow,
		by_layer := GeometryInstance3D.SHADOW_CASTING_SETTING_ON) -> float:
	var scatter := make_meadow(radius, lod_distance, shadow)
	var layer := scatter.layers[0] as ScatterLayer
	layer.cast_shadow = by_layer
	await settle(scatter)
	var cast: Image = await take_picture()
	var made: int = scatter.get_stats().tiles_made
	layer.cast_shadow = GeometryInstance3D.SHADOW_CASTING_SETTING_OFF
	((layer.meshes[0] as ScatterModel).lods[1] as ScatterLod).cast_shadow = ScatterLod.CAST_SHADOW_LAYER
	await settle(scatter)
	if shadow == ScatterLod.CAST_SHADOW_LAYER:
		check_equal(scatter.get_stats().tiles_made, made, "tiles generated for the layer's shadows")
	var without: Image = await take_picture()
	await clean()
	return difference(cast, without)


func test_far_lods_of_a_dense_layer_cast_no_shadow_by_default() -> void:
	var by_itself := ScatterLod.CAST_SHADOW_LAYER
	check_equal(await shadow_of_meadow(0.8, 7.0, by_itself), 0.0, "shadow of a meadow")
	var shadows := {
		"of an LOD that begins near": await shadow_of_meadow(0.8, 5.0, by_itself),
		"of a sparse layer": await shadow_of_meadow(0.9, 7.0, by_itself),
		"of an LOD with a shadow": await shadow_of_meadow(0.8, 7.0, ScatterLod.CAST_SHADOW_ON),
		"of a double-sided layer":
			await shadow_of_meadow(0.8, 7.0, by_itself, GeometryInstance3D.SHADOW_CASTING_SETTING_DOUBLE_SIDED),
	}
	for kind: String in shadows:
		check(shadows[kind] > 0.05, "the shadow %s changes %f of the image" % [kind, shadows[kind]])


## Checks that a scattered scene looks like nodes of that scene at the same transforms. Returns the screenshot.
func compare(packed: PackedScene) -> Image:
	var camera := make_stage()
	var empty: Image = await take_picture()
	var scatter := make_wood(packed, camera)
	await settle(scatter)
	var scattered: Image = await take_picture()
	var standing := shown_instances(scatter)
	scatter.visible = false
	for at: Transform3D in standing:
		var scene := packed.instantiate() as Node3D
		root.add_child(scene)
		scene.global_transform = at
	var instanced: Image = await take_picture()
	check(standing.size() > 10 and difference(empty, instanced) > 0.1, "trees are visible: %f" % difference(empty, instanced))
	var share := difference(scattered, instanced)
	check(share < MOST_DIFFERENT, "%f of the pixels differ" % share)
	return scattered


func test_nearby_scenes_replace_their_models_invisibly() -> void:
	var packed := near_tree()
	var camera := make_stage()
	var scatter := make_wood(packed, camera)
	await settle(scatter)
	var models: Image = await take_picture()
	var layer := scatter.layers[0]
	layer.scene = packed
	layer.scene_distance = 25.0
	await settle(scatter)
	var scenes: Image = await take_picture()
	check(scatter.get_stats()["scenes"] > 5, "scenes are shown: %s" % scatter.get_stats())
	var share := difference(models, scenes)
	check(share < MOST_DIFFERENT, "%f of the pixels differ" % share)

