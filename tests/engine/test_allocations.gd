extends "queries_harness.gd"
## Repeats calls while one large allocation after another fails. tests/engine/test_allocations.py preloads a library that makes them fail.
## Each call must return its usual result or print an error, and the next call must work as before. Small allocations are excluded,
## because the engine crashes when one fails.

const LARGE := 1000 ## The minimum size in bytes of an allocation that may fail.
const MOST := 400   ## The maximum number of allocations per call that fail in turn.


## Calls `work` once for each of its allocations of at least `bytes`, with that allocation failing. `work` must return the same value each time.
func sweep(context: String, work: Callable, bytes := LARGE) -> void:
	var expected: Variant = work.call()
	check_no_error(context)
	var failed := 0
	for number in range(1, MOST + 1):
		OS.set_environment("THICKET_ALLOCATIONS", "fail %d %d" % [number, bytes])
		var got: Variant = work.call()
		OS.set_environment("THICKET_ALLOCATIONS", "stop")
		var messages := errors.take()
		if messages.is_empty():
			check(got == expected, "%s: allocation %d fails silently" % [context, number])
			if number > failed + 8:
				break # The call has no more allocations.
		else:
			failed = number
	check(failed > 0, context + ": no allocation failed")
	check(OS.get_environment("THICKET_ALLOCATIONS") == "", "the library that makes allocations fail is preloaded")
	check(work.call() == expected, context + ": works as before")
	check_no_error(context + ", afterwards")


func test_answers_of_queries() -> void:
	var scatter := make_wood(make_viewer())
	await settle(scatter)
	var all := Rect2(-60, -60, 120, 120)
	sweep("ids", func() -> PackedInt64Array: return scatter.query_rect(all).ids)
	sweep("layers", func() -> PackedInt32Array: return scatter.query_rect(all).layer_indices)
	sweep("positions", func() -> PackedVector3Array: return scatter.query_rect(all).positions)
	sweep("transforms", func() -> PackedFloat32Array: return scatter.query_rect(all).transforms)
	var found := scatter.query_rect(all)
	OS.set_environment("THICKET_ALLOCATIONS", "fail 1 %d" % LARGE)
	check(found.transforms.is_empty(), "no transforms without memory")
	OS.set_environment("THICKET_ALLOCATIONS", "stop")
	check_memory_error("ScatterInstances.get_transforms")
	check(found.transforms.size() == 12 * found.size(), "the same result returns them later")


func test_tiles() -> void:
	var scatter := make_wood(make_viewer())
	await settle(scatter)
	sweep("a tile's ids", func() -> Array: return ids_of(scatter.get_tile(scatter.layers[1], Vector2i(0, 0))))
	sweep("a built area", func() -> Array:
		var built := scatter.build_rect(scatter.layers[1], Rect2(0, 0, 30, 30))
		return [ids_of(built), buffers_of(built)] if built != null else [])


func test_masks() -> void:
	var mask := ScatterMask.new()
	mask.set_pixels(Rect2i(0, 0, 64, 64), noise(64 * 64))
	sweep("a mask's data", func() -> PackedByteArray: return mask.data)
	sweep("a mask's pixels", func() -> PackedByteArray: return mask.get_pixels(Rect2i(0, 0, 64, 64)))


func test_states() -> void:
	var scatter := make_wood(make_viewer())
	scatter.state = ScatterState.new()
	scatter.state.copy_at_runtime = true
	await settle(scatter)
	var ids := scatter.query_rect(Rect2(-40, -40, 80, 80)).ids
	scatter.remove_instances(ids)
	sweep("removed ids", func() -> PackedInt64Array: return scatter.state.get_removed())
	sweep("bytes", func() -> bool: return scatter.state.to_bytes().size() > 1000)
	sweep("removal", func() -> int:
		for id in ids:
			scatter.state.restore(id)
		return scatter.remove_instances(ids).size())
	var data := PackedByteArray()
	data.resize(3000)
	# Test only the write, because the engine crashes if an allocation fails while it reads.
	sweep("data of an instance", func() -> bool: return scatter.state.set_instance_data(ids[0], data))


