@tool
extends HBoxContainer
## Base of the tools: what the left button does in the 3D view while a scatter is selected. A tool is the row of its own settings, which
## the toolbar shows beside its button while it is on. One tool is on at a time.

const Marks := preload("res://addons/thicket/editor/layers/layer_marks.gd")

## The view is to be drawn again.
signal redraw_requested

const NOT_MINE := EditorPlugin.AFTER_GUI_INPUT_PASS
const MINE := EditorPlugin.AFTER_GUI_INPUT_STOP

## Switches the tool on and off; the toolbar places it.
var button := Button.new()
## True for a tool that works on the layer which is chosen in the toolbar.
var needs_layer := true
## What the tool works on; null for none.
var scatter: TerrainScatter3D
## The chosen layer; null for none.
var layer: ScatterLayer
## Its index in the scatter's list.
var layer_index := -1
## All chosen layers, for a tool that works on several; the one above is the first.
var layers: Array[ScatterLayer] = []
## What is noted on layers: a locked one is not to be changed by a tool.
var marks: Marks
var undo_redo: EditorUndoRedoManager


## Names the button, gives it an icon of the editor, and says what it is for.
func _setup(text: String, icon: StringName, tip: String) -> void:
	button.text = text
	button.tooltip_text = tip
	button.toggle_mode = true
	button.theme_type_variation = &"FlatButton"
	button.set_meta(&"icon", icon)
	button.toggled.connect(func(_on: bool) -> void: _on_toggled(); redraw_requested.emit())


## Whether the tool has the left button.
func is_on() -> bool:
	return button.button_pressed


func set_on(on: bool) -> void:
	button.button_pressed = on


## Input over the view, while the tool is on and has a scatter. Returns [constant MINE] or [constant NOT_MINE].
func input(_camera: Camera3D, _event: InputEvent) -> int:
	return NOT_MINE


## Draws over the view, while the tool is on and has a scatter.
func draw_over(_overlay: Control) -> void:
	pass


## Looks, some times a second, whether what it shows has changed; called whether the tool is on or not.
func look() -> void:
	pass


## Ends what is under way: the scatter or the layer is about to change, or the tool is put away.
func finish() -> void:
	pass


func _on_toggled() -> void:
	pass


## Keeps a key from the editor, which would take it as a shortcut.
func _take_key() -> void:
	if is_inside_tree():
		get_viewport().set_input_as_handled()
	redraw_requested.emit()


## The ground of the scatter; null for none.
func ground() -> ScatterGround:
	return scatter.ground if is_instance_valid(scatter) else null


## The chosen layers that may be changed: those that are not locked.
func unlocked() -> Array[ScatterLayer]:
	return layers.filter(func(chosen: ScatterLayer) -> bool: return marks == null or not marks.is_locked(chosen))


## Why a tool may not change the chosen layers, in a sentence; empty if it may change one of them.
func lock_problem() -> String:
	if layers.is_empty() or not unlocked().is_empty():
		return ""
	return "%s is locked: unlock it in the Scatter panel." % (layer.resource_name if layer.resource_name else "The layer")


## The file of the scene that is worked on; empty while it has none.
static func scene_path() -> String:
	return EditorInterface.get_edited_scene_root().scene_file_path
