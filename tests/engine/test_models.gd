extends "models_harness.gd"
## Tests scenes as models: reading, merging parts into one mesh, LODs, shapes, and rejected input.


func test_a_scene_is_read_part_by_part() -> void:
	var tree := make_tree()
	var expected: Array = range(3).map(func(lod: int) -> Array: return sorted_faces(faces_of_scene(tree, "LOD%d" % lod)))
	var model := ScatterModel.new()
	model.scene = pack(tree)
	check_equal(model.lods.size(), 3, "LODs")
	for lod in 3:
		var mesh := model.get_mesh(lod)
		check_equal(mesh.get_surface_count(), 2, "one surface per material")
		check(is_close(sorted_faces(faces_of(mesh)), expected[lod]), "LOD %d has the triangles of the scene" % lod)
		var colors := range(2).map(func(surface: int) -> Color: return mesh.surface_get_material(surface).albedo_color)
		check_equal(colors, [TRUNK, LEAF], "materials of LOD %d" % lod)
	check(model.get_mesh(3) == null, "no fourth LOD")
	check_equal(model.shapes.size(), 2, "shapes")
	check_equal(model.shape_transforms[0].origin, Vector3(0.2, 2.0, 0.0), "position of the trunk's shape")
	check(model.get_problems().is_empty(), "nothing is skipped: %s" % model.get_problems())
	var size := model.get_mesh(0).get_aabb().size.length()
	check(model.lods[1].distance == 0.0 and size > 4.0, "the distance is not set")


func test_normals_and_tangents_rotate_with_their_parts() -> void:
	var scene := Node3D.new()
	var material := material_of(LEAF)
	var at := Transform3D(Basis(Vector3(1, 2, 0.5).normalized(), 1.1).scaled(Vector3(1.0, 3.0, 0.5)), Vector3(1, 0, 2))
	put_mesh(box(Vector3(1, 2, 3), material), "A", scene, scene, at)
	put_mesh(box(Vector3.ONE, material), "B", scene, scene)
	var model := ScatterModel.new()
	model.scene = pack(scene)
	var mesh := model.get_mesh()
	check_equal(mesh.get_surface_count(), 1, "one material, one surface")
	var arrays := mesh.surface_get_arrays(0)
	var corners: PackedVector3Array = arrays[Mesh.ARRAY_VERTEX]
	var normals: PackedVector3Array = arrays[Mesh.ARRAY_NORMAL]
	var tangents: PackedFloat32Array = arrays[Mesh.ARRAY_TANGENT]
	var indices: PackedInt32Array = arrays[Mesh.ARRAY_INDEX]
	check_equal(corners.size(), 48, "corners of both boxes")
	var bent := 0
	for index in range(0, indices.size(), 3):
		var a := corners[indices[index]]
		var flat := (corners[indices[index + 2]] - a).cross(corners[indices[index + 1]] - a).normalized()
		var corner := indices[index]
		var tangent := Vector3(tangents[4 * corner], tangents[4 * corner + 1], tangents[4 * corner + 2])
		bent += int(flat.dot(normals[corner]) < 0.999 or absf(tangent.dot(flat)) > 0.01)
	check_equal(bent, 0, "normals that differ from the normals of their faces")


func test_a_single_mesh_is_used_directly() -> void:
	var mesh := box(Vector3.ONE, material_of(LEAF))
	var scene := Node3D.new()
	put_mesh(mesh, "Stone", scene, scene)
	var packed := pack(scene)
	var model := ScatterModel.new()
	model.scene = packed
	check_equal(model.get_mesh(), mesh, "the mesh itself is drawn")
	check_equal(model.lods.size(), 1, "LODs")


