extends "harness.gd"
## Tests impostors without a renderer: baking, saving, rejected input, and impostors as LODs of a layer.

const Bake := preload("res://addons/thicket/bake_impostors.gd")
const Impostor := preload("res://addons/thicket/impostor.gd")
const Models := preload("impostor_models.gd")


## Returns a baker with settings that take little time.
func small() -> Impostor:
	var impostor := Impostor.new()
	impostor.frames = 4
	impostor.frame_size = 32
	impostor.samples = 2
	return impostor


## Returns the middle pixel of the atlas frame that shows the front, along -z, if the frames are hemi-octahedral.
func front_pixel(mesh: Mesh, texture: StringName) -> Color:
	var material := mesh.surface_get_material(0) as ShaderMaterial
	var image := (material.get_shader_parameter(texture) as Texture2D).get_image()
	var side: int = material.get_shader_parameter(&"impostor_frame_size")
	var last: int = material.get_shader_parameter(&"impostor_frames") - 1
	return image.get_pixel(last * side + side / 2, side / 2)


func painted(color: Color) -> StandardMaterial3D:
	var material := StandardMaterial3D.new()
	material.albedo_color = color
	return material


func test_an_impostor_has_two_triangles_and_the_models_box() -> void:
	var impostor := small()
	var tree := Models.tree()
	var mesh := impostor.bake([tree])
	check(impostor.problem.is_empty() and impostor.warnings.is_empty(), impostor.problem + " ".join(impostor.warnings))
	check_equal(mesh.get_faces().size(), 6, "number of corners of the impostor's triangles")
	check(mesh.get_aabb().is_equal_approx(tree.get_aabb()), "box %s, expected %s" % [mesh.get_aabb(), tree.get_aabb()])
	var path := "user://impostor.res"
	check_equal(ResourceSaver.save(mesh, path), OK, "the impostor is saved")
	var loaded := ResourceLoader.load(path, "", ResourceLoader.CACHE_MODE_IGNORE) as Mesh
	for texture: StringName in [&"impostor_albedo", &"impostor_normal"]:
		var before := (mesh.surface_get_material(0) as ShaderMaterial).get_shader_parameter(texture) as Texture2D
		var after := (loaded.surface_get_material(0) as ShaderMaterial).get_shader_parameter(texture) as Texture2D
		check_equal(after.get_image().get_data(), before.get_image().get_data(), "%s after saving and loading" % texture)
		check(before.get_image().has_mipmaps(), "mip maps of %s" % texture)
	check_equal(Impostor.switch_distance(loaded), Impostor.switch_distance(mesh), "distance after saving and loading")
	check(Impostor.switch_distance(mesh) > 50.0, "distance: %f" % Impostor.switch_distance(mesh))
	check_equal(Impostor.switch_distance(tree), 0.0, "distance of a mesh that is not an impostor")
	DirAccess.remove_absolute(path)


func test_parts_use_their_transforms() -> void:
	var impostor := small()
	var box := BoxMesh.new()
	var mesh := impostor.bake([box, box], [Transform3D.IDENTITY, Transform3D(Basis.from_scale(Vector3(1, 2, 1)), Vector3(0, 3, 0))])
	check(mesh.get_aabb().is_equal_approx(AABB(Vector3(-0.5, -0.5, -0.5), Vector3(1.0, 4.5, 1.0))), str(mesh.get_aabb()))
	check(front_pixel(mesh, &"impostor_normal").b > 0.9, "the normal faces the front: %s" % front_pixel(mesh, &"impostor_normal"))


