@tool
extends EditorProperty
## An inspector editor for a property that refers to any number of layers, with a check box for each layer.

const Names := preload("res://addons/thicket/editor/inspector/layer_names.gd")

var _boxes := VBoxContainer.new()
var _summary := Label.new()
var _read_only := false
var _empty_text: String
var _only_earlier: bool


## [param empty_text] is the text to display if no layer is checked. If [param only_earlier] is true, only layers that come before the edited layer are
## listed.
func _init(empty_text: String, only_earlier := false) -> void:
	_empty_text = empty_text
	_only_earlier = only_earlier
	_summary.clip_text = true
	add_child(_summary)
	add_child(_boxes)
	set_bottom_editor(_boxes)


func _set_read_only(read_only: bool) -> void:
	_read_only = read_only


func _update_property() -> void:
	var object := get_edited_object()
	var values: Array = object.get(get_edited_property())
	for box in _boxes.get_children():
		_boxes.remove_child(box)
		box.queue_free()
	var referenced := values.map(func(value: Variant) -> ScatterLayer: return Names.layer_of(object, value))
	var titles := PackedStringArray()
	for layer in Names.others(object, _only_earlier):
		_add_box(Names.title(object, layer), layer in referenced, _toggle.bind(layer))
	for index in values.size():
		titles.append(Names.title(object, values[index]))
		if referenced[index] == null:
			_add_box(titles[index], true, _remove.bind(values[index]))
	_summary.text = ", ".join(titles) if values else _empty_text


func _add_box(title: String, is_ticked: bool, on_toggled: Callable) -> void:
	var box := CheckBox.new()
	box.text = title
	box.button_pressed = is_ticked
	box.disabled = _read_only
	box.clip_text = true
	box.toggled.connect(on_toggled)
	_boxes.add_child(box)


func _toggle(is_ticked: bool, layer: ScatterLayer) -> void:
	var object := get_edited_object()
	var values: Array = object.get(get_edited_property())
	values = values.filter(func(value: Variant) -> bool: return Names.layer_of(object, value) != layer)
	if is_ticked:
		values.append(Names.reference_to(layer))
	emit_changed(get_edited_property(), values)


func _remove(_is_ticked: bool, value: Variant) -> void:
	var values: Array = get_edited_object().get(get_edited_property())
	values = values.duplicate()
	values.erase(value)
	emit_changed(get_edited_property(), values)
