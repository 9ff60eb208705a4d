extends "res://demo/stage.gd"
## The scene that shows the presets of the add-on, and layers of one model each, with the values of a drop, one at a time on the same hill and under the
## same light.

const DemoGround := preload("res://demo/demo_ground.gd")
const FOLDER := "res://addons/thicket/presets/"
const ON_THE_HILL := {"eye": Vector3(62.0, 3.2, 96.0), "heading": 318.0, "pitch": 2.0}
const GREEN: Array[Color] = [Color(0.33, 0.39, 0.14), Color(0.4, 0.41, 0.17), Color(0.4, 0.385, 0.35)]
## The presets, and single models, as stops. [code]colors[/code] are those of the ground: below plants, where it is dry, and on steep slopes.
const STOPS: Array[Dictionary] = [
	{"name": "forest", "eye": Vector3(30.0, 3.0, 128.0), "heading": 312.0, "pitch": 4.0, "glade": 11.0,
		"colors": [Color(0.25, 0.27, 0.1), Color(0.29, 0.27, 0.13), Color(0.4, 0.385, 0.35)]},
	{"name": "meadow", "colors": GREEN},
	{"name": "pine_wood", "colors": [Color(0.3, 0.27, 0.15), Color(0.33, 0.28, 0.18), Color(0.4, 0.385, 0.35)]},
	{"name": "scree", "colors": [Color(0.37, 0.37, 0.22), Color(0.41, 0.38, 0.27), Color(0.42, 0.405, 0.37)],
		"eye": Vector3(128.0, 2.5, 20.0), "heading": 52.0, "pitch": 10.0},
	{"name": "shore", "colors": [Color(0.4, 0.41, 0.2), Color(0.5, 0.45, 0.29), Color(0.4, 0.385, 0.35)],
		"eye": Vector3(4.0, 3.5, 24.0), "heading": 318.0, "pitch": -7.0},
	{"name": "desert", "colors": [Color(0.62, 0.48, 0.31), Color(0.68, 0.52, 0.34), Color(0.53, 0.35, 0.23)]},
	{"name": "one_tree", "model": "birch_1", "colors": GREEN, "glade": 11.0},
	{"name": "one_shrub", "model": "shrub_1", "colors": GREEN},
	{"name": "one_grass", "model": "grass_1", "colors": GREEN, "glade": 0.1},
	{"name": "one_rock", "model": "rock_1", "colors": GREEN},
]

var _shown := 0

@onready var _glade: Node3D = $Scatter/Glade


func _ready() -> void:
	ground = DemoGround.new($Scatter.ground)
	super()


func stops() -> Array[Dictionary]:
	return STOPS


func own_key(keycode: Key) -> void:
	if keycode == KEY_M:
		_show(STOPS[(_shown + 1) % STOPS.size()])


func place(stop: Dictionary) -> void:
	_show(stop)
	var there := ON_THE_HILL.merged(stop, true)
	super(there)
	# Nothing tall stands in front of the camera.
	_glade.set(&"layers", layers().filter(func(layer: Resource) -> bool: return layer.get(&"view_distance") > 100.0))
	_glade.position = there.eye
	_glade.set(&"radius", there.get("glade", 6.5))


func _show(stop: Dictionary) -> void:
	_shown = STOPS.find(stop)
	scatter.set(&"layers", _preset(stop.name) if not stop.has("model") else [_dropped(stop.model)])
	_densities.clear()
	for layer: Resource in layers():
		_densities.append(layer.get(&"density"))
	_set_density(1.0)
	var names: Array[StringName] = [&"meadow", &"meadow_dry", &"rock"]
	for index in names.size():
		$Ground.material.set_shader_parameter(names[index], stop.colors[index])


func _preset(name: String) -> Array:
	var preset := (load(FOLDER + name + ".tscn") as PackedScene).instantiate()
	var found: Array = preset.get(&"layers")
	preset.free()
	return found


## A layer with the values that the panel sets for a model that is dropped on it.
func _dropped(model: String) -> Resource:
	var layer: Resource = ClassDB.instantiate(&"ScatterLayer")
	layer.resource_name = model
	layer.set(&"meshes", [load(FOLDER + "plants/%s.res" % model)])
	layer.call(&"fit_to_meshes")
	return layer
