@tool
extends "res://addons/thicket/editor/ground/ground_tool.gd"
## The tool with which the user drags a rectangle of x and z on the ground with the left mouse button.

const EditorSnap := preload("res://addons/thicket/editor/editor_snap.gd")

## Emitted when drawing has ended. [param rect] is in meters. It is empty if drawing was canceled.
signal drawn(rect: Rect2)

const HINT := "Drag from corner to corner   Esc cancels"
const COLOR := Color(0.55, 0.85, 1.0)

var _start := Vector3.INF


func _init() -> void:
	needs_layer = false
	_setup("Rectangle", &"", "")
	# Only the bake dialog turns the tool on.
	button.visible = false


func _on_key(key: InputEventKey) -> int:
	if not key.pressed or not key.keycode in [KEY_ESCAPE, KEY_DELETE]:
		return NOT_MINE
	if key.keycode == KEY_ESCAPE:
		_end(Rect2())
	_take_key()
	return MINE


func _on_motion(_motion: InputEventMouseMotion) -> int:
	return MINE if _start.is_finite() else NOT_MINE


func _on_button(click: InputEventMouseButton) -> void:
	problem = _position_problem()
	if click.pressed:
		_start = _cursor.on_ground if problem.is_empty() else Vector3.INF
	elif _start.is_finite() and problem.is_empty() and _rect().has_area():
		_end(_rect())
	else:
		_start = Vector3.INF


func _draw_view(overlay: Control) -> void:
	_cursor.draw_hint(overlay, HINT)
	if not _start.is_finite() or not _position_problem().is_empty():
		return
	var rect := _rect()
	var corners: Array[Vector2] = [
		rect.position, Vector2(rect.end.x, rect.position.y), rect.end, Vector2(rect.position.x, rect.end.y), rect.position,
	]
	for side in 4:
		var start := Vector3(corners[side].x, _start.y, corners[side].y)
		var end := Vector3(corners[side + 1].x, _start.y, corners[side + 1].y)
		_cursor.draw_path(overlay, _cursor.along_ground(start, end, true), COLOR, 2.0)


func finish() -> void:
	_start = Vector3.INF


## Returns the reason why a corner cannot be below the mouse; empty if it can.
func _position_problem() -> String:
	if ground() == null:
		return _ground_problem("draw on")
	if not _cursor.on_ground.is_finite():
		return NO_GROUND_BELOW
	return SurfacePlace.map_problem(scatter, _cursor.on_ground, "The rectangle is projected along the y axis and can be drawn", "Draw it there.")


func _end(rect: Rect2) -> void:
	finish()
	set_on(false)
	drawn.emit(rect)


## Returns the rectangle, snapped to whole meters, or to the editor's snap step if snapping is on.
func _rect() -> Rect2:
	var step := maxf(0.01, EditorSnap.meters()) if EditorSnap.is_on() else 1.0
	var start := Vector2(_start.x, _start.z).snapped(Vector2(step, step))
	var end := Vector2(_cursor.on_ground.x, _cursor.on_ground.z).snapped(Vector2(step, step))
	return Rect2(start, end - start).abs()
