@tool
extends VBoxContainer
## The panel with the layers of the selected scatter. It shows their names and numbers of visible instances and has all
## commands for them. Tools work on the layers that are selected here.

const Controls := preload("res://addons/thicket/editor/editor_controls.gd")
const ChosenLayers := preload("res://addons/thicket/editor/inspector/chosen_layers.gd")
const Copies := preload("res://addons/thicket/editor/layers/layer_copies.gd")
const LayerEdits := preload("res://addons/thicket/editor/layers/layer_edits.gd")
const LayersTree := preload("res://addons/thicket/editor/layers/layers_tree.gd")
const Marks := preload("res://addons/thicket/editor/layers/layer_marks.gd")
const Notes := preload("res://addons/thicket/editor/layers/panel_notes.gd")
const NumberText := preload("res://addons/thicket/number_text.gd")
const Pictures := preload("res://addons/thicket/editor/layers/layer_pictures.gd")
const Presets := preload("res://addons/thicket/editor/layers/presets.gd")
const PreviewBar := preload("res://addons/thicket/editor/layers/preview_bar.gd")
const ScatterLayers := preload("res://addons/thicket/editor/layers/scatter_layers.gd")
const SceneFiles := preload("res://addons/thicket/editor/scene_files.gd")
const Shared := preload("res://addons/thicket/editor/layers/shared_layers.gd")
const Steps := preload("res://addons/thicket/editor/layers/preview_steps.gd")
const Welcome := preload("res://addons/thicket/editor/layers/welcome.gd")

## Emitted when the user has selected layers for tools. The first one is the main layer.
signal layers_chosen(layers: Array[ScatterLayer])
signal preset_chosen(name: String)
## Emitted when layers are about to be added.
signal adding
## Emitted when layers were added.
signal added

enum Add { MESHES, LAYERS, EMPTY, FIRST_PRESET }
const MESH_CLASSES: Array[StringName] = [&"Mesh", &"PackedScene", &"ScatterModel"]
const LAYER_CLASSES: Array[StringName] = [&"ScatterLayer"]
## The colors of marks, like those of folders in the FileSystem dock.
const COLORS: Dictionary[String, Color] = {
	"Red": Color(1.0, 0.27, 0.27), "Orange": Color(1.0, 0.56, 0.27), "Yellow": Color(1.0, 0.89, 0.27), "Green": Color(0.5, 1.0, 0.27),
	"Teal": Color(0.27, 1.0, 0.64), "Blue": Color(0.27, 0.75, 1.0), "Purple": Color(0.56, 0.27, 1.0), "Pink": Color(1.0, 0.27, 0.65),
}
const HEIGHT := 230.0

## The rows of layers.
var tree := LayersTree.new()
## Notes about the scatter, above the rows.
var notes: Notes
## Visible while no scatter is selected.
var welcome := Welcome.new()

var _undo_redo: EditorUndoRedoManager
var _files: SceneFiles
var _marks: Marks
var _steps: Steps
var _scatter: TerrainScatter3D
var _shown_state: Array = []
var _pictures := Pictures.new()
var _empty := Label.new()
var _add := MenuButton.new()
var _copy: Button
var _remove: Button
var _keep_apart := CheckBox.new()
var _total := Label.new()
var _colors := PopupMenu.new()
var _colored: Array[ScatterLayer] = []