func test_materials_of_nodes() -> void:
	var scene := Node3D.new()
	var own := material_of(Color.RED)
	var over := material_of(Color.BLUE)
	var all := material_of(Color.WHITE)
	put_mesh(box(Vector3.ONE, own), "Plain", scene, scene, Transform3D(Basis(), Vector3.UP))
	put_mesh(box(Vector3.ONE, own), "Surface", scene, scene).set_surface_override_material(0, over)
	put_mesh(box(Vector3.ONE, own), "Whole", scene, scene).material_override = all
	put_mesh(box(Vector3.ONE, own), "Hidden", scene, scene).visible = false
	var model := ScatterModel.new()
	model.scene = pack(scene)
	var mesh := model.get_mesh()
	var used := range(mesh.get_surface_count()).map(func(surface: int) -> Color: return mesh.surface_get_material(surface).albedo_color)
	check_equal(used, [Color.RED, Color.BLUE, Color.WHITE], "materials, in the order of the nodes")
	check_equal(mesh.get_faces().size(), 3 * 36, "hidden nodes are skipped")


func test_lods_from_names_and_ranges() -> void:
	var scene := Node3D.new()
	var mesh := box(Vector3.ONE, material_of(LEAF))
	put_mesh(mesh, "Tree", scene, scene)
	put_mesh(mesh, "Tree_LOD1", scene, scene).visibility_range_begin = 30.0
	put_mesh(mesh, "tree_lod2", scene, scene)
	var model := ScatterModel.new()
	model.scene = pack(scene)
	check_equal(model.lods.map(func(lod: ScatterLod) -> float: return lod.distance), [0.0, 30.0, 0.0], "from names")
	scene = Node3D.new()
	put_mesh(mesh, "Near", scene, scene).visibility_range_end = 25.0
	var far := put_mesh(mesh, "Far", scene, scene)
	far.visibility_range_begin = 25.0
	far.visibility_range_end = 300.0
	model.scene = pack(scene)
	check_equal(model.lods.map(func(lod: ScatterLod) -> float: return lod.distance), [0.0, 25.0], "from ranges")


func test_lods_that_the_engine_selects_are_kept() -> void:
	var fine := SphereMesh.new()
	var importer := ImporterMesh.new()
	for material in 2:
		importer.add_surface(Mesh.PRIMITIVE_TRIANGLES, fine.get_mesh_arrays(), [], {}, material_of([TRUNK, LEAF][material]))
	importer.generate_lods(60.0, 25.0, [])
	var mesh := importer.get_mesh()
	var coarser: Array = RenderingServer.mesh_get_surface(mesh.get_rid(), 0)["lods"]
	check(coarser.size() > 1, "the mesh has LODs: %d" % coarser.size())
	var scene := Node3D.new()
	put_mesh(mesh, "A", scene, scene, Transform3D(Basis().scaled(Vector3.ONE * 2.0), Vector3.ZERO))
	put_mesh(mesh, "B", scene, scene, Transform3D(Basis().scaled(Vector3.ONE * 2.0), Vector3.UP))
	var model := ScatterModel.new()
	model.scene = pack(scene)
	var merged: Array = RenderingServer.mesh_get_surface(model.get_mesh().get_rid(), 0)["lods"]
	check_equal(merged.size(), coarser.size(), "LODs of the merged mesh")
	for lod in merged.size():
		check(is_equal_approx(merged[lod]["edge_length"], 2.0 * coarser[lod]["edge_length"]), "edge of LOD %d" % lod)
		check_equal(merged[lod]["index_data"].size(), 2 * coarser[lod]["index_data"].size(), "indices of LOD %d" % lod)


