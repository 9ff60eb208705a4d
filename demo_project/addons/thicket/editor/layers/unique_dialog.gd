@tool
extends ConfirmationDialog
## The dialog for making a scatter unique.

## Emitted when the user has decided whether to use a new seed, and whether to copy layers with their own files as well.
signal decided(new_seed: bool, with_files: bool)

const TEXT := "%s
It gets separate layers, painted masks and hand-placed instances. Masks and instances are saved in files next to the scene."

var _text := Label.new()
var _seed := CheckBox.new()
var _files := CheckBox.new()


func _init() -> void:
	title = "Make Unique"
	ok_button_text = "Make Unique"
	var rows := VBoxContainer.new()
	add_child(rows)
	_text.autowrap_mode = TextServer.AUTOWRAP_WORD_SMART
	_text.custom_minimum_size = Vector2(420.0, 0.0) * EditorInterface.get_editor_scale()
	rows.add_child(_text)
	_seed.text = "Use a new seed: instances are placed at different positions"
	_seed.button_pressed = true
	rows.add_child(_seed)
	_files.text = "Also copy layers that are saved as files"
	rows.add_child(_files)
	confirmed.connect(func() -> void: decided.emit(_seed.button_pressed, _files.button_pressed))


## Opens the dialog with a message about the shared resources. [param has_files] is true if any layer has its own file.
func ask(message: String, has_files: bool) -> void:
	_text.text = TEXT % message
	_files.visible = has_files
	_files.button_pressed = false
	reset_size()
	popup_centered()
