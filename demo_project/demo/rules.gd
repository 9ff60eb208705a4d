extends "res://demo/stage.gd"
## Shows the rules: a valley with a lake, woods, meadows and scree, and a clearing that moves through the forest. Behind the clearing, the same trees
## reappear, and nothing else changes.

## The stops, with the fields that [code]flight.gd[/code] describes. [code]clearing[/code] is the clearing's position on its path, from 0 to 1.
const STOPS: Array[Dictionary] = [
	{"name": "valley", "eye": Vector3(-84.0, 32.0, 170.0), "heading": 30.0, "pitch": -12.0},
	{"name": "ferns", "eye": Vector3(-19.0, 1.8, 160.0), "heading": 60.0, "pitch": -7.0},
	{"name": "shore", "eye": Vector3(-20.0, 2.2, 42.0), "heading": 330.0, "pitch": -5.0},
	{"name": "path", "eye": Vector3(22.0, 2.2, 104.0), "heading": 25.0, "pitch": -6.0},
	{"name": "scree", "eye": Vector3(128.0, 2.5, 20.0), "heading": 52.0, "pitch": 10.0},
	{"name": "clearing", "eye": Vector3(-50.0, 82.0, -20.0), "heading": 0.0, "pitch": -18.0},
	{"name": "clearing_moved", "eye": Vector3(-50.0, 82.0, -20.0), "heading": 0.0, "pitch": -18.0, "clearing": 1.0},
]
## The world x and z of the clearing at the start and at the end of its path.
const PATH: Array[Vector2] = [Vector2(-105.0, -160.0), Vector2(5.0, -170.0)]
## The time in seconds that the clearing takes to move along its path and back.
const PERIOD := 40.0

var _moving_seconds := 0.0
var _is_moving := false

@onready var _clearing: Node3D = $Scatter/Clearing


func _process(delta: float) -> void:
	super(delta)
	if _is_moving:
		_moving_seconds += delta
		move_clearing(0.5 - 0.5 * cos(TAU * _moving_seconds / PERIOD))


func stops() -> Array[Dictionary]:
	return STOPS


func own_key(keycode: Key) -> void:
	if keycode == KEY_M:
		_is_moving = not _is_moving


func place(stop: Dictionary) -> void:
	super(stop)
	if stop.has("clearing"):
		move_clearing(stop.clearing)


## Moves the clearing on its path. [param progress] is 0 at the start of the path and 1 at its end, where the clearing turns back.
func move_clearing(progress: float) -> void:
	var point_xz := PATH[0].lerp(PATH[1], progress)
	_clearing.global_position = Vector3(point_xz.x, _clearing.global_position.y, point_xz.y)
