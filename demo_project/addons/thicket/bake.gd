extends RefCounted
## Bakes the instances in a rectangle to Godot resources: a [MultiMesh] for each layer, mesh and tile. Saves built-in meshes to files. It also writes
## a scene with a [MultiMeshInstance3D] for each [MultiMesh], at the center of its tile.
##
## Use it for scatter that never changes, and for tools that read scenes. It also works without the editor:
## [codeblock]
## var bake := preload("res://addons/thicket/bake.gd").new()
## if bake.begin($TerrainScatter3D, Rect2(0, 0, 512, 512), "res://baked", "valley") == OK:
##     while bake.step(20.0):
##         await get_tree().process_frame
## [/codeblock] All files are first written to a temporary folder and moved to their final paths at the end. Canceling therefore leaves the previous
## files unchanged.

const WholeFile := preload("res://addons/thicket/whole_file.gd")

const UNFINISHED := ".bake_unfinished/"
## The largest total number of tiles of all layers.
const MOST_TILES := 100000
const UNWRITABLE := "Cannot write %s: %s. Check that the folder is writable and the disk has room."

## The error message; empty if there is none.
var problem := ""
## The progress of the bake, from 0 to 1.
var progress := 0.0
## The number of instances that the current or the last bake has written.
var instances := 0
## The path of the scene, once [method step] has returned false without a [member problem].
var scene_path := ""

var _scatter: Node3D
var _rect := Rect2()
var _folder := ""
var _name := ""
var _is_running := false
var _nodes: Array[Array] = [] # One entry per MultiMesh: layer, tile, origin, MultiMesh.
var _tiles: Array[Vector3i] = [] # The tiles to bake: layer index, tile x, tile y.
var _next_tile := 0
var _written_files: PackedStringArray = []
var _mesh_files: Dictionary[Mesh, Mesh] = {}


## Begins to bake [param rect] (x and z in meters) into [param folder], which is created if it does not exist. The scene is
## named [param name]. [param layers] contains entries of [member TerrainScatter3D.layers] or their names; if empty, all entries are
## baked. Layers of biomes cannot be baked. [param rect] is in the engine's space, without [member TerrainScatter3D.world_offset].
## On failure, returns an error and sets [member problem] to its explanation.
func begin(scatter: Node3D, rect: Rect2, folder: String, name: String, layers := []) -> Error:
	cancel()
	problem = ""
	instances = 0
	progress = 0.0
	_scatter = scatter
	_rect = rect.abs()
	_folder = folder if folder.ends_with("/") else folder + "/"
	scene_path = _folder + name + ".tscn"
	if not _rect.is_finite() or not _rect.has_area():
		return _fail(ERR_INVALID_PARAMETER, "The rectangle must be finite and have an area, got %s." % rect)
	if name.is_empty() or not name.is_valid_filename():
		return _fail(ERR_INVALID_PARAMETER, "The name must be a valid file name, without characters such as / : ? *, got '%s'." % name)
	if scatter.get(&"ground") == null:
		return _fail(ERR_UNCONFIGURED, "%s has no ground: set TerrainScatter3D.ground." % scatter.name)
	var error := _list_tiles(layers)
	if error != OK:
		return error
	error = DirAccess.make_dir_recursive_absolute(_folder + UNFINISHED)
	if error != OK:
		return _fail(error, "Cannot create the folder %s: %s. Choose a writable folder." % [_folder, error_string(error)])
	_empty_unfinished()
	_name = name
	_is_running = true
	return OK


## Continues the bake for about [param msec] milliseconds, but for at least one tile. The last call also writes the
## scene and moves all files, regardless of how long that takes. Returns true while there is more to do. Returns false
## at the end, after [method cancel], or after an error, which sets [member problem].
func step(msec: float) -> bool:
	if not _is_running:
		return false
	var deadline := Time.get_ticks_usec() + int(msec * 1000.0)
	while _next_tile < _tiles.size():
		if not _bake_tile(_tiles[_next_tile]):
			cancel()
			return false
		_next_tile += 1
		progress = 0.99 * _next_tile / _tiles.size()
		if Time.get_ticks_usec() >= deadline:
			return true
	if _write_scene() and _move_all():
		progress = 1.0
	cancel()
	return false


