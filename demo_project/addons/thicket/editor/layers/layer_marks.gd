@tool
extends RefCounted
## Marks on layers that affect only the editor: a layer may be hidden in the view, locked against tools, or have a color. The editor stores the marks
## of each scene outside of the scene file.

const ScatterLayers := preload("res://addons/thicket/editor/layers/scatter_layers.gd")

## Emitted when a mark on a layer has changed.
signal changed

const HIDDEN := &"hidden"
const LOCKED := &"locked"
const COLOR := &"color"

var _layer_marks: Dictionary[int, Dictionary] = {} ## The marks of each layer, by the layer's instance ID.


func is_hidden(layer: ScatterLayer) -> bool:
	return _mark(layer, HIDDEN, false)


func is_locked(layer: ScatterLayer) -> bool:
	return _mark(layer, LOCKED, false)


## Returns the color mark of a layer, which is transparent if there is none.
func color(layer: ScatterLayer) -> Color:
	return _mark(layer, COLOR, Color(0.0, 0.0, 0.0, 0.0))


## Sets a mark on a layer. [param name] is one of the constants above. A [param value] of null or false removes the mark.
func put(layer: ScatterLayer, name: StringName, value: Variant) -> void:
	var layer_marks: Dictionary = _layer_marks.get_or_add(layer.get_instance_id(), {})
	if value:
		layer_marks[name] = value
	else:
		layer_marks.erase(name)
	changed.emit()


## Sets a mark on several layers, as one undo step. Since Godot 4.5, the step does not mark the scene as unsaved.
func put_undoable(layers: Array[ScatterLayer], name: StringName, value: Variant, scatter: TerrainScatter3D,
		undo_redo: EditorUndoRedoManager) -> void:
	var action: Array = ["Mark Layers", UndoRedo.MERGE_DISABLE, scatter, false]
	if undo_redo.get_method_argument_count(&"create_action") > action.size(): # Since Godot 4.5, the last argument specifies whether the action marks the scene as unsaved.
		action.append(false)
	undo_redo.create_action.callv(action)
	for layer in layers:
		undo_redo.add_do_method(self, &"put", layer, name, value)
		undo_redo.add_undo_method(self, &"put", layer, name, _mark(layer, name, null))
	undo_redo.commit_action()


## Removes all marks.
func clear() -> void:
	_layer_marks.clear()
	changed.emit()


## Hides the layers of a scatter that are marked as hidden.
func apply(scatter: TerrainScatter3D) -> void:
	scatter._set_preview_hidden(ScatterLayers.of(scatter).filter(
			func(layer: ScatterLayer) -> bool: return layer != null and is_hidden(layer)))


## Returns the marks on the layers of some scatters in a scene, for the editor to save.
func to_state(root: Node, scatters: Array[TerrainScatter3D]) -> Dictionary:
	var state := {}
	for scatter in scatters:
		var scatter_marks := {}
		for layer in ScatterLayers.of(scatter):
			if layer != null and _layer_marks.get(layer.get_instance_id(), {}):
				scatter_marks[layer.layer_id] = _layer_marks[layer.get_instance_id()].duplicate()
		if scatter_marks:
			state[String(root.get_path_to(scatter))] = scatter_marks
	return state


## Restores the marks that [method to_state] returned.
func from_state(root: Node, state: Dictionary) -> void:
	for path: String in state:
		var scatter := root.get_node_or_null(path) as TerrainScatter3D
		if scatter == null:
			continue
		var scatter_marks: Dictionary = state[path]
		for layer in ScatterLayers.of(scatter):
			if layer != null and scatter_marks.has(layer.layer_id):
				_layer_marks[layer.get_instance_id()] = (scatter_marks[layer.layer_id] as Dictionary).duplicate()
	changed.emit()


func _mark(layer: ScatterLayer, name: StringName, default: Variant) -> Variant:
	return _layer_marks[layer.get_instance_id()].get(name, default) if layer != null and _layer_marks.has(layer.get_instance_id()) else default
