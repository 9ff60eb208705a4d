class_name BakedWorld
extends Node3D
## Streams the tiles of a baked world around the current camera. Plain GDScript: it needs no extension, so it runs where none can be loaded.
##
## [code]bash demo_project/bake_export.sh OUT godot FOLDER[/code] writes the tiles of a bake as scenes, and [code]baked_world.scn[/code] with one such node.
## Files are read on threads, and at most [member frame_budget_usec] of a frame go into tiles that come or go, or one tile where that takes longer. What is
## baked stands as it is: for rules, felling and queries use [code]TerrainScatter3D[/code].

const Index := preload("res://addons/thicket/baked_world_index.gd")

## A tile is in the tree from now on.
signal tile_shown(tile: Vector2i)
## A tile is gone.
signal tile_freed(tile: Vector2i)
## A tile cannot be loaded; an error says why. It is not tried again until [member index] is set.
signal tile_failed(tile: Vector2i)

## Files that are read at once.
const MOST_LOADING := 4
const INVALID := "BakedWorld.index: %s must have %s, got %s. Nothing that depends on it is shown. Export the bake again."

## Which tiles there are.
@export var index: Index:
	set(value):
		_drop_all()
		index = value
		_look_up()
## Tiles that are nearer to the camera than this are shown, in meters in the plane of x and z. A tile goes when it is farther away by a quarter of its side.
@export_range(0.0, 100000.0, 1.0, "or_greater", "suffix:m") var view_distance := 512.0:
	set(value):
		if not (value >= 0.0 and value < 1e6):
			push_error("BakedWorld.view_distance must be between 0 and 1000000 m, got %s. The last valid value stays; set one in this range." % value)
			return
		view_distance = value
		_is_stale = true
## How much of a frame may go into tiles that come or go, in microseconds. At least one tile comes in a frame where one is ready.
@export_range(100, 20000, 100, "suffix:µs") var frame_budget_usec := 2000
## Whose surroundings are shown; the current camera of the viewport where there is none.
@export var viewer: Node3D

## Where the engine's origin is in the world, in meters, as [code]TerrainScatter3D.world_offset[/code]. At first, as the baked scene had it.
var world_offset := Vector3.ZERO:
	set(value):
		world_offset = value
		_is_stale = true
		for tile in _shown:
			_shown[tile].position = _place_of(_numbers[tile])

var _numbers: Dictionary[Vector2i, int] = {} # Of each tile in the index.
var _shown: Dictionary[Vector2i, Node3D] = {}
var _loading: Dictionary[Vector2i, String] = {} # The path that is being read.
var _failed: Dictionary[Vector2i, bool] = {}
var _wanted: Array[Vector2i] = [] # Neither shown nor being read, the nearest last.
# What stands for a renderer in a headless engine may not be told of multimeshes by several threads.
var _reads_on_threads := DisplayServer.get_name() != "headless"
var _is_stale := true
var _looked_from := Vector2.INF # World x, z.


func _exit_tree() -> void:
	_drop_all()
	_is_stale = true


func _process(_delta: float) -> void:
	var from := _viewer()
	if from == null or index == null:
		return
	var place := from.global_position - global_position
	var here := Vector2(place.x + world_offset.x, place.z + world_offset.z)
	if _is_stale or here.distance_to(_looked_from) > index.tile_size / 16.0:
		_look_around(here)
	# Whoever hears a signal may have changed anything.
	if index != null:
		_request()
	if index != null:
		_take(Time.get_ticks_usec() + frame_budget_usec)


## The tiles that are in the tree, in no order.
func get_shown_tiles() -> Array[Vector2i]:
	return _shown.keys()


## The scene of a tile: a [MultiMeshInstance3D] for each layer and model. Null while it is not shown.
func get_tile(tile: Vector2i) -> Node3D:
	return _shown.get(tile)


## How many instances stand in the tiles that are shown.
func get_instance_count() -> int:
	var sum := 0
	for tile in _shown:
		sum += index.instances[_numbers[tile]]
	return sum


## Whether everything that is near enough is shown, but for what cannot be loaded.
func is_settled() -> bool:
	return index != null and not _is_stale and _wanted.is_empty() and _loading.is_empty()


func _viewer() -> Node3D:
	if is_instance_valid(viewer):
		return viewer
	return get_viewport().get_camera_3d()


func _look_up() -> void:
	_numbers.clear()
	_failed.clear()
	if index == null:
		return
	var count := index.instances.size()
	if index.tiles.size() != 2 * count or index.centers.size() != 3 * count or count > 0 and not index.tile_size > 0.0:
		push_error(INVALID % ["tiles, centers and tile_size", "2 and 3 numbers for each of the %d entries of instances, and meters above 0" % count,
				"%d, %d and %s" % [index.tiles.size(), index.centers.size(), index.tile_size]])
		return
	for number in count:
		_numbers[Vector2i(index.tiles[2 * number], index.tiles[2 * number + 1])] = number
	if index.world_offset.size() not in [0, 3]:
		push_error(INVALID % ["world_offset", "3 numbers", index.world_offset.size()])
	elif not index.world_offset.is_empty():
		world_offset = Vector3(index.world_offset[0], index.world_offset[1], index.world_offset[2])
	_is_stale = true


