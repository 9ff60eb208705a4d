@tool
extends PanelContainer
## Where scenes, meshes and models are dropped from the file system: on a layer they join its meshes, on a scatter each becomes a layer.

const HINT_ON_LAYER := "Drop scenes or meshes here"
const HINT_ON_SCATTER := "Drop scenes or meshes here: a layer for each"
## What follows from the size of what is dropped on a layer that had nothing.
const FITTED: Array[StringName] = [&"radius", &"instance_radius", &"instance_height", &"collision_shape"]

var _object: Object


func _init(object: Object) -> void:
	_object = object
	var label := Label.new()
	label.text = HINT_ON_LAYER if object.is_class("ScatterLayer") else HINT_ON_SCATTER
	label.horizontal_alignment = HORIZONTAL_ALIGNMENT_CENTER
	label.mouse_filter = Control.MOUSE_FILTER_PASS
	label.modulate.a = 0.7
	add_child(label)


func _can_drop_data(_at: Vector2, data: Variant) -> bool:
	return not _paths(data).is_empty() or _resource(data) != null


func _drop_data(_at: Vector2, data: Variant) -> void:
	var dropped: Array[Resource] = []
	if _resource(data) != null:
		dropped.append(_resource(data))
	for path in _paths(data):
		dropped.append(load(path))
	add(_object, dropped, EditorInterface.get_editor_undo_redo())


## Adds what was dropped on a layer or a scatter, as one step of undo. What cannot be drawn is told in the output and adds nothing.
static func add(object: Object, dropped: Array[Resource], undo_redo: EditorUndoRedoManager) -> void:
	if object.is_class("ScatterLayer"):
		_add_to_layer(object as Resource, dropped, undo_redo)
	else:
		_add_layers(object, dropped, undo_redo)


static func _add_to_layer(layer: Resource, dropped: Array[Resource], undo_redo: EditorUndoRedoManager) -> void:
	var old: Array = layer.get(&"meshes")
	var fitted := _layer_of(old + dropped)
	if fitted == null:
		return
	undo_redo.create_action("Add Meshes", UndoRedo.MERGE_DISABLE, layer)
	undo_redo.add_do_property(layer, &"meshes", old + dropped)
	undo_redo.add_undo_property(layer, &"meshes", old)
	if old.is_empty():
		for property in FITTED:
			undo_redo.add_do_property(layer, property, fitted.get(property))
			undo_redo.add_undo_property(layer, property, layer.get(property))
	undo_redo.commit_action()


static func _add_layers(scatter: Object, dropped: Array[Resource], undo_redo: EditorUndoRedoManager) -> void:
	var old: Array = scatter.get(&"layers")
	var new := old.duplicate()
	for resource in dropped:
		var layer := _layer_of([resource])
		if layer != null:
			layer.resource_name = resource.resource_path.get_file().get_basename().capitalize()
			new.append(layer)
	if new.size() == old.size():
		return
	undo_redo.create_action("Add Layers", UndoRedo.MERGE_DISABLE, scatter)
	undo_redo.add_do_property(scatter, &"layers", new)
	undo_redo.add_undo_property(scatter, &"layers", old)
	undo_redo.commit_action()


## A layer of these meshes, and of the sizes that they have; null if there is nothing to draw.
static func _layer_of(meshes: Array) -> Resource:
	var layer := ClassDB.instantiate(&"ScatterLayer") as Resource
	for mesh: Variant in meshes: # One by one: what a layer refuses is only kept in its list where nothing was before.
		layer.set(&"meshes", layer.get(&"meshes") + [mesh])
	return layer if layer.call(&"fit_to_meshes") and layer.get(&"meshes").size() == meshes.size() else null


## The files among what is dragged that have something to draw; none if one of them has not.
static func _paths(data: Variant) -> PackedStringArray:
	if not data is Dictionary or data.get("type") != "files":
		return []
	for path: String in data["files"]:
		var type := StringName(EditorInterface.get_resource_filesystem().get_file_type(path))
		if not _is_drawable(type):
			return []
	return data["files"]


static func _resource(data: Variant) -> Resource:
	var resource: Resource = data.get("resource") as Resource if data is Dictionary and data.get("type") == "resource" else null
	return resource if resource != null and _is_drawable(resource.get_class()) else null


static func _is_drawable(type: StringName) -> bool:
	return ClassDB.class_exists(type) and (ClassDB.is_parent_class(type, &"Mesh") or type in [&"PackedScene", &"ScatterModel"])
