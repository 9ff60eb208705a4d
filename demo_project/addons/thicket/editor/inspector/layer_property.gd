@tool
extends EditorProperty
## An inspector editor for a property that refers to one layer or none.

const Names := preload("res://addons/thicket/editor/inspector/layer_names.gd")

var _button := OptionButton.new()
var _values: Array = []


func _init() -> void:
	_button.clip_text = true
	_button.item_selected.connect(_on_selected)
	# Layers may be added and removed while the inspector is open.
	_button.pressed.connect(_update_property)
	add_child(_button)
	add_focusable(_button)


func _set_read_only(read_only: bool) -> void:
	_button.disabled = read_only


func _update_property() -> void:
	var object := get_edited_object()
	var value: Variant = object.get(get_edited_property())
	_button.clear()
	_button.add_item("None")
	_values = [""]
	var selected_index := 0
	for layer in Names.others(object, true):
		if value and Names.layer_of(object, value) == layer:
			selected_index = _values.size()
		_add(Names.reference_to(layer), Names.title(object, layer))
	if value and selected_index == 0:
		selected_index = _values.size()
		_add(value, Names.title(object, value))
	_button.select(selected_index)


func _add(value: Variant, title: String) -> void:
	_button.add_item(title)
	_values.append(value)


func _on_selected(index: int) -> void:
	emit_changed(get_edited_property(), _values[index])