func _init(undo_redo: EditorUndoRedoManager, marks: Marks, files: SceneFiles, steps: Steps) -> void:
	name = "Scatter"
	_undo_redo = undo_redo
	_marks = marks
	_files = files
	_steps = steps
	undo_redo.version_changed.connect(refresh.call_deferred) # Updates immediately after undo and redo.
	notes = Notes.new(undo_redo, files)
	custom_minimum_size.y = HEIGHT * EditorInterface.get_editor_scale()
	_add_header()
	add_child(notes)
	tree.marks = marks
	tree.size_flags_vertical = SIZE_EXPAND_FILL
	tree.layers_chosen.connect(_on_chosen)
	tree.layer_renamed.connect(_on_renamed)
	tree.layers_moved.connect(func(layers: Array[ScatterLayer], to: int) -> void: LayerEdits.move(_scatter, layers, to, _undo_redo))
	tree.resources_dropped.connect(add)
	tree.mark_pressed.connect(_on_mark)
	tree.gui_input.connect(_on_tree_input)
	add_child(tree)
	_empty.set_anchors_preset(PRESET_FULL_RECT)
	_empty.horizontal_alignment = HORIZONTAL_ALIGNMENT_CENTER
	_empty.vertical_alignment = VERTICAL_ALIGNMENT_CENTER
	_empty.modulate.a = 0.7
	tree.add_child(_empty)
	welcome.set_anchors_preset(PRESET_FULL_RECT)
	tree.add_child(welcome)
	_pictures.made.connect(tree.set_picture)
	_marks.changed.connect(tree.update_marks)
	for color in COLORS:
		_colors.add_item(color)
	_colors.add_item("None")
	_colors.index_pressed.connect(_on_color)
	add_child(_colors)


## Shows the layers of a scatter, or nothing if it is null.
func set_scatter(scatter: TerrainScatter3D) -> void:
	_scatter = scatter
	refresh()


## Selects the rows of layers. Does not emit [signal layers_chosen].
func choose(layers: Array[ScatterLayer]) -> void:
	var selection := tree.chosen_layers()
	if layers.size() != selection.size() or not layers.all(selection.has): # If only the order differs, the selection is kept, so the last clicked row stays current.
		tree.choose(layers)
	_enable()


## Updates everything that has changed. Called several times per second.
func refresh() -> void:
	if not is_instance_valid(_scatter):
		_scatter = null
	var layers := ScatterLayers.of(_scatter)
	var biomes := PackedStringArray(layers.map(func(layer: ScatterLayer) -> String: return ScatterLayers.biome_name(_scatter, layer)))
	var state: Array = [_scatter, layers.duplicate(), Copies.names(layers), biomes]
	if state != _shown_state and not get_viewport().gui_is_dragging():
		_shown_state = state
		tree.show_layers(layers, biomes)
		_enable()
	_empty.text = "Drop meshes, scenes or layers here to add a layer for each." if _scatter != null and layers.is_empty() else ""
	welcome.visible = _scatter == null
	if not is_visible_in_tree():
		return
	notes.refresh(_scatter)
	if _scatter == null:
		_total.text = ""
		return
	var total := 0
	for layer in layers:
		if layer != null:
			total += _show_count(layer)
			_pictures.ask(_scatter, layer)
	_total.text = "%s visible" % NumberText.grouped(total)


## Adds a layer for each of these resources that can be drawn, at an index, and selects the new layers. If the index is
## -1, each is inserted at a suitable position.
func add(resources: Array[Resource], index := -1) -> void:
	if not is_instance_valid(_scatter):
		return
	adding.emit()
	var new_layers := LayerEdits.add(_scatter, resources, index, keeps_apart(), _files, _undo_redo)
	added.emit()
	_show_toast(LayerEdits.skipped_message(resources, new_layers))
	if not new_layers.is_empty():
		_select_new_layers(new_layers)


## Returns true if new layers keep a distance from other layers.
func keeps_apart() -> bool:
	return _keep_apart.button_pressed


## Adds copies of the selected layers, except for layers of biomes.
func duplicate_chosen() -> void:
	var layers := _selected_own_layers()
	if layers.is_empty():
		return
	var copies := LayerEdits.copy(_scatter, layers, keeps_apart(), _files, SceneFiles.edited_scene_path(), _undo_redo)
	if copies.is_empty():
		_show_toast(_files.problem)
	else:
		_select_new_layers(copies)