## Stops a bake in progress and removes its unfinished files. Has no effect if no bake is in progress.
func cancel() -> void:
	if not _is_running:
		return
	_is_running = false
	_empty_unfinished()
	DirAccess.remove_absolute(_folder + UNFINISHED)
	_nodes.clear()
	_tiles.clear()
	_written_files.clear()
	_mesh_files.clear()
	_next_tile = 0
	_scatter = null


func _empty_unfinished() -> void:
	for file in DirAccess.get_files_at(_folder + UNFINISHED):
		DirAccess.remove_absolute(_folder + UNFINISHED + file)


func _fail(error: Error, message: String) -> Error:
	problem = message
	return error


func _list_tiles(requested: Array) -> Error:
	# Convert the rectangle to world x and z in double precision, because tiles use these coordinates.
	var offset: Vector3 = _scatter.get(&"world_offset")
	var low := [_rect.position.x + offset.x, _rect.position.y + offset.z]
	var bounds := PackedFloat64Array([low[0], low[1], low[0] + _rect.size.x, low[1] + _rect.size.y])
	var grid := ClassDB.instantiate(&"ScatterTileGrid") as RefCounted
	var layers: Array = _scatter.get(&"layers")
	_tiles.clear()
	var chosen: Array[Resource] = []
	for requested_layer: Variant in requested:
		var matching := layers.filter(func(layer: Resource) -> bool: return layer != null and (is_same(requested_layer, layer) or str(requested_layer) == layer.resource_name))
		if matching.is_empty():
			return _fail(ERR_INVALID_PARAMETER, "layers contains %s, which is not a layer of %s: pass entries of TerrainScatter3D.layers, or their names." % [
				requested_layer, _scatter.name])
		chosen.append(matching[0])
	for index in layers.size():
		var layer: Resource = layers[index]
		if layer == null or not (chosen.is_empty() or chosen.has(layer)):
			continue
		grid.set(&"tile_size", layer.get(&"tile_size"))
		var covered_tiles: Rect2i = grid.call(&"get_tiles_in", bounds)
		if not covered_tiles.has_area():
			return _fail(ERR_PARAMETER_RANGE_ERROR,
					"The rectangle %s is too far from the origin for the tiles of layer %d: increase its tile_size." % [_rect, index])
		if covered_tiles.size.x * covered_tiles.size.y > MOST_TILES - _tiles.size():
			return _fail(ERR_PARAMETER_RANGE_ERROR,
					"The rectangle %s has more than %d tiles: bake a smaller one, or increase the tile_size of the layers." % [_rect, MOST_TILES])
		for y in range(covered_tiles.position.y, covered_tiles.end.y):
			for x in range(covered_tiles.position.x, covered_tiles.end.x):
				_tiles.append(Vector3i(index, x, y))
	return OK if not _tiles.is_empty() else _fail(ERR_UNCONFIGURED, "%s has no layer to bake: add one to TerrainScatter3D.layers." % _scatter.name)


func _bake_tile(tile: Vector3i) -> bool:
	var layer: Resource = _scatter.get(&"layers")[tile.x]
	var tile_instances: RefCounted = _scatter.call(&"build_tile", layer, Vector2i(tile.y, tile.z), _rect)
	if tile_instances.get_mesh_count() == 0:
		problem = "Layer %d cannot be baked. See the Output panel for details." % tile.x
		return false
	for mesh_index: int in tile_instances.get_mesh_count():
		var buffer: PackedFloat32Array = tile_instances.get_buffer(mesh_index)
		var mesh: Mesh = tile_instances.get_mesh(mesh_index)
		if buffer.is_empty() or mesh == null:
			continue
		var file := "%s_%s_%d_%d_%d.res" % [_name, _file_part(tile.x), mesh_index, tile.y, tile.z]
		var ids: PackedInt64Array = tile_instances.get_ids(mesh_index)
		var multimesh := _multimesh(layer, buffer, ids.size(), _in_file(mesh, tile.x, mesh_index))
		if multimesh == null or not _save(multimesh, file):
			return false
		instances += multimesh.instance_count
		_nodes.append([layer, tile, tile_instances.get_origin(), multimesh])
	return true


