@tool
extends VBoxContainer
## Notes about problems of a scatter, one per row, with a button that fixes the problem. The scatter may have no ground,
## share resources by accident, or be in a scene that would appear gray in the game.

const Copies := preload("res://addons/thicket/editor/layers/layer_copies.gd")
const SceneFiles := preload("res://addons/thicket/editor/scene_files.gd")
const Shared := preload("res://addons/thicket/editor/layers/shared_layers.gd")
const Surroundings := preload("res://addons/thicket/editor/layers/scene_surroundings.gd")
const UniqueDialog := preload("res://addons/thicket/editor/layers/unique_dialog.gd")

## Emitted when the user wants to choose a ground.
signal ground_wanted

## The number of updates between two searches for shared resources.
const SEARCH_EVERY := 6

## The dialog for making the scatter unique.
var dialog := UniqueDialog.new()

var _undo_redo: EditorUndoRedoManager
var _files: SceneFiles
var _scatter: TerrainScatter3D
var _ground: HBoxContainer
var _sharing: HBoxContainer
var _gray: HBoxContainer
var _hidden_for: Dictionary[String, bool] = {} ## The paths of scenes for which the user has hidden the note about surroundings.
var _shared: Shared.Shared
var _update_count := 0


func _init(undo_redo: EditorUndoRedoManager, files: SceneFiles) -> void:
	_undo_redo = undo_redo
	_files = files
	_ground = _row(&"NodeWarning")
	_label(_ground).text = "The scatter has no ground, so no instances are placed."
	var choose_button := Button.new()
	choose_button.text = "Use as Ground..."
	choose_button.tooltip_text = "Choose a mesh or a static body of the scene. For other kinds of ground, use the Ground property in the inspector."
	choose_button.pressed.connect(ground_wanted.emit)
	_ground.add_child(choose_button)
	_sharing = _row(&"NodeWarning")
	var unique_button := Button.new()
	unique_button.text = "Make Unique..."
	unique_button.pressed.connect(ask_to_make_unique)
	_sharing.add_child(unique_button)
	_gray = _row(&"NodeInfo")
	var surround_button := Button.new()
	surround_button.text = "Add Camera, Sun, Sky and Wind"
	surround_button.tooltip_text = "Adds the missing parts to the scene. The camera gets the position and the direction of this view."
	surround_button.pressed.connect(_add_surroundings)
	_gray.add_child(surround_button)
	var accept_button := Button.new()
	accept_button.text = "Not Here"
	accept_button.tooltip_text = "Hides this note. Use it if another scene contains these parts."
	accept_button.pressed.connect(_accept_gray)
	_gray.add_child(accept_button)
	add_child(dialog)
	dialog.decided.connect(make_unique)


## Updates the notes about a scatter, which may be null.
func refresh(scatter: TerrainScatter3D) -> void:
	if scatter != _scatter or _update_count % SEARCH_EVERY == 0:
		_shared = Shared.find(scatter) if scatter != null else null
		_update_count = 0
	_update_count += 1
	_scatter = scatter
	_ground.visible = scatter != null and scatter.ground == null
	_sharing.visible = _shared != null and _shared.is_by_accident()
	_update_surroundings_note()
	visible = _ground.visible or _sharing.visible or _gray.visible
	if _sharing.visible:
		_label(_sharing).text = _shared.describe(scatter.name)
		_label(_sharing).tooltip_text = _shared.describe(scatter.name)


## Returns the note about a single layer, or an empty string if there is none.
func note_on(layer: ScatterLayer) -> String:
	if _shared == null:
		return ""
	if layer in _shared.files:
		return "Another scatter also uses the file %s: changes apply to both." % layer.resource_path.get_file()
	return "Another scatter also has this layer: changes apply to both. Press Make Unique to copy it." if layer in _shared.layers else ""


## Opens the dialog.
func ask_to_make_unique() -> void:
	if is_instance_valid(_scatter) and _shared != null:
		var has_files := _scatter.layers.any(
				func(layer: ScatterLayer) -> bool: return layer != null and Copies.is_file(layer))
		dialog.ask(_shared.describe(_scatter.name), has_files)


func make_unique(new_seed: bool, with_files: bool) -> void:
	if not is_instance_valid(_scatter):
		return
	var problem := Shared.make_unique(_scatter, new_seed, with_files, _files, SceneFiles.edited_scene_path(), _undo_redo)
	if not problem.is_empty():
		EditorInterface.get_editor_toaster().push_toast(problem, EditorToaster.SEVERITY_ERROR)
	_update_count = 0
	refresh(_scatter)


## Updates the note about missing surroundings, which requires a scatter with a ground and layers.
func _update_surroundings_note() -> void:
	var root := EditorInterface.get_edited_scene_root()
	_gray.visible = root != null and _scatter != null and _scatter.ground != null and not _scatter.layers.is_empty() and (
			not _hidden_for.has(root.scene_file_path)) and Surroundings.is_gray(root)
	if _gray.visible:
		_label(_gray).text = "The game would show a gray window: this scene has no %s." % ", no ".join(Surroundings.missing(root))


func _add_surroundings() -> void:
	var root := EditorInterface.get_edited_scene_root()
	if root != null:
		Surroundings.add(root, EditorInterface.get_editor_viewport_3d(0).get_camera_3d().global_transform, _undo_redo)
		refresh(_scatter)


func _accept_gray() -> void:
	var root := EditorInterface.get_edited_scene_root()
	if root != null:
		_hidden_for[root.scene_file_path] = true
		refresh(_scatter)


func _row(icon: StringName) -> HBoxContainer:
	var row := HBoxContainer.new()
	var picture := TextureRect.new()
	picture.stretch_mode = TextureRect.STRETCH_KEEP_CENTERED
	picture.set_meta(&"icon", icon)
	row.add_child(picture)
	var label := Label.new()
	label.size_flags_horizontal = SIZE_EXPAND_FILL
	label.text_overrun_behavior = TextServer.OVERRUN_TRIM_ELLIPSIS
	label.mouse_filter = MOUSE_FILTER_PASS
	row.add_child(label)
	row.hide()
	add_child(row)
	return row


static func _label(row: HBoxContainer) -> Label:
	return row.get_child(1) as Label


func _notification(what: int) -> void:
	if what == NOTIFICATION_THEME_CHANGED:
		for picture: TextureRect in find_children("*", "TextureRect", true, false):
			picture.texture = get_theme_icon(picture.get_meta(&"icon"), &"EditorIcons")
