@tool
extends "res://addons/thicket/editor/scatter_tool.gd"
## The base class of the brushes. It draws a ring on the ground and handles strokes with the left mouse button.

const Controls := preload("res://addons/thicket/editor/editor_controls.gd")
const GroundCursor := preload("res://addons/thicket/editor/ground/ground_cursor.gd")
const GroundRay := preload("res://addons/thicket/ground_ray.gd")
const PaintedOverlay := preload("res://addons/thicket/editor/brush/painted_overlay.gd")

const RADIUS_STEP := 1.15
const NO_GROUND_BELOW := "There is no ground below the brush: paint where the ground is."

## The reason why the last stroke failed; empty if it succeeded.
var problem := ""

var _cursor := GroundCursor.new()
var _radius: EditorSpinSlider


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
		if not _is_painting():
			return NOT_MINE
		if at.is_finite():
			_move_stroke(Vector2(at.x, at.z))
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
	_cursor.draw_ring(overlay, ground(), _radius.value, _color(), 2.0)
	_draw_inside(overlay)
	_cursor.draw_dot(overlay, _color())


## Draws additional shapes inside the ring. The individual brushes override it.
func _draw_inside(_overlay: Control) -> void:
	pass


## Returns the color of the ring.
func _color() -> Color:
	return Color.WHITE


func _is_painting() -> bool:
	return false


## Begins a stroke at a position on the ground, which is not finite if there is no ground. Returns an empty string on
## success, or the reason for a failure.
func _begin_stroke(_at: Vector3, _pressed: InputEventMouseButton) -> String:
	return ""


## Continues the stroke to world x and z.
func _move_stroke(_at: Vector2) -> void:
	pass


## Returns an error message if there is no ground to paint on. Otherwise, returns an empty string.
func _ground_problem() -> String:
	return "" if ground() != null else "There is no ground to paint on: set the ground of %s, or press Use as Ground." % scatter.name


func _on_toggled() -> void:
	problem = ""
	_cursor.clear()


func _on_key(key: InputEventKey) -> int:
	if not key.pressed or not (key.keycode == KEY_BRACKETLEFT or key.keycode == KEY_BRACKETRIGHT):
		return NOT_MINE
	_radius.value *= RADIUS_STEP if key.keycode == KEY_BRACKETRIGHT else 1.0 / RADIUS_STEP
	return MINE


func _add_radius(meters: float) -> void:
	_radius = _slider("Radius", "The radius of the brush in meters (keys [ and ]).", 0.25, 256.0, 0.25, meters, "m")
	_radius.exp_edit = true
	_radius.value_changed.connect(redraw_requested.emit.unbind(1))


## Shows the painted resource on the ground in the center of the view while the brush is on. Shows nothing if [param painted] is null.
func _show_painted(overlay: PaintedOverlay, painted: Resource) -> void:
	if not is_on() or ground() == null:
		painted = null
	overlay.watch(painted)
	if painted == null:
		overlay.hide()
		return
	var camera := EditorInterface.get_editor_viewport_3d(0).get_camera_3d()
	var away := GroundRay.distance(ground(), camera.global_position, -camera.global_basis.z)
	overlay.show(scatter, camera.global_position - camera.global_basis.z * away, away)


func _slider(label: String, tip: String, from: float, to: float, step: float, value: float,
		suffix: String) -> EditorSpinSlider:
	var slider := Controls.slider(label, tip, Vector3(from, to, step), value, suffix, 138.0)
	add_child(slider)
	return slider