func test_shadows_of_nodes() -> void:
	var scene := Node3D.new()
	var mesh := box(Vector3.ONE, material_of(LEAF))
	put_mesh(mesh, "Grass", scene, scene).cast_shadow = GeometryInstance3D.SHADOW_CASTING_SETTING_OFF
	var model := ScatterModel.new()
	model.scene = pack(scene)
	check_equal(model.lods[0].cast_shadow, ScatterLod.CAST_SHADOW_OFF, "casts no shadow")
	scene = Node3D.new()
	put_mesh(mesh, "Trunk", scene, scene)
	put_mesh(mesh, "Leaves", scene, scene, Transform3D(Basis(), Vector3.UP)).cast_shadow = GeometryInstance3D.SHADOW_CASTING_SETTING_OFF
	put_mesh(mesh, "Proxy", scene, scene, Transform3D(Basis(), Vector3.UP * 2.0)).cast_shadow = (
			GeometryInstance3D.SHADOW_CASTING_SETTING_SHADOWS_ONLY)
	model.scene = pack(scene)
	var lod := model.lods[0]
	check_equal(lod.mesh.get_aabb(), AABB(-Vector3.ONE * 0.5, Vector3(1, 2, 1)), "trunk and leaves are drawn")
	check_equal(lod.shadow_mesh.get_aabb(), AABB(-Vector3.ONE * 0.5, Vector3(1, 3, 1)), "trunk and proxy cast shadows")


func test_unsupported_nodes_are_reported() -> void:
	var scene := make_tree()
	put(AnimationPlayer.new(), "Player", scene, scene)
	put(OmniLight3D.new(), "Lamp", scene, scene)
	var skinned := put_mesh(box(Vector3.ONE, null), "Vine", scene, scene)
	skinned.skin = Skin.new()
	var trimesh := ConcavePolygonShape3D.new()
	(put(CollisionShape3D.new(), "Exact", scene, scene) as CollisionShape3D).shape = trimesh
	var model := ScatterModel.new()
	model.scene = pack(scene)
	var problems := "\n".join(model.get_problems())
	for words: String in ["\"Player\" does not play", "\"Lamp\" is not drawn", "\"Vine\" has a skeleton: it is drawn in its rest pose",
			"\"Exact\" is left out: a ConcavePolygonShape3D"]:
		check(words in problems, "reported: %s, got %s" % [words, problems])
	check_equal(model.shapes.size(), 2, "the other shapes are read")


## Returns a plate with two blend shapes. One lifts it by 2 m, and the other moves it along x by 1 m.
func bending_mesh() -> ArrayMesh:
	var mesh := ArrayMesh.new()
	var arrays := PlaneMesh.new().get_mesh_arrays()
	var shapes: Array[Array] = []
	for offset: Vector3 in [Vector3.UP * 2.0, Vector3.RIGHT]:
		mesh.add_blend_shape("Shape%d" % shapes.size())
		var moved := []
		moved.resize(Mesh.ARRAY_TANGENT + 1)
		moved[Mesh.ARRAY_VERTEX] = PackedVector3Array(Array(arrays[Mesh.ARRAY_VERTEX]).map(func(at: Vector3) -> Vector3: return at + offset))
		moved[Mesh.ARRAY_NORMAL] = arrays[Mesh.ARRAY_NORMAL]
		moved[Mesh.ARRAY_TANGENT] = arrays[Mesh.ARRAY_TANGENT]
		shapes.append(moved)
	mesh.blend_shape_mode = Mesh.BLEND_SHAPE_MODE_NORMALIZED
	mesh.add_surface_from_arrays(Mesh.PRIMITIVE_TRIANGLES, arrays, shapes)
	return mesh


func test_weights_of_blend_shapes_are_drawn() -> void:
	var scene := Node3D.new()
	var shown := put_mesh(bending_mesh(), "Plate", scene, scene)
	shown.set_blend_shape_value(0, 0.5)
	shown.set_blend_shape_value(1, 0.25)
	var model := ScatterModel.new()
	model.scene = pack(scene)
	var box := model.get_mesh().get_aabb()
	check(box.position.is_equal_approx(Vector3(-0.75, 1.0, -1.0)), "both blend shapes move the plate: %s" % box)
	check((box.size - Vector3(2.0, 0.0, 2.0)).length() < 0.001, "the size does not change: %s" % box)
	for normal: Vector3 in model.get_mesh().surface_get_arrays(0)[Mesh.ARRAY_NORMAL]:
		check(normal.distance_to(Vector3.UP) < 0.001, "a normal: %s" % normal)


