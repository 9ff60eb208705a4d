extends SceneTree
## Prints how the add-on divides rectangles into tiles. Each argument is a case, as a JSON array: a rectangle, a tile
## size, and the tile size of a layer.

const BakeGrid := preload("res://addons/thicket/baking/bake_grid.gd")


func _initialize() -> void:
	for argument in OS.get_cmdline_user_args():
		var case: Array = JSON.parse_string(argument)
		var layers: Array[Dictionary] = [{"index": 0, "tile_size": case[2]}]
		var grid := BakeGrid.new(case[0], case[1], layers)
		var parts := {}
		for z in range(grid.tiles.position.y, grid.tiles.end.y):
			for x in range(grid.tiles.position.x, grid.tiles.end.x):
				parts["%d,%d" % [x, z]] = grid.parts_of(Vector2i(x, z))
		print("grid ", JSON.stringify(grid.description().merged({"parts": parts}), "", false, true))
	quit()
