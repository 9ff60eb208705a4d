extends "models_harness.gd"
## Tests models that use one part of a scene, and scenes with mirrored parts.


## Returns three parts side by side: a moved node, a node under a scaled group, and a node whose vertices are moved.
func make_pack() -> PackedScene:
	var scene := Node3D.new()
	var group := put(Node3D.new(), "Group", scene, scene, Transform3D(Basis().scaled(Vector3.ONE * 2.0), Vector3(20.0, 0.0, 0.0))) as Node3D
	put_mesh(box(Vector3(1.0, 4.0, 1.0), null), "Moved", scene, scene, Transform3D(Basis(), Vector3(10.0, 2.0, -5.0)))
	put_mesh(box(Vector3(1.0, 1.0, 1.0), null), "Scaled", group, scene, Transform3D(Basis(), Vector3(0.0, 0.5, 0.0)))
	var baked := SurfaceTool.new()
	baked.append_from(box(Vector3(2.0, 1.0, 3.0), null), 0, Transform3D(Basis(), Vector3(-30.0, 0.5, 7.0)))
	put_mesh(baked.commit(), "Baked", scene, scene)
	return pack(scene)


func test_one_part_of_a_pack() -> void:
	var scene := make_pack()
	var boxes := {"Moved": AABB(Vector3(-0.5, 0.0, -0.5), Vector3(1.0, 4.0, 1.0)), "Group/Scaled": AABB(Vector3(-1.0, 0.0, -1.0), Vector3.ONE * 2.0),
		"Group": AABB(Vector3(-1.0, 0.0, -1.0), Vector3.ONE * 2.0), "Baked": AABB(Vector3(-1.0, 0.0, -1.5), Vector3(2.0, 1.0, 3.0))}
	for path: String in boxes:
		var model := ScatterModel.new()
		model.scene_part = path
		model.scene = scene
		check(model.get_aabb().is_equal_approx(boxes[path]), "%s is at the origin: %s" % [path, model.get_aabb()])
	var model := ScatterModel.new()
	model.scene = scene
	check(model.get_aabb().size.x > 40.0, "without a path, the model is the whole scene")
	var mesh := model.get_mesh(0)
	model.scene_part = "Missing"
	check_equal(model.get_mesh(0), mesh, "the content stays")
	check_error(["ScatterModel.scene", "no descendant \"Missing\"", "scene_part"], "a path without a node")
	check_equal(model.scene_part, "", "scene_part is restored to the last valid path")
	model.scene_part = "Moved"
	ResourceSaver.save(model, "user://part.tres")
	var loaded := ResourceLoader.load("user://part.tres", "", ResourceLoader.CACHE_MODE_IGNORE) as ScatterModel
	check(loaded.get_aabb().is_equal_approx(boxes["Moved"]), "the saved and loaded model has the same bounds: %s" % loaded.get_aabb())


