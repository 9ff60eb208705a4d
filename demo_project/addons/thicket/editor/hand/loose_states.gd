@tool
extends RefCounted
## Manages states that were created or changed without the hand tool. A state that a script or the inspector has created has no file, so
## all of its instances would be saved in the scene. Such a state gets a file next to the scene, like those of the hand tool. If a script
## has changed a state that has a file, the file is saved with the scene.

const SceneFiles := preload("res://addons/thicket/editor/scene_files.gd")
const Shared := preload("res://addons/thicket/editor/layers/shared_layers.gd")

var _files: SceneFiles
var _revisions: Dictionary[int, int] = {} ## The revision of each state when it was last saved, by the state's instance id.


func _init(files: SceneFiles) -> void:
	_files = files


## Creates a file for each state of a scene that contains instances but has no file, if the scene has a file. Marks states that differ from their
## files. Returns true if any file was created.
func move_to_files(root: Node) -> bool:
	var has_moved := false
	for scatter in Shared.scatters_of(root):
		var state := scatter.state
		if state == null:
			continue
		if _is_loose(state, root.scene_file_path):
			has_moved = _move_to_file(state, scatter.name, root.scene_file_path) or has_moved
		elif state.resource_path.begins_with("res://") and not "::" in state.resource_path:
			_mark_if_changed(state)
	return has_moved


func _move_to_file(state: ScatterState, owner_name: String, scene_path: String) -> bool:
	if scene_path.is_empty():
		return false
	# A game changes its own copy, and never the editor's file.
	state.copy_at_runtime = true
	if not _files.create(scene_path, state, owner_name, "state"):
		EditorInterface.get_editor_toaster().push_toast(_files.problem, EditorToaster.SEVERITY_ERROR)
		return false
	_revisions[state.get_instance_id()] = state.get_revision()
	return true


func _mark_if_changed(state: ScatterState) -> void:
	var id := state.get_instance_id()
	var revision := state.get_revision()
	if _revisions.get(id, -1) == revision:
		return
	var file_state: ScatterState
	if not _revisions.has(id): # The saved revision is unknown at first, so the content is compared with the file.
		file_state = ResourceLoader.load(state.resource_path, "", ResourceLoader.CACHE_MODE_IGNORE)
	if file_state == null or file_state.get_digest() != state.get_digest():
		_files.mark(state)
	_revisions[id] = revision


## Moves the states of a scene that had no file before to files, after the scene was saved. The scene must then be saved again.
func on_scene_saved(path: String) -> void:
	var root := EditorInterface.get_edited_scene_root()
	if root != null and root.scene_file_path == path and move_to_files(root):
		EditorInterface.mark_scene_as_unsaved()
		EditorInterface.get_editor_toaster().push_toast("Instances placed in %s are now stored in a separate file. Save the scene once more, so that it refers to the file." %
				path.get_file(), EditorToaster.SEVERITY_WARNING)


static func _is_loose(state: ScatterState, scene_path: String) -> bool:
	var path := state.resource_path
	return (path.is_empty() or path.begins_with(scene_path + "::")) and not state.data.is_empty()
