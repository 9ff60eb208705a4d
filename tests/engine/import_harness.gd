extends "harness.gd"
## Base class for the import tests. Provides random transforms, multimeshes, and the instances of a layer.

const ImportInstances := preload("res://addons/thicket/import_instances.gd")

var random := RandomNumberGenerator.new()


func some_transform() -> Transform3D:
	var turned := Basis.from_euler(Vector3(random.randf(), random.randf_range(-3, 3), random.randf()))
	return Transform3D(turned.scaled(Vector3.ONE * random.randf_range(0.3, 2.0)),
			Vector3(random.randf_range(-90, 90), random.randf_range(-5, 20), random.randf_range(-90, 90)))


func some_transforms(count: int) -> Array[Transform3D]:
	var result: Array[Transform3D] = []
	for index in count:
		result.push_back(some_transform())
	return result


func floats_of_transforms(all: Array[Transform3D], more := 0) -> PackedFloat32Array:
	var floats := PackedFloat32Array()
	for t in all:
		floats.append_array([t.basis.x.x, t.basis.y.x, t.basis.z.x, t.origin.x, t.basis.x.y, t.basis.y.y, t.basis.z.y, t.origin.y,
				t.basis.x.z, t.basis.y.z, t.basis.z.z, t.origin.z])
		for index in more:
			floats.push_back(random.randf())
	return floats


func make_multimesh(mesh: Mesh, all: Array[Transform3D], data := false) -> MultiMeshInstance3D:
	var node := MultiMeshInstance3D.new()
	node.multimesh = MultiMesh.new()
	node.multimesh.transform_format = MultiMesh.TRANSFORM_3D
	node.multimesh.use_colors = data
	node.multimesh.use_custom_data = data
	node.multimesh.mesh = mesh
	node.multimesh.instance_count = all.size()
	node.multimesh.buffer = floats_of_transforms(all, 8 if data else 0)
	return node


func make_bare(layers: Array[ScatterLayer] = []) -> TerrainScatter3D:
	return make_scatter(layers, ScatterGroundFlat.new(), make_viewer(Vector3(1e5, 0, 0)))


## Checks that a layer's instances are exactly these, placed by hand, in any order.
func check_placed(scatter: TerrainScatter3D, layer: Variant, expected: Array[Transform3D], context: String) -> void:
	var found := scatter.query_rect(Rect2(-250, -250, 500, 500), scatter.layers[layer] if layer is int else layer)
	var wanted := {}
	for each in expected:
		wanted[each] = int(wanted.get(each, 0)) + 1
	var wrong := 0
	for index in found.size():
		var at := found.get_transform(index)
		wrong += int(found.get_id(index) >= 0 or int(wanted.get(at, 0)) == 0)
		wanted[at] = int(wanted.get(at, 0)) - 1
	check(wrong == 0 and found.size() == expected.size(), "%s: %d of %d, %d wrong" % [context, found.size(), expected.size(), wrong])
