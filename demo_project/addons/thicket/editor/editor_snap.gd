@tool
extends RefCounted
## Reads the snap settings of the editor's 3D view, which scripts can access since Godot 4.6. In earlier versions, Ctrl snaps with the editor's default
## settings.


## Returns true if the editor currently snaps: either its snap button is on or Ctrl is held, but not both.
static func is_on() -> bool:
	if EditorInterface.has_method(&"is_node_3d_snap_enabled"):
		return EditorInterface.call(&"is_node_3d_snap_enabled")
	return Input.is_key_pressed(KEY_CTRL)


## Returns the snap step in meters.
static func meters() -> float:
	if EditorInterface.has_method(&"get_node_3d_translate_snap"):
		return EditorInterface.call(&"get_node_3d_translate_snap")
	return 0.1 if Input.is_key_pressed(KEY_SHIFT) else 1.0
