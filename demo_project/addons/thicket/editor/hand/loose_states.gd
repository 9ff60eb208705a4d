@tool
extends RefCounted
## States that others than the hand tool have made or changed. One that a script or the inspector has made lies in no file, and would be
## saved inside of the scene with all its instances: it gets a file beside it, as one of the hand tool has from the beginning. And what a
## script has changed of one in a file is saved with the scene.

const SceneFiles := preload("res://addons/thicket/editor/scene_files.gd")
const Shared := preload("res://addons/thicket/editor/layers/shared_layers.gd")

var _files: SceneFiles
var _revisions: Dictionary[int, int] = {} ## Of states, by the ids of the objects, as they were written last.


func _init(files: SceneFiles) -> void:
	_files = files


## Gives each state in a scene that holds instances a file, if the scene has one, and marks those whose files are no longer what they are.
## True if there were any without a file.
func take_in(root: Node) -> bool:
	var moved := false
	for scatter in Shared.scatters_of(root):
		var state := scatter.state
		if state == null:
			continue
		if _is_loose(state, root.scene_file_path):
			moved = _move_out(state, scatter.name, root.scene_file_path) or moved
		elif state.resource_path.begins_with("res://") and not "::" in state.resource_path:
			_look_at(state)
	return moved


func _move_out(state: ScatterState, owner_name: String, scene_path: String) -> bool:
	if scene_path.is_empty():
		return false
	# A game changes a copy of its own, and never what is in the editor's file.
	state.copy_at_runtime = true
	if not _files.create(scene_path, state, owner_name, "state"):
		EditorInterface.get_editor_toaster().push_toast(_files.problem, EditorToaster.SEVERITY_ERROR)
		return false
	_revisions[state.get_instance_id()] = state.get_revision()
	return true


func _look_at(state: ScatterState) -> void:
	var id := state.get_instance_id()
	var revision := state.get_revision()
	if _revisions.get(id, -1) == revision:
		return
	var saved: ScatterState
	if not _revisions.has(id): # The first time, only its file knows.
		saved = ResourceLoader.load(state.resource_path, "", ResourceLoader.CACHE_MODE_IGNORE)
	if saved == null or saved.get_digest() != state.get_digest():
		_files.mark(state)
	_revisions[id] = revision


## After a scene was saved: if it had no file to be beside of until now, its states come out of it when it is saved once more.
func on_scene_saved(path: String) -> void:
	var root := EditorInterface.get_edited_scene_root()
	if root != null and root.scene_file_path == path and take_in(root):
		EditorInterface.mark_scene_as_unsaved()
		EditorInterface.get_editor_toaster().push_toast("Instances placed in %s are now in a file of their own. Save the scene once more to refer to it." %
				path.get_file(), EditorToaster.SEVERITY_WARNING)


static func _is_loose(state: ScatterState, scene_path: String) -> bool:
	var path := state.resource_path
	return (path.is_empty() or path.begins_with(scene_path + "::")) and not state.data.is_empty()
