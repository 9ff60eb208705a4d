extends RefCounted
## The fixed path and the stops of the first scene, for runs without user input.
##
## Positions are world meters in x and z and meters above the ground in y, so the path follows the terrain.

## Meters per second between the first two stops.
const SPEED := 100.0

## The stops: the name, the eye (x, meters above the ground, z), the direction in degrees clockwise from north, and the
## pitch in degrees, positive for looking up.
const STOPS: Array[Dictionary] = [
	{"name": "overview", "eye": Vector3(2350.0, 280.0, 150.0), "heading": 301.0, "pitch": -11.0},
	{"name": "forest", "eye": Vector3(1620.0, 26.0, -1180.0), "heading": 325.0, "pitch": -3.0},
	{"name": "walk", "eye": Vector3(418.0, 1.75, -1200.0), "heading": 330.0, "pitch": 1.0},
	{"name": "ridge", "eye": Vector3(1046.0, 26.0, -2000.0), "heading": 200.0, "pitch": -6.0},
	{"name": "stones", "eye": Vector3(-12552.5, 1.75, 10573.5), "heading": 45.0, "pitch": -7.0},
	{"name": "tiles", "eye": Vector3(1900.0, 150.0, -700.0), "heading": 318.0, "pitch": -28.0, "tiles": true},
]


## World x and z (as y) on the straight line between the first two stops after [param seconds].
static func on_the_way(seconds: float) -> Vector2:
	var from: Vector3 = STOPS[0].eye
	var to: Vector3 = STOPS[1].eye
	var start := Vector2(from.x, from.z)
	return start.move_toward(Vector2(to.x, to.z), SPEED * seconds)


## Seconds from the first stop to the second.
static func flight_seconds() -> float:
	var from: Vector3 = STOPS[0].eye
	var to: Vector3 = STOPS[1].eye
	return Vector2(from.x, from.z).distance_to(Vector2(to.x, to.z)) / SPEED
