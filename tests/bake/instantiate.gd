extends SceneTree
## Instantiates the scene that the first argument names, then frees it.


func _initialize() -> void:
	(load(OS.get_cmdline_user_args()[0]) as PackedScene).instantiate().free()
	quit()
