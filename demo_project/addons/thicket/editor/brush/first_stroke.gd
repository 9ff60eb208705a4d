@tool
extends ConfirmationDialog
## The dialog for the first Paint stroke on a layer without a mask. Such a layer already grows everywhere, so the user
## chooses the effect of the stroke.

## Emitted when the user has chosen a brush mode for the stroke that began at a position on the ground.
signal chosen(mode: ScatterMask.Mode, point: Vector3)

const TEXT := "%s grows wherever its rules permit, so there is nothing to add.\n
Only here: the layer grows only where you paint. %s
Not here: the layer stays, except where you paint."
const TEXT_OF_MANY := "%s grow wherever their rules permit, so there is nothing to add.\n
Only here: the layers grow only where you paint. %s
Not here: the layers stay, except where you paint."

var _point := Vector3.ZERO


func _init() -> void:
	title = "First Stroke on a Layer"
	ok_button_text = "Only here"
	confirmed.connect(_choose.bind(ScatterMask.MODE_PAINT))
	add_button("Not here", true, "erase")
	custom_action.connect(func(_action: StringName) -> void: _choose(ScatterMask.MODE_ERASE))


## Opens the dialog for layers with these names and this number of visible instances. [param point] is the position of the stroke.
func ask(names: PackedStringArray, instances: int, point: Vector3) -> void:
	_point = point
	var removal_text := "All others of the %d visible instances are removed." % instances if instances > 0 else ""
	var layer_name := names[0] if names[0] else "The layer"
	dialog_text = TEXT % [layer_name, removal_text] if names.size() == 1 else TEXT_OF_MANY % [", ".join(names), removal_text]
	popup_centered()


func _choose(mode: ScatterMask.Mode) -> void:
	hide()
	chosen.emit(mode, _point)