func test_samplers() -> void:
	var sampler := PoissonSampler.new()
	var rect := Rect2(0, 0, 30, 30)
	sweep("points", func() -> Array:
		var points := sampler.sample(rect)
		return [points.ids, points.ranks, points.positions])
	sweep("exact points", func() -> Array:
		var points := sampler.sample_exact(0, 0, 30, 30)
		return [points.x, points.y, points.positions])
	sampler.method = PoissonSampler.METHOD_HIERARCHICAL
	sweep("a domain", func() -> PackedVector2Array: return sampler.sample_domain(rect))
	sweep("an exact domain", func() -> PackedFloat64Array: return sampler.sample_domain_exact(0, 0, 30, 30).y)


## If a change runs out of memory, the next frame retries it. The test uses 100 layers so that lists of layers are large allocations.
## Tiles that cannot be generated are reported and remain unchanged.
func test_changes_to_layers() -> void:
	var layers: Array[ScatterLayer] = []
	for index in 100:
		layers.push_back(make_layer(12.0))
		layers.back().layer_id = index + 1
		layers.back().view_distance = 20.0
	var scatter := make_scatter(layers, ScatterGroundFlat.new(), make_viewer())
	var expected := []
	for density: float in [0.3, 0.8]:
		layers[7].density = density
		await settle(scatter)
		expected.push_back(ids_of_shown(scatter, 7))
	check(expected[0] != expected[1] and not expected[0].is_empty(), "the two densities differ")
	check_no_error("without failures")
	var hits := 0
	for number in range(1, 60):
		layers[7].density = [0.3, 0.8][number % 2]
		OS.set_environment("THICKET_ALLOCATIONS", "fail %d %d" % [number, LARGE])
		await frames(2)
		OS.set_environment("THICKET_ALLOCATIONS", "stop")
		await settle(scatter)
		var reported := "".join(errors.take())
		hits += int(reported != "")
		check("tile (" in reported or ids_of_shown(scatter, 7) == expected[number % 2], "allocation %d: the change is applied" % number)
	check(hits > 5, "%d allocations failed" % hits)


func ids_of_shown(scatter: TerrainScatter3D, layer: int) -> Array:
	var ids := []
	for tile in scatter.get_shown_tiles(scatter.layers[layer]):
		ids.append_array(ids_of(scatter.get_tile(scatter.layers[layer], tile)))
	return ids


## Allocations fail on worker threads. Tiles that cannot be generated are reported, and all uploaded tiles are complete.
func test_streaming() -> void:
	var expected := await stream(0)
	check_no_error("a stream")
	var hits := 0
	for number in range(1, 200, 3):
		var got := await stream(number)
		var messages := errors.take()
		hits += int(not messages.is_empty())
		for layer in expected.size():
			for tile: Vector2i in got[layer]:
				var whole: bool = got[layer][tile] == expected[layer][tile]
				check(whole or (got[layer][tile] == [] and not messages.is_empty()), "allocation %d: tile %s is complete" % [number, tile])
			check(got[layer].size() == expected[layer].size() or not messages.is_empty(), "allocation %d fails silently" % number)
	check(hits > 20, "%d allocations failed" % hits)


## Streams a wood, and lets the worker allocation with this number fail (none for 0). Returns the visible tiles by layer, with the
## renderer's data.
func stream(number: int) -> Array:
	var viewer := make_viewer()
	var scatter := make_wood(viewer)
	if number > 0:
		OS.set_environment("THICKET_ALLOCATIONS", "worker %d %d" % [number, LARGE])
	await settle(scatter)
	OS.set_environment("THICKET_ALLOCATIONS", "stop")
	var result := []
	for layer in scatter.layers.size():
		var tiles := {}
		for tile in scatter.get_shown_tiles(scatter.layers[layer]):
			var displayed_tile := scatter.get_tile(scatter.layers[layer], tile)
			tiles[tile] = [ids_of(displayed_tile), buffers_of(displayed_tile)] if displayed_tile.get_mesh_count() > 0 else []
		result.push_back(tiles)
	scatter.free()
	viewer.free()
	return result


func noise(count: int) -> PackedByteArray:
	var random := RandomNumberGenerator.new()
	random.seed = 1
	var bytes := PackedByteArray()
	for index in count:
		bytes.push_back(random.randi_range(0, 255))
	return bytes


func check_memory_error(source: String) -> void:
	var messages := Array(errors.take()).filter(func(message: String) -> bool: return "more memory than is available" in message)
	check(messages.size() == 1 and source in messages[0], "%s: one error, got %s" % [source, messages])
