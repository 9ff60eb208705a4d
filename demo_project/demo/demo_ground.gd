extends RefCounted
## Adapts a [ScatterGround] for the camera and the tile borders, which call [method height].

var _ground: ScatterGround


func _init(ground: ScatterGround) -> void:
	_ground = ground


## Returns the height of the ground in meters at world x and z, or NAN if there is no ground.
func height(x: float, z: float) -> float:
	return _ground.get_height(Vector3(x, 0.0, z))
