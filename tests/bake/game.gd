extends SceneTree
## Runs the world as a game does, with a player who walks through it. Writes the rows of every visible tile into the file that the first argument
## names. Each entry has the layer, x, y and the size of the rows, as 32-bit integers, and then the rows.


func _initialize() -> void:
	var world: Node3D = load("res://world.tscn").instantiate()
	root.add_child(world)
	var scatter: TerrainScatter3D = world.get_node("Scatter")
	var player := Node3D.new()
	world.add_child(player)
	scatter.viewers = [scatter.get_path_to(player)]
	for step in 4:
		player.position = Vector3(100.0 - 30.0 * step, 0.0, 20.0 * step)
		for frame in 5:
			await process_frame
	while not scatter.is_settled():
		await process_frame
	var file := FileAccess.open(OS.get_cmdline_user_args()[0], FileAccess.WRITE)
	for layer in 2:
		for tile in scatter.get_shown_tiles(scatter.layers[layer]):
			var rows := scatter.get_tile(scatter.layers[layer], tile).get_rows()
			for number: int in [layer, tile.x, tile.y, rows.size()]:
				file.store_32(number)
			file.store_buffer(rows)
	file.close()
	quit()
