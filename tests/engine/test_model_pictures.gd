extends "models_harness.gd"
## What is scattered of a scene looks as the scene does: pictures of both, side by side. Needs a renderer.

const MOST_DIFFERENT := 0.004 ## Of the pixels: edges that fall to the other side of a sample.


func take_picture() -> Image:
	await frames(4)
	await RenderingServer.frame_post_draw
	return root.get_texture().get_image()


## The share of pixels that differ by more than a few steps of 255.
func difference(a: Image, b: Image) -> float:
	var differ := 0
	for x in a.get_width():
		for y in a.get_height():
			var from := a.get_pixel(x, y)
			var to := b.get_pixel(x, y)
			differ += int(absf(from.r - to.r) + absf(from.g - to.g) + absf(from.b - to.b) > 0.05)
	return differ / float(a.get_width() * a.get_height())


## Sun, sky and a camera that looks over a few trees.
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
	for tile: Vector2i in scatter.get_shown_tiles(0):
		for id in tile_ids(scatter, 0, tile)[0]:
			result.append(scatter.get_instance(id).transform)
	return result


## The near LOD alone: where LODs change is not what is compared.
func near_tree() -> PackedScene:
	var tree := make_tree()
	tree.get_node("LOD1").free()
	tree.get_node("LOD2").free()
	return pack(tree)


func test_a_wood_of_scenes_and_a_wood_of_models() -> void:
	await compare(near_tree())


## Leaves that cast no shadow, and a large sheet that casts nothing else: another mesh than the one that is drawn.
func test_shadows_are_those_of_the_scene() -> void:
	var tree := make_tree()
	tree.get_node("LOD1").free()
	tree.get_node("LOD2").free()
	(tree.get_node("LOD0/Crown/Leaves") as MeshInstance3D).cast_shadow = GeometryInstance3D.SHADOW_CASTING_SETTING_OFF
	var sheet := put_mesh(box(Vector3(4.0, 0.1, 4.0), null), "Sheet", tree, tree, Transform3D(Basis(), Vector3(0.0, 5.0, 0.0)))
	sheet.cast_shadow = GeometryInstance3D.SHADOW_CASTING_SETTING_SHADOWS_ONLY
	var plain: Image = await compare(near_tree())
	await clean()
	var other: Image = await compare(pack(tree))
	check(difference(plain, other) > 0.02, "other shadows: %f" % difference(plain, other))


## A layer of small boxes all of which are so far away that their second LOD is drawn, which looks as the first one does.
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


## How much of the picture of such a layer its shadows change.
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
		check_equal(scatter.get_stats().tiles_made, made, "tiles made, the layer's shadows are another matter")
	var without: Image = await take_picture()
	await clean()
	return difference(cast, without)


func test_far_lods_of_a_dense_layer_cast_no_shadow_unless_somebody_says_so() -> void:
	var by_itself := ScatterLod.CAST_SHADOW_LAYER
	check_equal(await shadow_of_meadow(0.8, 7.0, by_itself), 0.0, "shadow of a meadow")
	var shadows := {
		"of an LOD that begins near": await shadow_of_meadow(0.8, 5.0, by_itself),
		"of a layer that is not dense": await shadow_of_meadow(0.9, 7.0, by_itself),
		"of an LOD that is to cast one": await shadow_of_meadow(0.8, 7.0, ScatterLod.CAST_SHADOW_ON),
		"of a layer that says more than on":
			await shadow_of_meadow(0.8, 7.0, by_itself, GeometryInstance3D.SHADOW_CASTING_SETTING_DOUBLE_SIDED),
	}
	for what: String in shadows:
		check(shadows[what] > 0.05, "the shadow %s changes %f of the picture" % [what, shadows[what]])


## Checks that what is scattered of a scene looks as the scenes do, and returns the picture.
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
	check(standing.size() > 10 and difference(empty, instanced) > 0.1, "trees are in the picture: %f" % difference(empty, instanced))
	var share := difference(scattered, instanced)
	check(share < MOST_DIFFERENT, "%f of the pixels differ" % share)
	return scattered


func test_scenes_near_by_take_the_place_of_their_models_unseen() -> void:
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
	check(scatter.get_stats()["scenes"] > 5, "scenes stand: %s" % scatter.get_stats())
	var share := difference(models, scenes)
	check(share < MOST_DIFFERENT, "%f of the pixels differ" % share)