func _multimesh(layer: Resource, buffer: PackedFloat32Array, count: int, mesh: Mesh) -> MultiMesh:
	if mesh == null:
		return null
	var multimesh := MultiMesh.new()
	multimesh.transform_format = MultiMesh.TRANSFORM_3D
	multimesh.use_colors = layer.get(&"use_colors")
	multimesh.use_custom_data = layer.get(&"use_custom_data")
	multimesh.mesh = mesh
	multimesh.instance_count = count
	multimesh.buffer = buffer
	return multimesh


## Returns the mesh itself if it has its own file, otherwise a copy that is saved to a file. Returns null if it cannot be saved.
func _in_file(mesh: Mesh, layer: int, mesh_index: int) -> Mesh:
	if not mesh.resource_path.is_empty() and not "::" in mesh.resource_path:
		return mesh
	if not _mesh_files.has(mesh):
		var copy := mesh.duplicate() as Mesh
		var file := "%s_%s_%d.res" % [_name, _file_part(layer), mesh_index]
		_mesh_files[mesh] = copy if _save(copy, file) else null
	return _mesh_files[mesh]


func _instance(layer: Resource, tile: Vector3i, origin: Vector3, multimesh: MultiMesh) -> MultiMeshInstance3D:
	var instance := MultiMeshInstance3D.new()
	instance.name = "%s_%d_%d" % [layer.resource_name.validate_node_name(), tile.y, tile.z]
	instance.position = origin
	instance.multimesh = multimesh
	var properties: Dictionary = layer.call(&"get_geometry_properties")
	for property: StringName in properties:
		instance.set(properties[property], layer.get(property))
	return instance


## Returns the part of a file name that identifies a layer: its index, followed by its name if it has one.
func _file_part(layer: int) -> String:
	var name: String = _scatter.get(&"layers")[layer].resource_name.to_snake_case().validate_filename()
	return "%d_%s" % [layer, name] if not name.is_empty() else str(layer)


## Saves a resource in the temporary folder. Sets its path to the final one, by which other resources refer to it.
func _save(resource: Resource, file: String) -> bool:
	var error := WholeFile.save_new(resource, _folder + UNFINISHED + file)
	resource.set_path_cache(_folder + file)
	if error != OK:
		problem = UNWRITABLE % [_folder + file, error_string(error)]
		return false
	_written_files.append(file)
	return true


func _write_scene() -> bool:
	var scene := Node3D.new()
	scene.name = _name.to_pascal_case()
	for node in _nodes:
		var instance := _instance(node[0], node[1], node[2], node[3])
		scene.add_child(instance, true)
		instance.owner = scene
	var packed := PackedScene.new()
	var error := packed.pack(scene)
	scene.free()
	if error != OK:
		problem = "Cannot pack %s: %s." % [scene_path, error_string(error)]
		return false
	return _save(packed, scene_path.get_file())


## Moves all files to their final paths, the scene last. Removes files that an earlier bake wrote and the current one did not.
func _move_all() -> bool:
	var stale := _files_of_scene()
	for file in _written_files:
		var error := DirAccess.rename_absolute(_folder + UNFINISHED + file, _folder + file)
		if error != OK:
			problem = UNWRITABLE % [_folder + file, error_string(error)]
			return false
		stale.erase(file)
	for file in stale:
		var error := DirAccess.remove_absolute(_folder + file)
		if error != OK:
			push_warning("Cannot remove %s, a file of an earlier bake: %s. Delete it manually." % [_folder + file, error_string(error)])
	for file in _written_files:
		if ResourceLoader.has_cached(_folder + file):
			ResourceLoader.load(_folder + file, "", ResourceLoader.CACHE_MODE_REPLACE)
	return true


## Returns the files that an earlier bake with this name has written to the folder.
func _files_of_scene() -> PackedStringArray:
	var files := PackedStringArray()
	if FileAccess.file_exists(scene_path):
		var prefix := scene_path.get_file().get_basename() + "_"
		for dependency in ResourceLoader.get_dependencies(scene_path):
			var path := dependency.get_slice("::", dependency.get_slice_count("::") - 1)
			if path.get_base_dir() + "/" == _folder and path.get_file().begins_with(prefix):
				files.append(path.get_file())
	return files
