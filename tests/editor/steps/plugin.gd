@tool
extends EditorPlugin
## Base class of the tests in the editor, which work like a designer. Runs the script given after `--`, with its methods that start
## with "test_", prints "editor tests: N checks, 0 failed", and quits.

const SIZE := Vector2i(1440, 900)

var checks := 0
var failures := 0


func _enter_tree() -> void:
	if OS.get_cmdline_user_args().is_empty():
		return
	# Drawing the editor in software is slow, so it only draws for pictures.
	RenderingServer.render_loop_enabled = false
	# After its first scan, the editor first lays out its docks, draws and hides panels. Then it emits this signal.
	EditorInterface.get_resource_filesystem().sources_changed.connect(_run.unbind(1), CONNECT_ONE_SHOT | CONNECT_DEFERRED)


func _run() -> void:
	await get_tree().process_frame # The editor refuses to show progress within a deferred call.
	while EditorInterface.get_resource_filesystem().is_scanning():
		await get_tree().process_frame
	get_window().mode = Window.MODE_WINDOWED
	get_window().size = SIZE
	var script: GDScript = load("res://tests/%s.gd" % OS.get_cmdline_user_args()[0])
	var steps: Node = script.new()
	steps.set(&"plugin", self)
	add_child(steps)
	for method in script.get_script_method_list():
		if method.name.begins_with("test_"):
			var begun := Time.get_ticks_msec()
			@warning_ignore("redundant_await")
			await steps.call(method.name)
			print("%s: %d ms" % [method.name, Time.get_ticks_msec() - begun])
	var deadline := Time.get_ticks_msec() + 60000
	while _is_reading() and Time.get_ticks_msec() < deadline:
		await get_tree().process_frame
	await get_tree().create_timer(0.2).timeout # The thread that read the scripts ends.
	print("editor tests: %d checks, %d failed" % [checks, failures])
	get_tree().quit(mini(failures, 1))


## True while the editor scans files, or reads scripts for its class reference, which it only does with a window. Quitting then would
## cause a warning or a crash (godotengine/godot#122158).
func _is_reading() -> bool:
	var is_read := Engine.has_meta(&"class_reference_is_read") or DisplayServer.get_name() == "headless"
	return EditorInterface.get_resource_filesystem().is_scanning() or not is_read
