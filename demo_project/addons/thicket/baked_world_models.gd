extends RefCounted
## Loads the meshes and materials that the tiles of a baked world number, on the engine's threads where it has a renderer.

const Index := preload("res://addons/thicket/baked_world_index.gd")

const _MISSING := "ScatterBakedWorld: %s %s. What is drawn with it stays hidden. Put it into the project, or export the bake again."

## By their numbers; null for those that cannot be loaded, once [method load_step] returned true.
var meshes: Array[Mesh] = []
## By their numbers; null for those that cannot be loaded.
var materials: Array[Material] = []

var _waiting := PackedStringArray() # Paths, in the order of both.
var _next := 0
var _mesh_count := 0
var _on_threads: bool
var _is_requested := false


## Loads the models of an index. Without [param on_threads] each is loaded by the caller of [method load_step].
func _init(index: Index, on_threads: bool) -> void:
	_on_threads = on_threads
	_waiting = index.meshes + index.materials
	_mesh_count = index.meshes.size()


## Begins to load what is missing, and takes what is there, until [param deadline] in microseconds of the engine's clock. Returns whether all is there.
func load_step(deadline: int) -> bool:
	if _on_threads and not _is_requested:
		_is_requested = true
		for path in _waiting:
			if ResourceLoader.exists(path):
				ResourceLoader.load_threaded_request(path)
	while _next < _waiting.size():
		var path := _waiting[_next]
		if _on_threads and ResourceLoader.load_threaded_get_status(path) == ResourceLoader.THREAD_LOAD_IN_PROGRESS:
			return false
		_take(_load(path), path)
		if Time.get_ticks_usec() >= deadline:
			break
	return _next == _waiting.size()


## Takes what was requested, which the engine keeps otherwise.
func drop() -> void:
	while _is_requested and _next < _waiting.size():
		_load(_waiting[_next])
		_next += 1


func _load(path: String) -> Resource:
	if not ResourceLoader.exists(path):
		return null
	return ResourceLoader.load_threaded_get(path) if _on_threads else ResourceLoader.load(path)


func _take(resource: Resource, path: String) -> void:
	var is_mesh := _next < _mesh_count
	_next += 1
	if is_mesh:
		meshes.append(resource as Mesh)
	else:
		materials.append(resource as Material)
	if resource == null:
		push_error(_MISSING % [path, "cannot be loaded"])
	elif (meshes if is_mesh else materials).back() == null:
		push_error(_MISSING % [path, "is a %s, where a %s is expected" % [resource.get_class(), "Mesh" if is_mesh else "Material"]])
