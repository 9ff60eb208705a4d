@tool
extends RefCounted
## Tells the tests' plugin that the editor has read all scripts for its class reference. The editor reads the scripts in the project's own folder
## last, in the order of their names.


static func _static_init() -> void:
	Engine.set_meta(&"class_reference_is_read", true)
