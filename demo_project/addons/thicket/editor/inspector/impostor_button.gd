@tool
extends VBoxContainer
## A button in a layer's inspector. It bakes an impostor of each of the layer's meshes into files next to the scene.
## Each impostor becomes the last LOD of its mesh, as one undo step.

const Job := preload("res://addons/thicket/bake_impostors.gd")
const SceneFiles := preload("res://addons/thicket/editor/scene_files.gd")

## Emitted when the bake has ended. [param written] is true if the layer has its impostors, and false if the bake failed or was canceled.
signal finished(written: bool)

## The current or the last bake.
var job := Job.new()

var _layer: ScatterLayer
var _files: SceneFiles
var _button := Button.new()
var _bar := ProgressBar.new()


func _init(layer: ScatterLayer = null, files: SceneFiles = null) -> void:
	_layer = layer
	_files = files
	_button.text = "Bake Impostors"
	_button.tooltip_text = "Bakes an impostor of each mesh (views from all directions, drawn on two triangles) as its last LOD."
	_button.pressed.connect(press)
	add_child(_button)
	add_child(_bar)
	_bar.hide()


func _ready() -> void:
	set_process(false) # The engine enables processing for every script with a _process.


## Starts a bake, or cancels the current one.
func press() -> void:
	if is_processing():
		job.cancel()
		_end(false, "Canceled: no impostor was baked.")
		return
	var path := SceneFiles.path_prefix_of(_layer)
	if path.is_empty():
		_end(false, "The scene has no file yet. Save the scene first: impostors are saved next to it.")
	elif job.begin(_layer, path.get_base_dir(), path.get_file()) != OK:
		_end(false, job.problem)
	else:
		_button.text = "Cancel"
		_bar.show()
		set_process(true)


func _process(_delta: float) -> void:
	var is_unfinished := job.step()
	_bar.value = job.progress * 100.0
	if is_unfinished:
		return
	if not job.problem.is_empty():
		_end(false, job.problem)
		return
	for warning in job.warnings:
		_toast(warning)
	var undo := EditorInterface.get_editor_undo_redo()
	undo.create_action("Bake Impostors", UndoRedo.MERGE_DISABLE, _layer)
	undo.add_do_property(_layer, &"meshes", job.meshes)
	undo.add_undo_property(_layer, &"meshes", _layer.meshes.duplicate())
	_add_files(undo)
	undo.commit_action()
	for path in job.files: # A scan of the file system is not used, because undo might remove a file during the scan.
		EditorInterface.get_resource_filesystem().update_file(path)
	_end(true, "")


## Adds the files to the undo step that is being created. Undo removes new files and restores the content of replaced ones.
func _add_files(undo: EditorUndoRedoManager) -> void:
	var root := EditorInterface.get_edited_scene_root()
	var new_meshes: Array[Mesh] = []
	for mesh in job.baked:
		if mesh == null:
			continue
		var path := mesh.resource_path
		if job.replaced.has(path):
			undo.add_do_method(_files, &"put", path, FileAccess.get_file_as_bytes(path), mesh)
			undo.add_undo_method(_files, &"put", path, job.replaced[path].bytes, job.replaced[path].resource)
		elif root != null: # Without a scene, nothing will refer to the new file.
			new_meshes.append(mesh)
	if not new_meshes.is_empty():
		_files.add_new_to_undo(new_meshes, _layer, undo)


func _exit_tree() -> void:
	job.cancel()
	set_process(false)


func _end(written: bool, problem: String) -> void:
	set_process(false)
	_bar.hide()
	_button.text = "Bake Impostors"
	if not problem.is_empty():
		_toast(problem)
	finished.emit(written)


static func _toast(message: String) -> void:
	EditorInterface.get_editor_toaster().push_toast(message, EditorToaster.SEVERITY_WARNING)
