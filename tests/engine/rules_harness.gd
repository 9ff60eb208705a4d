extends "harness.gd"
## Base class for the tests of a layer's rules. Provides a ground with many heights and slopes, and the instances on it by ID.

const SIDE := 65


## Returns a ground that rises with x, with heights from 0 to 400 m and slopes from 0 to 63 degrees.
func hillside() -> ScatterGroundHeightmap:
	var image := Image.create_empty(SIDE, SIDE, false, Image.FORMAT_RF)
	for x in SIDE:
		for z in SIDE:
			image.set_pixel(x, z, Color(pow(x / (SIDE - 1.0), 2.0), 0.0, 0.0))
	var terrain := ScatterGroundHeightmap.new()
	terrain.image = image
	terrain.rect = Rect2(-200, -200, 400, 400)
	terrain.max_height = 400.0
	return terrain


## Scatters a layer on the ground that `hillside` returns. Progressive levels keep its points evenly spread at densities below 1.
func scatter_on_hillside(layer: ScatterLayer) -> TerrainScatter3D:
	layer.progressive_levels = 3
	return make_scatter([layer], hillside(), make_viewer(Vector3(0, 0, 20)))


## Returns the visible instances of a layer, as {ID: [world transform, the floats that follow the transform in the buffer]}.
func instances(scatter: TerrainScatter3D, layer := 0) -> Dictionary:
	var result := {}
	for tile: Vector2i in scatter.get_shown_tiles(scatter.layers[layer]):
		var origin := scatter.get_tile(scatter.layers[layer], tile).get_origin()
		var buffers := tile_buffers(scatter, layer, tile)
		var all_ids := tile_ids(scatter, layer, tile)
		for mesh in buffers.size():
			var buffer: PackedFloat32Array = buffers[mesh]
			var ids: PackedInt64Array = all_ids[mesh]
			var stride := buffer.size() / maxi(ids.size(), 1)
			for index in ids.size():
				var at := index * stride
				var transform := Transform3D(
						Vector3(buffer[at], buffer[at + 4], buffer[at + 8]),
						Vector3(buffer[at + 1], buffer[at + 5], buffer[at + 9]),
						Vector3(buffer[at + 2], buffer[at + 6], buffer[at + 10]),
						origin + Vector3(buffer[at + 3], buffer[at + 7], buffer[at + 11]))
				result[ids[index]] = [transform, buffer.slice(at + 12, at + stride)]
	return result


## Checks that `after` contains the instances of `before` thinned by `density`, a function of the position. No instance may be new or moved.
## No instance may remain where the density is 0, and all must remain where it is 1. The count must match the sum of the densities within
## five standard deviations.
func check_filtered(before: Dictionary, after: Dictionary, density: Callable, context: String) -> void:
	var expected := 0.0
	var variance := 0.0
	var wrong := 0
	for id: int in before:
		var placed: Transform3D = before[id][0]
		var share: float = clampf(density.call(placed.origin), 0.0, 1.0)
		expected += share
		variance += share * (1.0 - share)
		var stands := after.has(id)
		if (stands and after[id][0] != placed) or (stands and share <= 0.0) or (not stands and share >= 1.0):
			wrong += 1
	check_equal(wrong, 0, "%s: moved, or wrongly kept or removed, of %d" % [context, before.size()])
	check(before.has_all(after.keys()), context + ": nothing new")
	check(absf(after.size() - expected) <= 5.0 * sqrt(variance) + 1.0, "%s: %d remain, %.1f expected" % [context, after.size(), expected])
	check(after.size() > 100 and after.size() < before.size(), "%s: %d of %d" % [context, after.size(), before.size()])


## Sets one property and checks the result. Then resets it and checks that the initial instances are back.
func check_rule(scatter: TerrainScatter3D, property: String, value: Variant, density: Callable) -> void:
	var layer := scatter.layers[0]
	var before := instances(scatter)
	var old: Variant = layer.get(property)
	layer.set(property, value)
	await settle(scatter)
	check_filtered(before, instances(scatter), density, property)
	layer.set(property, old)
	await settle(scatter)
	check(instances(scatter) == before, property + " reset: as before")


## Runs `edit`, waits until the scatter settles, and returns how often each tile was shown, as {[layer index, tile]: count}.
func shown_by(scatter: TerrainScatter3D, edit: Callable) -> Dictionary:
	var shown := {}
	var count := func(shown_layer: ScatterLayer, tile: Vector2i) -> void:
		var layer := scatter.layers.find(shown_layer)
		shown[[layer, tile]] = shown.get([layer, tile], 0) + 1
	scatter.tile_shown.connect(count)
	edit.call()
	await settle(scatter)
	scatter.tile_shown.disconnect(count)
	return shown
