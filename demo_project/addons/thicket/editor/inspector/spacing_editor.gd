@tool
extends EditorProperty
## An inspector editor for distances to other layers. It has a row for each layer with a distance and a menu for adding
## other layers.

const Names := preload("res://addons/thicket/editor/inspector/layer_names.gd")
## The initial distance to an added layer, in meters.
const FIRST_DISTANCE := 1.0

var _rows := VBoxContainer.new()
var _add := MenuButton.new()
var _addable_layers: Array = []
var _row_keys: Array = []
var _read_only := false


func _init() -> void:
	_add.text = "Add Layer"
	_add.flat = false
	_add.about_to_popup.connect(_list_addable_layers)
	_add.get_popup().index_pressed.connect(func(index: int) -> void: _set_distance(FIRST_DISTANCE, _addable_layers[index], false))
	add_child(_add)
	add_focusable(_add)
	add_child(_rows)
	set_bottom_editor(_rows)


func _set_read_only(read_only: bool) -> void:
	_read_only = read_only
	_add.disabled = read_only


func _update_property() -> void:
	var object := get_edited_object()
	var spacing: Dictionary = object.get(get_edited_property())
	# Existing rows are updated in place, because a slider that is being dragged must not be freed.
	if spacing.keys() == _row_keys and _rows.get_child_count() == spacing.size():
		for index in _row_keys.size():
			(_rows.get_child(index).get_child(0) as EditorSpinSlider).set_value_no_signal(spacing[_row_keys[index]])
		return
	_row_keys = spacing.keys()
	for row in _rows.get_children():
		_rows.remove_child(row)
		row.queue_free()
	for key: Variant in _row_keys:
		_rows.add_child(_make_row(key, Names.title(object, key), spacing[key]))


func _make_row(key: Variant, title: String, meters: float) -> Control:
	var slider := EditorSpinSlider.new()
	slider.label = title
	slider.suffix = "m"
	slider.min_value = 0.1
	slider.max_value = 100.0
	slider.step = 0.01
	slider.exp_edit = true
	slider.allow_greater = true
	slider.allow_lesser = true
	slider.value = meters
	slider.read_only = _read_only
	slider.size_flags_horizontal = SIZE_EXPAND_FILL
	slider.value_changed.connect(_set_distance.bind(key, true))
	slider.ungrabbed.connect(func() -> void: _set_distance(slider.value, key, false))
	var remove := Button.new()
	remove.icon = EditorInterface.get_editor_theme().get_icon(&"Remove", &"EditorIcons")
	remove.tooltip_text = "Remove the distance to this layer."
	remove.disabled = _read_only
	remove.pressed.connect(_remove.bind(key))
	var row := HBoxContainer.new()
	row.add_child(slider)
	row.add_child(remove)
	return row


func _list_addable_layers() -> void:
	var object := get_edited_object()
	var present_layers: Array = (object.get(get_edited_property()) as Dictionary).keys().map(
			func(key: Variant) -> ScatterLayer: return Names.layer_of(object, key))
	var popup := _add.get_popup()
	popup.clear()
	_addable_layers = []
	for layer in Names.others(object):
		if not layer in present_layers:
			popup.add_item(Names.title(object, layer))
			_addable_layers.append(Names.reference_to(layer))
	if _addable_layers.is_empty():
		popup.add_item("No other layer")
		popup.set_item_disabled(0, true)


func _set_distance(meters: float, key: Variant, is_changing: bool) -> void:
	var spacing: Dictionary = get_edited_object().get(get_edited_property())
	spacing = spacing.duplicate()
	spacing[key] = meters
	emit_changed(get_edited_property(), spacing, &"", is_changing)


func _remove(key: Variant) -> void:
	var spacing: Dictionary = get_edited_object().get(get_edited_property())
	spacing = spacing.duplicate()
	spacing.erase(key)
	emit_changed(get_edited_property(), spacing)
