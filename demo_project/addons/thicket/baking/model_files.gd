extends RefCounted
## Determines the file paths of a layer's models. Meshes with a file in the project are referenced by its path. Resources that are built into a
## scene or created by a script get new files.

const WholeFile := preload("res://addons/thicket/whole_file.gd")

const FOLDER := "user://thicket_models"

## The models, one for each entry of the layer's [code]meshes[/code]: a [Dictionary] with [code]path[/code], [code]name[/code] and
## [code]lods[/code]. Each LOD has the [code]path[/code] of a mesh and the [code]distance[/code] in meters from which it is drawn.
var models: Array[Dictionary] = []
## The bytes of the new files, by their paths relative to the manifest.
var new_files: Dictionary[String, PackedByteArray] = {}
## The path of the material that replaces the materials of all meshes; empty if there is none.
var material := ""
## The error message; empty if there is none.
var problem := ""

var _layer: ScatterLayer


## Reads [param layer], whose index in the scatter's list is [param index].
func _init(layer: ScatterLayer, index: int) -> void:
	_layer = layer
	DirAccess.make_dir_recursive_absolute(FOLDER)
	if layer.material_override != null:
		material = _path_of(layer.material_override, "models/%d_material.res" % index)
	for entry in layer.meshes.size():
		models.append(_model(layer.meshes[entry], index, entry))


func _model(model: Resource, layer: int, entry: int) -> Dictionary:
	if model == null:
		return {"path": "", "name": "", "lods": []}
	var lods: Array[Dictionary] = []
	for lod in _layer.get_mesh_lods(entry):
		var file := "models/%d_%d%s.res" % [layer, entry, "" if lods.is_empty() else "_%d" % lods.size()]
		lods.append({"path": _path_of(lod.mesh, file), "distance": lod.distance})
	var scene := (model as ScatterModel).scene if model is ScatterModel else null
	var path := _own_path(scene if scene != null else model)
	var name := _name_of(model, path)
	if not path and not lods.is_empty(): # A model without a file is identified by its finest mesh.
		path = lods[0]["path"]
		if name.is_empty():
			var mesh: Mesh = _layer.get_mesh_lods(entry)[0].mesh
			name = _name_of(mesh, _own_path(mesh))
	return {"path": path, "name": name, "lods": lods}


static func _own_path(resource: Resource) -> String:
	var path := resource.resource_path
	return "" if "::" in path else path


## Returns the name of the model or of its file, or an empty string if it has neither.
static func _name_of(model: Resource, path: String) -> String:
	return model.resource_name if model.resource_name else path.get_file().get_basename()


## Returns the resource's path. If it has none, adds its bytes to [member new_files] and returns [param file].
func _path_of(resource: Resource, file: String) -> String:
	var existing_path := _own_path(resource)
	if existing_path:
		return existing_path
	var path := FOLDER.path_join("%d_%s" % [Time.get_ticks_usec(), file.get_file()])
	var error := WholeFile.save_new(resource, path, ResourceSaver.FLAG_COMPRESS)
	if error != OK:
		problem = "Cannot write %s for %s: %s. Check that %s has room and is writable." % [path, file, error_string(error), FOLDER]
		return ""
	var bytes := FileAccess.get_file_as_bytes(path)
	if bytes.is_empty():
		problem = "Cannot read %s for %s: %s. Check that %s has room and is readable." % [
			path, file, error_string(FileAccess.get_open_error()), FOLDER]
	new_files[file] = bytes
	DirAccess.remove_absolute(path)
	return file
