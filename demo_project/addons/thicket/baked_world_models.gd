extends RefCounted
## Loads the meshes and materials that the tiles of a baked world use. If the engine has threads and a renderer, its threads load them.

const Index := preload("res://addons/thicket/baked_world_index.gd")

const _MISSING := "ScatterBakedWorld: %s %s. Instances that need it stay hidden. Add it to the project, or export the bake again."

## The loaded meshes, in the order of the index, once [method load_step] has returned true. Null for meshes that cannot be loaded.
var meshes: Array[Mesh] = []
## The loaded materials, in the order of the index; null for those that cannot be loaded.
var materials: Array[Material] = []

var _paths := PackedStringArray() # The paths of the meshes, then those of the materials.
var _next_path := 0
var _mesh_count := 0
var _loads_on_threads: bool
var _has_requested := false


## Prepares to load the models of an index. If [param on_threads] is false, [method load_step] loads each model on the calling thread.
func _init(index: Index, on_threads: bool) -> void:
	_loads_on_threads = on_threads
	_paths = index.meshes + index.materials
	_mesh_count = index.meshes.size()


## Requests missing models and takes models that the engine has loaded, until [param deadline] (a time of [method Time.get_ticks_usec]).
## Takes at least one model, unless its thread has not finished. Returns true once all models are loaded or have been reported as missing.
func load_step(deadline: int) -> bool:
	if _loads_on_threads and not _has_requested:
		_has_requested = true
		for path in _paths:
			if ResourceLoader.exists(path):
				ResourceLoader.load_threaded_request(path)
	while _next_path < _paths.size():
		var path := _paths[_next_path]
		if _loads_on_threads and ResourceLoader.load_threaded_get_status(path) == ResourceLoader.THREAD_LOAD_IN_PROGRESS:
			return false
		_add(_load(path), path)
		if Time.get_ticks_usec() >= deadline:
			break
	return _next_path == _paths.size()


## Releases the remaining requested models. Otherwise the engine would keep them.
func drop() -> void:
	while _has_requested and _next_path < _paths.size():
		_load(_paths[_next_path])
		_next_path += 1


func _load(path: String) -> Resource:
	if not ResourceLoader.exists(path):
		return null
	return ResourceLoader.load_threaded_get(path) if _loads_on_threads else ResourceLoader.load(path)


func _add(resource: Resource, path: String) -> void:
	var is_mesh := _next_path < _mesh_count
	_next_path += 1
	if is_mesh:
		meshes.append(resource as Mesh)
	else:
		materials.append(resource as Material)
	if resource == null:
		push_error(_MISSING % [path, "cannot be loaded"])
	elif (meshes if is_mesh else materials).back() == null:
		push_error(_MISSING % [path, "is a %s, but must be a %s" % [resource.get_class(), "Mesh" if is_mesh else "Material"]])
