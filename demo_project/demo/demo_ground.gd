extends RefCounted
## The ground of a [ScatterGround] in the words that camera and tile borders ask for it.

var _ground: ScatterGround


func _init(ground: ScatterGround) -> void:
	_ground = ground


## Height of the ground in meters at world x and z; NAN where there is none.
func height(x: float, z: float) -> float:
	return _ground.get_height(Vector3(x, 0.0, z))
