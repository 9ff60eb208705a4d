@tool
extends RefCounted
## Signals to the tests' plugin that the editor has read all scripts for its class reference. The editor reads the scripts in the project's root
## folder last and in alphabetical order, so it reads this script after all others.


static func _static_init() -> void:
	Engine.set_meta(&"class_reference_is_read", true)
