class_name ScatterBakedWorld
extends Node3D
## Streams the tiles of a baked world around the current camera. The script needs no native library, so it also runs on platforms for which none
## exists.
##
## [code]bash demo_project/bake_export.sh OUT godot FOLDER[/code] writes the tiles of a bake, and a scene [code]baked_world.scn[/code] with a node of
## this class. Files are read on threads. Adding and removing tiles takes at most [member frame_budget_usec] of each frame, or longer if a single
## tile takes longer. Baked instances cannot change: for rules, felling and queries, use [code]TerrainScatter3D[/code].
##
## The index and the tiles are plain data. Reading them runs no code, so the files may come from players. The index contains the SHA-256 of each tile,
## and a tile with a different hash is not shown. Meshes and materials are loaded only from the game's own files in [code]res://[/code].

const Index := preload("res://addons/thicket/baked_world_index.gd")
const Tile := preload("res://addons/thicket/baked_world_tile.gd")
const Models := preload("res://addons/thicket/baked_world_models.gd")

## Emitted when a tile was added to the tree.
signal tile_shown(tile: Vector2i)
## Emitted when a tile was removed because it is too far away. Not emitted when all tiles are removed because [member index_file] is set or the node
## leaves the tree.
signal tile_freed(tile: Vector2i)
## Emitted when a tile cannot be loaded; the printed error gives the reason. The tile is not tried again until [member index_file] is set.
signal tile_failed(tile: Vector2i)

## The largest number of files that are read at the same time.
const MOST_LOADING := 4
const UNUSABLE := "ScatterBakedWorld.index_file is %s, which must be the index of a baked world: %s. Nothing is shown. Export the bake again (bake_export.sh)."
const OUTDATED := "ScatterBakedWorld.index names %s, which an earlier version exported, with scenes for tiles. Scenes may run code, so nothing is shown. " \
		+ "Export the bake again (bake_export.sh); the bake itself is still valid."

## The path of the world's index, [code]baked_world.baked[/code]. The tiles are in a folder next to it. Empty for no world.
@export_file("*.baked") var index_file := "":
	set(value):
		_drop_all()
		index_file = value
		_read_index()
## The horizontal distance from the camera within which tiles are shown, in meters. A tile is removed when it is farther away than this distance plus a
## quarter of the tile's edge length.
@export_range(0.0, 100000.0, 1.0, "or_greater", "suffix:m") var view_distance := 512.0:
	set(value):
		if not (value >= 0.0 and value < 1e6):
			push_error("ScatterBakedWorld.view_distance must be between 0 and 1000000 m, got %s. The last valid value is kept; set one in this range." % value)
			return
		view_distance = value
		_is_stale = true
## The time in each frame for loading models, adding tiles and removing tiles, in microseconds. If tiles are ready or too far away, at least one of them
## is added, and one removed, in each frame.
@export_range(100, 20000, 100, "suffix:µs") var frame_budget_usec := 2000
## The node around which tiles are shown; if null, the current camera of the viewport.
@export var viewer: Node3D

## The position of the engine's origin in the world, in meters, like [code]TerrainScatter3D.world_offset[/code]. Setting [member index_file] resets it to
## the offset of the baked scene.
var world_offset := Vector3.ZERO:
	set(value):
		world_offset = value
		_is_stale = true
		for tile in _tile_nodes:
			_tile_nodes[tile].position = _center_of(_tile_indices[tile])

var _index: Index # The index of the world; null if there is none, or if it is invalid.
var _models: Models
var _tile_indices: Dictionary[Vector2i, int] = {} # Where each tile is in the arrays of the index.
var _tile_nodes: Dictionary[Vector2i, Node3D] = {}
var _loading: Dictionary[Vector2i, Tile] = {}
var _failed_tiles: Dictionary[Vector2i, bool] = {}
var _missing_tiles: Array[Vector2i] = [] # Tiles in range that are neither shown nor being read, the nearest last.
var _distant_tiles: Array[Vector2i] = [] # Shown tiles that are too far away, and not yet removed.
# Most web builds have no threads.
var _has_threads: bool = OS.has_feature("threads") and ProjectSettings.get_setting("threading/worker_pool/max_threads", -1) != 0
# Without a display, the engine uses a dummy renderer, for which multimeshes must not be built on several threads.
var _builds_on_threads: bool = _has_threads and DisplayServer.get_name() != "headless"
var _is_stale := true
var _last_viewer_xz := Vector2.INF # The viewer's world x and z when the lists of tiles were last updated.


