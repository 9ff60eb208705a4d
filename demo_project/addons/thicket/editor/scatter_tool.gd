@tool
extends HBoxContainer
## The base class of the tools, which handle the left mouse button in the 3D view while a scatter is selected. A tool
## has a row of settings, which the toolbar shows next to the tool's button while the tool is on. Only one tool is on at
## a time.

const Marks := preload("res://addons/thicket/editor/layers/layer_marks.gd")

## Emitted when the view must be redrawn.
signal redraw_requested

const NOT_MINE := EditorPlugin.AFTER_GUI_INPUT_PASS
const MINE := EditorPlugin.AFTER_GUI_INPUT_STOP

## The button that turns the tool on and off. The toolbar contains it.
var button := Button.new()
## True for a tool that works on the layer that is selected in the toolbar.
var needs_layer := true
## The scatter that the tool works on; null if there is none.
var scatter: TerrainScatter3D
## The selected layer; null if there is none.
var layer: ScatterLayer
## The index of [member layer] in [method TerrainScatter3D.get_all_layers]; -1 if there is none.
var layer_index := -1
## All selected layers, for a tool that works on several. [member layer] is the first of them.
var layers: Array[ScatterLayer] = []
## The marks on layers. Tools must not change locked layers.
var marks: Marks
var undo_redo: EditorUndoRedoManager


## Sets the button's text, its editor icon and its tooltip.
func _setup(text: String, icon: StringName, tip: String) -> void:
	button.text = text
	button.tooltip_text = tip
	button.toggle_mode = true
	button.theme_type_variation = &"FlatButton"
	button.set_meta(&"icon", icon)
	button.toggled.connect(func(_on: bool) -> void: _on_toggled(); redraw_requested.emit())


## Returns true if the tool is on.
func is_on() -> bool:
	return button.button_pressed


func set_on(on: bool) -> void:
	button.button_pressed = on


## Handles input over the view while the tool is on and has a scatter. Returns [constant MINE] or [constant NOT_MINE].
func input(_camera: Camera3D, _event: InputEvent) -> int:
	return NOT_MINE


## Draws over the view while the tool is on and has a scatter.
func draw_over(_overlay: Control) -> void:
	pass


## Updates the tool's display if anything has changed. Called several times per second, whether the tool is on or not.
func refresh() -> void:
	pass


## Ends the current action, because the scatter or the layer is about to change, or the tool is turned off.
func finish() -> void:
	pass


func _on_toggled() -> void:
	pass


## Prevents the editor from handling a key as a shortcut.
func _take_key() -> void:
	if is_inside_tree():
		get_viewport().set_input_as_handled()
	redraw_requested.emit()


## Returns the ground of the scatter, or null if there is none.
func ground() -> ScatterGround:
	return scatter.ground if is_instance_valid(scatter) else null


## Returns the selected layers that are not locked, which tools may change.
func unlocked() -> Array[ScatterLayer]:
	return layers.filter(func(selected_layer: ScatterLayer) -> bool: return marks == null or not marks.is_locked(selected_layer))


## Returns an empty string if a tool may change at least one of the selected layers, otherwise the reason.
func lock_problem() -> String:
	if layers.is_empty() or not unlocked().is_empty():
		return ""
	return "%s is locked: unlock it in the Scatter panel." % (layer.resource_name if layer.resource_name else "The layer")
