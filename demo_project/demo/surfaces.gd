extends "res://demo/stage.gd"
## Shows layers that grow on all surfaces of meshes: a gorge with a bridge, a cave, a ruin, and a small planet in the sky.

const Shape := preload("res://terrain/gorge_shape.gd")
## The stops. The positions of the camera are in world space, because a position may have several levels of ground.
const STOPS: Array[Dictionary] = [
	{"name": "gorge", "eye": Vector3(2.6, 3.7, 23.0), "heading": 354.0, "pitch": 12.0, "fov": 62.0},
	{"name": "cave", "eye": Vector3(29.0, 3.8, 13.5), "heading": 233.0, "pitch": 3.0, "fov": 62.0},
	{"name": "log", "eye": Vector3(9.2, 2.8, -13.3), "heading": 343.0, "pitch": -28.0, "fov": 54.0},
	{"name": "ruin", "eye": Vector3(-35.5, 15.6, -1.0), "heading": 46.0, "pitch": 6.0, "fov": 58.0},
	{"name": "planet", "eye": Vector3(0.0, 362.0, 566.0), "heading": 0.0, "pitch": 14.5, "fov": 56.0},
]
## The ambient light in the cave, as a fraction of the ambient light outside.
const CAVE_LIGHT := 0.7

var _shape := Shape.new()
var _daylight := 0.0

@onready var _environment: Environment = $Daylight/WorldEnvironment.environment.duplicate()


func _ready() -> void:
	_daylight = _environment.ambient_light_energy
	$Daylight/WorldEnvironment.environment = _environment
	super()
	# The camera flies below bridges and through rock.
	camera.elevation = null


func _process(delta: float) -> void:
	super(delta)
	_environment.ambient_light_energy = _daylight * lerpf(1.0, CAVE_LIGHT, _shape.inside(camera.position))


func stops() -> Array[Dictionary]:
	return STOPS


## Returns the layers of the gorge.
func layers() -> Array:
	return $Scatter.get(&"layers")


## Moves the camera to a stop. The statistics of the scatter at this stop are then displayed.
func place(stop: Dictionary) -> void:
	super(stop)
	camera.position = stop.eye
	scatter = $PlanetScatter if stop.name == "planet" else $Scatter
