@tool
extends RefCounted
## Watches the layers of a new preset until their instances are placed, and explains if none are.

const GroundRay := preload("res://addons/thicket/editor/ground/ground_ray.gd")
const Presets := preload("res://addons/thicket/editor/layers/presets.gd")

var _scatter: TerrainScatter3D
var _fresh: Array[ScatterLayer] = []


## Adds a preset's layers to a scatter, and watches them.
func add(preset: String, scatter: TerrainScatter3D, undo_redo: EditorUndoRedoManager) -> void:
	var before := scatter.layers
	Presets.add(preset, scatter, undo_redo)
	_scatter = scatter
	_fresh = scatter.layers.filter(func(layer: ScatterLayer) -> bool: return not before.has(layer))


## Once all tiles are ready, reports the new layers without a visible instance, and the rules that
## prevent it.
func look() -> void:
	if _fresh.is_empty():
		return
	if not is_instance_valid(_scatter) or not _scatter.is_inside_tree():
		_fresh.clear()
		return
	if not _scatter.is_settled():
		return
	var layers := _scatter.layers
	var missing := _fresh.filter(func(layer: ScatterLayer) -> bool:
		return layer in layers and _scatter.get_shown_count(layer) == 0)
	_fresh.clear()
	if not missing.is_empty() and _scatter.ground != null: # Without a ground, the node has a warning.
		EditorInterface.get_editor_toaster().push_toast(_why(missing), EditorToaster.SEVERITY_WARNING)


## Explains for each layer, in a sentence, why it has no instance at the position that the view
## looks at.
func _why(missing: Array[ScatterLayer]) -> String:
	var camera := EditorInterface.get_editor_viewport_3d(0).get_camera_3d()
	var away := GroundRay.distance(_scatter.ground, camera.global_position, -camera.global_basis.z)
	var sentences := PackedStringArray()
	for explanation in _scatter.explain_position(camera.global_position - camera.global_basis.z * away, missing):
		sentences.append("%s: %s" % [explanation.layer_name, explanation.reason])
	return "No instance is visible here of " + " ".join(sentences)