## In double precision up to the last step.
func _place_of(number: int) -> Vector3:
	return Vector3(
		index.centers[3 * number] - world_offset.x,
		index.centers[3 * number + 1] - world_offset.y,
		index.centers[3 * number + 2] - world_offset.z,
	)


## Meters from a place to the square of a tile.
func _distance(tile: Vector2i, here: Vector2) -> float:
	var least := Vector2(tile) * index.tile_size
	return here.distance_to(here.clamp(least, least + Vector2.ONE * index.tile_size))


func _look_around(here: Vector2) -> void:
	_is_stale = false
	_looked_from = here
	var gone: Array[Vector2i] = []
	for tile: Vector2i in _shown.keys():
		if _distance(tile, here) > view_distance + index.tile_size / 4.0:
			gone.append(tile)
			_shown[tile].queue_free()
			_shown.erase(tile)
	_wanted.clear()
	var distances: Dictionary[Vector2i, float] = {}
	for tile in _tiles_near(here):
		if not (_shown.has(tile) or _loading.has(tile) or _failed.has(tile)):
			distances[tile] = _distance(tile, here)
			if distances[tile] <= view_distance:
				_wanted.append(tile)
	_wanted.sort_custom(func(a: Vector2i, b: Vector2i) -> bool: return distances[a] > distances[b])
	for tile in gone:
		tile_freed.emit(tile)


func _tiles_near(here: Vector2) -> Array[Vector2i]:
	var least := Vector2i(((here - Vector2.ONE * view_distance) / index.tile_size).floor())
	var greatest := Vector2i(((here + Vector2.ONE * view_distance) / index.tile_size).floor())
	var near: Array[Vector2i] = []
	# Whichever are fewer: the squares around, or the tiles that there are.
	if float(greatest.x - least.x + 1) * (greatest.y - least.y + 1) > _numbers.size():
		near.assign(_numbers.keys())
		return near
	for z in range(least.y, greatest.y + 1):
		for x in range(least.x, greatest.x + 1):
			if _numbers.has(Vector2i(x, z)):
				near.append(Vector2i(x, z))
	return near


func _request() -> void:
	while index != null and not _wanted.is_empty() and _loading.size() < MOST_LOADING:
		var tile: Vector2i = _wanted.pop_back()
		var path := index.tile_path(tile)
		if not ResourceLoader.exists(path, "PackedScene"):
			_fail(tile, "%s is missing" % path)
			continue
		var error := ResourceLoader.load_threaded_request(path, "PackedScene") if _reads_on_threads else OK
		if error == OK:
			_loading[tile] = path
		else:
			_fail(tile, "%s cannot be requested (%s) and so cannot be read" % [path, error_string(error)])


func _take(deadline: int) -> void:
	for tile: Vector2i in _loading.keys():
		if not _loading.has(tile):
			return
		var path := _loading[tile]
		if _reads_on_threads and ResourceLoader.load_threaded_get_status(path) == ResourceLoader.THREAD_LOAD_IN_PROGRESS:
			continue
		_loading.erase(tile)
		var scene := (ResourceLoader.load_threaded_get(path) if _reads_on_threads else ResourceLoader.load(path)) as PackedScene
		if scene == null:
			_fail(tile, "%s cannot be read" % path)
		elif _distance(tile, _looked_from) <= view_distance + index.tile_size / 4.0:
			_show(tile, scene, path)
		if Time.get_ticks_usec() >= deadline:
			return


func _show(tile: Vector2i, scene: PackedScene, path: String) -> void:
	var node := scene.instantiate() as Node3D
	var number := _numbers[tile]
	if node == null or node.get_meta(&"baked", []) != [tile, index.instances[number], index.scene_digest]:
		if node != null:
			node.free()
		_fail(tile, "%s is not what this world has there" % path)
		return
	node.position = _place_of(number)
	add_child(node)
	_shown[tile] = node
	tile_shown.emit(tile)


func _fail(tile: Vector2i, why: String) -> void:
	_failed[tile] = true
	push_error("BakedWorld: the tile %s cannot be shown: %s. Export the bake again." % [tile, why])
	tile_failed.emit(tile)


func _drop_all() -> void:
	for tile in _loading:
		if _reads_on_threads: # The engine keeps what was requested and not taken.
			ResourceLoader.load_threaded_get(_loading[tile])
	for tile in _shown:
		_shown[tile].queue_free()
	_loading.clear()
	_shown.clear()
	_wanted.clear()
