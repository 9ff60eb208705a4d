@tool
extends "res://addons/thicket/editor/scatter_tool.gd"
## The brush: paints the mask of a layer, and shows it.

const Brush := preload("res://addons/thicket/editor/brush/brush.gd")
const Controls := preload("res://addons/thicket/editor/editor_controls.gd")
const FirstStroke := preload("res://addons/thicket/editor/brush/first_stroke.gd")
const GroundCursor := preload("res://addons/thicket/editor/ground/ground_cursor.gd")
const GroundRay := preload("res://addons/thicket/ground_ray.gd")
const MaskOverlay := preload("res://addons/thicket/editor/brush/mask_overlay.gd")
const SceneFiles := preload("res://addons/thicket/editor/scene_files.gd")

const RADIUS_STEP := 1.15
const MODE_NAMES: PackedStringArray = ["Paint", "Erase", "Smooth"]
const MODE_TIPS: PackedStringArray = [
	"Paint: more of the layer. The first stroke on a layer that grows everywhere opens a dialog with two choices.",
	"Erase: less of the layer (or hold Ctrl).",
	"Smooth: blur the painted density (or hold Shift).",
]
const COLORS: Array[Color] = [Color(0.5, 1.0, 0.45), Color(1.0, 0.45, 0.35), Color(0.45, 0.75, 1.0)]

var brush := Brush.new()
## Asks what the first stroke on a layer without a mask means.
var first_stroke := FirstStroke.new()
## Shows the mask of the chosen layer.
var mask_overlay := MaskOverlay.new()
## The reason why the last stroke failed, as a sentence; empty if it succeeded.
var problem := ""

var _cursor := GroundCursor.new()
var _modes: Array[Button] = []
var _radius: EditorSpinSlider
var _strength: EditorSpinSlider
var _hardness: EditorSpinSlider


func _init() -> void:
	_setup("Brush", &"Paint", "Brush: paint where the layer grows, with the left mouse button.")
	var group := ButtonGroup.new()
	for mode in MODE_NAMES.size():
		var choice := Button.new()
		choice.text = MODE_NAMES[mode]
		choice.theme_type_variation = &"FlatButton"
		choice.tooltip_text = MODE_TIPS[mode]
		choice.toggle_mode = true
		choice.button_group = group
		choice.button_pressed = mode == brush.mode
		choice.pressed.connect(_on_mode.bind(mode))
		_modes.append(choice)
		add_child(choice)
	_radius = _slider("Radius", "The radius of the brush in meters (keys [ and ]).", 0.25, 256.0, 0.25, brush.radius, "m")
	_radius.exp_edit = true
	_radius.value_changed.connect(func(value: float) -> void: brush.radius = value; redraw_requested.emit())
	_strength = _slider("Strength", "Strength: the change of density by one dab, at its center.", 1.0, 100.0, 1.0, brush.strength * 100.0, "%")
	_strength.value_changed.connect(func(value: float) -> void: brush.strength = value * 0.01)
	_hardness = _slider("Hardness", "Hardness: the part of the radius with full strength.", 0.0, 100.0, 1.0,
			brush.hardness * 100.0, "%")
	_hardness.value_changed.connect(func(value: float) -> void: brush.hardness = value * 0.01; redraw_requested.emit())
	first_stroke.chosen.connect(_stroke_once)
	add_child(first_stroke)


## Chooses the mode of the left button.
func choose_mode(mode: ScatterMask.Mode) -> void:
	_modes[mode].button_pressed = true
	_on_mode(mode)


## Sets the brush: the radius in meters, and strength and hardness from 0 to 1.
func set_brush(radius: float, strength: float, hardness: float) -> void:
	_radius.value = radius
	_strength.value = strength * 100.0
	_hardness.value = hardness * 100.0


func input(camera: Camera3D, event: InputEvent) -> int:
	if event is InputEventKey:
		return _on_key(event as InputEventKey)
	if not event is InputEventMouse:
		return NOT_MINE
	var mouse := event as InputEventMouse
	_cursor.aim(camera, mouse.position, ground())
	redraw_requested.emit()
	var at := _cursor.on_ground
	if mouse is InputEventMouseMotion:
		if not brush.is_painting():
			return NOT_MINE
		if at.is_finite():
			brush.move(Vector2(at.x, at.z))
		return MINE
	var pressed := mouse as InputEventMouseButton
	if pressed == null or pressed.button_index != MOUSE_BUTTON_LEFT or pressed.alt_pressed:
		return NOT_MINE
	# The tool always takes the left button, because the editor's box selection would deselect the scatter.
	if not pressed.pressed:
		finish()
	else:
		problem = _begin_stroke(at, pressed)
	return MINE