## Deletes the selected layers, except for layers of biomes.
func remove_chosen() -> void:
	var layers := _selected_own_layers()
	if layers.is_empty():
		return
	var first_index := _scatter.layers.find(layers[0])
	var messages := LayerEdits.remove(_scatter, layers, _undo_redo)
	if not messages.is_empty():
		_show_toast(" ".join(messages))
	refresh()
	# The inspector must not keep a deleted layer.
	var remaining := _scatter.layers
	if remaining.is_empty():
		EditorInterface.edit_node(_scatter)
	else:
		_select_new_layers([remaining[clampi(first_index, 0, remaining.size() - 1)]] as Array[ScatterLayer])


## Adds a scatter to the edited scene and selects it. The scatter gets an unused seed and the ground of the scene's
## first scatter, if any.
func add_scatter() -> void:
	var root := EditorInterface.get_edited_scene_root()
	if root == null:
		_show_toast("A scatter cannot be added without an open scene. Open a 3D scene, or add a root node to the empty one.")
		return
	var scatter := TerrainScatter3D.new()
	scatter.name = "Scatter"
	scatter.seed = Shared.free_seed(null)
	var others := Shared.scatters_of(root)
	if not others.is_empty():
		scatter.ground = others[0].ground
	_undo_redo.create_action("New Scatter", UndoRedo.MERGE_DISABLE, root)
	_undo_redo.add_do_method(root, &"add_child", scatter, true)
	_undo_redo.add_do_property(scatter, &"owner", root)
	_undo_redo.add_do_reference(scatter)
	_undo_redo.add_undo_method(root, &"remove_child", scatter)
	_undo_redo.commit_action()
	EditorInterface.get_selection().clear()
	EditorInterface.get_selection().add_node(scatter)
	EditorInterface.edit_node(scatter)


func _add_header() -> void:
	var header := HBoxContainer.new()
	add_child(header)
	_button(header, "New Scatter", &"New", "Add a scatter to the scene.", add_scatter)
	_add.text = "Add Layer"
	_add.set_meta(&"icon", &"Add")
	_add.tooltip_text = "Add layers. Files may also be dropped on the list."
	var popup := _add.get_popup()
	popup.add_item("Mesh, Scene or Model...", Add.MESHES)
	popup.add_item("Layer from File...", Add.LAYERS)
	popup.add_item("Empty Layer", Add.EMPTY)
	popup.add_separator("Presets", 1000)
	for index in Presets.NAMES.size():
		popup.add_item(Presets.NAMES[index].capitalize(), Add.FIRST_PRESET + index)
	popup.id_pressed.connect(_on_add)
	header.add_child(_add)
	_copy = _button(header, "Duplicate", &"Duplicate", "Duplicate the selected layers (Ctrl+D).", duplicate_chosen)
	_remove = _button(header, "Delete", &"Remove", "Delete the selected layers (Delete).", remove_chosen)
	_keep_apart.text = "Keep apart"
	_keep_apart.button_pressed = true
	_keep_apart.tooltip_text = "New layers keep a distance from the other layers, calculated from their sizes (ScatterLayer.spacing)."
	header.add_child(_keep_apart)
	header.add_spacer(false)
	header.add_child(_total)


func _button(parent: Control, text: String, icon: StringName, tip: String, pressed: Callable) -> Button:
	var button := Controls.button(text, icon, tip)
	button.pressed.connect(pressed)
	parent.add_child(button)
	return button


func _notification(what: int) -> void:
	if what == NOTIFICATION_THEME_CHANGED:
		Controls.update_icons(self)


func _enable() -> void:
	_add.disabled = _scatter == null
	var has_no_selection := _selected_own_layers().is_empty()
	_copy.disabled = has_no_selection
	_remove.disabled = has_no_selection


## Returns the selected layers, except for layers of biomes. A biome adds and removes its layers itself, and other scatters may share it.
func _selected_own_layers() -> Array[ScatterLayer]:
	var result: Array[ScatterLayer] = []
	if is_instance_valid(_scatter):
		result = ScatterLayers.own(_scatter, tree.chosen_layers())
	return result


