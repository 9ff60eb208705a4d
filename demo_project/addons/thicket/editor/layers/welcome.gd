@tool
extends VBoxContainer
## The content of the Scatter panel while no scatter is selected: a hint about the next step, and buttons for newcomers.

const Controls := preload("res://addons/thicket/editor/editor_controls.gd")

signal example_wanted
signal first_forest_wanted
signal documentation_wanted


func _init() -> void:
	alignment = BoxContainer.ALIGNMENT_CENTER
	mouse_filter = MOUSE_FILTER_IGNORE
	var text := Label.new()
	text.text = "Select a scatter to see its layers, or create a new one."
	text.horizontal_alignment = HORIZONTAL_ALIGNMENT_CENTER
	text.modulate.a = 0.7
	add_child(text)
	var row := HBoxContainer.new()
	row.alignment = BoxContainer.ALIGNMENT_CENTER
	row.mouse_filter = MOUSE_FILTER_IGNORE
	add_child(row)
	_button(row, "Open the Example", &"PackedScene", "Open a small forest that you may change. It is saved as thicket_example.tscn.", example_wanted)
	_button(row, "First Forest", &"Help", "Open the tutorial that creates a forest on your own ground, in five minutes.", first_forest_wanted)
	_button(row, "Documentation", &"ExternalLink", "Open the documentation in the web browser.", documentation_wanted)


func _button(row: HBoxContainer, text: String, icon: StringName, tip: String, request: Signal) -> void:
	var button := Controls.button(text, icon, tip)
	button.pressed.connect(request.emit)
	row.add_child(button)
