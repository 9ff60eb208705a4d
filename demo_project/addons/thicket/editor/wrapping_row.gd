@tool
extends HFlowContainer
## A row above the 3D view that wraps into several lines if it is too long, like the editor's row of menus. A single
## long line would push the docks out of the window.

## The largest minimum width of the row, in pixels at an editor scale of 1. It is less than the width of the editor's menus.
const WIDTH := 600.0


func _init() -> void:
	size_flags_horizontal = SIZE_EXPAND_FILL


func _notification(what: int) -> void:
	match what:
		NOTIFICATION_SORT_CHILDREN:
			_request_width.call_deferred()
		NOTIFICATION_VISIBILITY_CHANGED, NOTIFICATION_ENTER_TREE:
			_stretch(visible)
		NOTIFICATION_EXIT_TREE:
			_stretch(false)


## Sets the minimum width to the full length of the row, up to [constant WIDTH].
func _request_width() -> void:
	var length := 0.0
	for child: Node in get_children():
		var control := child as Control
		if control != null and control.visible:
			length += control.get_combined_minimum_size().x + get_theme_constant(&"h_separation")
	custom_minimum_size.x = minf(ceilf(length), WIDTH * EditorInterface.get_editor_scale())


## Makes the editor's panel around the row fill its line while the row is visible. The row can then use the whole line before it wraps.
func _stretch(wide: bool) -> void:
	var panel := get_parent() as Control
	while panel != null and not panel.get_parent() is FlowContainer:
		panel = panel.get_parent() as Control
	if panel != null:
		panel.size_flags_horizontal = SIZE_EXPAND_FILL if wide else SIZE_FILL
