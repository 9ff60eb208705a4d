extends RefCounted
## Bakes the impostors of a layer: one for each of its meshes, as the last LOD, each in its own file. The editor's button uses this
## class. Scripts can use it too, also headless:
## [codeblock]
## var bake := preload("res://addons/thicket/bake_impostors.gd").new()
## if bake.begin(layer, "res://forest_impostors", "oaks") == OK:
##     while bake.step():
##         await get_tree().process_frame
##     layer.lod_meshes = bake.lod_meshes
##     layer.lod_distances = bake.lod_distances
## [/codeblock]
## Nothing is written before all of them are baked, and the layer is not changed. [member lod_meshes] and [member lod_distances]
## have the values to set on it.

const Impostor := preload("res://addons/thicket/impostor.gd")
const WholeFile := preload("res://addons/thicket/whole_file.gd")

## The content of a file before an impostor replaced it.
class Replaced:
	var bytes: PackedByteArray
	## The resource that was loaded from the file and is in use; null if there is none.
	var resource: Resource

## The settings of each impostor's bake. Change them before [method begin].
var impostor := Impostor.new()
## The error as a sentence; empty if there is none.
var problem := ""
## Warnings about material properties that impostors cannot reproduce, a sentence each.
var warnings := PackedStringArray()
## From 0 to 1.
var progress := 0.0
## The layer's LODs with the impostors as the last row, once [method step] has returned false without a [member problem]. If the
## last row was impostors already, they are replaced.
var lod_meshes: Array[Mesh] = []
## The distances for [member lod_meshes], in meters.
var lod_distances := PackedFloat32Array()
## The paths of the files that were written.
var files := PackedStringArray()
## The previous contents of those [member files] that existed before, for undo.
var replaced: Dictionary[String, Replaced] = {}

var _layer: Resource
var _meshes: Array[Mesh] = [] # Of the layer's entries; null for entries that draw nothing.
var _stem := ""
var _baked: Array[Mesh] = []
var _running := false


## Begins to bake the impostors of [param layer] into [param folder], which is created if it does not exist. File names begin with
## [param name]. On failure, returns an error and explains it in [member problem].
func begin(layer: Resource, folder: String, name: String) -> Error:
	cancel()
	problem = ""
	progress = 0.0
	warnings.clear()
	files.clear()
	replaced = {}
	lod_meshes = []
	lod_distances = PackedFloat32Array()
	_baked = []
	_layer = layer
	if name.is_empty() or not name.is_valid_filename():
		return _refuse(ERR_INVALID_PARAMETER, "The name must be a valid file name, without / : ? * and the like, got '%s'." % name)
	_meshes.assign(range((layer.get(&"meshes") as Array).size()).map(_finest))
	if not _meshes.any(func(mesh: Mesh) -> bool: return mesh != null):
		return _refuse(ERR_UNCONFIGURED, "The layer has no mesh to bake: add one to ScatterLayer.meshes.")
	var error := DirAccess.make_dir_recursive_absolute(folder)
	if error != OK:
		return _refuse(error, "Cannot create the folder %s: %s. Choose a writable folder." % [folder, error_string(error)])
	_stem = folder.path_join(name)
	impostor.material_override = layer.get(&"material_override")
	_running = true
	return _begin_next()


## Checks whether an impostor is finished, and begins the next one. This takes a moment after each impostor, and no time while
## another thread bakes one. Returns true while there is more to do. Returns false at the end, after [method cancel], and on an
## error.
func step() -> bool:
	if not _running:
		return false
	progress = (_baked.size() + impostor.get_progress()) / _meshes.size()
	if impostor.is_baking():
		return true
	var baked := impostor.finish()
	if baked == null:
		problem = impostor.problem
		_running = false
		return false
	_baked.append(baked)
	if _begin_next() != OK:
		_running = false
		return false
	if _baked.size() < _meshes.size():
		return true
	_running = false
	if _save():
		_set_lods()
		progress = 1.0
	return false


## Stops a bake in progress. Does nothing if none is in progress.
func cancel() -> void:
	if _running:
		impostor.cancel()
		_running = false


## The mesh that is baked for an entry of [member ScatterLayer.meshes]: its finest LOD; null if there is none.
func _finest(entry: int) -> Mesh:
	var lods: Array = _layer.call(&"get_mesh_lods", entry)
	var lod: Resource = lods[0] if not lods.is_empty() else null
	return lod.get(&"mesh") if lod != null else null


func _refuse(error: Error, why: String) -> Error:
	problem = why
	return error


## Begins the next impostor. A missing mesh draws nothing, so it has no impostor.
func _begin_next() -> Error:
	while _baked.size() < _meshes.size() and _meshes[_baked.size()] == null:
		_baked.append(null)
	if _baked.size() == _meshes.size():
		return OK
	var error := impostor.begin([_meshes[_baked.size()]])
	warnings.append_array(impostor.warnings)
	return OK if error == OK else _refuse(error, impostor.problem)


func _save() -> bool:
	for index in _baked.size():
		if _baked[index] == null:
			continue
		var path := "%s_impostor_%d.res" % [_stem, index]
		if FileAccess.file_exists(path):
			replaced[path] = Replaced.new()
			replaced[path].bytes = FileAccess.get_file_as_bytes(path)
			if FileAccess.get_open_error() != OK: # Undo could not restore the file.
				problem = "Cannot read %s, which would be replaced: %s. Make it readable, or remove it." % [
					path, error_string(FileAccess.get_open_error())]
				return false
			replaced[path].resource = load(path) if ResourceLoader.has_cached(path) else null
		var error := WholeFile.save(_baked[index], path)
		if error != OK:
			problem = "Cannot write %s: %s. Check that its folder is writable and the disk has room." % [path, error_string(error)]
			return false
		_baked[index].take_over_path(path)
		files.append(path)
	return true


## Instances may be larger than their meshes, and all meshes switch at one distance, so the largest one decides.
func _set_lods() -> void:
	var count := _baked.size()
	var distance := 0.0
	for mesh in _baked:
		distance = maxf(distance, Impostor.switch_distance(mesh) if mesh != null else 0.0)
	distance *= maxf(_layer.get(&"max_scale"), 0.01)
	var distances: PackedFloat32Array = _layer.get(&"lod_distances")
	var meshes: Array[Mesh] = []
	meshes.assign(_layer.get(&"lod_meshes"))
	meshes.resize(distances.size() * count)
	if not distances.is_empty() and _is_impostor_row(meshes.slice(-count)):
		distances.resize(distances.size() - 1)
		meshes.resize(distances.size() * count)
	# Distances must ascend: if the last LOD begins beyond the impostors' distance, it stays, and they begin behind it.
	if not distances.is_empty():
		distance = maxf(distance, distances[-1] * 1.25)
	distances.append(snappedf(distance, 1.0))
	meshes.append_array(_baked)
	lod_meshes = meshes
	lod_distances = distances


static func _is_impostor_row(row: Array[Mesh]) -> bool:
	return row.any(func(mesh: Mesh) -> bool: return mesh != null and Impostor.switch_distance(mesh) > 0.0)
