@tool
extends RefCounted
## What the editor's 3D view snaps to. The engine tells scripts since 4.6; before, Ctrl snaps to what the editor has at first.


## Whether the editor snaps now: its button is on, or, but not both, Ctrl is held.
static func is_on() -> bool:
	if EditorInterface.has_method(&"is_node_3d_snap_enabled"):
		return EditorInterface.call(&"is_node_3d_snap_enabled")
	return Input.is_key_pressed(KEY_CTRL)


## Meters from one place to the next.
static func meters() -> float:
	if EditorInterface.has_method(&"get_node_3d_translate_snap"):
		return EditorInterface.call(&"get_node_3d_translate_snap")
	return 0.1 if Input.is_key_pressed(KEY_SHIFT) else 1.0
