@tool
extends "res://addons/thicket/editor/ground/ground_tool.gd"
## The base class of the brushes. It draws a ring on the ground and handles strokes with the left mouse button.

const Controls := preload("res://addons/thicket/editor/editor_controls.gd")
const PaintedOverlay := preload("res://addons/thicket/editor/brush/painted_overlay.gd")

const RADIUS_STEP := 1.15
const HINT_LEVELS := "Painting applies to everything above and below this position"
const HINT_PLANET := "Layers without On Surfaces: painting also applies to the opposite side of the planet"

var _radius: EditorSpinSlider


func _on_motion(_motion: InputEventMouseMotion) -> int:
	if not _is_painting():
		return NOT_MINE
	var point := _cursor.on_ground
	if point.is_finite() and _map_problem().is_empty():
		_move_stroke(point)
	return MINE


func _on_button(click: InputEventMouseButton) -> void:
	if not click.pressed:
		finish()
	else:
		problem = _begin_stroke(_cursor.on_ground, click)


func _draw_view(overlay: Control) -> void:
	if not _position_problem(_cursor.on_ground).is_empty():
		return
	if SurfacePlace.is_planet(scatter):
		if not _covers_planet():
			_cursor.draw_hint(overlay, HINT_PLANET)
	elif _cursor.is_among_levels():
		_cursor.draw_hint(overlay, HINT_LEVELS)
	_cursor.draw_ring(overlay, _radius.value, _color(), 2.0)
	_draw_inside(overlay)
	_cursor.draw_dot(overlay, _color())


func _message() -> String:
	var position_problem := _position_problem(_cursor.on_ground) if _cursor.on_ground.is_finite() else ""
	return problem if position_problem.is_empty() else position_problem


## Draws additional shapes inside the ring. The individual brushes override it.
func _draw_inside(_overlay: Control) -> void:
	pass


## Returns the color of the ring.
func _color() -> Color:
	return Color.WHITE


func _is_painting() -> bool:
	return false


## Begins a stroke at a point on the ground. The point is not finite if there is no ground below the cursor. Returns
## an empty string on success, or the reason for a failure.
func _begin_stroke(_point: Vector3, _click: InputEventMouseButton) -> String:
	return ""


## Continues the stroke to a position on the ground.
func _move_stroke(_point: Vector3) -> void:
	pass


## Returns the reason why a stroke cannot begin at a position; empty if it can.
func _position_problem(point: Vector3) -> String:
	if ground() == null:
		return _ground_problem("paint on")
	return NO_GROUND_BELOW if not point.is_finite() else _map_problem()


## Returns true if the painted maps cover the planet, and false if they are projected along the y axis or there is no planet.
func _covers_planet() -> bool:
	return SurfacePlace.is_planet(scatter)


## Returns the reason why a map cannot be painted below the mouse; empty if it can.
func _map_problem() -> String:
	if _covers_planet():
		return ""
	return SurfacePlace.map_problem(scatter, _cursor.on_ground, "Masks of layers without On Surfaces are projected along the y axis and can be painted", "Turn on On Surfaces of these layers.")


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
	var distance := SurfacePlace.distance(scatter, camera.global_position, -camera.global_basis.z)
	var center := camera.global_position - camera.global_basis.z * distance
	if _covers_planet() or SurfacePlace.map_problem(scatter, center, "", "").is_empty():
		overlay.show(scatter, center, distance)
	else:
		overlay.hide()


func _slider(label: String, tip: String, minimum: float, maximum: float, step: float, value: float,
		suffix: String) -> EditorSpinSlider:
	var slider := Controls.slider(label, tip, Vector3(minimum, maximum, step), value, suffix, 138.0)
	add_child(slider)
	return slider