func test_materials_are_read() -> void:
	var impostor := small()
	var box := BoxMesh.new()
	box.material = painted(Color(0.8, 0.4, 0.2))
	check(front_pixel(impostor.bake([box]), &"impostor_albedo").is_equal_approx(Color8(204, 102, 51)), "the impostor has the material's color")
	var image := Image.create_empty(64, 64, false, Image.FORMAT_RGBA8)
	image.fill(Color(0.0, 0.0, 1.0))
	(box.material as StandardMaterial3D).albedo_texture = ImageTexture.create_from_image(image)
	check(front_pixel(impostor.bake([box]), &"impostor_albedo").is_equal_approx(Color8(0, 0, 51)), "multiplied by the texture")
	var twice := impostor.bake([box, box], [Transform3D.IDENTITY, Transform3D(Basis(), Vector3(0.0, 0.0, 2.0))])
	check(front_pixel(twice, &"impostor_albedo").is_equal_approx(Color8(0, 0, 51)), "a second part with the same texture has the same color")
	image.fill(Color(0.0, 0.0, 1.0, 0.2))
	(box.material as StandardMaterial3D).albedo_texture = ImageTexture.create_from_image(image)
	check_equal(front_pixel(impostor.bake([box]), &"impostor_albedo").a, 1.0, "alpha of an opaque material")
	(box.material as StandardMaterial3D).transparency = BaseMaterial3D.TRANSPARENCY_ALPHA_SCISSOR
	check_equal(front_pixel(impostor.bake([box]), &"impostor_albedo").a, 0.0, "alpha of a transparent material")
	impostor.material_override = painted(Color.GREEN)
	check(front_pixel(impostor.bake([box]), &"impostor_albedo").is_equal_approx(Color.GREEN), "the impostor has the color of the override")


func test_shader_parameters_are_read_by_common_names() -> void:
	var impostor := small()
	var box := BoxMesh.new()
	var material := ShaderMaterial.new()
	material.resource_name = "Leaves"
	material.shader = Shader.new()
	material.shader.code = "shader_type spatial; uniform vec4 albedo : source_color; void fragment() { ALBEDO = albedo.rgb; }"
	material.set_shader_parameter(&"albedo", Color.RED)
	box.material = material
	check(front_pixel(impostor.bake([box]), &"impostor_albedo").is_equal_approx(Color.RED), "the impostor has the color of the shader parameter")
	check(impostor.warnings.is_empty(), str(impostor.warnings))
	material.shader.code = "shader_type spatial; void fragment() { ALBEDO = vec3(UV, 0.0); }"
	impostor.bake([box])
	check_equal(impostor.warnings.size(), 1, "number of warnings")
	check("'Leaves'" in impostor.warnings[0] and "stand_ins" in impostor.warnings[0], impostor.warnings[0])
	impostor.stand_ins = {material: painted(Color.BLUE)}
	check(front_pixel(impostor.bake([box]), &"impostor_albedo").is_equal_approx(Color.BLUE), "the impostor has the color of the stand-in")
	check(impostor.warnings.is_empty(), str(impostor.warnings))


func test_bad_input() -> void:
	var impostor := small()
	check(impostor.bake([]) == null and "no triangles" in impostor.problem, impostor.problem)
	check(impostor.bake([null]) == null and "missing" in impostor.problem, impostor.problem)
	impostor.frame_size = 100
	check(impostor.bake([BoxMesh.new()]) == null and "frame_size" in impostor.problem, impostor.problem)
	check_error(["ScatterImpostorBaker.frame_size must be between", "a power of two", "got 100"], "frame_size")
	var baker := ScatterImpostorBaker.new()
	var error: Error = baker.bake()
	check_equal(error, ERR_INVALID_DATA, "baking nothing")
	check_error(["ScatterImpostorBaker.surfaces is missing"], "nothing")
	check_equal(baker.add_surface([PackedInt32Array()]), ERR_INVALID_DATA, "no vertices")
	check_error(["ScatterImpostorBaker.arrays"], "no vertices")
	var arrays := BoxMesh.new().get_mesh_arrays()
	check_equal(baker.add_surface(arrays, Transform3D.IDENTITY, Color.WHITE, null, 2.0), ERR_INVALID_DATA, "alpha_threshold")
	check_error(["ScatterImpostorBaker.alpha_threshold must be between 0 and 1, got 2"], "alpha_threshold")
	arrays[Mesh.ARRAY_INDEX][0] = 1000
	check_equal(baker.add_surface(arrays), ERR_INVALID_DATA, "indices")
	check_error(["ScatterImpostorBaker.indices must be at most", "got 1000"], "indices")
	check(baker.get_albedo_image() == null and baker.get_normal_image() == null, "no images")


