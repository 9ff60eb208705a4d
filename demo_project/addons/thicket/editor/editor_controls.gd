@tool
extends RefCounted
## Creates controls for the toolbars of the editor.


## Creates a slider for a number. [param limits] are the minimum, the maximum and the step. [param width] is in pixels
## at an editor scale of 1.
static func slider(label: String, tip: String, limits: Vector3, value: float, suffix: String, width: float) -> EditorSpinSlider:
	var made := EditorSpinSlider.new()
	made.label = label
	made.min_value = limits.x
	made.max_value = limits.y
	made.step = limits.z
	made.value = value
	made.suffix = suffix
	made.tooltip_text = tip
	made.custom_minimum_size.x = width * EditorInterface.get_editor_scale()
	return made


## Creates a flat button with an editor icon, which [method update_icons] sets.
static func button(text: String, icon: StringName, tip: String) -> Button:
	var made := Button.new()
	made.text = text
	made.tooltip_text = tip
	made.theme_type_variation = &"FlatButton"
	made.set_meta(&"icon", icon)
	return made


## Sets the icons of the buttons in a control by their metadata [code]icon[/code]. The icons come from the editor's theme, so call this
## when the theme changes, which also happens when the control enters the tree.
static func update_icons(parent: Control) -> void:
	for found: Button in parent.find_children("*", "Button", true, false):
		var icon: StringName = found.get_meta(&"icon", &"")
		if icon and parent.has_theme_icon(icon, &"EditorIcons"):
			found.icon = parent.get_theme_icon(icon, &"EditorIcons")
