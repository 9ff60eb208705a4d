extends "res://demo/stage.gd"
## Shows rows along paths: an avenue with a gap at a crossing, a hedge, and the parallel rows of a vineyard and a field. The wood keeps its
## distance from them. The key M bends the road.

const BEND := Vector3(45.0, 0.0, 0.0)
## The stops, with the fields that [code]flight.gd[/code] describes. [code]is_bent[/code] is true if the road is bent.
const STOPS: Array[Dictionary] = [
	{"name": "country", "eye": Vector3(20.0, 95.0, 170.0), "heading": 8.0, "pitch": -27.0, "is_bent": false},
	{"name": "bent", "eye": Vector3(20.0, 95.0, 170.0), "heading": 8.0, "pitch": -27.0, "is_bent": true},
	{"name": "avenue", "eye": Vector3(4.0, 1.8, 100.0), "heading": 8.0, "pitch": 6.0, "is_bent": false},
	{"name": "vineyard", "eye": Vector3(40.0, 5.0, 48.0), "heading": -40.0, "pitch": -10.0, "is_bent": false},
]

var _is_bent := false


func stops() -> Array[Dictionary]:
	return STOPS


func own_key(keycode: Key) -> void:
	if keycode == KEY_M:
		_bend(not _is_bent)


func place(stop: Dictionary) -> void:
	super(stop)
	_bend(stop.is_bent)


func _bend(is_bent: bool) -> void:
	if is_bent != _is_bent:
		_is_bent = is_bent
		var curve: Curve3D = $Road.curve
		curve.set_point_position(1, curve.get_point_position(1) + (BEND if is_bent else -BEND))