func test_overlays_are_drawn() -> void:
	var scene := Node3D.new()
	var glow := material_of(TRUNK)
	put_mesh(box(Vector3.ONE, material_of(LEAF)), "Stone", scene, scene).material_overlay = glow
	put_mesh(box(Vector3.ONE, material_of(LEAF)), "Plain", scene, scene, Transform3D(Basis(), Vector3.UP * 4.0))
	var model := ScatterModel.new()
	model.scene = pack(scene)
	var mesh := model.get_mesh()
	var over := range(mesh.get_surface_count()).filter(func(surface: int) -> bool: return mesh.surface_get_material(surface) == glow)
	if check(over.size() == 1, "exactly one surface has the overlay"):
		var heights := Array(mesh.surface_get_arrays(over[0])[Mesh.ARRAY_VERTEX]).map(func(at: Vector3) -> float: return at.y)
		check_equal(heights.max(), 0.5, "the overlay is on the part that has it")


func tinted(name: String) -> ShaderMaterial:
	var material := ShaderMaterial.new()
	material.shader = Shader.new()
	material.shader.code = "shader_type spatial;\nrender_mode unshaded;\ninstance uniform vec4 %s : source_color = vec4(1.0);\nvoid fragment() { ALBEDO = %s.rgb; }" % [name, name]
	return material


func test_per_instance_settings_of_nodes() -> void:
	var scene := Node3D.new()
	var leaves := put_mesh(box(Vector3.ONE, tinted("tint")), "Leaves", scene, scene)
	leaves.transparency = 0.25
	var trunk := put_mesh(box(Vector3.ONE, material_of(TRUNK)), "Trunk", scene, scene, Transform3D(Basis(), Vector3.UP))
	trunk.transparency = 0.25
	var model := ScatterModel.new()
	model.scene = with_shader_parameter(pack(scene), "Leaves", "tint = Color(1, 0, 0, 1)")
	check_equal(model.lods[0].instance_shader_parameters, {&"tint": Color.RED}, "a parameter")
	check_equal(model.lods[0].transparency, 0.25, "transparency")
	check_equal(model.get_problems(), PackedStringArray(), "no problems")
	scene = Node3D.new()
	put_mesh(box(Vector3.ONE, tinted("tint")), "Leaves", scene, scene).transparency = 0.25
	put_mesh(box(Vector3.ONE, tinted("tint")), "Other", scene, scene, Transform3D(Basis(), Vector3.UP * 2.0))
	model.scene = with_shader_parameter(pack(scene), "Leaves", "tint = Color(1, 0, 0, 1)")
	var problems := "\n".join(model.get_problems())
	check("\"Other\" has a different instance shader parameter \"tint\"" in problems, "reported: %s" % problems)
	check("\"Other\" has a different transparency" in problems, "reported: %s" % problems)


func test_invalid_scenes_do_not_change_the_model() -> void:
	var model := ScatterModel.new()
	model.scene = pack(make_tree())
	var before := model.scene
	var meshes := [model.get_mesh(0), model.get_mesh(1)]
	for bad: Array in bad_scenes():
		model.scene = bad[0]
		check_equal([model.get_mesh(0), model.get_mesh(1)], meshes, "the old meshes stay")
		check_error(["ScatterModel.scene", bad[1]], bad[1])
		check_equal(model.scene, before, "the old scene is restored")
	model.lods = []
	check_error(["ScatterModel.lods", "set scene to null"], "LODs of a scene cannot be edited")
	model.scene = null
	check_equal(model.get_mesh(0), meshes[0], "without a scene, the model keeps its LODs")
	model.lods = [model.lods[2]]
	check_equal(model.lods.size(), 1, "without a scene, the LODs can be edited")
	model.lods[0].distance = -1.0
	check_error(["ScatterLod.distance", "-1"], "a negative distance")


