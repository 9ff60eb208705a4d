@tool
extends ScatterGround
## An example of a ground in GDScript: a hilly island with a sinkhole, defined by a formula. There is no ground beyond
## the coast or in the sinkhole, so nothing is placed there.

## The average distance from the world's origin to the coast in meters.
@export_range(20.0, 500.0, 1.0, "suffix:m") var coast := 150.0:
	set(value):
		coast = value
		emit_changed()  # Makes the scatter regenerate its tiles and the terrain mesh rebuild itself.
## The center of the sinkhole, in meters of world x and z.
@export var sinkhole := Vector2(44.0, 20.0):
	set(value):
		sinkhole = value
		emit_changed()
## The average radius of the sinkhole in meters.
@export_range(0.0, 100.0, 1.0, "suffix:m") var sinkhole_radius := 17.0:
	set(value):
		sinkhole_radius = value
		emit_changed()


func _get_heights(positions: PackedVector2Array) -> PackedFloat32Array:
	var heights := PackedFloat32Array()
	heights.resize(positions.size())
	for i in positions.size():
		heights[i] = _height(positions[i])
	return heights


## Returns true, because this ground reads only its own settings. Any number of threads may query it concurrently.
func _is_thread_safe() -> bool:
	return true


## Returns the height in meters at world x and z.
func _height(point: Vector2) -> float:
	var angle := point.angle()
	var bays := 0.17 * sin(2.0 * angle + 0.4) + 0.09 * sin(3.0 * angle + 2.2) + 0.04 * sin(8.0 * angle)
	var rim := point - sinkhole
	if point.length() > coast * (1.0 + bays) or rim.length() < sinkhole_radius * (1.0 + 0.12 * sin(3.0 * rim.angle())):
		return NAN
	var hill := 42.0 * exp(-point.distance_squared_to(Vector2(-45.0, -55.0)) / 4500.0)
	return 15.0 + hill + 4.0 * sin(0.04 * point.x + sin(0.026 * point.y)) + 2.5 * cos(0.05 * point.y)
