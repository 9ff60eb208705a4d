@tool
extends RefCounted
## Changes single instances of a scatter. Each change is one undo step. The scatter's state, in a file next to the scene, stores all
## changes.
##
## Undo and redo are exact, because they apply diffs of the changed instances before and after a step ([method ScatterState.diff_of]).

const SceneFiles := preload("res://addons/thicket/editor/scene_files.gd")

## The manager of the files in which states are stored.
var files: SceneFiles
var undo_redo: EditorUndoRedoManager
## The reason why the last [method begin] failed, as a sentence.
var problem := ""

var _scatter: TerrainScatter3D
var _scene_path := ""
var _state: ScatterState
var _last_state: ScatterState ## The scatter's previous state if the step has created a new one.
var _is_new := false
var _before: Array[PackedByteArray] = [] ## Diffs that revert the changes since [method begin].
var _ids := PackedInt64Array()


## Returns true between [method begin] and [method commit] or [method abort].
func is_open() -> bool:
	return _state != null


## Begins a step of changes. A scatter without a state in a file gets one. On failure, returns false and sets [member problem].
func begin(scatter: TerrainScatter3D, scene_path: String) -> bool:
	abort()
	problem = ""
	var state := scatter.state
	_is_new = state == null or state.resource_path.is_empty() or "::" in state.resource_path
	if _is_new:
		_last_state = state
		state = state.duplicate() if state != null else ScatterState.new()
		# A game changes its own copies, and never the designer's file.
		state.copy_at_runtime = true
		if not files.create(scene_path, state, scatter.name, "state"):
			problem = files.problem
			_last_state = null
			return false
		scatter.state = state
	_scatter = scatter
	_scene_path = scene_path
	_state = state
	return true


## Places an instance of a layer and returns its id, or 0 if it cannot be placed.
func add(layer: ScatterLayer, transform: Transform3D, mesh: int) -> int:
	var id := _scatter.add_instance(layer, transform, mesh)
	_store_before_addition(id)
	return id


## Moves, rotates or scales an instance and returns its new id, or 0 if it does not exist.
func set_transform(id: int, transform: Transform3D) -> int:
	_store_before_change(id)
	var new_id := _scatter.set_instance_transform(id, transform)
	if new_id != id:
		_store_before_addition(new_id)
	return new_id


## Removes an instance permanently.
func remove(id: int) -> void:
	_store_before_change(id)
	_state.remove(id, 0.0)


## Ends the step and adds it to the undo history. If nothing has changed, no step is added.
func commit(name: String) -> void:
	if _state == null:
		return
	if not is_instance_valid(_scatter) or _ids.is_empty():
		abort()
		return
	undo_redo.create_action(name, UndoRedo.MERGE_DISABLE, _scatter)
	add_to_action()
	undo_redo.commit_action(false)


## Ends the step, and adds its changes to the undo action that the caller is creating.
func add_to_action() -> void:
	if _state == null:
		return
	var after: Array[PackedByteArray] = [_state.diff_of(_ids)]
	if _is_new:
		undo_redo.add_do_property(_scatter, &"state", _state)
		undo_redo.add_undo_property(_scatter, &"state", _last_state)
	undo_redo.add_do_method(self, &"restore", _state, after)
	undo_redo.add_undo_method(self, &"restore", _state, _before)
	if _is_new:
		undo_redo.add_do_method(files, &"keep", _state, _scene_path)
		undo_redo.add_undo_method(files, &"drop", _state, _scene_path)
	files.mark(_state)
	_close()


## Reverts the changes since [method begin].
func abort() -> void:
	if _state == null:
		return
	restore(_state, _before)
	if _is_new:
		if is_instance_valid(_scatter):
			_scatter.state = _last_state
		files.drop(_state, _scene_path)
	_close()


## Applies diffs to a state. For undo and redo.
func restore(state: ScatterState, diffs: Array[PackedByteArray]) -> void:
	for diff in diffs:
		state.apply_diff(diff)
	files.mark(state)


## Stores a diff of an instance before its first change.
func _store_before_change(id: int) -> void:
	if not _ids.has(id):
		_before.append(_state.diff_of(PackedInt64Array([id])))
		_ids.append(id)


## Stores a diff that removes a new instance again.
func _store_before_addition(id: int) -> void:
	if id != 0 and not _ids.has(id):
		_before.append(ScatterState.new().diff_of(PackedInt64Array([id])))
		_ids.append(id)


func _close() -> void:
	_scatter = null
	_state = null
	_last_state = null
	_is_new = false
	_before = []
	_ids = PackedInt64Array()
