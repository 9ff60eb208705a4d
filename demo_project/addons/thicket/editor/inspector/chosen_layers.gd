@tool
extends Resource
## Represents several layers as one object in the inspector. It has the values of the first layer and sets a changed
## value on all layers, as one undo step. The class is a resource, because the editor would deselect the node for other
## objects.

const Names := preload("res://addons/thicket/editor/inspector/layer_names.gd")
## Properties that are specific to each layer and are therefore hidden.
const INDIVIDUAL_PROPERTIES: PackedStringArray = ["meshes", "seed", "spacing", "script", "resource_local_to_scene", "resource_path", "resource_name"]

var layers: Array[ScatterLayer] = []

var _undo_redo: EditorUndoRedoManager


func _init(selected_layers: Array[ScatterLayer] = [], undo_redo: EditorUndoRedoManager = null) -> void:
	layers = selected_layers.duplicate()
	_undo_redo = undo_redo
	if not layers.is_empty():
		layers[0].property_list_changed.connect(_on_list_changed)


## Returns the title in the inspector.
func _get_editor_name() -> String:
	return "%d layers" % layers.size()


## Makes the inspector add no undo steps. This class adds them, because it knows the previous value of each layer.
func _dont_undo_redo() -> bool:
	return true


func _get_property_list() -> Array[Dictionary]:
	if layers.is_empty():
		return []
	var references := Names.reference_properties(layers[0])
	return layers[0].get_property_list().filter(func(property: Dictionary) -> bool:
		var name: String = property.name
		var is_title: bool = property.usage & (PROPERTY_USAGE_GROUP | PROPERTY_USAGE_SUBGROUP) or (
				property.usage & PROPERTY_USAGE_CATEGORY and name == "ScatterLayer")
		return is_title or property.usage & PROPERTY_USAGE_EDITOR and not name in INDIVIDUAL_PROPERTIES and not name in references)


func _validate_property(property: Dictionary) -> void:
	if property.name in INDIVIDUAL_PROPERTIES:
		property.usage = PROPERTY_USAGE_NO_EDITOR


func _get(property: StringName) -> Variant:
	return layers[0].get(property) if _is_shared(property) else null


func _set(property: StringName, value: Variant) -> bool:
	if not _is_shared(property):
		return false
	_undo_redo.create_action("Set %s of %d Layers" % [property, layers.size()], UndoRedo.MERGE_ENDS, layers[0])
	for layer in layers:
		_undo_redo.add_do_property(layer, property, value)
		_undo_redo.add_undo_property(layer, property, layer.get(property))
	_undo_redo.commit_action()
	return true


func _property_can_revert(property: StringName) -> bool:
	return _is_shared(property) and layers.any(func(layer: ScatterLayer) -> bool: return layer.property_can_revert(property))


func _property_get_revert(property: StringName) -> Variant:
	return layers[0].property_get_revert(property)


## Updates the inspector, because a value may show or hide other properties.
func _on_list_changed() -> void:
	notify_property_list_changed()


func _is_shared(property: StringName) -> bool:
	return not layers.is_empty() and not property in INDIVIDUAL_PROPERTIES and property in layers[0]
