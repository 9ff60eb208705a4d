extends "harness.gd"
## Base class for the tests of the ground classes.

func all_transforms(scatter: TerrainScatter3D, layer := 0) -> Array[Transform3D]:
	var result: Array[Transform3D] = []
	for tile: Vector2i in scatter.get_shown_tiles(scatter.layers[layer]):
		result.append_array(transforms(scatter, layer, tile))
	return result


## Returns {ID: position} for all instances of a layer, to compare scatters with different tile sizes. Positions are snapped to 2 mm.
## Buffers store them relative to a tile's center, so rounding depends on the tile.
func by_id(scatter: TerrainScatter3D, layer := 0) -> Dictionary:
	var result := {}
	for tile: Vector2i in scatter.get_shown_tiles(scatter.layers[layer]):
		var ids: Array[int] = []
		for of_mesh: PackedInt64Array in tile_ids(scatter, layer, tile):
			ids.append_array(Array(of_mesh))
		var stand := transforms(scatter, layer, tile)
		for index in ids.size():
			result[ids[index]] = stand[index].origin.snapped(Vector3.ONE * 0.002)
	return result


## Checks that large and small tiles place the same instances on a ground, within the area that both show.
func check_tiling(terrain: ScatterGround, context: String) -> void:
	var found: Array[Dictionary] = []
	for tile_size: float in [32.0, 13.0]:
		var layer := make_layer()
		layer.tile_size = tile_size
		layer.layer_id = 3
		layer.view_distance = 60.0
		layer.max_slope_degrees = 25.0
		var scatter := make_scatter([layer], terrain, make_viewer())
		await settle(scatter)
		found.push_back(by_id(scatter))
		scatter.free()
	var compared := 0
	for one in 2:
		var others := found[1 - one]
		for id: int in found[one]:
			var at: Vector3 = found[one][id]
			if Vector2(at.x, at.z).length() < 60.0:
				compared += 1
				check(others.has(id) and at.distance_to(others[id]) < 0.005, "%s: instance %d at %s" % [context, id, at])
	check(compared > 300, "%s: %d instances compared" % [context, compared])


## Returns the entries of `all` whose keys are in `some`.
func shared(all: Dictionary, some: Dictionary) -> Dictionary:
	var result := {}
	for key: Variant in some:
		if all.has(key):
			result[key] = all[key]
	return result


## Runs `edit`, waits until the scatter settles, and returns the tiles that were shown during that time.
func regenerated_by(scatter: TerrainScatter3D, edit: Callable) -> Array[Vector2i]:
	var made: Array[Vector2i] = []
	var note := func(_layer: ScatterLayer, tile: Vector2i) -> void: made.push_back(tile)
	scatter.tile_shown.connect(note)
	@warning_ignore("redundant_await")
	await edit.call()
	await settle(scatter)
	scatter.tile_shown.disconnect(note)
	return made


## Makes a scatter on the ground that `node` provides. Adds both to the tree.
func make_on(node: Node, thread_safe := false, layer := make_layer()) -> TerrainScatter3D:
	if not node.is_inside_tree():
		root.add_child(node)
	var terrain := ScatterGroundNode.new()
	terrain.thread_safe = thread_safe
	var scatter := make_scatter([layer], terrain, make_viewer())
	terrain.node = scatter.get_path_to(node)
	return scatter


## Runs `edit` and checks that exactly the visible tiles in `under` were regenerated. If `any` is true, at least one tile must have been
## regenerated.
func check_regenerated_under(scatter: TerrainScatter3D, under: Array[Vector2i], any: bool, context: String, edit: Callable) -> void:
	var regenerated_tiles := await regenerated_by(scatter, edit)
	var visible_tiles := scatter.get_shown_tiles(scatter.layers[0])
	for tile in under:
		check(regenerated_tiles.has(tile) or not visible_tiles.has(tile), "%s: tile %s was regenerated" % [context, tile])
	for tile in regenerated_tiles:
		check(under.has(tile), "%s: tile %s was regenerated unnecessarily" % [context, tile])
	check(not regenerated_tiles.is_empty() or not any, "%s: %d tiles were regenerated" % [context, regenerated_tiles.size()])
