extends "res://demo/stage.gd"
## Shows a forest on real terrain, and a flight over it. This is the first scene of the demo.

const Flight := preload("res://demo/flight.gd")

var _flight_seconds := -1.0


func _ready() -> void:
	ground = $Terrain.elevation
	super()


func _process(delta: float) -> void:
	super(delta)
	if _flight_seconds >= 0.0:
		_flight_seconds += delta
		fly(_flight_seconds)
		if _flight_seconds > flight_seconds():
			_flight_seconds = -1.0


func stops() -> Array[Dictionary]:
	return Flight.STOPS


func flight_seconds() -> float:
	return Flight.flight_seconds()


## Moves the camera to its position in the flight after [param seconds], without rotating it.
func fly(seconds: float) -> void:
	var point_xz := Flight.on_the_way(seconds)
	var height: float = ground.height(point_xz.x, point_xz.y)
	camera.position = Vector3(point_xz.x, height + Flight.HEIGHT, point_xz.y)


func own_key(keycode: Key) -> void:
	if keycode == KEY_P:
		place(Flight.STOPS[0])
		_flight_seconds = 0.0


func place(stop: Dictionary) -> void:
	_flight_seconds = -1.0
	super(stop)
