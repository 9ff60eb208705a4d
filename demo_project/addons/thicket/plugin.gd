@tool
extends EditorPlugin
## Adds Thicket's tools to the editor once the native library is loaded. Without the library, the plugin prints one warning and does not
## change the editor.
##
## The editor compiles this script in either case, so the script uses none of the library's classes.
## [code]editor/workspace.gd[/code] implements the tools.

# Relative paths, so that this script compiles in any folder and can report a wrong one.
const BakedWorldFormat := preload("baked_world_format.gd")
const LibraryGate := preload("library_gate.gd")

## The tools, an object of [code]editor/workspace.gd[/code]; null if they are not loaded.
var workspace: RefCounted

var _has_tried := false ## True if the plugin has tried to open the tools with the library loaded.


func _enter_tree() -> void:
	_open()


func _exit_tree() -> void:
	if workspace != null:
		workspace.leave()
		workspace = null


## Opens the tools if the library is loaded while the editor runs, after a build or after the entire add-on was copied
## into the project.
func _process(delta: float) -> void:
	if workspace != null:
		workspace.process(delta)
	elif not _has_tried and LibraryGate.is_open():
		_open()


func _open() -> void:
	_has_tried = LibraryGate.is_open()
	var misplaced := BakedWorldFormat.misplaced((get_script() as Script).resource_path)
	if misplaced:
		_has_tried = true
		push_error(misplaced)
		return
	var script := LibraryGate.load_script("editor/workspace.gd")
	if script != null:
		workspace = script.new(self)
	else:
		push_warning(LibraryGate.problem())


func _handles(object: Object) -> bool:
	return workspace != null and workspace.handles(object)


func _edit(object: Object) -> void:
	if workspace != null:
		workspace.edit(object)


func _make_visible(visible: bool) -> void:
	if workspace != null:
		workspace.make_visible(visible)


func _apply_changes() -> void:
	if workspace != null:
		workspace.apply_changes()


func _save_external_data() -> void:
	if workspace != null:
		workspace.save_external_data()


func _get_state() -> Dictionary:
	return workspace.dock.state() if workspace != null else {}


func _set_state(state: Dictionary) -> void:
	if workspace != null:
		workspace.dock.set_state(state)


func _forward_3d_gui_input(camera: Camera3D, event: InputEvent) -> int:
	return workspace.input(camera, event) if workspace != null else AFTER_GUI_INPUT_PASS


func _forward_3d_draw_over_viewport(overlay: Control) -> void:
	if workspace != null:
		workspace.draw_over(overlay)