func test_a_bake_can_be_canceled() -> void:
	var impostor := Impostor.new()
	check_equal(impostor.begin([Models.stone()]), OK, "the bake starts")
	check(impostor.is_baking(), "it is baking")
	impostor.cancel()
	check(not impostor.is_baking() and impostor.finish() == null, "the bake has ended without a result")
	check_equal(impostor.begin([Models.stone()]), OK, "started again, and released")


func run_to_end(bake: Bake) -> void:
	while bake.step():
		await process_frame


func test_a_bake_adds_a_last_lod() -> void:
	var layer := make_layer()
	layer.meshes = [Models.stone(), null, with_lods([BoxMesh.new()], [[SphereMesh.new()]], [5.0])[0]]
	layer.max_scale = 2.0
	var bake := Bake.new()
	bake.impostor = small()
	check_equal(bake.begin(layer, "user://impostors", "stones"), OK, "started: " + bake.problem)
	await run_to_end(bake)
	check_equal(bake.problem, "", "the bake reports no problem")
	check_equal(bake.progress, 1.0, "the bake is complete")
	check_equal(bake.files, PackedStringArray(["user://impostors/stones_impostor_0.res", "user://impostors/stones_impostor_2.res"]), "the bake lists its files")
	var models: Array = layer.meshes.duplicate()
	layer.meshes = bake.meshes
	check_equal(range(3).map(func(entry: int) -> int: return layer.get_mesh_lods(entry).size()), [2, 0, 3], "LODs, and the missing mesh")
	check((models[2] as ScatterModel).lods.size() == 2 and lod_mesh(layer, 2, 1) is SphereMesh, "the former model is unchanged, and its LODs stay")
	var expected := 2.0 * maxf(Impostor.switch_distance(bake.baked[0]), Impostor.switch_distance(bake.baked[2]))
	for entry: int in [0, 2]:
		var far: ScatterLod = layer.get_mesh_lods(entry)[-1]
		check(far.mesh == bake.baked[entry] and absf(far.distance - expected) <= 0.5, "%f, expected %f" % [far.distance, expected])
	check_equal(bake.begin(layer, "user://impostors", "stones"), OK, "the bake starts again")
	await run_to_end(bake)
	layer.meshes = bake.meshes
	check_equal(layer.get_mesh_lods(2).size(), 3, "the impostors are replaced")
	var tree := MeshInstance3D.new()
	tree.mesh = BoxMesh.new()
	var scene := PackedScene.new()
	scene.pack(tree)
	tree.free()
	layer.meshes = [scene]
	for time in 2:
		check_equal(bake.begin(layer, "user://impostors", "stones"), OK, "a scene, %d" % time)
		await run_to_end(bake)
		layer.meshes = bake.meshes
		check((layer.meshes[0] as ScatterModel).scene == scene, "the model uses the scene")
		check_equal(layer.get_mesh_lods(0).map(func(lod: ScatterLod) -> bool: return lod.mesh == bake.baked[0]), [false, true], "LODs of the scene")
	bake.files.append("user://impostors/stones_impostor_2.res")
	check_equal(bake.begin(layer, "user://impostors", "a/b"), ERR_INVALID_PARAMETER, "an invalid name")
	layer.meshes = []
	check_equal(bake.begin(layer, "user://impostors", "stones"), ERR_UNCONFIGURED, "no mesh")
	for file in bake.files:
		DirAccess.remove_absolute(file)
