extends SceneTree
## Writes res://pack/oak.glb, a tree like those in asset packs: trunk and leaves with a material each, three LODs by name, and a collision
## shape. Saves the texture of leaves and bark next to it. The tree is the demo's oak, whose scripts are in res://meshes.

const FILE := "res://pack/oak.glb"

var oak: GDScript = load("res://meshes/oak.gd")
var atlas: GDScript = load("res://meshes/leaf_atlas.gd")


func _initialize() -> void:
	DirAccess.make_dir_recursive_absolute("res://pack")
	var picture: Image = atlas.texture().get_image()
	var root_node := Node3D.new()
	root_node.name = "Oak"
	var bark := material_of("Bark")
	var leaves := material_of("Leaves")
	for level in 3:
		var parts := parts_of(level)
		put(root_node, "Trunk_LOD%d" % level, parts[0].mesh_of(0, bark))
		put(root_node, "Crown_LOD%d" % level, parts[1].mesh_of(0, leaves))
	var shape := BoxMesh.new()
	shape.size = Vector3(0.9, 5.0, 0.9)
	put(root_node, "Stop-convcolonly", shape).position.y = 2.5
	var state := GLTFState.new()
	var document := GLTFDocument.new()
	assert(document.append_from_scene(root_node, state) == OK)
	assert(document.write_to_filesystem(state, FILE) == OK)
	root_node.free()
	picture.clear_mipmaps()
	assert(picture.save_png("res://pack/oak.png") == OK)
	print("written")
	quit()


## Returns the trunk and the crown of an LOD.
func parts_of(level: int) -> Array:
	var random := RandomNumberGenerator.new()
	random.seed = 100
	var clumps: Array[Vector4] = oak.clumps_of(random, 0)
	var heart: Array[Vector4] = [Vector4(0.0, 9.4, 0.0, 3.7)]
	var builder: GDScript = load("res://meshes/mesh_builder.gd")
	var trunk: RefCounted = builder.new()
	var crown: RefCounted = builder.new()
	var branches: Array[Vector4] = []
	if level == 0:
		branches = clumps
	trunk.begin_level()
	crown.begin_level()
	oak.trunk(trunk, branches, [6, 4, 3][level])
	var leaves: RefCounted = oak.crown(Vector2.ONE, random)
	leaves.add(crown, heart, [22, 10, 5][level], [1.3, 1.8, 2.4][level])
	leaves.add(crown, clumps, [22, 7, 3][level], [1.0, 1.6, 2.2][level])
	for part: RefCounted in [trunk, crown]:
		part.end(PackedFloat32Array())
	return [trunk, crown]


func material_of(title: String) -> StandardMaterial3D:
	var new_material := StandardMaterial3D.new()
	new_material.resource_name = title
	new_material.vertex_color_use_as_albedo = true
	new_material.roughness = 1.0
	new_material.albedo_color = Color(0.5, 0.5, 0.5) # Plain gray without a texture, as in many imported files.
	return new_material


func put(parent: Node3D, title: String, mesh: Mesh) -> MeshInstance3D:
	var node := MeshInstance3D.new()
	node.name = title
	node.mesh = mesh
	parent.add_child(node)
	node.owner = parent
	return node
