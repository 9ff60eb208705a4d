@tool
extends PanelContainer
## An area in the inspector that accepts scenes, meshes and models from the FileSystem dock. A layer adds them to its meshes; a scatter adds a
## layer for each.

const HINT_ON_LAYER := "Drop scenes or meshes here"
const HINT_ON_SCATTER := "Drop scenes or meshes here: a layer for each"
const LayerEdits := preload("res://addons/thicket/editor/layers/layer_edits.gd")
const NewLayers := preload("res://addons/thicket/editor/layers/new_layers.gd")
const SceneFiles := preload("res://addons/thicket/editor/scene_files.gd")

var _object: Object
var _files: SceneFiles


func _init(object: Object, files: SceneFiles) -> void:
	_object = object
	_files = files
	var label := Label.new()
	label.text = HINT_ON_LAYER if object is ScatterLayer else HINT_ON_SCATTER
	label.horizontal_alignment = HORIZONTAL_ALIGNMENT_CENTER
	label.autowrap_mode = TextServer.AUTOWRAP_WORD_SMART # Without wrapping, the label would widen the inspector.
	label.mouse_filter = Control.MOUSE_FILTER_PASS
	label.modulate.a = 0.7
	add_child(label)


func _can_drop_data(_point: Vector2, data: Variant) -> bool:
	return can_take(data)


func _drop_data(_point: Vector2, data: Variant) -> void:
	add(_object, resources_in(data), _files, EditorInterface.get_editor_undo_redo())


## Adds the dropped resources to a layer or a scatter, as one undo step. A scatter leaves out those that cannot be
## drawn; a layer adds none if it rejects one of them. A toast names the resources that were not added. A layer that had
## no meshes also gets the properties that fit them.
static func add(object: Object, dropped: Array[Resource], files: SceneFiles, undo_redo: EditorUndoRedoManager) -> void:
	if object is ScatterLayer:
		_add_to_layer(object as ScatterLayer, dropped, undo_redo)
	else:
		var scatter := object as TerrainScatter3D
		_show_toast(LayerEdits.skipped_message(dropped, LayerEdits.add(scatter, dropped, scatter.layers.size(), true, files, undo_redo)))


## Returns true if all dragged resources can be drawn. If [param with_layers] is true, layers are accepted as well.
static func can_take(data: Variant, with_layers := false) -> bool:
	return not _paths(data, with_layers).is_empty() or _resource(data, with_layers) != null


## Returns the dragged resources, or an empty array if [method can_take] returns false.
static func resources_in(data: Variant, with_layers := false) -> Array[Resource]:
	var result: Array[Resource] = []
	if _resource(data, with_layers) != null:
		result.append(_resource(data, with_layers))
	for path in _paths(data, with_layers):
		result.append(load(path))
		if result[-1] == null:
			_show_toast("%s cannot be loaded. See the Output panel for details." % path)
	return result.filter(func(resource: Resource) -> bool: return resource != null)


static func _show_toast(message: String) -> void:
	if not message.is_empty():
		EditorInterface.get_editor_toaster().push_toast(message, EditorToaster.SEVERITY_WARNING)


static func _add_to_layer(layer: ScatterLayer, dropped: Array[Resource], undo_redo: EditorUndoRedoManager) -> void:
	var old_meshes := layer.meshes
	var template := NewLayers.of_meshes(old_meshes + dropped)
	if template == null:
		var rejected := dropped.filter(func(resource: Resource) -> bool: return NewLayers.of_meshes([resource]) == null)
		_show_toast(LayerEdits.skipped_message(rejected, []))
		return
	undo_redo.create_action("Add Meshes", UndoRedo.MERGE_DISABLE, layer)
	undo_redo.add_do_property(layer, &"meshes", old_meshes + dropped)
	undo_redo.add_undo_property(layer, &"meshes", old_meshes)
	if old_meshes.is_empty():
		NewLayers.add_fit(layer, template, undo_redo)
	undo_redo.commit_action()


## Returns the paths of the dragged files if all of them can be drawn, otherwise an empty array.
static func _paths(data: Variant, with_layers: bool) -> PackedStringArray:
	if not data is Dictionary or (data as Dictionary).get("type") != "files":
		return []
	for path: String in data["files"]:
		var type := StringName(EditorInterface.get_resource_filesystem().get_file_type(path))
		if not _is_drawable(type, with_layers):
			return []
	return data["files"]


static func _resource(data: Variant, with_layers: bool) -> Resource:
	if not data is Dictionary or (data as Dictionary).get("type") != "resource":
		return null
	var resource := (data as Dictionary).get("resource") as Resource
	return resource if resource != null and _is_drawable(resource.get_class(), with_layers) else null


static func _is_drawable(type: StringName, with_layers: bool) -> bool:
	return ClassDB.class_exists(type) and (ClassDB.is_parent_class(type, &"Mesh") or type in [&"PackedScene", &"ScatterModel"]
			or with_layers and type == &"ScatterLayer")
