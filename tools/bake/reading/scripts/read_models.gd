extends RefCounted
## Loads the mesh at a model's path. Bakes refer to meshes. Old bakes may also refer to scenes, whose models only Thicket's library can read.

## The reason why the last mesh could not be loaded.
var problem := ""


## Returns the mesh at [param path], or the finest LOD if it is a scene. On failure, returns null and sets [member problem].
func mesh_at(path: String) -> Mesh:
	var resource: Resource = ResourceLoader.load(path) if ResourceLoader.exists(path) else null
	if resource is Mesh:
		return resource
	if resource is PackedScene:
		return _finest(resource, path)
	if resource == null:
		problem = "%s cannot be loaded: check that it is in the project." % path
	else:
		problem = "%s must be a mesh or a scene, but is a %s." % [path, resource.get_class()]
	return null


## Returns the finest LOD of a scene, which only Thicket's library can read. A project that only displays bakes may lack the library.
func _finest(scene: PackedScene, path: String) -> Mesh:
	if not ClassDB.class_exists(&"ScatterModel"):
		problem = "%s is a scene, which only Thicket's library can read. Install the whole add-on in this project, or bake again: new bakes contain the mesh." % path
		return null
	var model: Resource = ClassDB.instantiate(&"ScatterModel")
	model.set(&"scene", scene)
	var mesh: Mesh = model.call(&"get_mesh", 0)
	if mesh == null:
		problem = "%s has no visible MeshInstance3D with a mesh: add one, or remove the scene from the layer and bake again." % path
	return mesh
