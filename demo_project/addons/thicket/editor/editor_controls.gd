@tool
extends RefCounted
## Creates controls for the toolbars of the editor.


## Creates a slider for a number. [param limits] are the minimum, the maximum and the step. [param width] is in pixels
## at an editor scale of 1.
static func slider(label: String, tip: String, limits: Vector3, value: float, suffix: String, width: float) -> EditorSpinSlider:
	var new_slider := EditorSpinSlider.new()
	new_slider.label = label
	new_slider.min_value = limits.x
	new_slider.max_value = limits.y
	new_slider.step = limits.z
	new_slider.value = value
	new_slider.suffix = suffix
	new_slider.tooltip_text = tip
	new_slider.custom_minimum_size.x = width * EditorInterface.get_editor_scale()
	return new_slider


## Creates a flat button with an editor icon, which [method update_icons] sets.
static func button(text: String, icon: StringName, tip: String) -> Button:
	var new_button := Button.new()
	new_button.text = text
	new_button.tooltip_text = tip
	new_button.theme_type_variation = &"FlatButton"
	new_button.set_meta(&"icon", icon)
	return new_button


## Sets the icons of the buttons in a control by their metadata [code]icon[/code]. The icons come from the editor's theme, so call this
## when the theme changes, which also happens when the control enters the tree.
static func update_icons(parent: Control) -> void:
	for icon_button: Button in parent.find_children("*", "Button", true, false):
		var icon: StringName = icon_button.get_meta(&"icon", &"")
		if icon and parent.has_theme_icon(icon, &"EditorIcons"):
			icon_button.icon = parent.get_theme_icon(icon, &"EditorIcons")
