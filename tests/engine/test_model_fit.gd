extends "models_harness.gd"
## Tests ScatterLayer.fit_to_meshes and the kind of model that it detects.


func layer_box(layer: ScatterLayer) -> AABB:
	var model := ScatterModel.new()
	model.scene = layer.meshes[0]
	return model.get_mesh().get_aabb()


func test_fit_to_meshes() -> void:
	var layer := ScatterLayer.new()
	check(not layer.fit_to_meshes(), "fit_to_meshes returns false without meshes")
	check_equal(layer.get_model_kind(), ScatterLayer.KIND_AUTOMATIC, "the kind of a layer without meshes")
	check_equal(layer.radius, 2.0, "the radius is unchanged without meshes")
	layer.meshes = [pack(make_tree())]
	layer.fit_to_meshes()
	var box := layer_box(layer)
	var reach := maxf(maxf(-box.position.x, box.end.x), maxf(-box.position.z, box.end.z))
	var width := 0.5 * (box.size.x + box.size.z)
	check(layer.radius > 0.5 * width and layer.radius <= width, "the radius is at most the crown's width: %f of %f" % [layer.radius, width])
	check(is_equal_approx(layer.instance_height, box.end.y), "the instances are as high as the model: %f" % layer.instance_height)
	check_equal(layer.collision_shape, ScatterLayer.COLLISION_MODEL, "a layer of models with shapes uses them")
	check(layer.instance_radius < reach and layer.instance_radius > 1.0, "instance_radius is smaller than the crown: %f" % layer.instance_radius)
	layer = ScatterLayer.new()
	layer.meshes = [box(Vector3(1.0, 0.5, 3.0), null)]
	layer.fit_to_meshes()
	check(is_equal_approx(layer.radius, 3.2), "solid objects have space between them: %f" % layer.radius)
	check_equal(layer.get_model_kind(), ScatterLayer.KIND_ROCK, "the kind of a solid mesh")
	check_equal(layer.collision_shape, ScatterLayer.COLLISION_NONE, "the collision shape of a layer of meshes")


## Instances of a fitted layer vary and are sunk slightly into the ground. A pivot next to the trunk does not increase the radius.
func test_a_fitted_layer_looks_natural() -> void:
	var layer := make_layer(6.0)
	layer.meshes = [pack(make_tree())]
	check(layer.fit_to_meshes(ScatterLayer.KIND_TREE), "fitted")
	var radius := layer.radius
	var scatter := make_scatter([layer], ScatterGroundFlat.new(), make_viewer())
	await settle(scatter)
	var scales := PackedFloat32Array()
	var leans := 0
	for transform: Transform3D in instances(scatter, 0).values():
		scales.append(transform.basis.get_scale().y)
		leans += int(transform.basis.y.normalized().y < 0.9999)
		check(transform.origin.y < 0.0, "the instance's origin is below the ground: %s" % transform.origin)
	scales.sort()
	check(scales.size() > 50 and scales[0] < 0.85 and scales[-1] > 1.15, "the scales range from below 0.85 to above 1.15: %s" % scales.slice(0, 3))
	check(leans > scales.size() / 2, "%d of %d instances lean" % [leans, scales.size()])

	var moved := Node3D.new()
	var tree := make_tree()
	moved.add_child(tree)
	tree.position = Vector3(3.0, 0.0, 0.0)
	for node: Node in [tree] + tree.find_children("*", "", true, false):
		node.owner = moved
	layer = make_layer(6.0)
	layer.meshes = [pack(moved)]
	layer.fit_to_meshes(ScatterLayer.KIND_TREE)
	check(is_equal_approx(layer.radius, radius), "%f with its pivot 3 m aside, %f in the middle" % [layer.radius, radius])


func test_kinds_differ() -> void:
	var layer := ScatterLayer.new()
	layer.meshes = [pack(make_tree())]
	var seen := {}
	for kind: ScatterLayer.ModelKind in [ScatterLayer.KIND_TREE, ScatterLayer.KIND_SHRUB, ScatterLayer.KIND_GRASS, ScatterLayer.KIND_ROCK]:
		check(layer.fit_to_meshes(kind), "kind %d" % kind)
		var values := []
		for property in layer.get_fitted_properties():
			values.append(layer.get(property))
		seen[values] = true
		check(layer.min_scale < 1.0 and layer.max_scale > 1.0 and layer.max_tilt_degrees > 0.0 and layer.height_offset < 0.0, "kind %d varies: %s" % [kind, values])
	check_equal(seen.size(), 4, "four kinds")
	check_equal(layer.get_model_kind(), ScatterLayer.KIND_TREE, "the detected kind does not depend on the requested one")
	var before := layer.radius
	check(not layer.fit_to_meshes(9 as ScatterLayer.ModelKind), "refused")
	check_error(["ScatterLayer.kind", "between 0 and 4", "got 9"], "an unknown kind")
	check_equal(layer.radius, before, "the radius after an unknown kind")


## Names take priority over shapes. A low-poly pack's bushes are as closed as rocks, and its trees as small as shrubs.
func test_names_determine_the_kind() -> void:
	var closed := box(Vector3(1.0, 0.8, 1.0), null)
	var layer := ScatterLayer.new()
	layer.meshes = [closed]
	check_equal(layer.get_model_kind(), ScatterLayer.KIND_ROCK, "without a name, the shape determines the kind")
	closed.resource_name = "Bush_1"
	check_equal(layer.get_model_kind(), ScatterLayer.KIND_SHRUB, "the mesh's name determines the kind")
	layer.fit_to_meshes()
	check(is_equal_approx(layer.radius, 1.0), "the radius is fitted for a shrub: %f" % layer.radius)
	closed.take_over_path("res://tree_small.res")
	check_equal(layer.get_model_kind(), ScatterLayer.KIND_TREE, "the file's name takes priority over the mesh's name")
	closed.take_over_path("res://pines.tscn::1")
	check_equal(layer.get_model_kind(), ScatterLayer.KIND_SHRUB, "the name of a file that contains a built-in mesh is ignored")
	var pack_of_models := Node3D.new()
	for title: String in ["Oak", "Boulder"]:
		put_mesh(box(Vector3.ONE, null), title, pack_of_models, pack_of_models, Transform3D())
	var model := ScatterModel.new()
	model.scene = pack(pack_of_models)
	model.scene.take_over_path("res://plants/ferns.glb")
	layer.meshes = [model]
	check_equal(layer.get_model_kind(), ScatterLayer.KIND_GRASS, "the name of the scene's file determines the kind")
	model.scene_part = "Boulder"
	check_equal(layer.get_model_kind(), ScatterLayer.KIND_ROCK, "the name of the scene's part determines the kind")


class EmptyMesh:
	extends Mesh

	func _get_aabb() -> AABB:
		return AABB(Vector3.ZERO, Vector3(2.0, 1.0, 2.0))

	func _get_surface_count() -> int:
		return 1

	func _surface_get_arrays(_index: int) -> Array:
		return []


func test_a_mesh_without_arrays_has_the_size_of_its_box() -> void:
	var layer := ScatterLayer.new()
	layer.meshes = [EmptyMesh.new()]
	check(layer.fit_to_meshes(ScatterLayer.KIND_SHRUB) and is_equal_approx(layer.radius, 2.0), "the radius equals the width of the mesh's box: %f" % layer.radius)
