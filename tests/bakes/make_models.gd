extends SceneTree
## Saves the mesh that a small bake has of its own. Arguments: the path.


func _initialize() -> void:
	var tuft := SphereMesh.new()
	tuft.radius = 0.25
	ResourceSaver.save(tuft, OS.get_cmdline_user_args()[0])
	quit()
