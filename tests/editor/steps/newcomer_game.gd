extends SceneTree
## Plays the scene that newcomer.gd has saved, prints the number of visible trees, and takes a screenshot. The argument is its file.

const SIZE := Vector2i(1280, 720)


func _initialize() -> void:
	_play.call_deferred()


func _play() -> void:
	root.size = SIZE
	var scene := (load("res://node_3d.tscn") as PackedScene).instantiate()
	root.add_child(scene)
	var scatter := scene.get_node("Scatter") as Node3D
	RenderingServer.render_loop_enabled = false # Software rendering would leave too little time for streaming.
	for frame in 3:
		await process_frame
	while not scatter.is_settled():
		await process_frame
	for frame in 2:
		RenderingServer.force_draw()
	root.get_texture().get_image().save_png(OS.get_cmdline_user_args()[0])
	print("newcomer: %d trees in the game" % scatter.get_shown_count(scatter.layers[0]))
	RenderingServer.render_loop_enabled = true # A process that draws nothing might not quit.
	quit()
