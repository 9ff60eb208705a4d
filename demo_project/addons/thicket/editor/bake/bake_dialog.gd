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
var _numbers: Array[SpinBox] = []
var _folder := LineEdit.new()
var _name := LineEdit.new()
var _layers := VBoxContainer.new()
var _draw := Button.new()
var _replace := CheckBox.new()
var _bar := ProgressBar.new()
var _state := Label.new()
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
		spin.min_value = -1e6 if _numbers.size() < 2 else 1.0
		spin.max_value = 1e6
		spin.step = 1.0
		spin.suffix = "m"
		_numbers.append(spin)
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
	_replace.tooltip_text = "Adds the baked scene below the scatter, and a region that keeps the baked layers out of the rectangle."
	rows.add_child(_replace)
	rows.add_child(_bar)
	_state.autowrap_mode = TextServer.AUTOWRAP_WORD_SMART
	_state.custom_minimum_size = Vector2(380.0, 24.0)
	rows.add_child(_state)
	_folders.file_mode = EditorFileDialog.FILE_MODE_OPEN_DIR
	_folders.dir_selected.connect(func(folder: String) -> void: _folder.text = folder)
	add_child(_folders)
	confirmed.connect(start)
	canceled.connect(stop)
	set_process(false)


## Opens the dialog for a scatter and offers a rectangle around a world position.
func open(scatter: TerrainScatter3D, around: Vector3) -> void:
	fill(scatter, Rect2(Vector2(around.x, around.z).round() - Vector2(SIDE, SIDE) * 0.5, Vector2(SIDE, SIDE)))
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
	_state.text = ""


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
	var chosen := _chosen()
	if chosen.is_empty():
		_state.text = "No layer is chosen: check at least one under Layers."
		return
	if job.begin(_scatter, _rect(), _folder.text, _name.text, chosen) != OK:
		_state.text = job.problem
		finished.emit(false)
		return
	_set_running(true)


## Cancels the bake and removes everything that it has written.
func stop() -> void:
	if is_processing():
		job.cancel()
		_set_running(false)
		_state.text = "Canceled."
		finished.emit(false)


func _exit_tree() -> void:
	stop()


func _process(_delta: float) -> void:
	if not is_instance_valid(_scatter):
		stop()
		return
	var more := job.step(SLICE_MSEC)
	_bar.value = job.progress * 100.0
	_state.text = "%d instances" % job.instances
	if more:
		return
	_set_running(false)
	if job.problem.is_empty():
		_state.text = "%d instances in %s" % [job.instances, job.scene_path]
		EditorInterface.get_resource_filesystem().scan()
		if _replace.button_pressed:
			var obstacle := Replacement.replace(edits, _scatter, job.scene_path, _rect(), _chosen())
			_state.text += "" if obstacle.is_empty() else "\n" + obstacle
	else:
		_state.text = job.problem
	finished.emit(job.problem.is_empty())


func _show(rect: Rect2) -> void:
	var numbers: Array[float] = [rect.position.x, rect.position.y, rect.size.x, rect.size.y]
	for index in 4:
		_numbers[index].value = numbers[index]


func _rect() -> Rect2:
	return Rect2(_numbers[0].value, _numbers[1].value, _numbers[2].value, _numbers[3].value)


## Returns the checked layers, which are to be baked.
func _chosen() -> Array[ScatterLayer]:
	var chosen: Array[ScatterLayer] = []
	for box: CheckBox in _layers.get_children():
		if box.button_pressed:
			chosen.append(box.get_meta(&"layer"))
	return chosen


func _add_row(text: String, control: Control) -> void:
	var label := Label.new()
	label.text = text
	_form.add_child(label)
	control.size_flags_horizontal = Control.SIZE_EXPAND_FILL
	_form.add_child(control)


func _set_running(running: bool) -> void:
	set_process(running)
	get_ok_button().disabled = running
	for spin in _numbers:
		spin.editable = not running
