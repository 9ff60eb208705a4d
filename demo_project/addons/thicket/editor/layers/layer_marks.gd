@tool
extends RefCounted
## What a designer has noted on layers for the editor alone: hidden there, locked against tools, a color to find them by. The editor keeps
## it for each scene, beside the scene and never in it.

const ScatterLayers := preload("res://addons/thicket/editor/layers/scatter_layers.gd")

## A note on a layer is another one.
signal changed

const HIDDEN := &"hidden"
const LOCKED := &"locked"
const COLOR := &"color"

var _notes: Dictionary[int, Dictionary] = {} ## By the layer's instance id.


func is_hidden(layer: ScatterLayer) -> bool:
	return _note(layer, HIDDEN, false)


func is_locked(layer: ScatterLayer) -> bool:
	return _note(layer, LOCKED, false)


## The color that a layer is marked with; transparent for none.
func color(layer: ScatterLayer) -> Color:
	return _note(layer, COLOR, Color(0.0, 0.0, 0.0, 0.0))


## Notes something on a layer, by one of the names above; null to forget it.
func put(layer: ScatterLayer, name: StringName, value: Variant) -> void:
	var notes: Dictionary = _notes.get_or_add(layer.get_instance_id(), {})
	if value:
		notes[name] = value
	else:
		notes.erase(name)
	changed.emit()


## The same for several layers, as one step of undo that leaves the scene as saved as it is.
func put_undoable(layers: Array[ScatterLayer], name: StringName, value: Variant, scatter: TerrainScatter3D,
		undo_redo: EditorUndoRedoManager) -> void:
	var action: Array = ["Mark Layers", UndoRedo.MERGE_DISABLE, scatter, false]
	if undo_redo.get_method_argument_count(&"create_action") > action.size(): # Since 4.5: nothing to save.
		action.append(false)
	undo_redo.create_action.callv(action)
	for layer in layers:
		undo_redo.add_do_method(self, &"put", layer, name, value)
		undo_redo.add_undo_method(self, &"put", layer, name, _note(layer, name, null))
	undo_redo.commit_action()


## Forgets all.
func clear() -> void:
	_notes.clear()
	changed.emit()


## Hides in the view what is hidden of a scatter.
func apply(scatter: TerrainScatter3D) -> void:
	scatter._set_preview_hidden(ScatterLayers.of(scatter).filter(
			func(layer: ScatterLayer) -> bool: return layer != null and is_hidden(layer)))


## All notes on the layers of some scatters of a scene, as the editor keeps them.
func to_state(root: Node, scatters: Array[TerrainScatter3D]) -> Dictionary:
	var state := {}
	for scatter in scatters:
		var notes := {}
		for layer in ScatterLayers.of(scatter):
			if layer != null and _notes.get(layer.get_instance_id(), {}):
				notes[layer.layer_id] = _notes[layer.get_instance_id()].duplicate()
		if notes:
			state[String(root.get_path_to(scatter))] = notes
	return state


## Takes them back.
func from_state(root: Node, state: Dictionary) -> void:
	for path: String in state:
		var scatter := root.get_node_or_null(path) as TerrainScatter3D
		if scatter == null:
			continue
		var notes: Dictionary = state[path]
		for layer in ScatterLayers.of(scatter):
			if layer != null and notes.has(layer.layer_id):
				_notes[layer.get_instance_id()] = (notes[layer.layer_id] as Dictionary).duplicate()
	changed.emit()


func _note(layer: ScatterLayer, name: StringName, otherwise: Variant) -> Variant:
	return _notes[layer.get_instance_id()].get(name, otherwise) if layer != null and _notes.has(layer.get_instance_id()) else otherwise
