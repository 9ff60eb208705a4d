@tool
extends Tree
## Shows the layers of a scatter as rows with a thumbnail, the name, the number of visible instances, and marks. User
## actions only emit signals, which other objects handle.

const Copies := preload("res://addons/thicket/editor/layers/layer_copies.gd")
const Marks := preload("res://addons/thicket/editor/layers/layer_marks.gd")
const MeshDrop := preload("res://addons/thicket/editor/layers/mesh_drop.gd")

## Emitted when the user has selected rows. The layer that was clicked last comes first, if it is selected.
signal layers_chosen(layers: Array[ScatterLayer])
signal layer_renamed(layer: ScatterLayer, name: String)
## Emitted when layers were dragged in front of the layer at the index [param to], or to the end if there is no such layer.
signal layers_moved(layers: Array[ScatterLayer], to: int)
## Emitted when meshes, scenes, models or layers were dropped. [param to] is the index at which to insert them, or -1 if they were not dropped on a row
## of the scatter's own list.
signal resources_dropped(resources: Array[Resource], to: int)
## Emitted when the user has clicked a mark of a layer. [param mark] is one of the constants in [code]layer_marks.gd[/code].
signal mark_pressed(layer: ScatterLayer, mark: StringName)

enum Column { NAME, COUNT, MARKS }
const MARKS: Array[StringName] = [Marks.COLOR, Marks.LOCKED, Marks.HIDDEN]
const DRAGGED := "scatter_layers"
## Sizes in pixels at an editor scale of 1.
const PICTURE := 26.0
const COUNT_WIDTH := 170.0
const MARKS_WIDTH := 100.0

var marks: Marks

var _layers: Array[ScatterLayer] = []
var _pictures: Dictionary[int, Texture2D] = {} ## The thumbnails of layers, by the layer's instance ID.
var _is_selecting := false
var _is_emitting := false
var _clicked_layer: ScatterLayer


func _init() -> void:
	columns = 3
	hide_root = true
	select_mode = SELECT_MULTI
	allow_rmb_select = true
	allow_reselect = true
	column_titles_visible = true
	var scale := EditorInterface.get_editor_scale()
	var titles: PackedStringArray = ["Layer", "Visible", ""]
	for column in columns:
		set_column_title(column, titles[column])
		set_column_expand(column, column == Column.NAME)
	set_column_title_alignment(Column.NAME, HORIZONTAL_ALIGNMENT_LEFT)
	set_column_title_alignment(Column.COUNT, HORIZONTAL_ALIGNMENT_RIGHT)
	set_column_custom_minimum_width(Column.COUNT, roundi(COUNT_WIDTH * scale))
	set_column_custom_minimum_width(Column.MARKS, roundi(MARKS_WIDTH * scale))
	multi_selected.connect(_on_multi_selected)
	item_edited.connect(_on_edited)
	button_clicked.connect(_on_button)


## Shows the layers of a scatter. Layers of a biome are below the name of the biome. Layers that were shown before keep their thumbnails, and
## selected layers stay selected.
func show_layers(layers: Array[ScatterLayer], biomes: PackedStringArray) -> void:
	var selection := chosen_layers()
	_layers = layers.duplicate()
	_is_selecting = true
	clear()
	var root := create_item()
	var headings: Dictionary[String, TreeItem] = {"": root}
	for index in _layers.size():
		if _layers[index] != null:
			if not headings.has(biomes[index]):
				headings[biomes[index]] = _add_heading(root, biomes[index])
			_add_row(headings[biomes[index]], _layers[index])
	_is_selecting = false
	choose(selection)


func choose(layers: Array[ScatterLayer]) -> void:
	_is_selecting = true
	deselect_all()
	for row in rows():
		if layer_of(row) in layers:
			row.select(Column.NAME)
	_is_selecting = false


func chosen_layers() -> Array[ScatterLayer]:
	var result: Array[ScatterLayer] = []
	for row in rows():
		if row.is_selected(Column.NAME):
			result.append(layer_of(row))
	return result


