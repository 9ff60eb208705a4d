@tool
extends ConfirmationDialog
## The dialog for bakes, in which the user chooses the rectangle, the layers and the folder. It bakes over many frames
## and shows the progress.

const HandEdits := preload("res://addons/thicket/editor/hand/hand_edits.gd")
const Job := preload("res://addons/thicket/bake.gd")
const Replacement := preload("res://addons/thicket/editor/bake/bake_replacement.gd")

## The time for baking in each frame, in milliseconds.
const SLICE_MSEC := 20.0
## The edge length of the initial rectangle, in meters.
const SIDE := 256.0

## Emitted when the bake has ended. [param written] is false if the bake was canceled or has failed.
signal finished(written: bool)
## Emitted when the user wants to draw the rectangle in the view. Pass the result to [method take_drawn].
signal drawing_requested

## The current or the last bake.
var job := Job.new()
## The object that removes the hand-placed instances that the baked scene replaces.
var edits: HandEdits

var _scatter: TerrainScatter3D
var _rect_fields: Array[SpinBox] = []
var _folder := LineEdit.new()
var _name := LineEdit.new()
var _layers := VBoxContainer.new()
var _draw := Button.new()
var _replace := CheckBox.new()
var _bar := ProgressBar.new()
var _status := Label.new()
var _form := GridContainer.new()
var _folders := EditorFileDialog.new()


func _init() -> void:
	title = "Bake Scatter"
	dialog_hide_on_ok = false
	ok_button_text = "Bake"
	var rows := VBoxContainer.new()
	add_child(rows)
	_form.columns = 2
	rows.add_child(_form)
	for label: String in ["West (x)", "North (z)", "Width (x)", "Depth (z)"]:
		var spin := SpinBox.new()
		spin.min_value = -1e6 if _rect_fields.size() < 2 else 1.0
		spin.max_value = 1e6
		spin.step = 1.0
		spin.suffix = "m"
		_rect_fields.append(spin)
		_add_row(label, spin)
	_draw.text = "Draw in the View"
	_draw.tooltip_text = "Drag the rectangle over the ground, from corner to corner."
	_draw.pressed.connect(func() -> void: hide(); drawing_requested.emit())
	_add_row("", _draw)
	var folder_row := HBoxContainer.new()
	_folder.custom_minimum_size.x = 260.0
	_folder.size_flags_horizontal = Control.SIZE_EXPAND_FILL
	folder_row.add_child(_folder)
	var browse := Button.new()
	browse.text = "..."
	browse.pressed.connect(func() -> void: _folders.popup_file_dialog())
	folder_row.add_child(browse)
	_add_row("Folder", folder_row)
	_add_row("Name", _name)
	_add_row("Layers", _layers)
	_replace.text = "Replace these instances in the scene"
	_replace.tooltip_text = "Adds the baked scene as a child of the scatter, and a region that keeps the baked layers out of the rectangle."
	rows.add_child(_replace)
	rows.add_child(_bar)
	_status.autowrap_mode = TextServer.AUTOWRAP_WORD_SMART
	_status.custom_minimum_size = Vector2(380.0, 24.0)
	rows.add_child(_status)
	_folders.file_mode = EditorFileDialog.FILE_MODE_OPEN_DIR
	_folders.dir_selected.connect(func(folder: String) -> void: _folder.text = folder)
	add_child(_folders)
	confirmed.connect(start)
	canceled.connect(stop)
	set_process(false)


## Opens the dialog for a scatter and offers a rectangle around a world position.
func open(scatter: TerrainScatter3D, center: Vector3) -> void:
	fill(scatter, Rect2(Vector2(center.x, center.z).round() - Vector2(SIDE, SIDE) * 0.5, Vector2(SIDE, SIDE)))
	popup_centered()


## Fills the form, as [method open] does.
func fill(scatter: TerrainScatter3D, rect: Rect2) -> void:
	stop()
	_scatter = scatter
	_show(rect)
	if _folder.text.is_empty():
		_folder.text = "res://baked"
	_name.text = String(scatter.name).to_snake_case()
	for child in _layers.get_children():
		child.free()
	var layers := scatter.layers
	for index in layers.size():
		if layers[index] != null:
			var box := CheckBox.new()
			box.text = layers[index].resource_name if layers[index].resource_name else "Layer %d" % index
			box.button_pressed = true
			box.set_meta(&"layer", layers[index])
			_layers.add_child(box)
	_bar.value = 0.0
	_status.text = ""


## Opens the dialog again with the rectangle that was drawn in the view. If drawing was canceled, the
## rectangle is empty and has no effect.
func take_drawn(rect: Rect2) -> void:
	if rect.has_area():
		_show(rect)
	popup_centered()


## Sets whether [method start] replaces the scatter in the scene with the baked scene.
func choose_replacing(on: bool) -> void:
	_replace.button_pressed = on


## Sets the folder for the files of [method start].
func choose_folder(folder: String) -> void:
	_folder.text = folder


## Starts a bake with the settings of the form.
func start() -> void:
	if is_processing() or not is_instance_valid(_scatter):
		return
	var layers := _checked_layers()
	if layers.is_empty():
		_status.text = "No layer is chosen: check at least one under Layers."
		return
	if job.begin(_scatter, _rect(), _folder.text, _name.text, layers) != OK:
		_status.text = job.problem
		finished.emit(false)
		return
	_set_running(true)


## Cancels the bake and removes everything that it has written.
func stop() -> void:
	if is_processing():
		job.cancel()
		_set_running(false)
		_status.text = "Canceled."
		finished.emit(false)


func _exit_tree() -> void:
	stop()


func _process(_delta: float) -> void:
	if not is_instance_valid(_scatter):
		stop()
		return
	var is_unfinished := job.step(SLICE_MSEC)
	_bar.value = job.progress * 100.0
	_status.text = "%d instances" % job.instances
	if is_unfinished:
		return
	_set_running(false)
	if job.problem.is_empty():
		_status.text = "%d instances in %s" % [job.instances, job.scene_path]
		EditorInterface.get_resource_filesystem().scan()
		if _replace.button_pressed:
			var problem := Replacement.replace(edits, _scatter, job.scene_path, _rect(), _checked_layers())
			_status.text += "" if problem.is_empty() else "\n" + problem
	else:
		_status.text = job.problem
	finished.emit(job.problem.is_empty())


func _show(rect: Rect2) -> void:
	var numbers: Array[float] = [rect.position.x, rect.position.y, rect.size.x, rect.size.y]
	for index in 4:
		_rect_fields[index].value = numbers[index]


func _rect() -> Rect2:
	return Rect2(_rect_fields[0].value, _rect_fields[1].value, _rect_fields[2].value, _rect_fields[3].value)


## Returns the layers to bake, whose boxes are checked.
func _checked_layers() -> Array[ScatterLayer]:
	var layers: Array[ScatterLayer] = []
	for box: CheckBox in _layers.get_children():
		if box.button_pressed:
			layers.append(box.get_meta(&"layer"))
	return layers


func _add_row(text: String, control: Control) -> void:
	var label := Label.new()
	label.text = text
	_form.add_child(label)
	control.size_flags_horizontal = Control.SIZE_EXPAND_FILL
	_form.add_child(control)


func _set_running(running: bool) -> void:
	set_process(running)
	get_ok_button().disabled = running
	for spin in _rect_fields:
		spin.editable = not running
