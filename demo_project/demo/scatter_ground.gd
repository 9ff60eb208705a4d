extends RefCounted
## The ground of a [ScatterTerrain] in the words that camera and tile borders ask for it.

var _terrain: ScatterTerrain


func _init(terrain: ScatterTerrain) -> void:
	_terrain = terrain


## Height of the ground in meters at world x and z; NAN where there is none.
func height(x: float, z: float) -> float:
	return _terrain.get_height(Vector3(x, 0.0, z))
