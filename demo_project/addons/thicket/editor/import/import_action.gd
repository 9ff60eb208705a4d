@tool
extends RefCounted
## Imports instances as one undo step. The scatter's state, in a file next to the scene, stores the placed instances. A
## scatter without a state in a file gets one.

const ImportInstances := preload("res://addons/thicket/import_instances.gd")
const SceneFiles := preload("res://addons/thicket/editor/scene_files.gd")

## The reason why [method run] failed.
var problem := ""

var _scatter: TerrainScatter3D
var _layer: Variant
var _reading: ImportInstances.Reading
var _files: SceneFiles
var _scene_path := ""
var _layers_before: Array[ScatterLayer] = []
var _layers_after: Array[ScatterLayer] = []
var _state_before: ScatterState
var _state: ScatterState
var _ids := PackedInt64Array()


## Imports instances into a scatter. [param layer] is as in [method ImportInstances.from_node]. [param files] manages the files of states
## next to scenes. Returns the number of placed instances. On failure, returns 0 and sets [member problem].
func run(scatter: TerrainScatter3D, layer: Variant, reading: ImportInstances.Reading, files: SceneFiles, scene_path: String,
		undo_redo: EditorUndoRedoManager) -> int:
	problem = ""
	_scatter = scatter
	_layer = layer
	_reading = reading
	_files = files
	_scene_path = scene_path
	_layers_before = scatter.layers.duplicate()
	_state_before = scatter.state
	if not _find_state():
		return 0
	_ids = ImportInstances.place(scatter, layer, reading)
	if _ids.is_empty():
		problem = "None of the %d instances were placed in %s. See the Output panel for details." % [reading.size(), scatter.name]
		_drop_state()
		return 0
	_layers_after = scatter.layers.duplicate()
	_files.mark(_state)
	undo_redo.create_action("Import %d Instances" % _ids.size(), UndoRedo.MERGE_DISABLE, scatter)
	undo_redo.add_do_method(self, &"redo")
	undo_redo.add_undo_method(self, &"undo")
	undo_redo.commit_action(false)
	return _ids.size()


## Reverts the import. Called by the undo history.
func undo() -> void:
	_scatter.remove_instances(_ids)
	if _layers_after != _layers_before:
		_scatter.layers = _layers_before.duplicate()
	_files.mark(_state)
	_drop_state()


## Repeats the import. Called by the undo history.
func redo() -> void:
	if _state != _state_before:
		_scatter.state = _state
		_files.keep(_state, _scene_path)
	if _layers_after != _layers_before:
		_scatter.layers = _layers_after.duplicate()
	_ids = ImportInstances.place(_scatter, _layer, _reading)
	_files.mark(_state)


## Ensures that the scatter's state has its own file. If it has none, writes a copy of the state, or a new state, to a
## file and assigns it. On failure, returns false and sets [member problem].
func _find_state() -> bool:
	_state = _state_before
	if _state != null and not _state.resource_path.is_empty() and not "::" in _state.resource_path:
		return true
	_state = _state_before.duplicate() if _state_before != null else ScatterState.new()
	# A game changes its own copies, and never the designer's file.
	_state.copy_at_runtime = true
	if not _files.create(_scene_path, _state, _scatter.name, "state"):
		problem = _files.problem
		return false
	_scatter.state = _state
	return true


func _drop_state() -> void:
	if _state != _state_before:
		_scatter.state = _state_before
		_files.drop(_state, _scene_path)
