@tool
extends "res://terrain/masonry.gd"
## The walls of a ruined hall without a roof. The origin is the northwest corner of its floor.

## The size of a block in meters, and the size of the hall in blocks.
const BLOCK := Vector3(0.7, 0.5, 0.55)
const SIZE := Vector3i(18, 21, 16)
## The thickness of the walls, in blocks.
const THICK := 2
## The openings in the walls along x and in the walls along z. Each has its middle, half its width, and the heights of
## its sill and of its top, in blocks.
const ALONG_X: Array[Vector4] = [Vector4(5.5, 1.6, 4.0, 9.0), Vector4(11.5, 2.1, 0.0, 7.0)]
const ALONG_Z: Array[Vector4] = [Vector4(7.5, 1.6, 4.0, 9.0)]

var _damage := FastNoiseLite.new()


func _init() -> void:
	_damage.seed = 12
	_damage.frequency = 0.13


func counts() -> Vector3i:
	return SIZE


func is_solid(block: Vector3i) -> bool:
	if block.x < 0 or block.x >= SIZE.x or block.y < 0 or block.z < 0 or block.z >= SIZE.z:
		return false
	var along_x := block.z < THICK or block.z >= SIZE.z - THICK
	var along_z := block.x < THICK or block.x >= SIZE.x - THICK
	if not along_x and not along_z or block.y >= _height(block.x, block.z):
		return false
	if along_x and along_z:
		return true
	for opening in (ALONG_X if along_x else ALONG_Z):
		var side_offset := absf((block.x if along_x else block.z) + 0.5 - opening.x) / opening.y
		# The top of an opening is round.
		var top := opening.w - 2.0 + 2.0 * sqrt(maxf(1.0 - side_offset * side_offset, 0.0))
		if side_offset >= 1.0:
			continue
		if block.y >= opening.z - 1 and block.y < top:
			return false
		# If the wall at either side of an opening is too low, the stones above the opening have fallen.
		var sides := Vector2i(floori(opening.x - opening.y - 0.5), floori(opening.x + opening.y + 0.5))
		for side: int in [sides.x, sides.y]:
			if block.y >= top and (_height(side, block.z) if along_x else _height(block.x, side)) < opening.w + 1.0:
				return false
	return true


func corner(block: Vector3i) -> Vector3:
	return Vector3(block) * BLOCK - Vector3.UP * BLOCK.y


## Returns the height of the wall in blocks. The northern corners are the highest.
func _height(x: int, z: int) -> float:
	var south := float(z) / SIZE.z
	return 14.0 - 6.0 * south + 3.0 * absf(x * 2.0 / SIZE.x - 1.0) + 8.0 * _damage.get_noise_2d(x, z) + 1.2 * _random(Vector3i(x / 2, 0, z / 2), 3)