func rows() -> Array[TreeItem]:
	var result: Array[TreeItem] = []
	if get_root() != null:
		for row in get_root().get_children():
			if row.get_metadata(Column.NAME) != null:
				result.append(row)
			result.append_array(row.get_children()) # The children of a heading are the layers of a biome.
	return result


func row_of(layer: ScatterLayer) -> TreeItem:
	for row in rows():
		if layer_of(row) == layer:
			return row
	return null


func layer_of(row: TreeItem) -> ScatterLayer:
	return row.get_metadata(Column.NAME)


## Sets the text for the number of instances in a layer's row, and a note. The note is shown as an icon with a tooltip, unless it is empty.
func show_count(layer: ScatterLayer, text: String, note: String) -> void:
	var row := row_of(layer)
	if row == null:
		return
	if row.get_text(Column.COUNT) != text:
		row.set_text(Column.COUNT, text)
	if row.get_tooltip_text(Column.COUNT) != note:
		row.set_tooltip_text(Column.COUNT, note)
		row.set_icon(Column.COUNT, get_theme_icon(&"NodeWarning", &"EditorIcons") if note else null)


## Updates the marks of all rows.
func update_marks() -> void:
	for row in rows():
		_show_marks(row)


## Starts editing the name of a layer.
func rename(layer: ScatterLayer) -> void:
	var row := row_of(layer)
	if row != null:
		row.select(Column.NAME)
		scroll_to_item(row)
		set_selected(row, Column.NAME)
		edit_selected(true)


func set_picture(layer: ScatterLayer, picture: Texture2D) -> void:
	_pictures[layer.get_instance_id()] = picture
	var row := row_of(layer)
	if row != null:
		row.set_icon(Column.NAME, picture)


func has_picture(layer: ScatterLayer) -> bool:
	return _pictures.has(layer.get_instance_id())


## Adds the name of a biome as a heading for the rows of its layers.
func _add_heading(root: TreeItem, title: String) -> TreeItem:
	var heading := create_item(root)
	heading.set_text(Column.NAME, title)
	heading.set_tooltip_text(Column.NAME, "Layers of a biome. Add and remove them in the biome itself.")
	for column in columns:
		heading.set_selectable(column, false)
		heading.set_custom_bg_color(column, get_theme_color(&"prop_subsection", &"Editor"))
	return heading


func _add_row(parent: TreeItem, layer: ScatterLayer) -> void:
	var row := create_item(parent)
	var title := layer.resource_name if layer.resource_name else "Layer %d" % _layers.find(layer)
	row.set_metadata(Column.NAME, layer)
	row.set_text(Column.NAME, title)
	row.set_tooltip_text(Column.NAME, title + (" (%s)" % layer.resource_path if Copies.is_file(layer) else ""))
	row.set_editable(Column.NAME, true)
	var icon_size := roundi(PICTURE * EditorInterface.get_editor_scale())
	row.set_icon_max_width(Column.NAME, icon_size)
	row.custom_minimum_height = icon_size # Without this, rows would move under the mouse when thumbnails arrive.
	row.set_icon(Column.NAME, _pictures.get(layer.get_instance_id(), get_theme_icon(&"MeshInstance3D", &"EditorIcons")))
	row.set_text_alignment(Column.COUNT, HORIZONTAL_ALIGNMENT_RIGHT)
	for column: int in [Column.COUNT, Column.MARKS]:
		row.set_selectable(column, false)
	for mark in MARKS:
		row.add_button(Column.MARKS, get_theme_icon(&"StatusWarning", &"EditorIcons"))
	_show_marks(row)


