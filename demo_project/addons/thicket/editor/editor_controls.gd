@tool
extends RefCounted
## Controls as the rows of the editor have them.


## A number to drag: the smallest, the largest and the step of it, with a width in pixels of an unscaled editor.
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


## A flat button with an icon of the editor, which [method update_icons] gives it.
static func button(text: String, icon: StringName, tip: String) -> Button:
	var made := Button.new()
	made.text = text
	made.tooltip_text = tip
	made.theme_type_variation = &"FlatButton"
	made.set_meta(&"icon", icon)
	return made


## Gives the buttons in a control the icons that their meta [code]icon[/code] names. Icons come from the editor's theme, so this is to be
## called when the theme changes, as it does once the control is in the tree.
static func update_icons(parent: Control) -> void:
	for found: Button in parent.find_children("*", "Button", true, false):
		var icon: StringName = found.get_meta(&"icon", &"")
		if icon and parent.has_theme_icon(icon, &"EditorIcons"):
			found.icon = parent.get_theme_icon(icon, &"EditorIcons")