func _show_count(layer: ScatterLayer) -> int:
	var count := _scatter.get_shown_count(layer)
	var watch := _steps.limited_of(_scatter, layer)
	var text := NumberText.grouped(count)
	var note := notes.note_on(layer)
	if _marks.is_hidden(layer):
		text = "hidden in the editor"
	elif watch != null:
		text += " of ~" + PreviewBar.rounded(watch.estimate())
		note = "The view shows fewer instances than the game. See the bar below the view."
	tree.show_count(layer, text, note)
	return count


func _select_new_layers(layers: Array[ScatterLayer]) -> void:
	if get_viewport().gui_is_dragging(): # The user is still dropping files, whose rows are added afterward.
		get_tree().process_frame.connect(_select_new_layers.bind(layers), CONNECT_ONE_SHOT)
		return
	refresh()
	tree.choose(layers)
	_on_chosen(layers)


func _on_chosen(layers: Array[ScatterLayer]) -> void:
	_enable()
	layers_chosen.emit(layers)
	if not layers.is_empty():
		EditorInterface.inspect_object(layers[0] if layers.size() == 1 else ChosenLayers.new(layers, _undo_redo), "", true)


func _on_renamed(layer: ScatterLayer, text: String) -> void:
	LayerEdits.rename(_scatter, layer, text, _undo_redo)
	_shown_state = []
	refresh.call_deferred() # Deferred, because the row is still being edited.


func _on_add(id: int) -> void:
	match id:
		Add.MESHES:
			EditorInterface.popup_quick_open(_on_file_chosen, MESH_CLASSES)
		Add.LAYERS:
			EditorInterface.popup_quick_open(_on_file_chosen, LAYER_CLASSES)
		Add.EMPTY:
			var layer := ScatterLayer.new()
			layer.resource_name = Copies.free_name("Layer", Copies.names(_scatter.layers))
			add([layer] as Array[Resource])
		_:
			preset_chosen.emit(Presets.NAMES[id - Add.FIRST_PRESET])
			refresh()


func _on_file_chosen(path: String) -> void:
	var resource := load(path) as Resource if not path.is_empty() else null
	if resource != null:
		add([resource] as Array[Resource])
	elif not path.is_empty():
		_show_toast("%s cannot be loaded. See the Output panel for details." % path)


## Applies a mark to all selected layers if the clicked layer is one of them, otherwise only to the clicked layer.
func _on_mark(layer: ScatterLayer, mark: StringName) -> void:
	var layers := tree.chosen_layers()
	if not layer in layers:
		layers = [layer]
	match mark:
		Marks.HIDDEN:
			_marks.put_undoable(layers, mark, not _marks.is_hidden(layer), _scatter, _undo_redo)
		Marks.LOCKED:
			_marks.put_undoable(layers, mark, not _marks.is_locked(layer), _scatter, _undo_redo)
		Marks.COLOR:
			_colored = layers
			_colors.position = Vector2i(get_screen_position() + get_local_mouse_position())
			_colors.popup()


func _on_color(index: int) -> void:
	var colors: Array[Color] = COLORS.values()
	_marks.put_undoable(_colored, Marks.COLOR, colors[index] if index < colors.size() else null, _scatter, _undo_redo)


func _on_tree_input(event: InputEvent) -> void:
	var key := event as InputEventKey
	if key == null or not key.pressed or key.echo:
		return
	if key.keycode == KEY_DELETE and not key.is_command_or_control_pressed():
		remove_chosen()
	elif key.keycode == KEY_D and key.is_command_or_control_pressed():
		duplicate_chosen()
	elif key.keycode == KEY_F2 and not tree.chosen_layers().is_empty():
		tree.rename(tree.chosen_layers()[0])
	else:
		return
	tree.accept_event()


static func _show_toast(message: String) -> void:
	if not message.is_empty():
		EditorInterface.get_editor_toaster().push_toast(message, EditorToaster.SEVERITY_WARNING)
