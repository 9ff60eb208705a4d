@tool
extends Button
## A button in a layer's inspector that makes foliage materials from the standard materials of its models.

const FoliageMaterials := preload("res://addons/thicket/editor/materials/foliage_materials.gd")
const SceneFiles := preload("res://addons/thicket/editor/scene_files.gd")

var _layer: ScatterLayer
var _files: SceneFiles


## Hidden if no model has a standard material.
func _init(layer: ScatterLayer, files: SceneFiles) -> void:
	_layer = layer
	_files = files
	text = "Make Foliage Materials"
	tooltip_text = "Gives the models materials that sway in the wind, let light through leaves and fade: made from their standard materials, and saved beside the scene. Normal and roughness maps are not used."
	visible = layer.get_materials().any(func(material: Material) -> bool: return material is BaseMaterial3D)
	pressed.connect(press)


func press() -> void:
	var place := SceneFiles.place_of(_layer)
	var told := PackedStringArray()
	if place.is_empty():
		told.append("The scene has no file yet. Save the scene first: materials go into files beside it.")
	else:
		told = FoliageMaterials.new(_files).convert(_layer, place, EditorInterface.get_editor_undo_redo())
	if not told.is_empty():
		EditorInterface.get_editor_toaster().push_toast(" ".join(told), EditorToaster.SEVERITY_WARNING)
