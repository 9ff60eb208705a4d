@tool
extends ConfirmationDialog
## Asks what to bake of a scatter and where to, bakes over many frames, and shows how far it is.

const Job := preload("res://addons/thicket/bake.gd")

## Milliseconds of a frame for baking.
const SLICE_MSEC := 20.0
## Meters: the side of the rectangle that is offered first.
const SIDE := 256.0

## It is over: the bake is written, or given up, or has failed.
signal finished(written: bool)

## What bakes, or has baked last.
var job := Job.new()

var _scatter: Node3D
var _numbers: Array[SpinBox] = []
var _folder := LineEdit.new()
var _name := LineEdit.new()
var _layers := VBoxContainer.new()
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


## Asks about a scatter; offers a rectangle around a position in the world.
func open(scatter: Node3D, around: Vector3) -> void:
	fill(scatter, Rect2(Vector2(around.x, around.z).round() - Vector2(SIDE, SIDE) * 0.5, Vector2(SIDE, SIDE)))
	popup_centered()


## Fills the form, as [method open] does.
func fill(scatter: Node3D, rect: Rect2) -> void:
	stop()
	_scatter = scatter
	var numbers: Array[float] = [rect.position.x, rect.position.y, rect.size.x, rect.size.y]
	for index in 4:
		_numbers[index].value = numbers[index]
	if _folder.text.is_empty():
		_folder.text = "res://baked"
	_name.text = String(scatter.name).to_snake_case()
	for child in _layers.get_children():
		child.free()
	var layers: Array = scatter.get(&"layers")
	for index in layers.size():
		if layers[index] != null:
			var box := CheckBox.new()
			box.text = layers[index].resource_name if layers[index].resource_name else "Layer %d" % index
			box.button_pressed = true
			box.set_meta(&"index", index)
			_layers.add_child(box)
	_bar.value = 0.0
	_state.text = ""


## Where files go, for [method start].
func choose_folder(folder: String) -> void:
	_folder.text = folder


## Bakes what the form says.
func start() -> void:
	if is_processing() or not is_instance_valid(_scatter):
		return
	var chosen := PackedInt32Array()
	for box: CheckBox in _layers.get_children():
		if box.button_pressed:
			chosen.append(box.get_meta(&"index"))
	if chosen.is_empty():
		_state.text = "Choose a layer."
		return
	var rect := Rect2(_numbers[0].value, _numbers[1].value, _numbers[2].value, _numbers[3].value)
	if job.begin(_scatter, rect, _folder.text, _name.text, chosen) != OK:
		_state.text = job.problem
		finished.emit(false)
		return
	_set_running(true)


## Gives up; nothing of the bake is left.
func stop() -> void:
	if is_processing():
		job.cancel()
		_set_running(false)
		_state.text = "Cancelled."
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
	else:
		_state.text = job.problem
	finished.emit(job.problem.is_empty())


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