func _exit_tree() -> void:
	_drop_all()
	_is_stale = true


## Reports scenes that earlier versions exported. They set the property index to a resource.
func _set(property: StringName, value: Variant) -> bool:
	if property != &"index":
		return false
	push_error(OUTDATED % ((value as Resource).resource_path if value is Resource else str(value)))
	return true


func _process(_delta: float) -> void:
	var from := _viewer()
	if from == null or _index == null:
		return
	var relative := from.global_position - global_position
	var viewer_xz := Vector2(relative.x + world_offset.x, relative.z + world_offset.z)
	if _is_stale or viewer_xz.distance_to(_last_viewer_xz) > _index.tile_size / 16.0:
		_update_tile_lists(viewer_xz)
	var deadline := Time.get_ticks_usec() + frame_budget_usec
	_remove_distant_tiles(deadline)
	# Handlers of tile_freed may have changed the index.
	if _index != null and _has_models(deadline):
		_start_loading()
		_add_loaded_tiles(deadline)


## Returns the tiles that are in the tree, in no particular order.
func get_shown_tiles() -> Array[Vector2i]:
	return _tile_nodes.keys()


## Returns the root node of a tile, with a [MultiMeshInstance3D] for each layer and model, or null if the tile is not shown.
func get_tile(tile: Vector2i) -> Node3D:
	return _tile_nodes.get(tile)


## Returns the number of instances in all tiles that are in the tree.
func get_instance_count() -> int:
	var sum := 0
	for tile in _tile_nodes:
		sum += _index.instances[_tile_indices[tile]]
	return sum


## Returns true if all tiles within [member view_distance] are shown, except for those that cannot be loaded, and no tile is left to remove. Returns
## false if there is no valid [member index_file].
func is_settled() -> bool:
	return _index != null and not _is_stale and _missing_tiles.is_empty() and _loading.is_empty() and _distant_tiles.is_empty()


func _viewer() -> Node3D:
	if is_instance_valid(viewer):
		return viewer
	return get_viewport().get_camera_3d()


func _read_index() -> void:
	_tile_indices.clear()
	_failed_tiles.clear()
	_index = null
	if index_file.is_empty():
		return
	var index := Index.new()
	if not index.read(index_file):
		push_error(UNUSABLE % [index_file, index.problem])
		return
	_index = index
	for tile_index in index.instances.size():
		_tile_indices[Vector2i(index.tiles[2 * tile_index], index.tiles[2 * tile_index + 1])] = tile_index
	world_offset = Vector3(index.world_offset[0], index.world_offset[1], index.world_offset[2])
	_is_stale = true


## Returns the position of a tile's root, subtracting in double precision.
func _center_of(tile_index: int) -> Vector3:
	return Vector3(
		_index.centers[3 * tile_index] - world_offset.x,
		_index.centers[3 * tile_index + 1] - world_offset.y,
		_index.centers[3 * tile_index + 2] - world_offset.z,
	)


## Returns the distance in meters from a position to the square of a tile.
func _distance(tile: Vector2i, viewer_xz: Vector2) -> float:
	var lowest_corner := Vector2(tile) * _index.tile_size
	return viewer_xz.distance_to(viewer_xz.clamp(lowest_corner, lowest_corner + Vector2.ONE * _index.tile_size))


func _update_tile_lists(viewer_xz: Vector2) -> void:
	_is_stale = false
	_last_viewer_xz = viewer_xz
	_distant_tiles.clear()
	for tile in _tile_nodes:
		if _distance(tile, viewer_xz) > view_distance + _index.tile_size / 4.0:
			_distant_tiles.append(tile)
	_missing_tiles.clear()
	var distances: Dictionary[Vector2i, float] = {}
	for tile in _tiles_near(viewer_xz):
		if not (_tile_nodes.has(tile) or _loading.has(tile) or _failed_tiles.has(tile)):
			distances[tile] = _distance(tile, viewer_xz)
			if distances[tile] <= view_distance:
				_missing_tiles.append(tile)
	_missing_tiles.sort_custom(func(a: Vector2i, b: Vector2i) -> bool: return distances[a] > distances[b])


