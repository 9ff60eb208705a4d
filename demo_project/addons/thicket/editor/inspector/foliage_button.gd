@tool
extends Button
## A button in the inspector of a layer or a model. It creates foliage materials from the object's standard materials.

const FoliageMaterials := preload("res://addons/thicket/editor/materials/foliage_materials.gd")
const SceneFiles := preload("res://addons/thicket/editor/scene_files.gd")

var _object: Resource
var _files: SceneFiles


## Creates a button for a layer or a model. The button is hidden if the object has no standard material.
func _init(object: Resource, files: SceneFiles) -> void:
	_object = object
	_files = files
	text = "Make Foliage Materials"
	tooltip_text = "Replaces the models' standard materials with materials that sway in the wind, let light through leaves and fade. They are saved next to the scene. Roughness, metal and emission are not used."
	visible = _materials().any(func(material: Material) -> bool: return material is BaseMaterial3D)
	pressed.connect(press)


func press() -> void:
	var path_prefix := SceneFiles.path_prefix_of(_object)
	var messages := PackedStringArray()
	if path_prefix.is_empty():
		messages.append("The scene has no file yet. Save the scene first: materials are saved next to it.")
	elif _object is ScatterLayer:
		messages = FoliageMaterials.new(path_prefix).convert(_object as ScatterLayer, _files, EditorInterface.get_editor_undo_redo())
	else:
		messages = FoliageMaterials.new(path_prefix).convert_model(_object as ScatterModel, _files, EditorInterface.get_editor_undo_redo())
	if not messages.is_empty():
		EditorInterface.get_editor_toaster().push_toast(" ".join(messages), EditorToaster.SEVERITY_WARNING)


func _materials() -> Array[Material]:
	var layer := _object as ScatterLayer
	if layer == null:
		layer = ScatterLayer.new()
		layer.meshes = [_object]
	return layer.get_materials()
