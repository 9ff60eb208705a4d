@tool
extends ConfirmationDialog
## The dialog for importing hand-placed instances, in which the user chooses a node of the scene or a table, and the layer. It shows the
## number of instances before the import.

const ImportAction := preload("res://addons/thicket/editor/import/import_action.gd")
const ImportInstances := preload("res://addons/thicket/import_instances.gd")
const SceneFiles := preload("res://addons/thicket/editor/scene_files.gd")

## The choice that imports each mesh into its own layer.
const BY_MESH := -1

## The number of instances that the last import placed.
var imported := 0
## The manager of the files, next to scenes, in which states are stored.
var files: SceneFiles
var undo_redo: EditorUndoRedoManager

var _scatter: TerrainScatter3D
var _reading: ImportInstances.Reading
var _form := GridContainer.new()
var _sources := OptionButton.new()
var _layers := OptionButton.new()
var _message := Label.new()
var _tables := EditorFileDialog.new()
var _nodes: Array[Node] = []
var _table := ""


func _init() -> void:
	title = "Import Instances"
	ok_button_text = "Import"
	dialog_hide_on_ok = false
	var rows := VBoxContainer.new()
	add_child(rows)
	_form.columns = 2
	rows.add_child(_form)
	_add_row("From", _sources)
	_sources.item_selected.connect(func(_index: int) -> void: _choose_source())
	_add_row("Layer", _layers)
	_layers.item_selected.connect(func(_index: int) -> void: _update_message())
	_message.autowrap_mode = TextServer.AUTOWRAP_WORD_SMART
	_message.custom_minimum_size = Vector2(420.0, 72.0)
	rows.add_child(_message)
	_tables.file_mode = EditorFileDialog.FILE_MODE_OPEN_FILE
	_tables.access = EditorFileDialog.ACCESS_FILESYSTEM
	_tables.add_filter("*.csv, *.tsv, *.txt", "Tables of transforms")
	_tables.file_selected.connect(choose_table)
	add_child(_tables)
	confirmed.connect(start)


## Opens the dialog for a scatter and offers the nodes of the scene.
func open(scatter: TerrainScatter3D, scene: Node) -> void:
	fill(scatter, scene)
	popup_centered()


## Fills the form, as [method open] does.
func fill(scatter: TerrainScatter3D, scene: Node) -> void:
	_scatter = scatter
	_table = ""
	_nodes.clear()
	_sources.clear()
	if scene != null:
		_list(scene, scene)
	_sources.add_separator()
	_sources.add_item("Table (CSV)...", _nodes.size())
	_layers.clear()
	_layers.add_item("Layer with the same mesh (created if missing)", 0)
	_layers.set_item_metadata(0, BY_MESH)
	var layers := scatter.layers
	for index in layers.size():
		if layers[index] != null:
			_layers.add_item(layers[index].resource_name if layers[index].resource_name else "Layer %d" % index)
			_layers.set_item_metadata(-1, index)
	_sources.select(0 if not _nodes.is_empty() else -1)
	_choose_source()


## Selects the node that [method start] imports.
func choose_node(node: Node) -> void:
	_sources.select(_nodes.find(node))
	_choose_source()


## Selects the table that [method start] imports.
func choose_table(path: String) -> void:
	_table = path
	var index := _sources.item_count - 1
	_sources.set_item_text(index, path.get_file())
	_sources.select(index)
	_read(ImportInstances.read_csv(path))


## Selects the layer for [method start] by its index, or BY_MESH.
func choose_layer(layer_index: int) -> void:
	for item in _layers.item_count:
		if _layers.get_item_metadata(item) == layer_index:
			_layers.select(item)
	_update_message()


## Returns the text that the dialog shows about the import.
func message() -> String:
	return _message.text


## Imports with the settings of the form.
func start() -> void:
	imported = 0
	if not is_instance_valid(_scatter) or get_ok_button().disabled:
		return
	var action := ImportAction.new()
	imported = action.run(_scatter, _layer(), _reading, files, SceneFiles.edited_scene_path(), undo_redo)
	if imported == 0:
		_message.text = action.problem
		return
	hide()


func _add_row(text: String, control: Control) -> void:
	var label := Label.new()
	label.text = text
	_form.add_child(label)
	control.size_flags_horizontal = Control.SIZE_EXPAND_FILL
	_form.add_child(control)


## Lists the nodes that can be imported, without their descendants.
func _list(node: Node, scene: Node) -> void:
	if node is MultiMeshInstance3D or node.has_node(NodePath(ImportInstances.PROTON_OUTPUT)) or ImportInstances.is_terrain_3d(node):
		_sources.add_item(String(scene.get_path_to(node)) if node != scene else String(node.name), _nodes.size())
		_nodes.append(node)
		return
	for child in node.get_children():
		_list(child, scene)


func _layer() -> Variant:
	var layer: int = _layers.get_selected_metadata()
	return null if layer == BY_MESH else _scatter.layers[layer]


func _choose_source() -> void:
	var id := _sources.get_selected_id() if _sources.selected >= 0 else -1
	if id >= 0 and id < _nodes.size() and is_instance_valid(_nodes[id]):
		_read(ImportInstances.read_node(_nodes[id]))
	elif id == _nodes.size() and id >= 0 and _sources.selected == _sources.item_count - 1:
		_read(ImportInstances.Reading.new())
		if visible:
			_tables.popup_file_dialog()
	else:
		_read(ImportInstances.Reading.new())


func _read(reading: ImportInstances.Reading) -> void:
	_reading = reading
	_update_message()


## Shows the instances that will be imported, or the reason why they cannot be.
func _update_message() -> void:
	var problems := _reading.problems.duplicate()
	var has_table := _reading.batches.any(func(batch: ImportInstances.Batch) -> bool: return batch.mesh == null)
	if has_table and _layer() == null:
		problems.append("A table does not name meshes: choose the layer for its instances.")
	get_ok_button().disabled = _reading.size() == 0 or not problems.is_empty()
	if not problems.is_empty():
		_message.text = "\n".join(problems)
	elif _reading.size() == 0:
		_message.text = "Choose a node or a table to import."
	else:
		var batch_texts := PackedStringArray()
		for batch: ImportInstances.Batch in _reading.batches.slice(0, 5):
			batch_texts.append("%d %s" % [batch.size(), batch.name])
		var remainder := "" if _reading.batches.size() <= 5 else " and %d more" % (_reading.batches.size() - 5)
		_message.text = "%d instances: %s%s. The source is not changed; hide it after the import." % [
			_reading.size(), ", ".join(batch_texts), remainder]
