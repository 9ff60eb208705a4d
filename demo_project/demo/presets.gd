extends "res://demo/stage.gd"
## Shows the presets of the add-on, one at a time, on the same hill and in the same light. Also shows layers with a single model, with the values that
## the Scatter panel sets for a dropped model.

const FOLDER := "res://addons/thicket/presets/"
const ON_THE_HILL := {"eye": Vector3(62.0, 3.2, 96.0), "heading": 318.0, "pitch": 2.0}
const GREEN: Array[Color] = [Color(0.255, 0.32, 0.095), Color(0.32, 0.345, 0.125), Color(0.4, 0.385, 0.35)]
## Ground that no grass covers, where it would look darker.
const LAWN: Array[Color] = [Color(0.31, 0.37, 0.125), Color(0.37, 0.385, 0.155), Color(0.4, 0.385, 0.35)]
## The horizontal direction toward the sun.
const SUNWARD := Vector3(-0.83, 0.0, 0.557)
## The presets, and single models, as stops. [code]colors[/code] are the colors of the ground: below plants, where it is dry, and on steep slopes.
## [code]near[/code] is the radius of the circle around the camera without tall plants, in meters. [code]glade[/code] is
## the radius of a circle without trees, which lies toward the sun, so that the trees at its edge are lit.
const STOPS: Array[Dictionary] = [
	{"name": "forest", "eye": Vector3(30.0, 3.0, 128.0), "heading": 312.0, "pitch": 5.0, "glade": 26.0,
		"colors": [Color(0.2, 0.25, 0.085), Color(0.25, 0.26, 0.11), Color(0.4, 0.385, 0.35)]},
	{"name": "meadow", "colors": GREEN, "eye": Vector3(100.0, 3.0, 110.0), "heading": 297.0},
	{"name": "pine_wood", "glade": 22.0, "colors": [Color(0.26, 0.25, 0.12), Color(0.3, 0.265, 0.15), Color(0.4, 0.385, 0.35)]},
	{"name": "scree", "colors": [Color(0.33, 0.335, 0.18), Color(0.38, 0.365, 0.24), Color(0.42, 0.405, 0.37)],
		"eye": Vector3(128.0, 2.5, 20.0), "heading": 52.0, "pitch": 10.0},
	{"name": "shore", "colors": [Color(0.285, 0.33, 0.115), Color(0.34, 0.345, 0.15), Color(0.4, 0.385, 0.35)],
		"eye": Vector3(4.0, 3.5, 24.0), "heading": 318.0, "pitch": -7.0},
	{"name": "desert", "eye": Vector3(50.0, 2.6, 88.0), "heading": 300.0, "colors": [Color(0.58, 0.43, 0.275), Color(0.62, 0.475, 0.315), Color(0.53, 0.35, 0.23)]},
	{"name": "one_tree", "model": "birch_1", "colors": LAWN, "near": 11.0},
	{"name": "one_shrub", "model": "shrub_1", "colors": LAWN},
	{"name": "one_grass", "model": "grass_1", "colors": GREEN, "near": 0.1, "glade": 0.1},
	{"name": "one_rock", "model": "rock_1", "colors": LAWN},
]

var _stop_index := 0

@onready var _near: Node3D = $Scatter/Near
@onready var _glade: Node3D = $Scatter/Glade


func stops() -> Array[Dictionary]:
	return STOPS


func own_key(keycode: Key) -> void:
	if keycode == KEY_M:
		_show(STOPS[(_stop_index + 1) % STOPS.size()])


func place(stop: Dictionary) -> void:
	_show(stop)
	var preset_stop := ON_THE_HILL.merged(stop, true)
	super(preset_stop)
	# Keeps tall plants away from the camera, and trees away from its surroundings.
	_glade.set(&"radius", preset_stop.get("glade", 6.5))
	_near.set(&"radius", preset_stop.get("near", 6.5))
	_clear(_near, 150.0, preset_stop.eye)
	_clear(_glade, 400.0, preset_stop.eye + SUNWARD * 0.8 * _glade.get(&"radius"))


## Moves a region, which keeps layers out that are visible beyond [param distance] meters.
func _clear(region: Node3D, distance: float, center: Vector3) -> void:
	region.set(&"layers", layers().filter(func(layer: Resource) -> bool: return layer.get(&"view_distance") > distance))
	region.position = center


func _show(stop: Dictionary) -> void:
	_stop_index = STOPS.find(stop)
	scatter.set(&"layers", _preset(stop.name) if not stop.has("model") else [_layer_of_model(stop.model)])
	_densities.clear()
	for layer: Resource in layers():
		_densities.append(layer.get(&"density"))
	_set_density(1.0)
	var names: Array[StringName] = [&"meadow", &"meadow_dry", &"rock"]
	for index in names.size():
		$Ground.material.set_shader_parameter(names[index], stop.colors[index])


func _preset(name: String) -> Array:
	var preset := (load(FOLDER + name + ".tscn") as PackedScene).instantiate()
	var preset_layers: Array = preset.get(&"layers")
	preset.free()
	return preset_layers


## Returns a layer with the values that the panel sets for a model that is dropped on it.
func _layer_of_model(model: String) -> Resource:
	var layer: Resource = ClassDB.instantiate(&"ScatterLayer")
	layer.resource_name = model
	layer.set(&"meshes", [load(FOLDER + "plants/%s.res" % model)])
	layer.call(&"fit_to_meshes")
	return layer
