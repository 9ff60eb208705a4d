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
	# Quitting during a scan would cause a warning.
	var deadline := Time.get_ticks_msec() + 10000
	while EditorInterface.get_resource_filesystem().is_scanning() and Time.get_ticks_msec() < deadline:
		await get_tree().process_frame
	print("editor tests: %d checks, %d failed" % [checks, failures])
	get_tree().quit(mini(failures, 1))
