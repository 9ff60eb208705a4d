extends Node
## Loads the library, which the page has attached to the engine, and continues with the script that is named after `--`. The script extends
## SceneTree, as in a call of Godot with `--script`, which official web builds do not accept.


func _ready() -> void:
	var entry_point: int = JavaScriptBridge.eval("entryPoint")
	var status := GDExtensionManager.load_extension_from_function("libgodot://thicket", entry_point)
	if status != GDExtensionManager.LOAD_STATUS_OK:
		print("the engine did not load the library: status %d" % status)
		get_tree().quit(1)
		return
	_name_classes()
	_continue.call_deferred(OS.get_cmdline_user_args()[0])


## Makes the library's classes known to GDScript by name. Otherwise, it would know them as types only, because it lists all classes before
## the first script runs.
func _name_classes() -> void:
	JavaScriptBridge.eval("initLanguage('%d')" % Engine.get_script_language(0).get_instance_id())


func _continue(path: String) -> void:
	var tree := get_tree()
	tree.set_script(load(path))
	tree.call("_initialize")