func draw_over(overlay: Control) -> void:
	if not _cursor.is_over(overlay):
		return
	if not problem.is_empty():
		_cursor.say(overlay, problem)
	if not _cursor.on_ground.is_finite() or ground() == null:
		return
	var color := COLORS[brush.mode]
	_cursor.draw_ring(overlay, ground(), brush.radius, color, 2.0)
	if brush.hardness > 0.0:
		_cursor.draw_ring(overlay, ground(), brush.radius * brush.hardness, Color(color, 0.45), 1.0)
	_cursor.draw_dot(overlay, color)


## Shows the mask of the chosen layer while the brush is on.
func look() -> void:
	var mask := layer.mask if is_on() and layer != null and ground() != null else null
	mask_overlay.watch(mask)
	if mask == null:
		mask_overlay.hide()
		return
	var camera := EditorInterface.get_editor_viewport_3d(0).get_camera_3d()
	var away := GroundRay.distance(ground(), camera.global_position, -camera.global_basis.z)
	mask_overlay.show(scatter, camera.global_position - camera.global_basis.z * away, away)


func finish() -> void:
	brush.finish(undo_redo)


func _on_toggled() -> void:
	problem = ""
	_cursor.clear()


func _on_mode(mode: ScatterMask.Mode) -> void:
	brush.mode = mode
	redraw_requested.emit()


func _on_key(key: InputEventKey) -> int:
	if not key.pressed or not (key.keycode == KEY_BRACKETLEFT or key.keycode == KEY_BRACKETRIGHT):
		return NOT_MINE
	_radius.value *= RADIUS_STEP if key.keycode == KEY_BRACKETRIGHT else 1.0 / RADIUS_STEP
	return MINE


## Begins a stroke at a position on the ground. Returns the reason if it cannot, as a sentence.
func _begin_stroke(at: Vector3, pressed: InputEventMouseButton) -> String:
	if ground() == null:
		return "There is no ground to paint on: set the ground of %s, or press Use as Ground." % scatter.name
	if layer == null:
		return "There is nothing to paint: add a layer to %s in the Scatter panel." % scatter.name
	if not lock_problem().is_empty():
		return lock_problem()
	if not at.is_finite():
		return "There is no ground below the brush: paint where the ground is."
	var mode := brush.mode
	if pressed.shift_pressed:
		mode = ScatterMask.MODE_SMOOTH
	elif pressed.ctrl_pressed:
		mode = ScatterMask.MODE_ERASE
	var on_map := Vector2(at.x, at.z)
	var everywhere := unlocked().filter(func(chosen: ScatterLayer) -> bool: return chosen.mask == null)
	if mode == ScatterMask.MODE_PAINT and not everywhere.is_empty():
		var names := PackedStringArray(everywhere.map(func(chosen: ScatterLayer) -> String: return chosen.resource_name))
		first_stroke.ask(names, everywhere.reduce(
				func(sum: int, chosen: ScatterLayer) -> int: return sum + scatter.get_shown_count(chosen), 0), on_map)
		return ""
	return brush.begin(scatter, unlocked(), SceneFiles.edited_scene_path(), mode, on_map)


## Paints a single dab for the user's choice in the dialog, and keeps its mode for the brush.
func _stroke_once(mode: ScatterMask.Mode, at: Vector2) -> void:
	if not is_instance_valid(scatter) or unlocked().is_empty():
		return
	choose_mode(mode)
	problem = brush.begin(scatter, unlocked(), SceneFiles.edited_scene_path(), mode, at)
	finish()
	redraw_requested.emit()


func _slider(label: String, tip: String, from: float, to: float, step: float, value: float,
		suffix: String) -> EditorSpinSlider:
	var slider := Controls.slider(label, tip, Vector3(from, to, step), value, suffix, 138.0)
	add_child(slider)
	return slider
