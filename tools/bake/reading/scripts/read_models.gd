extends RefCounted
## Makes one mesh of what a model's path names: of a mesh itself, or of the visible parts of a scene.

## Why there is no mesh, in a sentence.
var problem := ""


## The mesh that a path names; null, with a [member problem], for none.
func mesh_at(path: String) -> Mesh:
	var found: Resource = ResourceLoader.load(path) if ResourceLoader.exists(path) else null
	if found is Mesh:
		return found
	if found is PackedScene:
		var merged := _merged(found)
		if merged == null:
			problem = "%s has no visible MeshInstance3D with a mesh." % path
		return merged
	if found == null:
		problem = "%s cannot be loaded: is it in the project?" % path
	else:
		problem = "%s is a %s, where a mesh or a scene is expected." % [path, found.get_class()]
	return null


## All parts of a scene in one mesh, a surface for each material. Of parts that are named for levels of detail, those of the finest.
func _merged(scene: PackedScene) -> ArrayMesh:
	var root := scene.instantiate() if scene.can_instantiate() else null
	if root == null:
		return null
	var tools: Dictionary[Material, SurfaceTool] = {}
	_append(root, Transform3D(), true, tools)
	root.free()
	var mesh: ArrayMesh = null
	for material: Material in tools:
		tools[material].set_material(material)
		mesh = tools[material].commit(mesh)
	return mesh


func _append(node: Node, above: Transform3D, is_root: bool, r_tools: Dictionary[Material, SurfaceTool]) -> void:
	var coarse := RegEx.create_from_string("(?i)lod_?[1-9]\\d*$")
	var here := above
	if node is Node3D:
		if not is_root and (not node.visible or coarse.search(node.name) != null):
			return
		here = Transform3D() if is_root else above * node.transform
	if node is MeshInstance3D and node.mesh != null:
		for surface: int in node.mesh.get_surface_count():
			var material: Material = node.get_active_material(surface)
			if not r_tools.has(material):
				r_tools[material] = SurfaceTool.new()
			r_tools[material].append_from(node.mesh, surface, here)
	for child in node.get_children():
		_append(child, here, false, r_tools)