## Asset packs often contain parts that are mirror images of other parts.
func test_mirrored_parts_are_drawn() -> void:
	var lopsided := ArrayMesh.new()
	var tool := SurfaceTool.new()
	tool.create_from(SphereMesh.new(), 0)
	tool.generate_tangents()
	lopsided = tool.commit()
	var scene := Node3D.new()
	put_mesh(lopsided, "Right", scene, scene, Transform3D(Basis(), Vector3(2.0, 0.0, 0.0)))
	put_mesh(lopsided, "Left", scene, scene, Transform3D(Basis().scaled(Vector3(-1.0, 1.0, 1.0)), Vector3(-2.0, 0.0, 0.0)))
	var box_node := CollisionShape3D.new()
	var hull := CollisionShape3D.new()
	box_node.shape = BoxShape3D.new()
	hull.shape = lopsided.create_convex_shape()
	for shape: CollisionShape3D in [box_node, hull]:
		shape.name = "Hull" if shape == hull else "Box"
		shape.scale.z = -2.0
		scene.add_child(shape)
		shape.owner = scene
	var model := ScatterModel.new()
	model.scene = pack(scene)
	check_equal(model.shapes.size(), 1, "shapes of the model: only the box")
	check(model.shape_transforms[0].basis.determinant() > 0.0 and is_equal_approx(model.shape_transforms[0].basis.get_scale().z, 2.0), "the shape is not mirrored and keeps its scale: %s" % model.shape_transforms[0])
	check(model.get_problems().size() == 1 and "\"Hull\" is left out" in model.get_problems()[0], "the hull is left out: %s" % model.get_problems())
	var drawn := model.get_mesh(0)
	check_equal(drawn.get_faces().size(), 2 * lopsided.get_faces().size(), "both parts")
	var inside_out := 0
	var faces := drawn.get_faces()
	for at in range(0, faces.size(), 3):
		var middle := Vector3(2.0 * signf(faces[at].x), 0.0, 0.0)
		var normal := (faces[at + 2] - faces[at]).cross(faces[at + 1] - faces[at])
		inside_out += int(normal.length() > 1e-6 and normal.dot(faces[at] - middle) < 0.0)
	check_equal(inside_out, 0, "no triangle shows its back")
	var arrays := drawn.surface_get_arrays(0)
	var normals: PackedVector3Array = arrays[Mesh.ARRAY_NORMAL]
	var vertices: PackedVector3Array = arrays[Mesh.ARRAY_VERTEX]
	var tangents: PackedFloat32Array = arrays[Mesh.ARRAY_TANGENT]
	var signs := {}
	for at in vertices.size():
		check(normals[at].dot(vertices[at] - Vector3(2.0 * signf(vertices[at].x), 0.0, 0.0)) > 0.0, "normals point outward")
		signs[Vector2(signf(vertices[at].x), tangents[4 * at + 3])] = true
	check_equal(signs.size(), 2, "the mirrored part has the other handedness: %s" % [signs.keys()])


## In some packs, a part's position is baked into its vertices, and its node is at the origin.
func test_a_part_moves_to_the_origin_with_its_shapes() -> void:
	var scene := Node3D.new()
	var at := Transform3D(Basis(), Vector3(-30.0, 0.5, 7.0))
	var baked := SurfaceTool.new()
	baked.append_from(box(Vector3.ONE, null), 0, at)
	var part := put_mesh(baked.commit(), "Baked", scene, scene)
	var shape := put(CollisionShape3D.new(), "Shape", part, scene, at) as CollisionShape3D
	shape.shape = BoxShape3D.new()
	var model := ScatterModel.new()
	model.scene_part = "Baked"
	model.scene = pack(scene)
	check(model.get_aabb().position.is_equal_approx(Vector3(-0.5, 0.0, -0.5)), "its mesh: %s" % model.get_aabb())
	check(model.shape_transforms[0].origin.is_equal_approx(Vector3(0.0, 0.5, 0.0)), "its shape: %s" % model.shape_transforms)


func test_mirrored_strips_are_drawn() -> void:
	var arrays := []
	arrays.resize(Mesh.ARRAY_MAX)
	arrays[Mesh.ARRAY_VERTEX] = PackedVector3Array([Vector3(0, 0, 0), Vector3(0, 1, 0), Vector3(1, 0, 0), Vector3(1, 1, 0)])
	arrays[Mesh.ARRAY_NORMAL] = PackedVector3Array([Vector3.BACK, Vector3.BACK, Vector3.BACK, Vector3.BACK])
	arrays[Mesh.ARRAY_INDEX] = PackedInt32Array([0, 1, 2, 3])
	var strip := ArrayMesh.new()
	strip.add_surface_from_arrays(Mesh.PRIMITIVE_TRIANGLE_STRIP, arrays, [], {0.5: PackedInt32Array([0, 1, 3])})
	var scene := Node3D.new()
	put_mesh(strip, "Left", scene, scene, Transform3D(Basis().scaled(Vector3(-1.0, 1.0, 1.0)), Vector3.ZERO))
	var model := ScatterModel.new()
	model.scene = pack(scene)
	var faces := model.get_mesh(0).get_faces()
	var seen := 0
	for at in range(0, faces.size(), 3):
		var normal := (faces[at + 2] - faces[at]).cross(faces[at + 1] - faces[at])
		check(normal.z > -1e-6, "no triangle shows its back: %s" % normal)
		seen += int(normal.z > 0.5)
	check_equal(seen, 2, "both triangles")
	var lods: Array = RenderingServer.mesh_get_surface(model.get_mesh(0).get_rid(), 0).lods
	check_equal(lods.size(), 1, "its LOD")