func _show_marks(row: TreeItem) -> void:
	var layer := layer_of(row)
	var color := marks.color(layer)
	var is_hidden := marks.is_hidden(layer)
	var is_locked := marks.is_locked(layer)
	row.set_button(Column.MARKS, 0, get_theme_icon(&"GuiGraphNodePort" if color.a > 0.0 else &"ColorPick", &"EditorIcons"))
	row.set_button_color(Column.MARKS, 0, color if color.a > 0.0 else Color(1.0, 1.0, 1.0, 0.5))
	row.set_button_tooltip_text(Column.MARKS, 0, "Mark with a color in the editor only.")
	row.set_button(Column.MARKS, 1, get_theme_icon(&"Lock" if is_locked else &"Unlock", &"EditorIcons"))
	row.set_button_color(Column.MARKS, 1, Color(1.0, 1.0, 1.0, 1.0 if is_locked else 0.5))
	row.set_button_tooltip_text(Column.MARKS, 1, "Locked: tools do not change the layer." if is_locked else "Lock: prevent tools from changing the layer.")
	row.set_button(Column.MARKS, 2, get_theme_icon(&"GuiVisibilityHidden" if is_hidden else &"GuiVisibilityVisible", &"EditorIcons"))
	row.set_button_tooltip_text(Column.MARKS, 2, "Hidden in the editor, but visible in the game." if is_hidden else "Hide in the editor only.")
	for column in columns:
		if color.a > 0.0:
			row.set_custom_bg_color(column, Color(color, 0.15))
		else:
			row.clear_custom_bg_color(column)
		row.set_custom_color(column, get_theme_color(&"font_color", &"Tree") * Color(1.0, 1.0, 1.0, 0.5 if is_hidden else 1.0))


func _notification(what: int) -> void:
	if what == NOTIFICATION_THEME_CHANGED and marks != null:
		update_marks()


func _on_multi_selected(row: TreeItem, _column: int, is_selected: bool) -> void:
	if _is_selecting:
		return
	if is_selected:
		_clicked_layer = layer_of(row)
	if not _is_emitting: # One click may select and deselect several rows, but the signal is emitted only once.
		_is_emitting = true
		_emit_selection.call_deferred()


func _emit_selection() -> void:
	_is_emitting = false
	var selection := chosen_layers()
	if selection.has(_clicked_layer):
		selection.erase(_clicked_layer)
		selection.push_front(_clicked_layer)
	layers_chosen.emit(selection)


func _on_edited() -> void:
	var row := get_edited()
	if row != null:
		layer_renamed.emit(layer_of(row), row.get_text(Column.NAME))


func _on_button(row: TreeItem, _column: int, id: int, _mouse_button: int) -> void:
	mark_pressed.emit(layer_of(row), MARKS[id])


func _get_drag_data(_point: Vector2) -> Variant:
	var dragged_layers: Array[ScatterLayer] = chosen_layers().filter(func(layer: ScatterLayer) -> bool: return _is_in_scatter_list(row_of(layer)))
	if dragged_layers.is_empty():
		return null
	var preview := Label.new()
	preview.text = ", ".join(Copies.names(dragged_layers))
	set_drag_preview(preview)
	return {"type": DRAGGED, "tree": self, "layers": dragged_layers}


func _can_drop_data(point: Vector2, data: Variant) -> bool:
	drop_mode_flags = DROP_MODE_INBETWEEN
	if data is Dictionary and (data as Dictionary).get("type") == DRAGGED:
		return data["tree"] == self and _insert_index_at(point) >= 0
	return MeshDrop.can_take(data, true)


func _drop_data(point: Vector2, data: Variant) -> void:
	var target_index := _insert_index_at(point)
	if (data as Dictionary).get("type") == DRAGGED:
		layers_moved.emit(data["layers"], target_index)
	else:
		resources_dropped.emit(MeshDrop.resources_in(data, true), target_index)


## Returns true for the row of a layer in the scatter's list, not in a biome.
func _is_in_scatter_list(row: TreeItem) -> bool:
	return row.get_parent() == get_root() and row.get_metadata(Column.NAME) != null


## Returns the index in the scatter's list at which to insert dropped layers, or -1 if the position is not on a row of that list.
func _insert_index_at(point: Vector2) -> int:
	var row := get_item_at_position(point)
	if row == null or not _is_in_scatter_list(row):
		return -1
	return _layers.find(layer_of(row)) + (1 if get_drop_section_at_position(point) > 0 else 0)
