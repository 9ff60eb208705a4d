@tool
extends "res://addons/thicket/editor/scatter_tool.gd"
## The base class of the tools that use the position on the ground below the mouse. It finds that position for each mouse event, and shows why an
## action failed.

const GroundCursor := preload("res://addons/thicket/editor/ground/ground_cursor.gd")
const SurfacePlace := preload("res://addons/thicket/editor/ground/surface_place.gd")

const NO_GROUND_BELOW := "There is no ground below the mouse: click where the ground is."

## The reason why the last action failed, as a sentence; empty if it succeeded.
var problem := ""

var _cursor := GroundCursor.new()


func input(camera: Camera3D, event: InputEvent) -> int:
	if event is InputEventKey:
		return _on_key(event as InputEventKey)
	if not event is InputEventMouse:
		return NOT_MINE
	var mouse := event as InputEventMouse
	_cursor.aim(camera, mouse.position, scatter)
	redraw_requested.emit()
	if mouse is InputEventMouseMotion:
		return _on_motion(mouse as InputEventMouseMotion)
	var click := mouse as InputEventMouseButton
	if click == null or click.button_index != MOUSE_BUTTON_LEFT or click.alt_pressed:
		return NOT_MINE
	# The tool always takes the left button, because the editor's box selection would deselect the scatter.
	_on_button(click)
	return MINE


func draw_over(overlay: Control) -> void:
	if not _cursor.is_over(overlay):
		return
	_draw_view(overlay)
	var message := _message()
	if not message.is_empty():
		_cursor.draw_message(overlay, message)


## Handles a key. Returns [constant MINE] or [constant NOT_MINE].
func _on_key(_key: InputEventKey) -> int:
	return NOT_MINE


## Handles a motion of the mouse. Returns [constant MINE] or [constant NOT_MINE].
func _on_motion(_motion: InputEventMouseMotion) -> int:
	return NOT_MINE


## Handles the left mouse button, pressed or released.
func _on_button(_click: InputEventMouseButton) -> void:
	pass


## Draws over the view in which the mouse is.
func _draw_view(_overlay: Control) -> void:
	pass


## Returns the message that is shown next to the mouse, or an empty string for none.
func _message() -> String:
	return problem


## Returns an error message if the scatter has no ground, otherwise an empty string. [param purpose] says what the ground is for.
func _ground_problem(purpose: String) -> String:
	return "" if ground() != null else "There is no ground to %s: set the ground of %s, or press Use as Ground." % [purpose, scatter.name]


func _on_toggled() -> void:
	problem = ""
	_cursor.clear()
