@tool
extends HFlowContainer
## A row above the 3D view that goes on in further lines where it is too long, as the editor's own row of menus does, instead of pushing the
## docks out of the window.

## Pixels of an unscaled editor: as much as the row asks for before it wraps, less than the editor's own menus have.
const WIDTH := 600.0


func _init() -> void:
	size_flags_horizontal = SIZE_EXPAND_FILL


func _notification(what: int) -> void:
	match what:
		NOTIFICATION_SORT_CHILDREN:
			_ask_for_width.call_deferred()
		NOTIFICATION_VISIBILITY_CHANGED, NOTIFICATION_ENTER_TREE:
			_stretch(visible)
		NOTIFICATION_EXIT_TREE:
			_stretch(false)


## Asks for all of its length, unless that is much.
func _ask_for_width() -> void:
	var length := 0.0
	for child: Node in get_children():
		var control := child as Control
		if control != null and control.visible:
			length += control.get_combined_minimum_size().x + get_theme_constant(&"h_separation")
	custom_minimum_size.x = minf(ceilf(length), WIDTH * EditorInterface.get_editor_scale())


## Has the editor's panel around it fill its line, while the row is seen: what is left of the line is the room to wrap in.
func _stretch(wide: bool) -> void:
	var panel := get_parent() as Control
	while panel != null and not panel.get_parent() is FlowContainer:
		panel = panel.get_parent() as Control
	if panel != null:
		panel.size_flags_horizontal = SIZE_EXPAND_FILL if wide else SIZE_FILL
