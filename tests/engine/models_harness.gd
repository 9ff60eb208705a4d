extends "harness.gd"
## Base class for the model tests. Builds scenes like those that artists make.

const TRUNK := Color(0.4, 0.3, 0.2)
const LEAF := Color(0.1, 0.6, 0.2)


func material_of(color: Color) -> StandardMaterial3D:
	var material := StandardMaterial3D.new()
	material.albedo_color = color
	return material


## Returns a box with its own material.
func box(size: Vector3, material: Material) -> BoxMesh:
	var mesh := BoxMesh.new()
	mesh.size = size
	mesh.material = material
	return mesh


## Adds a node to a scene and sets its owner, so that packing the scene includes it.
func put(node: Node, name: String, parent: Node, scene: Node, at := Transform3D()) -> Node:
	node.name = name
	parent.add_child(node)
	node.owner = scene
	if node is Node3D:
		(node as Node3D).transform = at
	return node


func put_mesh(mesh: Mesh, name: String, parent: Node, scene: Node, at := Transform3D()) -> MeshInstance3D:
	var instance := put(MeshInstance3D.new(), name, parent, scene, at) as MeshInstance3D
	instance.mesh = mesh
	return instance


func pack(scene: Node) -> PackedScene:
	var packed := PackedScene.new()
	packed.pack(scene)
	scene.free()
	return packed


## Returns a tree with two materials, three LODs, parts under rotated and scaled parents, and collision shapes.
func make_tree() -> Node3D:
	var bark := material_of(TRUNK)
	var leaves := material_of(LEAF)
	var scene := Node3D.new()
	scene.name = "Tree"
	var turned := Transform3D(Basis(Vector3.UP, 0.7).scaled(Vector3(1.5, 2.0, 1.5)), Vector3(0.2, 0.5, 0.0))
	for lod in 3:
		var group := put(Node3D.new(), "LOD%d" % lod, scene, scene, turned)
		put_mesh(box(Vector3(0.4, 2.0, 0.4), bark), "Trunk", group, scene, Transform3D(Basis(), Vector3(0.0, 1.0, 0.0)))
		var crown := put(Node3D.new(), "Crown", group, scene, Transform3D(Basis(Vector3.RIGHT, 0.4), Vector3(0.3, 2.0, 0.1)))
		put_mesh(box(Vector3.ONE * (2.0 - 0.3 * lod), leaves), "Leaves", crown, scene, Transform3D(Basis(), Vector3(0.0, 0.5, 0.0)))
		if lod == 0:
			put_mesh(box(Vector3(0.2, 0.2, 1.5), bark), "Branch", crown, scene, Transform3D(Basis(), Vector3(0.0, -0.4, 0.5)))
	var body := put(StaticBody3D.new(), "Body", scene, scene)
	var trunk := CylinderShape3D.new()
	trunk.radius = 0.4
	trunk.height = 4.0
	(put(CollisionShape3D.new(), "Trunk", body, scene, Transform3D(Basis(), Vector3(0.2, 2.0, 0.0))) as CollisionShape3D).shape = trunk
	var crown_shape := BoxShape3D.new()
	crown_shape.size = Vector3(3.0, 1.0, 1.0)
	(put(CollisionShape3D.new(), "Crown", body, scene, Transform3D(Basis(Vector3.UP, 0.5), Vector3(0.0, 4.5, 0.5))) as CollisionShape3D).shape = crown_shape
	return scene


## Returns the triangles of all surfaces, three corners each.
func faces_of(mesh: Mesh) -> PackedVector3Array:
	return mesh.get_faces()


## Returns the triangles of a scene's meshes whose paths start with `lod`, the name of an LOD's group, in the scene's space.
func faces_of_scene(scene: Node3D, lod: String) -> PackedVector3Array:
	var faces := PackedVector3Array()
	for instance: MeshInstance3D in scene.find_children("*", "MeshInstance3D", true, false):
		if not scene.get_path_to(instance).get_concatenated_names().begins_with(lod):
			continue
		var at := Transform3D()
		var node: Node = instance
		while node != scene:
			at = (node as Node3D).transform * at
			node = node.get_parent()
		faces.append_array(at * instance.mesh.get_faces())
	return faces


## Returns the triangles in sorted order, with coordinates rounded to 0.1 mm.
func sorted_faces(faces: PackedVector3Array) -> Array:
	var result := []
	for at in range(0, faces.size(), 3):
		var corners := [faces[at].snappedf(1e-4), faces[at + 1].snappedf(1e-4), faces[at + 2].snappedf(1e-4)]
		corners.sort()
		result.append(corners)
	result.sort()
	return result


func is_close(a: Array, b: Array) -> bool:
	if a.size() != b.size():
		return false
	for index in a.size():
		for corner in 3:
			if (a[index][corner] as Vector3).distance_to(b[index][corner]) > 3e-4:
				return false
	return true
