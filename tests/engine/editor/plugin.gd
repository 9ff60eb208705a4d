@tool
extends EditorPlugin
## Base of what is done in the editor, as a designer would: runs the script named after `--`, with its methods that start
## with "test_", prints "editor tests: N checks, 0 failed", and quits.

const SIZE := Vector2i(1440, 900)

var checks := 0
var failures := 0


func _enter_tree() -> void:
	if OS.get_cmdline_user_args().is_empty():
		return
	# Software takes long to draw the editor, so it draws for pictures alone.
	RenderingServer.render_loop_enabled = false
	# What the editor does after its first scan it does before this hears of it: it lays out its docks, draws meanwhile, and hides panels.
	EditorInterface.get_resource_filesystem().sources_changed.connect(_run.unbind(1), CONNECT_ONE_SHOT | CONNECT_DEFERRED)


func _run() -> void:
	await get_tree().process_frame # Within a deferred call the editor refuses to show progress.
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
	# A scan that is cut short by the end is told as a warning.
	var deadline := Time.get_ticks_msec() + 10000
	while EditorInterface.get_resource_filesystem().is_scanning() and Time.get_ticks_msec() < deadline:
		await get_tree().process_frame
	print("editor tests: %d checks, %d failed" % [checks, failures])
	get_tree().quit(mini(failures, 1))
