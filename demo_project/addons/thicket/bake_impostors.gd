extends RefCounted
## Bakes the impostors of a layer: one for each of its meshes, as the last LOD, each in its own file. The editor's
## button uses this class. Scripts can also use it, with or without a window:
## [codeblock]
## var bake := preload("res://addons/thicket/bake_impostors.gd").new()
## if bake.begin(layer, "res://forest_impostors", "oaks") == OK:
##     while bake.step():
##         await get_tree().process_frame
##     layer.meshes = bake.meshes
## [/codeblock]
## Files are written only after all impostors are baked. The layer is not changed: assign [member meshes] to it.

const Impostor := preload("res://addons/thicket/impostor.gd")
const WholeFile := preload("res://addons/thicket/whole_file.gd")

## The content of a file before an impostor replaced it.
class Replaced:
	var bytes: PackedByteArray
	## The resource that was loaded from the file and is in use; null if there is none.
	var resource: Resource

## The settings for baking each impostor. Change them before calling [method begin], which sets their material override
## to that of the layer.
var impostor := Impostor.new()
## The error message; empty if there is none.
var problem := ""
## Warnings about material properties that impostors cannot reproduce, one message each.
var warnings := PackedStringArray()
## The progress of the bake, from 0 to 1.
var progress := 0.0
## The meshes to assign to the layer: one [ScatterModel] for each of its entries, with the impostor as the last LOD. Entries that draw nothing are
## unchanged. Available once [method step] has returned false without a [member problem]. New impostors replace the impostors of an earlier bake.
## The models of the layer stay unchanged, because other layers may use them.
var meshes := []
## The impostors of [member meshes]; null for entries that draw nothing.
var baked: Array[Mesh] = []
## The paths of the files that were written.
var files := PackedStringArray()
## The previous contents of all [member files] that existed before the bake, for undo.
var replaced: Dictionary[String, Replaced] = {}

var _layer: Resource
var _meshes: Array[Mesh] = [] # The finest mesh of each of the layer's entries; null for entries that draw nothing.
var _stem := ""
var _is_running := false


## Begins to bake the impostors of [param layer] into [param folder], which is created if it does not exist. File names begin with
## [param name]. On failure, returns an error and sets [member problem] to its explanation.
func begin(layer: Resource, folder: String, name: String) -> Error:
	cancel()
	problem = ""
	progress = 0.0
	warnings.clear()
	files.clear()
	replaced = {}
	meshes = []
	baked = []
	_layer = layer
	if name.is_empty() or not name.is_valid_filename():
		return _fail(ERR_INVALID_PARAMETER, "The name must be a valid file name, without characters such as / : ? *, got '%s'." % name)
	_meshes.assign(range((layer.get(&"meshes") as Array).size()).map(_finest))
	if not _meshes.any(func(mesh: Mesh) -> bool: return mesh != null):
		return _fail(ERR_UNCONFIGURED, "The layer has no mesh to bake: add one to ScatterLayer.meshes.")
	var error := DirAccess.make_dir_recursive_absolute(folder)
	if error != OK:
		return _fail(error, "Cannot create the folder %s: %s. Choose a writable folder." % [folder, error_string(error)])
	_stem = folder.path_join(name)
	impostor.material_override = layer.get(&"material_override")
	_is_running = true
	return _begin_next()


## Begins the next impostor if the current one is finished. Only a call that finishes an impostor is slow; otherwise
## another thread does the work. Returns true while there is more to do. Returns false at the end, after [method
## cancel], or after an error, which sets [member problem].
func step() -> bool:
	if not _is_running:
		return false
	progress = (baked.size() + impostor.get_progress()) / _meshes.size()
	if impostor.is_baking():
		return true
	var mesh := impostor.finish()
	if mesh == null:
		problem = impostor.problem
		_is_running = false
		return false
	baked.append(mesh)
	if _begin_next() != OK:
		_is_running = false
		return false
	if baked.size() < _meshes.size():
		return true
	_is_running = false
	if _save():
		_set_lods()
		progress = 1.0
	return false


## Stops a bake in progress. Has no effect if none is in progress.
func cancel() -> void:
	if _is_running:
		impostor.cancel()
		_is_running = false


