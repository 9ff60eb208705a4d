extends RefCounted
## The fixed flight path and the camera stops of the first scene, for runs without user input.
##
## Positions are in meters. x and z are world coordinates, and y is the height above the ground, so the path follows the terrain.

## The speed of the flight in meters per second.
const SPEED := 100.0
## The flight's height above the ground in meters.
const HEIGHT := 280.0
## World x and z of the flight's start and end. The y component of each vector is z.
const FROM := Vector2(2350.0, 150.0)
const TO := Vector2(1620.0, -1180.0)

## The stops. Each has a name, the position of the camera ([code]eye[/code]: x, meters above the ground, z), a heading and a pitch. The heading is in
## degrees clockwise from north. The pitch is in degrees and positive when looking up. [code]fov[/code], a vertical field of view in degrees, is
## optional. The sun is low in the west-southwest, at 246 degrees. Most stops look at a right angle to it, so that shadows lie across the view.
const STOPS: Array[Dictionary] = [
	{"name": "overview", "eye": Vector3(3080.0, 95.0, 330.0), "heading": 312.0, "pitch": -9.0, "fov": 52.0},
	{"name": "forest", "eye": Vector3(1420.0, 30.0, -700.0), "heading": 147.0, "pitch": -6.0, "fov": 50.0},
	{"name": "walk", "eye": Vector3(2347.5, 1.75, 86.0), "heading": 350.0, "pitch": 3.0, "fov": 52.0},
	{"name": "lake", "eye": Vector3(2838.0, 2.0, 348.0), "heading": 352.0, "pitch": 3.0, "fov": 55.0},
	{"name": "ridge", "eye": Vector3(-725.0, 5.0, 6095.0), "heading": 318.0, "pitch": -4.0, "fov": 48.0},
	{"name": "stones", "eye": Vector3(-12552.5, 1.75, 10573.5), "heading": 45.0, "pitch": -7.0},
	{"name": "tiles", "eye": Vector3(1900.0, 150.0, -700.0), "heading": 318.0, "pitch": -28.0, "tiles": true},
]


## Returns the world x and z of the flight after [param seconds]. The y component of the result is z.
static func on_the_way(seconds: float) -> Vector2:
	return FROM.move_toward(TO, SPEED * seconds)


## Returns the duration of the flight in seconds.
static func flight_seconds() -> float:
	return FROM.distance_to(TO) / SPEED
