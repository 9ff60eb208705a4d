extends SceneTree
## Moves a camera through an exported world and prints which tiles are visible at each stop. Arguments: the path of the
## scene, then one for each step:
##   X,Z        move there, in meters relative to the engine's origin, and wait until no tile appears or disappears
##   offset=X   move the engine's origin to this world x, together with the camera
##   far=M      set view_distance
##   other=PATH assign another index to the node

var _world: Node3D
var _camera := Camera3D.new()
var _most := 0 # The largest number of tiles that appeared in one frame.
var _most_removed := 0
var _came := 0
var _removed := 0
var _failed: Array[Vector2i] = []


func _initialize() -> void:
	root.add_child(_camera)
	var arguments := OS.get_cmdline_user_args()
	_world = (load(arguments[0]) as PackedScene).instantiate()
	_world.tile_shown.connect(func(_tile: Vector2i) -> void: _came += 1)
	_world.tile_freed.connect(func(_tile: Vector2i) -> void: _removed += 1)
	_world.tile_failed.connect(func(tile: Vector2i) -> void: _failed.append(tile))
	_world.frame_budget_usec = 1
	_world.view_distance = 30.0
	root.add_child(_world)
	for argument in arguments.slice(1):
		var value := argument.get_slice("=", 1)
		if argument.begins_with("offset="):
			_camera.position.x -= value.to_float() - _world.world_offset.x
			_world.world_offset = Vector3(value.to_float(), _world.world_offset.y, _world.world_offset.z)
		elif argument.begins_with("far="):
			_world.view_distance = value.to_float()
		elif argument.begins_with("other="):
			_world.index_file = value
		else:
			_camera.position = Vector3(argument.get_slice(",", 0).to_float(), 920.0, argument.get_slice(",", 1).to_float())
		await _settle()
		_tell()
	_world.queue_free()
	await process_frame
	await process_frame
	print("stream: done")
	quit()


func _settle() -> void:
	_most = 0
	_most_removed = 0
	for frame in 600:
		_came = 0
		_removed = 0
		await process_frame
		_most = maxi(_most, _came)
		_most_removed = maxi(_most_removed, _removed)
		if frame > 2 and _world.is_settled():
			return
	print("stream: never settled")


func _tell() -> void:
	var tiles: Array = []
	var drawn := 0
	var positions: Dictionary = {}
	for tile: Vector2i in _world.get_shown_tiles():
		tiles.append([tile.x, tile.y])
		var node: Node3D = _world.get_tile(tile)
		positions["%d,%d" % [tile.x, tile.y]] = [node.global_position.x, node.global_position.y, node.global_position.z]
		for child: MultiMeshInstance3D in node.get_children():
			drawn += child.multimesh.instance_count if not "_LOD1" in child.name else 0
	print("stop ", JSON.stringify({
		"tiles": tiles, "instances": _world.get_instance_count(), "drawn": drawn, "places": positions, "most": _most, "most_removed": _most_removed,
		"failed": _failed.map(func(tile: Vector2i) -> Array: return [tile.x, tile.y]), "children": _world.get_child_count(),
	}))