## Removes tiles that are too far away, until the deadline.
func _remove_distant_tiles(deadline: int) -> void:
	while not _distant_tiles.is_empty():
		var tile: Vector2i = _distant_tiles.pop_back()
		var node := _tile_nodes[tile]
		_tile_nodes.erase(tile)
		node.free()
		tile_freed.emit(tile)
		if Time.get_ticks_usec() >= deadline:
			return


func _tiles_near(viewer_xz: Vector2) -> Array[Vector2i]:
	var lowest_corner := Vector2i(((viewer_xz - Vector2.ONE * view_distance) / _index.tile_size).floor())
	var greatest := Vector2i(((viewer_xz + Vector2.ONE * view_distance) / _index.tile_size).floor())
	var tiles: Array[Vector2i] = []
	# Iterates over the smaller set: the squares in range, or all tiles of the index.
	if float(greatest.x - lowest_corner.x + 1) * (greatest.y - lowest_corner.y + 1) > _tile_indices.size():
		tiles.assign(_tile_indices.keys())
		return tiles
	for z in range(lowest_corner.y, greatest.y + 1):
		for x in range(lowest_corner.x, greatest.x + 1):
			if _tile_indices.has(Vector2i(x, z)):
				tiles.append(Vector2i(x, z))
	return tiles


## Continues to load the meshes and materials that tiles need, until the deadline. Returns true once all are loaded.
func _has_models(deadline: int) -> bool:
	if _models == null:
		_models = Models.new(_index, _builds_on_threads)
	return _models.load_step(deadline)


func _start_loading() -> void:
	while not _missing_tiles.is_empty() and _loading.size() < MOST_LOADING:
		var tile: Vector2i = _missing_tiles.pop_back()
		var loading_tile := Tile.new(_index, _tile_indices[tile], _models.meshes, _models.materials)
		if _has_threads:
			loading_tile.task = WorkerThreadPool.add_task(loading_tile.run if _builds_on_threads else loading_tile.read, false, "Read a tile of a ScatterBakedWorld")
		_loading[tile] = loading_tile


func _add_loaded_tiles(deadline: int) -> void:
	for tile: Vector2i in _loading.keys():
		# A signal handler may have dropped all tiles.
		if not _loading.has(tile):
			return
		var loading_tile := _loading[tile]
		if _has_threads and not WorkerThreadPool.is_task_completed(loading_tile.task):
			continue
		_loading.erase(tile)
		_finish_loading(loading_tile)
		if loading_tile.node == null:
			_report_failure(tile, loading_tile.problem)
		elif _distance(tile, _last_viewer_xz) <= view_distance + _index.tile_size / 4.0:
			_show_tile(tile, loading_tile)
		else:
			loading_tile.drop()
		if Time.get_ticks_usec() >= deadline:
			return


## Waits until a tile's thread task has ended. Runs the steps that cannot run on other threads on this thread.
func _finish_loading(tile: Tile) -> void:
	if _has_threads:
		WorkerThreadPool.wait_for_task_completion(tile.task)
	else:
		tile.read()
	if not _builds_on_threads:
		tile.build()


func _show_tile(tile: Vector2i, loaded_tile: Tile) -> void:
	var center := _center_of(_tile_indices[tile])
	if not center.is_finite():
		loaded_tile.drop()
		_report_failure(tile, "its center is %s, which must be finite" % center)
		return
	loaded_tile.node.position = center
	_tile_nodes[tile] = loaded_tile.node
	add_child(loaded_tile.node)
	tile_shown.emit(tile)


func _report_failure(tile: Vector2i, message: String) -> void:
	_failed_tiles[tile] = true
	push_error("ScatterBakedWorld: tile %s cannot be shown: %s. Export the bake again." % [tile, message])
	tile_failed.emit(tile)


func _drop_all() -> void:
	var loading := _loading
	_loading = {}
	for tile in loading:
		loading[tile].is_cancelled = true
	for tile in loading:
		if _has_threads:
			WorkerThreadPool.wait_for_task_completion(loading[tile].task)
		loading[tile].drop()
	for tile in _tile_nodes:
		_tile_nodes[tile].queue_free()
	if _models != null:
		_models.drop()
	_models = null
	_tile_nodes.clear()
	_missing_tiles.clear()
	_distant_tiles.clear()
