extends Node3D
## The base class of the demo's scenes. It has a scatter, a camera, an overlay, keys that change the scatter, and a run that takes screenshots without
## user input.
##
## Arguments after [code]--[/code]: [code]--screenshots[/code] or [code]--screenshots=FOLDER[/code] visits the scene's stops, writes a screenshot at each,
## prints the statistics and quits. The default folder is build/demo next to the project, with a subfolder for each scene except the first. With --headless, no
## screenshots are written. [code]--stops=NAME,NAME[/code] visits only these stops. [code]--seed=NUMBER[/code] sets the seed. [code]--at=STOP[/code] starts at a
## stop.

const DemoGround := preload("res://demo/demo_ground.gd")
const Figures := preload("res://demo/figures.gd")
const Screenshots := preload("res://demo/screenshots.gd")
const DENSITY_STEP := 0.1

## The scatter's statistics, collected in every frame.
var figures := Figures.new()
## The ground under the camera, an object with a method [code]height(x, z)[/code]. By default, the scatter's ground. A scene's script may set another one
## before calling [method _ready] of this class.
var ground: RefCounted

var _density := 1.0
var _densities := PackedFloat64Array()

@onready var scatter: Node3D = $Scatter
@onready var camera: Camera3D = $Camera
## The scene's field of view in degrees, for stops without their own.
@onready var _fov := camera.fov
@onready var _overlay: CanvasLayer = $Overlay
@onready var _borders: MeshInstance3D = $TileBorders


func _ready() -> void:
	if ground == null:
		ground = DemoGround.new(scatter.get(&"ground"))
	camera.elevation = ground
	_borders.follow(scatter, ground)
	for layer: Resource in layers():
		_densities.append(layer.get(&"density"))
	var arguments := _arguments()
	if arguments.has("seed"):
		scatter.set(&"seed", int(arguments.seed))
	place(stops()[0])
	for stop in stops():
		if stop.name == arguments.get("at", ""):
			place(stop)
	if arguments.has("screenshots"):
		_take_screenshots(arguments.screenshots, arguments.get("stops", ""))


func _process(_delta: float) -> void:
	figures.sample(scatter.call(&"get_stats"))
	var mode := ""
	if not figures.frozen:
		mode = ", %s, %d frames per second" % ["walking" if camera.walking else "flying", Engine.get_frames_per_second()]
	_overlay.show_figures(figures.text(), "seed %d, density %.0f %%%s" % [scatter.get(&"seed"), _density * 100.0, mode])


func _unhandled_key_input(event: InputEvent) -> void:
	var key := event as InputEventKey
	if key == null or not key.pressed or key.echo:
		return
	match key.keycode:
		KEY_N:
			scatter.set(&"seed", int(scatter.get(&"seed")) + 1)
		KEY_B:
			scatter.set(&"seed", int(scatter.get(&"seed")) - 1)
		KEY_PLUS, KEY_EQUAL, KEY_KP_ADD:
			_set_density(_density + DENSITY_STEP)
		KEY_MINUS, KEY_KP_SUBTRACT:
			_set_density(_density - DENSITY_STEP)
		KEY_F:
			camera.walking = not camera.walking
		KEY_T:
			show_tiles(not _borders.visible)
		KEY_H:
			_overlay.toggle_help()
		KEY_ESCAPE:
			Input.mouse_mode = Input.MOUSE_MODE_VISIBLE
		_:
			own_key(key.keycode)


## Returns the stops of the screenshot run. The scene starts at the first of them. [code]flight.gd[/code] describes the fields of a stop. If
## [code]tiles[/code] is true, the screenshot shows the tile borders and the statistics.
func stops() -> Array[Dictionary]:
	return []


## Returns the layers whose density the keys + and - change.
func layers() -> Array:
	return scatter.get(&"layers")


## Returns the duration of the scene's flight in seconds, or 0 for a scene without a flight.
func flight_seconds() -> float:
	return 0.0


## Moves the camera to its position in the flight after [param _seconds].
func fly(_seconds: float) -> void:
	pass


## Handles a key that this class does not handle. The scenes override it.
func own_key(_keycode: Key) -> void:
	pass


## Moves the camera to a stop.
func place(stop: Dictionary) -> void:
	var eye: Vector3 = stop.eye
	var height: float = ground.height(eye.x, eye.z)
	var view_basis := Basis.from_euler(Vector3(deg_to_rad(stop.pitch), -deg_to_rad(stop.heading), 0.0))
	camera.walking = false
	camera.fov = stop.get("fov", _fov)
	camera.transform = Transform3D(view_basis, Vector3(eye.x, eye.y if is_nan(height) else height + eye.y, eye.z))


## Shows or hides the borders of the tiles.
func show_tiles(enabled: bool) -> void:
	_borders.visible = enabled


## Shows or hides the statistics.
func show_overlay(enabled: bool) -> void:
	_overlay.visible = enabled


func _set_density(density: float) -> void:
	_density = clampf(density, 0.0, 1.0)
	var changed_layers := layers()
	for i in changed_layers.size():
		changed_layers[i].set(&"density", _densities[i] * _density)


func _take_screenshots(folder: String, only: String) -> void:
	_overlay.hide_help()
	var run := Screenshots.new()
	run.demo = self
	if DisplayServer.get_name() != "headless":
		var scene := scene_file_path.get_file().get_basename()
		var default_folder := ProjectSettings.globalize_path("res://").path_join("../build/demo").simplify_path()
		run.folder = folder if folder != "" else default_folder.path_join("" if scene == "demo" else scene)
	run.only = only.split(",", false)
	add_child(run)
	run.run()


## Returns the command-line arguments. For an argument --name=value, the key is name. An argument --name has an empty value.
static func _arguments() -> Dictionary:
	var result := {}
	for argument in OS.get_cmdline_user_args():
		var name_and_value := argument.trim_prefix("--").split("=", true, 1)
		result[name_and_value[0]] = name_and_value[1] if name_and_value.size() > 1 else ""
	return result
