extends "models_harness.gd"
## Tests a GLB file like those in asset packs: res://tree.glb, which `test_make_glb` wrote in an earlier process and the editor imported.


## Writes the file to import, in a separate process with the argument `make`.
func test_make_glb() -> void:
	if not "make" in arguments:
		check(true, "the file exists")
		return
	var tree := make_tree()
	for shape in tree.find_children("*", "StaticBody3D", true, false): # glTF can describe bodies only by node names.
		shape.free()
	put_mesh(box(Vector3(0.8, 4.0, 0.8), null), "Trunk-convcolonly", tree, tree, Transform3D(Basis(), Vector3(0.2, 2.0, 0.0)))
	var state := GLTFState.new()
	var document := GLTFDocument.new()
	check_equal(document.append_from_scene(tree, state), OK, "the tree is converted to glTF")
	check_equal(document.write_to_filesystem(state, "res://tree.glb"), OK, "the file is written")
	tree.free()


func test_the_imported_model_is_complete() -> void:
	if "make" in arguments:
		check(true, "the file has not been imported yet")
		return
	var tree := make_tree()
	var layer := make_layer(6.0)
	layer.meshes = [load("res://tree.glb")]
	layer.fit_to_meshes()
	check_equal(layer.collision_shape, ScatterLayer.COLLISION_MODEL, "the layer uses the model's collision shape")
	var scatter := make_scatter([layer], ScatterGroundFlat.new(), make_viewer())
	await settle(scatter)
	check(scatter.get_stats()["instances"] > 20, "many instances are placed: %s" % scatter.get_stats())
	var mesh := scatter.get_tile(scatter.layers[0], scatter.get_shown_tiles(scatter.layers[0])[0]).get_mesh(0)
	check_equal(mesh.get_surface_count(), 2, "trunk and leaves are merged into one mesh")
	check(is_close(sorted_faces(mesh.get_faces()), sorted_faces(faces_of_scene(tree, "LOD0"))), "the mesh has the triangles of the first LOD")
	tree.free()
	var model := ScatterModel.new()
	model.scene = load("res://tree.glb")
	check_equal(model.lods.size(), 3, "number of LODs")
	check_equal(model.shapes.size(), 1, "number of shapes")
	check(model.get_problems().is_empty(), "no part is skipped: %s" % model.get_problems())
