@tool
extends HBoxContainer
## What stands above the 3D view while a scatter is selected: the brush and its settings, presets, bake.

const Brush := preload("res://addons/thicket/editor/brush.gd")
const Presets := preload("res://addons/thicket/editor/presets.gd")

signal preset_chosen(name: String)
signal bake_requested
## The brush was switched on or off, or one of its settings has changed.
signal brush_changed

const MODE_TIPS: PackedStringArray = [
	"Paint: more of the layer. The first stroke on a layer that stands everywhere asks what you mean.",
	"Erase: less of the layer (or hold Ctrl).",
	"Smooth: even out what is painted (or hold Shift).",
]

var brush := Brush.new()

var _on: Button
var _layers: OptionButton
var _modes: Array[Button] = []
var _radius: EditorSpinSlider
var _strength: EditorSpinSlider
var _hardness: EditorSpinSlider
var _settings: Array[Control] = []


func _init() -> void:
	_on = _button("", "Paint", "Brush: paint where the layer stands, with the left button.")
	_on.toggle_mode = true
	_on.toggled.connect(_on_toggled)
	_layers = OptionButton.new()
	_layers.tooltip_text = "The layer to paint."
	_layers.item_selected.connect(func(_index: int) -> void: brush_changed.emit())
	_add_setting(_layers)
	var group := ButtonGroup.new()
	for mode in MODE_TIPS.size():
		var button := Button.new()
		button.text = ["Paint", "Erase", "Smooth"][mode]
		button.theme_type_variation = &"FlatButton"
		button.tooltip_text = MODE_TIPS[mode]
		button.toggle_mode = true
		button.button_group = group
		button.button_pressed = mode == brush.mode
		button.pressed.connect(_on_mode.bind(mode))
		_modes.append(button)
		_add_setting(button)
	_radius = _slider("Radius", "Radius of the brush (keys [ and ]).", 0.25, 256.0, 0.25, brush.radius, "m")
	_radius.exp_edit = true
	_radius.value_changed.connect(func(value: float) -> void: brush.radius = value; brush_changed.emit())
	_strength = _slider("Strength", "How far one dab goes in its middle.", 1.0, 100.0, 1.0, brush.strength * 100.0, "%")
	_strength.value_changed.connect(func(value: float) -> void: brush.strength = value * 0.01)
	_hardness = _slider("Hardness", "The part of the radius that is painted in full.", 0.0, 100.0, 1.0,
			brush.hardness * 100.0, "%")
	_hardness.value_changed.connect(func(value: float) -> void: brush.hardness = value * 0.01; brush_changed.emit())
	add_child(VSeparator.new())
	_add_presets()
	var bake := _button("Bake", "Bake", "Write what stands in a rectangle as MultiMesh resources and a scene.")
	bake.pressed.connect(func() -> void: bake_requested.emit())
	_on_toggled(false)


## Shows the layers of a scatter; null for none. The chosen index stays if the list has it.
func show_layers(scatter: Node3D) -> void:
	var chosen := layer_index()
	_layers.clear()
	var layers: Array = scatter.get(&"layers") if scatter != null else []
	for index in layers.size():
		var layer: Resource = layers[index]
		if layer != null:
			_layers.add_item(layer.resource_name if layer.resource_name else "Layer %d" % index, index)
	var again := _layers.get_item_index(chosen)
	if again >= 0:
		_layers.select(again)


## The index of the layer to paint in the scatter's list; -1 for none.
func layer_index() -> int:
	return _layers.get_selected_id() if _layers.selected >= 0 else -1


## Whether the left button paints.
func is_brush_on() -> bool:
	return _on.button_pressed


## Switches the brush on or off.
func set_brush_on(on: bool) -> void:
	_on.button_pressed = on


## Chooses the layer at an index in the scatter's list, if it is there.
func choose_layer(index: int) -> void:
	_layers.select(_layers.get_item_index(index))
	brush_changed.emit()


## Chooses what the left button does.
func choose_mode(mode: int) -> void:
	_modes[mode].button_pressed = true
	_on_mode(mode)


## Sets the brush: meters, and two parts from 0 to 1.
func set_brush(radius: float, strength: float, hardness: float) -> void:
	_radius.value = radius
	_strength.value = strength * 100.0
	_hardness.value = hardness * 100.0


## Makes the brush larger or smaller by a factor.
func scale_radius(factor: float) -> void:
	_radius.value = _radius.value * factor


func _notification(what: int) -> void:
	# Icons come from the editor's theme, which is there once the toolbar is in the tree.
	if what == NOTIFICATION_THEME_CHANGED:
		for button: Button in find_children("*", "Button", true, false):
			var icon: StringName = button.get_meta(&"icon", &"")
			if icon and has_theme_icon(icon, &"EditorIcons"):
				button.icon = get_theme_icon(icon, &"EditorIcons")


func _button(text: String, icon: StringName, tip: String) -> Button:
	var button := Button.new()
	button.text = text
	button.tooltip_text = tip
	button.theme_type_variation = &"FlatButton"
	button.set_meta(&"icon", icon)
	add_child(button)
	return button


func _slider(label: String, tip: String, from: float, to: float, step: float, value: float,
		suffix: String) -> EditorSpinSlider:
	var slider := EditorSpinSlider.new()
	slider.label = label
	slider.min_value = from
	slider.max_value = to
	slider.step = step
	slider.value = value
	slider.suffix = suffix
	slider.tooltip_text = tip
	slider.custom_minimum_size.x = 138.0 * EditorInterface.get_editor_scale()
	_add_setting(slider)
	return slider


func _add_setting(control: Control) -> void:
	add_child(control)
	_settings.append(control)


func _add_presets() -> void:
	var menu := MenuButton.new()
	menu.text = "Presets"
	menu.set_meta(&"icon", &"Add")
	menu.tooltip_text = "Add layers to start from."
	for name in Presets.NAMES:
		menu.get_popup().add_item("Add " + name.capitalize())
	menu.get_popup().index_pressed.connect(func(index: int) -> void: preset_chosen.emit(Presets.NAMES[index]))
	add_child(menu)


func _on_toggled(on: bool) -> void:
	for control in _settings:
		control.visible = on
	brush_changed.emit()


func _on_mode(mode: int) -> void:
	brush.mode = mode as Brush.Mode
	brush_changed.emit()