## Returns the mesh to bake for an entry of [member ScatterLayer.meshes], which is its finest LOD, or null if there is none.
func _finest(entry: int) -> Mesh:
	var lods: Array = _layer.call(&"get_mesh_lods", entry)
	var lod: Resource = lods[0] if not lods.is_empty() else null
	return lod.get(&"mesh") if lod != null else null


func _fail(error: Error, message: String) -> Error:
	problem = message
	return error


## Begins the next impostor and skips entries without a mesh.
func _begin_next() -> Error:
	while baked.size() < _meshes.size() and _meshes[baked.size()] == null:
		baked.append(null)
	if baked.size() == _meshes.size():
		return OK
	var error := impostor.begin([_meshes[baked.size()]])
	warnings.append_array(impostor.warnings)
	return OK if error == OK else _fail(error, impostor.problem)


func _save() -> bool:
	for index in baked.size():
		if baked[index] == null:
			continue
		var path := "%s_impostor_%d.res" % [_stem, index]
		if FileAccess.file_exists(path):
			replaced[path] = Replaced.new()
			replaced[path].bytes = FileAccess.get_file_as_bytes(path)
			if FileAccess.get_open_error() != OK: # Without the old content, undo could not restore the file.
				problem = "Cannot read %s, which would be replaced: %s. Make it readable, or remove it." % [
					path, error_string(FileAccess.get_open_error())]
				return false
			replaced[path].resource = load(path) if ResourceLoader.has_cached(path) else null
		var error := WholeFile.save(baked[index], path)
		if error != OK:
			problem = "Cannot write %s: %s. Check that its folder is writable and the disk has room." % [path, error_string(error)]
			return false
		baked[index].take_over_path(path)
		files.append(path)
	return true


## Fills [member meshes]. All impostors begin at the distance of the largest one at its maximum scale. A single distance is used, because each
## additional distance divides the layer's tiles into more cells.
func _set_lods() -> void:
	var distance := 0.0
	for mesh in baked:
		distance = maxf(distance, _switch_distance(mesh))
	distance *= maxf(_layer.get(&"max_scale"), 0.01)
	for entry in baked.size(): # Impostors begin beyond all other LODs.
		for lod: Resource in _without_impostors(_layer.call(&"get_mesh_lods", entry)):
			distance = maxf(distance, lod.get(&"distance") * 1.25)
	meshes = (_layer.get(&"meshes") as Array).duplicate()
	for entry in baked.size():
		if baked[entry] != null:
			meshes[entry] = _with_impostor(meshes[entry], _lod(baked[entry], snappedf(distance, 1.0)))


## Returns a copy of [param entry], an entry of the layer's meshes, as a model with [param far_lod] as its last LOD.
static func _with_impostor(entry: Resource, far_lod: Resource) -> Resource:
	var model: Resource = entry.duplicate() if entry.is_class("ScatterModel") else ClassDB.instantiate(&"ScatterModel")
	if entry is PackedScene:
		model.set(&"scene", entry)
	elif entry is Mesh:
		model.set(&"lods", _lods([_lod(entry as Mesh, 0.0)]))
	var list_name := &"far_lods" if model.get(&"scene") != null else &"lods"
	for property: StringName in [&"lods", &"far_lods"]:
		if property == &"far_lods" or list_name == &"lods":
			model.set(property, _lods(_without_impostors(model.get(property)) + ([far_lod] if property == list_name else [])))
	return model


static func _without_impostors(lods: Array) -> Array:
	return lods.filter(func(lod: Resource) -> bool: return lod != null and _switch_distance(lod.get(&"mesh")) == 0.0)


## Returns [method Impostor.switch_distance], or 0 for a mesh that is not an impostor.
static func _switch_distance(mesh: Mesh) -> float:
	return Impostor.switch_distance(mesh) if mesh != null else 0.0


static func _lod(mesh: Mesh, distance: float) -> Resource:
	var lod: Resource = ClassDB.instantiate(&"ScatterLod")
	lod.set(&"mesh", mesh)
	lod.set(&"distance", distance)
	return lod


static func _lods(lods: Array) -> Array:
	return Array(lods, TYPE_OBJECT, &"ScatterLod", null)
