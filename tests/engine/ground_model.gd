extends RefCounted
## Computes heights and slopes of a raw 16-bit heightmap independently in GDScript, to check ScatterGroundHeightmap.

var _heights: PackedFloat64Array
var _columns: int
var _rows: int
var _first: Vector2
var _step_x: float
var _step_z: float


func _init(terrain: ScatterGroundHeightmap) -> void:
	_columns = terrain.post_count.x
	_rows = terrain.post_count.y
	_first = terrain.rect.position
	_step_x = terrain.rect.size.x / (_columns - 1)
	_step_z = terrain.rect.size.y / (_rows - 1)
	var bytes := FileAccess.get_file_as_bytes(terrain.heightmap_path)
	_heights.resize(_columns * _rows)
	for index in _heights.size():
		_heights[index] = lerpf(terrain.min_height, terrain.max_height, bytes.decode_u16(2 * index) / 65535.0)


func height(x: float, z: float) -> float:
	var column := clampi(floori((x - _first.x) / _step_x), 0, _columns - 2)
	var row := clampi(floori((z - _first.y) / _step_z), 0, _rows - 2)
	var along_x := (x - _first.x) / _step_x - column
	var along_z := (z - _first.y) / _step_z - row
	var at := row * _columns + column
	return lerpf(lerpf(_heights[at], _heights[at + 1], along_x),
			lerpf(_heights[at + _columns], _heights[at + _columns + 1], along_x), along_z)


## Returns the slope in degrees, interpolated from the gradients at the four surrounding samples.
func slope(x: float, z: float) -> float:
	var column := clampi(floori((x - _first.x) / _step_x), 0, _columns - 2)
	var row := clampi(floori((z - _first.y) / _step_z), 0, _rows - 2)
	var along_x := (x - _first.x) / _step_x - column
	var along_z := (z - _first.y) / _step_z - row
	var near := _gradient(column, row).lerp(_gradient(column + 1, row), along_x)
	var far := _gradient(column, row + 1).lerp(_gradient(column + 1, row + 1), along_x)
	return rad_to_deg(atan(near.lerp(far, along_z).length()))


func _gradient(column: int, row: int) -> Vector2:
	var left := maxi(column - 1, 0)
	var right := mini(column + 1, _columns - 1)
	var front := maxi(row - 1, 0)
	var back := mini(row + 1, _rows - 1)
	return Vector2(
			(_heights[row * _columns + right] - _heights[row * _columns + left]) / ((right - left) * _step_x),
			(_heights[back * _columns + column] - _heights[front * _columns + column]) / ((back - front) * _step_z))
