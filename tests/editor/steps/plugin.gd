@tool
extends EditorPlugin
## Runs an editor test that works as a designer would. Calls the "test_" methods of the script given after `--`, prints
## "editor tests: N checks, 0 failed" and quits.

const SIZE := Vector2i(1440, 900)

var checks := 0
var failures := 0


func _enter_tree() -> void:
	if OS.get_cmdline_user_args().is_empty():
		return
	# Software rendering of the editor is slow, so the editor draws only when a screenshot is taken.
	RenderingServer.render_loop_enabled = false
	# Before the editor emits this signal, it finishes its first scan, lays out its docks, and draws and hides panels.
	EditorInterface.get_resource_filesystem().sources_changed.connect(_run.unbind(1), CONNECT_ONE_SHOT | CONNECT_DEFERRED)


func _run() -> void:
	await get_tree().process_frame # The editor refuses to show a progress dialog in a deferred call.
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
	await get_tree().create_timer(0.2).timeout # Wait until the thread that read the scripts has ended.
	print("editor tests: %d checks, %d failed" % [checks, failures])
	get_tree().quit(mini(failures, 1))


## Returns true while the editor is scanning files, or reading scripts for its class reference. It reads scripts only if it has a window. Quitting at
## such a time would cause a warning or a crash (godotengine/godot#122158).
func _is_reading() -> bool:
	var is_read := Engine.has_meta(&"class_reference_is_read") or DisplayServer.get_name() == "headless"
	return EditorInterface.get_resource_filesystem().is_scanning() or not is_read
