@tool
extends "res://addons/thicket/editor/brush/brush_tool.gd"
## The brush that paints and displays the masks of layers.

const Brush := preload("res://addons/thicket/editor/brush/brush.gd")
const FirstStroke := preload("res://addons/thicket/editor/brush/first_stroke.gd")
const MaskOverlay := preload("res://addons/thicket/editor/brush/mask_overlay.gd")
const SceneFiles := preload("res://addons/thicket/editor/scene_files.gd")

const MODE_NAMES: PackedStringArray = ["Paint", "Erase", "Smooth"]
const MODE_TIPS: PackedStringArray = [
	"Paint: increase the density of the layer. The first stroke on a layer that grows unmasked opens a dialog with two choices.",
	"Erase: decrease the density of the layer (or hold Ctrl).",
	"Smooth: blur the painted density (or hold Shift).",
]
const COLORS: Array[Color] = [Color(0.5, 1.0, 0.45), Color(1.0, 0.45, 0.35), Color(0.45, 0.75, 1.0)]

var brush := Brush.new()
## The dialog for the first stroke on a layer without a mask.
var first_stroke := FirstStroke.new()
## The overlay that shows the mask of the selected layer on the ground.
var mask_overlay := MaskOverlay.new()

var _modes: Array[Button] = []
var _strength: EditorSpinSlider
var _hardness: EditorSpinSlider


func _init() -> void:
	_setup("Brush", &"Paint", "Brush: use the left mouse button to paint where the layer grows.")
	var group := ButtonGroup.new()
	for mode in MODE_NAMES.size():
		var mode_button := Button.new()
		mode_button.text = MODE_NAMES[mode]
		mode_button.theme_type_variation = &"FlatButton"
		mode_button.tooltip_text = MODE_TIPS[mode]
		mode_button.toggle_mode = true
		mode_button.button_group = group
		mode_button.button_pressed = mode == brush.mode
		mode_button.pressed.connect(_on_mode.bind(mode))
		_modes.append(mode_button)
		add_child(mode_button)
	_add_radius(brush.radius)
	_radius.value_changed.connect(func(value: float) -> void: brush.radius = value)
	_strength = _slider("Strength", "Strength: the change in density at the center of one dab.", 1.0, 100.0, 1.0, brush.strength * 100.0, "%")
	_strength.value_changed.connect(func(value: float) -> void: brush.strength = value * 0.01)
	_hardness = _slider("Hardness", "Hardness: the fraction of the radius with full strength.", 0.0, 100.0, 1.0,
			brush.hardness * 100.0, "%")
	_hardness.value_changed.connect(func(value: float) -> void: brush.hardness = value * 0.01; redraw_requested.emit())
	first_stroke.chosen.connect(_stroke_once)
	add_child(first_stroke)


## Sets the mode of the left mouse button.
func choose_mode(mode: ScatterMask.Mode) -> void:
	_modes[mode].button_pressed = true
	_on_mode(mode)


## Sets the brush: the radius in meters, and strength and hardness from 0 to 1.
func set_brush(radius: float, strength: float, hardness: float) -> void:
	_radius.value = radius
	_strength.value = strength * 100.0
	_hardness.value = hardness * 100.0


## Shows the mask of the chosen layer while the brush is on.
func refresh() -> void:
	mask_overlay.planet_radius = SurfacePlace.planet_radius(scatter) if is_instance_valid(scatter) and _covers_planet() else 0.0
	_show_painted(mask_overlay, layer.mask if layer != null else null)


func finish() -> void:
	brush.finish(undo_redo)


func _color() -> Color:
	return COLORS[brush.mode]


func _draw_inside(overlay: Control) -> void:
	if brush.hardness > 0.0:
		_cursor.draw_ring(overlay, brush.radius * brush.hardness, Color(_color(), 0.45), 1.0)


func _is_painting() -> bool:
	return brush.is_painting()


func _move_stroke(point: Vector3) -> void:
	brush.move(point)


func _covers_planet() -> bool:
	return Brush.covers_planet(scatter, unlocked())


func _on_mode(mode: ScatterMask.Mode) -> void:
	brush.mode = mode
	redraw_requested.emit()


func _begin_stroke(point: Vector3, click: InputEventMouseButton) -> String:
	if ground() == null:
		return _position_problem(point)
	if layer == null:
		return "There is nothing to paint: add a layer to %s in the Scatter panel." % scatter.name
	if not lock_problem().is_empty():
		return lock_problem()
	if not _position_problem(point).is_empty():
		return _position_problem(point)
	var mode := brush.mode
	if click.shift_pressed:
		mode = ScatterMask.MODE_SMOOTH
	elif click.ctrl_pressed:
		mode = ScatterMask.MODE_ERASE
	var unmasked := unlocked().filter(func(unlocked_layer: ScatterLayer) -> bool: return unlocked_layer.mask == null)
	if mode == ScatterMask.MODE_PAINT and not unmasked.is_empty():
		var names := PackedStringArray(unmasked.map(func(unlocked_layer: ScatterLayer) -> String: return unlocked_layer.resource_name))
		first_stroke.ask(names, unmasked.reduce(
				func(sum: int, unlocked_layer: ScatterLayer) -> int: return sum + scatter.get_shown_count(unlocked_layer), 0), point)
		return ""
	return brush.begin(scatter, unlocked(), SceneFiles.edited_scene_path(), mode, point)


## Paints a single dab with the mode that the user has chosen in the dialog. The brush keeps that mode.
func _stroke_once(mode: ScatterMask.Mode, point: Vector3) -> void:
	if not is_instance_valid(scatter) or unlocked().is_empty():
		return
	choose_mode(mode)
	problem = brush.begin(scatter, unlocked(), SceneFiles.edited_scene_path(), mode, point)
	finish()
	redraw_requested.emit()
