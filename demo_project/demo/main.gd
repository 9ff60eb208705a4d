extends Node3D
## The demo: a forest on real terrain, a camera, an overlay, and keys to play with the scatter.
##
## Arguments after [code]--[/code]: [code]--screenshots[/code] or [code]--screenshots=FOLDER[/code] flies the fixed
## path, writes a picture at each stop (to build/demo beside the project unless told otherwise; none with --headless),
## prints the figures and quits; [code]--stops=NAME,NAME[/code] does so for these stops alone;
## [code]--seed=NUMBER[/code] starts with another seed; [code]--at=STOP[/code] starts at a stop of the flight.

const Figures := preload("res://demo/figures.gd")
const Flight := preload("res://demo/flight.gd")
const Screenshots := preload("res://demo/screenshots.gd")
const DENSITY_STEP := 0.1

## The scatter's figures, gathered in every frame.
var figures := Figures.new()

var _density := 1.0
var _densities := PackedFloat64Array()
var _flight_seconds := -1.0

@onready var scatter: Node3D = $Scatter
@onready var _terrain: Node3D = $Terrain
@onready var _camera: Camera3D = $Camera
@onready var _overlay: CanvasLayer = $Overlay
@onready var _borders: MeshInstance3D = $TileBorders


func _ready() -> void:
	_camera.elevation = _terrain.elevation
	_borders.follow(scatter, _terrain.elevation)
	for layer: Resource in scatter.get(&"layers"):
		_densities.append(layer.get(&"density"))
	var arguments := _arguments()
	if arguments.has("seed"):
		scatter.set(&"seed", int(arguments.seed))
	place(Flight.STOPS[0])
	for stop in Flight.STOPS:
		if stop.name == arguments.get("at", ""):
			place(stop)
	if arguments.has("screenshots"):
		_take_screenshots(arguments.screenshots, arguments.get("stops", ""))


func _process(delta: float) -> void:
	figures.sample(scatter.call(&"get_stats"))
	if _flight_seconds >= 0.0:
		_flight_seconds += delta
		fly_to(Flight.on_the_way(_flight_seconds))
		if _flight_seconds > Flight.flight_seconds():
			_flight_seconds = -1.0
	var mode := ""
	if not figures.frozen:
		mode = ", %s, %d frames a second" % ["walking" if _camera.walking else "flying", Engine.get_frames_per_second()]
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
			_camera.walking = not _camera.walking
		KEY_T:
			show_tiles(not _borders.visible)
		KEY_P:
			place(Flight.STOPS[0])
			_flight_seconds = 0.0
		KEY_H:
			_overlay.toggle_help()
		KEY_ESCAPE:
			Input.mouse_mode = Input.MOUSE_MODE_VISIBLE


## Puts the camera where a stop of the flight says.
func place(stop: Dictionary) -> void:
	_flight_seconds = -1.0
	_camera.walking = false
	_camera.transform = Flight.transform(stop, _terrain.elevation.height(stop.eye.x, stop.eye.z))


## Puts the camera over world x and z (as y), as high above the ground as the flight begins, looking as it looks.
func fly_to(place_in_plane: Vector2) -> void:
	var ground: float = _terrain.elevation.height(place_in_plane.x, place_in_plane.y)
	_camera.position = Vector3(place_in_plane.x, ground + float(Flight.STOPS[0].eye.y), place_in_plane.y)


## Shows or hides the borders of the tiles.
func show_tiles(shown: bool) -> void:
	_borders.visible = shown


## Shows or hides the figures.
func show_overlay(shown: bool) -> void:
	_overlay.visible = shown


func _set_density(density: float) -> void:
	_density = clampf(density, 0.0, 1.0)
	var layers: Array = scatter.get(&"layers")
	for i in layers.size():
		layers[i].set(&"density", _densities[i] * _density)


func _take_screenshots(folder: String, stops: String) -> void:
	_overlay.hide_help()
	var run := Screenshots.new()
	run.demo = self
	if DisplayServer.get_name() != "headless":
		var beside := ProjectSettings.globalize_path("res://").path_join("../build/demo").simplify_path()
		run.folder = folder if folder != "" else beside
	run.only = stops.split(",", false)
	add_child(run)
	run.run()


## The user's arguments: --name=value as name and value, --name as name and an empty value.
static func _arguments() -> Dictionary:
	var found := {}
	for argument in OS.get_cmdline_user_args():
		var parts := argument.trim_prefix("--").split("=", true, 1)
		found[parts[0]] = parts[1] if parts.size() > 1 else ""
	return found
