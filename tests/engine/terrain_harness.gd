extends "harness.gd"
## What the tests of the kinds of ground share.

func all_transforms(scatter: TerrainScatter3D, layer := 0) -> Array[Transform3D]:
	var result: Array[Transform3D] = []
	for tile: Vector2i in scatter.get_shown_tiles(layer):
		result.append_array(transforms(scatter, layer, tile))
	return result


## All instances of a layer by their ids, for comparing scatters of other tile sizes. Positions to the millimeter: a
## tile's own floats count from its center.
func by_id(scatter: TerrainScatter3D, layer := 0) -> Dictionary:
	var result := {}
	for tile: Vector2i in scatter.get_shown_tiles(layer):
		var ids: Array[int] = []
		for of_mesh: PackedInt64Array in tile_ids(scatter, layer, tile):
			ids.append_array(Array(of_mesh))
		var stand := transforms(scatter, layer, tile)
		for index in ids.size():
			result[ids[index]] = stand[index].origin.snapped(Vector3.ONE * 0.002)
	return result


## The same instances stand on a ground whether tiles are large or small, as far as both show them.
func check_tiling(terrain: ScatterGround, what: String) -> void:
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
				check(others.has(id) and at.distance_to(others[id]) < 0.005, "%s: instance %d at %s" % [what, id, at])
	check(compared > 300, "%s: %d instances compared" % [what, compared])


## The entries of `all` whose keys are in `some`.
func shared(all: Dictionary, some: Dictionary) -> Dictionary:
	var result := {}
	for key: Variant in some:
		if all.has(key):
			result[key] = all[key]
	return result


## Tiles that were made since the scatter was settled, once it is again.
func made_again(scatter: TerrainScatter3D, edit: Callable) -> Array[Vector2i]:
	var made: Array[Vector2i] = []
	var note := func(_layer: int, tile: Vector2i) -> void: made.push_back(tile)
	scatter.tile_shown.connect(note)
	@warning_ignore("redundant_await")
	await edit.call()
	await settle(scatter)
	scatter.tile_shown.disconnect(note)
	return made


## A scatter on the ground that a node gives, both in the tree.
func make_on(node: Node, thread_safe := false, layer := make_layer()) -> TerrainScatter3D:
	if not node.is_inside_tree():
		root.add_child(node)
	var terrain := ScatterGroundNode.new()
	terrain.thread_safe = thread_safe
	var scatter := make_scatter([layer], terrain, make_viewer())
	terrain.node = scatter.get_path_to(node)
	return scatter


## Makes an edit, and checks that the tiles `under` it were made again, as far as they are visible, and no others. `any`: at least one was.
func check_made_under(scatter: TerrainScatter3D, under: Array[Vector2i], any: bool, what: String, edit: Callable) -> void:
	var made := await made_again(scatter, edit)
	var shown := scatter.get_shown_tiles(0)
	for tile in under:
		check(made.has(tile) or not shown.has(tile), "%s: tile %s was made again" % [what, tile])
	for tile in made:
		check(under.has(tile), "%s: tile %s was made for nothing" % [what, tile])
	check(not made.is_empty() or not any, "%s: %d tiles were made" % [what, made.size()])