## An empty model, such as one that is being loaded, keeps an invalid scene, so that saving does not lose the reference.
func test_an_empty_model_keeps_an_invalid_scene() -> void:
	for bad: Array in bad_scenes().slice(1):
		var model := ScatterModel.new()
		model.scene = bad[0]
		check_no_error("setting the scene reads nothing")
		check_equal(model.lods.size(), 0, "there is nothing to draw")
		check_error(["ScatterModel.scene", bad[1]], bad[1])
		check_equal(model.scene, bad[0], "the scene stays")
		check_equal(model.lods.size(), 0, "the scene is not read again")


func test_shapes_set_before_the_scene_is_read_stay() -> void:
	var model := ScatterModel.new()
	model.scene = pack(make_tree())
	model.scene = null
	var own := BoxShape3D.new()
	model.shapes = [own]
	check_equal(model.lods.size(), 3, "the scene that was set last is read")
	check_equal(model.shapes, [own] as Array[Shape3D], "shapes that were set by hand stay")
	check_equal(model.shape_transforms.size(), 2, "their transforms are read")


## Returns invalid scenes, each with a part of its error message.
func bad_scenes() -> Array:
	var mesh := box(Vector3.ONE, null)
	var empty := Node3D.new()
	var flat := Node3D.new()
	put_mesh(mesh, "Leaf", flat, flat, Transform3D(Basis().scaled(Vector3(1, 0, 1)), Vector3.ZERO))
	var crowd := Node3D.new()
	for number in 300:
		put_mesh(mesh, "Part%d" % number, crowd, crowd)
	return [[PackedScene.new(), "it is empty"], [pack(empty), "no visible MeshInstance3D"],
			[pack(flat), "\"Leaf\" has a scale of 0"], [pack(crowd), "more than 256 meshes"]]


func test_saved_models_contain_no_copy_of_their_scene() -> void:
	var scene := pack(make_tree())
	ResourceSaver.save(scene, "user://tree.tscn")
	scene.take_over_path("user://tree.tscn")
	var model := ScatterModel.new()
	model.scene = scene
	ResourceSaver.save(model, "user://tree_model.tres")
	var text := FileAccess.get_file_as_string("user://tree_model.tres")
	check("tree.tscn" in text and not "lods" in text and text.length() < 500, "saved: %s" % text)
	var loaded := ResourceLoader.load("user://tree_model.tres", "", ResourceLoader.CACHE_MODE_IGNORE) as ScatterModel
	check_equal(loaded.lods.size(), 3, "the scene is read after loading")
	model.scene = null
	ResourceSaver.save(model, "user://tree_model.tres")
	loaded = ResourceLoader.load("user://tree_model.tres", "", ResourceLoader.CACHE_MODE_IGNORE) as ScatterModel
	check_equal(loaded.lods.size(), 3, "without a scene, LODs are saved")
	check(is_close(sorted_faces(faces_of(loaded.get_mesh(1))), sorted_faces(faces_of(model.get_mesh(1)))), "the saved LODs have the same meshes")


func test_a_changed_file_is_read_again() -> void:
	var scene := pack(make_tree())
	ResourceSaver.save(scene, "user://changing.tscn")
	var model := ScatterModel.new()
	model.scene = load("user://changing.tscn")
	var changes := [0]
	model.changed.connect(func() -> void: changes[0] += 1)
	var other := Node3D.new()
	put_mesh(box(Vector3(9, 1, 1), null), "Log", other, other)
	ResourceSaver.save(pack(other), "user://changing.tscn")
	check(model.reload(), "it reloads")
	check_equal(model.get_aabb().size, Vector3(9, 1, 1), "the model's size after the file has changed")
	check_equal(changes[0], 1, "one signal")
	var nothing := Node3D.new()
	ResourceSaver.save(pack(nothing), "user://changing.tscn")
	check(not model.reload(), "a file with nothing to draw")
	check_error(["ScatterModel.scene", "changing.tscn", "no visible MeshInstance3D"], "reload")
	check_equal(model.get_aabb().size, Vector3(9, 1, 1), "the model's size after a failed reload")
