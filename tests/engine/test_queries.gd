extends "queries_harness.gd"
## Tests that queries return the same instances as a scan of generated tiles, whichever tiles are loaded.


func test_queries_match_a_scan() -> void:
	var random := RandomNumberGenerator.new()
	random.seed = 4
	var viewer := make_viewer(Vector3(5000, 0, 0))
	var scatter := make_wood(viewer)
	var all := scan(scatter)
	check(all.ids.size() > 4000, "%d instances" % all.ids.size())
	check_all(scatter, all, random, "nothing loaded")
	viewer.global_position = Vector3.ZERO
	await settle(scatter)
	check(scatter.get_shown_tiles(scatter.layers[0]).size() > 8, "tiles are loaded")
	check_all(scatter, all, random, "loaded")
	viewer.global_position = Vector3(0, 0, -9000)
	await settle(scatter)
	check_all(scatter, all, random, "dropped")
	scatter.regenerate()
	viewer.global_position = Vector3(20, 0, 5)
	await settle(scatter)
	check_all(scatter, all, random, "loaded again")
	var gone := PackedInt64Array()
	for index in range(0, all.ids.size(), 3):
		gone.push_back(all.ids[index])
		scatter.remove_instance(all.ids[index])
	all = all.without(gone)
	check_all(scatter, all, random, "a third removed")
	check(scatter.get_instance(gone[5]) == null and not scatter.has_instance(gone[6]), "get_instance does not find them either")
	for index in 20:
		var at := Transform3D(Basis.from_euler(Vector3(0.3, index, 0.1)).scaled(Vector3.ONE * 1.5),
				Vector3(random.randf_range(-40, 40), random.randf_range(0, 15), random.randf_range(-40, 40)))
		all.ids.push_back(scatter.add_instance(scatter.layers[0], at, 1))
		all.layers.push_back(0)
		all.meshes.push_back(1)
		all.transforms.push_back(at)
	for index in 20:
		var at := all.transforms[-1 - index]
		check_ray(scatter, all, at * Vector3(5, 3, 1), at * Vector3(-5, 3, -1), [])
	var found: PackedInt64Array = scatter.query_rect(Rect2(-60, -60, 120, 120), scatter.layers[0]).ids
	check(Array(all.ids.slice(-20)).all(func(id: int) -> bool: return found.has(id)), "queries find the hand-placed instances")


func test_a_server_without_viewers_returns_the_same() -> void:
	var scatter := make_wood(make_viewer())
	await settle(scatter)
	var server := make_wood(make_viewer())
	server.viewers = []
	check(server.get_shown_tiles(server.layers[0]).is_empty(), "no tiles are loaded")
	for rect: Rect2 in [Rect2(-20, -20, 40, 40), Rect2(3e4, -7e5, 30, 30)]:
		var answer := scatter.query_rect(rect)
		check(answer.size() > 200, "%d instances in %s" % [answer.size(), rect])
		check(content_of(answer) == content_of(server.query_rect(rect)), "the same in %s" % rect)
	await frames(10)
	check(server.get_shown_tiles(server.layers[0]).is_empty(), "no tile was shown for a query")
	var outsider := TerrainScatter3D.new()
	outsider.seed = scatter.seed
	outsider.layers = scatter.layers
	outsider.ground = scatter.ground
	check(content_of(outsider.query_sphere(Vector3.ZERO, 20.0)) == content_of(scatter.query_sphere(Vector3.ZERO, 20.0)),
			"outside of the tree")
	outsider.free()


func test_predicates_are_called_only_for_results() -> void:
	var scatter := make_wood(make_viewer())
	var queried := PackedInt64Array()
	var odd := func(id: int, layer: ScatterLayer, at: Transform3D) -> bool:
		queried.push_back(id)
		check(layer == scatter.layers[0] and at == scatter.get_instance(id).transform, "arguments of the predicate for %d" % id)
		return id % 2 == 1
	var rect := Rect2(-20, -20, 40, 40)
	var all: PackedInt64Array = scatter.query_rect(rect, scatter.layers[0]).ids
	var found: PackedInt64Array = scatter.query_rect(rect, scatter.layers[0], odd).ids
	check(queried == all and all.size() > 30, "the predicate is called once per result, in order")
	var accepted := Array(all).filter(func(id: int) -> bool: return id % 2 == 1)
	check(found == PackedInt64Array(accepted), "only accepted results")
	queried.clear()
	var nearest := scatter.query_nearest(Vector3(3, 5, 4), 40.0, scatter.layers[0], odd)
	check(nearest.id == queried[-1] and nearest.id % 2 == 1, "query_nearest calls the predicate until it accepts")
	var distances: Array = Array(queried).map(func(id: int) -> float:
		return scatter.get_instance(id).position.distance_to(Vector3(3, 5, 4)))
	var sorted := distances.duplicate()
	sorted.sort()
	check(distances == sorted, "query_nearest calls the predicate by distance")
	var removed := scatter.remove_in_sphere(Vector3.ZERO, 15.0, scatter.layers[0], odd)
	check(removed.size() > 3 and Array(removed).all(func(id: int) -> bool: return id % 2 == 1), "removed instances")
	check(not scatter.has_instance(removed[0]), "the instance is removed")
	scatter.query_rect(rect, scatter.layers[0], func(_id: int) -> bool: return true)
	check_error(["TerrainScatter3D.query_rect", "predicate"], "too few parameters")
	scatter.query_rect(rect, scatter.layers[0], func(_id: int, _layer: ScatterLayer, _at: Transform3D) -> int: return 1)
	check_error(["predicate", "bool"], "a result that is not a bool")


func test_workers_complete_requests() -> void:
	var scatter := make_wood(make_viewer())
	scatter.viewers = []
	await frames(2)
	var rect := Rect2(900, -40, 70, 90)
	var first := scatter.request_rect(rect)
	var second := scatter.request_sphere(Vector3(-2000, 0, 0), 40.0, scatter.layers[1])
	var third := scatter.request_rect(Rect2(3000, 3000, 60, 60))
	var completed := {}
	for request: ScatterRequest in [first, second, third]:
		var number := request.get_instance_id()
		request.completed.connect(func(result: ScatterInstances) -> void: completed[number] = result)
	check(not first.is_completed() and first.get_result().is_empty(), "not completed immediately")
	check(third.cancel(), "one request is canceled")
	check(not third.cancel() and third.is_canceled() and third.is_completed(), "a request can be canceled only once")
	check(completed.is_empty(), "no immediate signal")
	await until(func() -> bool: return completed.size() == 3, "all requests are completed")
	await frames(10)
	check(third.get_result().is_empty() and completed[third.get_instance_id()].is_empty(), "a canceled request has no result")
	check(first.is_completed() and not first.is_canceled() and not first.cancel(), "a completed request cannot be canceled")
	check(completed[first.get_instance_id()] == first.get_result(), "the result is kept")
	check(content_of(first.get_result()) == content_of(scatter.query_rect(rect)), "the same as a direct query")
	check(content_of(second.get_result()) == content_of(scatter.query_sphere(Vector3(-2000, 0, 0), 40.0, scatter.layers[1])), "the sphere request returns the same as a direct query")
	check(first.get_result().size() > 1000, "the request returns many instances")
	check(scatter.get_shown_tiles(scatter.layers[0]).is_empty(), "no tile was shown")
	var id := first.get_result().get_id(7)
	var fourth := scatter.request_rect(rect)
	scatter.remove_instance(id)
	var warm: ScatterInstances = await fourth.completed
	check(warm.size() == first.get_result().size() - 1 and not warm.ids.has(id), "an instance that was removed in between is missing")
	var awaited: ScatterInstances = await scatter.request_sphere(Vector3(100, 0, 0), 20.0).completed
	check(content_of(awaited) == content_of(scatter.query_sphere(Vector3(100, 0, 0), 20.0)), "an awaited request returns the same as a direct query")


func test_every_request_is_completed() -> void:
	var scatter := make_wood(make_viewer())
	await frames(2)
	var far := Rect2(5000, 5000, 300, 300)
	check((await scatter.request_rect(Rect2(0, 0, -1, 1)).completed).is_empty(), "a rejected request")
	check_error(["request_rect", "rect"], "a rejected request")
	check((await scatter.request_sphere(Vector3.ZERO, 5.0, "nothing").completed).is_empty(), "a request for a missing layer")
	check_error(["request_sphere", "nothing"], "a request for a missing layer")
	var canceled := scatter.request_rect(far)
	canceled.cancel()
	check((await canceled.completed).is_empty(), "a canceled request")
	for action: Callable in [
			func() -> void: root.remove_child(scatter),
			func() -> void: root.add_child(scatter),
			func() -> void: scatter.ground = null,
			func() -> void: scatter.free()]:
		if scatter.ground == null:
			scatter.ground = ScatterGroundFlat.new()
		var left := [false]
		scatter.request_rect(far).completed.connect(func(_found: ScatterInstances) -> void: left[0] = true)
		action.call()
		await until(func() -> bool: return left[0], "a request whose node left or changed")
	await frames(2)


func test_requests_take_a_predicate() -> void:
	var scatter := make_wood(make_viewer())
	var rect := Rect2(900, -300, 80, 80)
	var accept := func(id: int, layer: ScatterLayer, at: Transform3D) -> bool: return id % 2 == 0 and (layer == scatter.layers[1] or at.origin.x > 940.0)
	var found: ScatterInstances = await scatter.request_rect(rect, [], accept).completed
	check(found.size() > 20, "%d are accepted" % found.size())
	check(content_of(found) == content_of(scatter.query_rect(rect, [], accept)), "the same as query_rect")
	var near: ScatterInstances = await scatter.request_sphere(Vector3(-900, 0, 0), 30.0, scatter.layers[0], accept).completed
	check(content_of(near) == content_of(scatter.query_sphere(Vector3(-900, 0, 0), 30.0, scatter.layers[0], accept)), "the same as query_sphere")
	check((await scatter.request_rect(rect, [], func(_id: int) -> bool: return true).completed).is_empty(), "a predicate that cannot be called")
	check_error(["TerrainScatter3D.request_rect", "predicate must take"], "a predicate that cannot be called")
	# The predicate may free the node.
	var calls := [0]
	var freeing := func(_id: int, _layer: ScatterLayer, _at: Transform3D) -> bool:
		calls[0] += 1
		if calls[0] == 3:
			scatter.queue_free()
		return true
	var last: ScatterInstances = await scatter.request_rect(rect, [], freeing).completed
	check_equal(last.size(), calls[0], "all calls before the node was freed")
	await frames(2)
	check(not is_instance_valid(scatter), "the node is freed")


func test_requests_ignore_tiles_of_an_old_size() -> void:
	var scatter := make_wood(make_viewer())
	scatter.viewers = []
	await frames(2)
	for turn in 12:
		var rect := Rect2(-100, -100, 200, 200) # Tiles of both sizes use the same tile coordinates here.
		var request := scatter.request_rect(rect, scatter.layers[0])
		await frames(1 + turn % 4) # Wait until workers have started.
		scatter.layers[0].tile_size = 24.0 if turn % 2 == 0 else 40.0
		await until(request.is_completed, "the request is completed")
		var expected := PackedInt64Array()
		for ids: PackedInt64Array in ids_of(scatter.build_rect(scatter.layers[0], rect)):
			expected.append_array(ids)
		var got := request.get_result().ids
		got.sort()
		expected.sort()
		check(got == expected, "turn %d: %d instances, %d expected" % [turn, got.size(), expected.size()])


func test_layers_by_name_and_reference() -> void:
	var scatter := make_wood(make_viewer())
	scatter.layers[1].resource_name = "ferns"
	var rect := Rect2(-30, -30, 60, 60)
	var trees := content_of(scatter.query_rect(rect, scatter.layers[0]))
	var ferns := content_of(scatter.query_rect(rect, scatter.layers[1]))
	var both := content_of(scatter.query_rect(rect))
	check(trees != ferns and both != ferns, "three different results")
	for reference: Variant in [
			"trees", &"trees", scatter.layers[0], ["trees"], [scatter.layers[0]], PackedStringArray(["trees"])]:
		check(content_of(scatter.query_rect(rect, reference)) == trees, "trees as %s" % [reference])
	for references: Variant in [scatter.layers, ["ferns", scatter.layers[0]], [scatter.layers[1], "trees", "ferns"], []]:
		check(content_of(scatter.query_rect(rect, references)) == both, "both as %s" % [references])
	var at := Transform3D(Basis(), Vector3(1, 20, 1))
	var id := scatter.add_instance("ferns", at)
	check_equal(scatter.get_instance(id).layer, scatter.layers[1], "a hand-placed fern")
	check_equal(scatter.query_nearest(at.origin, 2.0, "ferns").id, id, "the hand-placed fern is the nearest")
	check(scatter.query_nearest(at.origin, 2.0, "trees") == null, "no tree")
	check_equal(scatter.remove_in_sphere(at.origin, 2.0, scatter.layers[1]).size(), 1, "one fern is removed")
	for wrong: Variant in ["oaks", "", 0, -1, null, 0.5, ["trees", "oaks"], ["trees", 1], PackedInt32Array([0]), ScatterLayer.new(), Node]:
		check(scatter.query_rect(rect, wrong).is_empty(), "no layer %s" % [wrong])
		check_error(["TerrainScatter3D.query_rect", "ayer"], "no layer %s" % [wrong])
	check_equal(scatter.add_instance("oaks", at), 0, "a missing layer")
	check_error(["TerrainScatter3D.add_instance", "\"oaks\""], "a missing layer")


func test_invalid_queries_are_rejected() -> void:
	var scatter := make_wood(make_viewer())
	for rect: Rect2 in [Rect2(0, 0, -5, 5), Rect2(0, NAN, 5, 5), Rect2(0, 0, INF, 5), Rect2(-1e6, -1e6, 2e6, 2e6)]:
		check(scatter.query_rect(rect).is_empty(), "nothing in %s" % rect)
		check_error(["TerrainScatter3D.query_rect", "rect"], str(rect))
		scatter.request_rect(rect)
		check_error(["TerrainScatter3D.request_rect", "rect"], str(rect))
	scatter.query_sphere(Vector3(0, NAN, 0), 5.0)
	check_error(["TerrainScatter3D.query_sphere", "center", "finite"], "a center that is not finite")
	scatter.query_sphere(Vector3.ZERO, -5.0)
	check_error(["TerrainScatter3D.query_sphere", "radius", "-5"], "a negative radius")
	check(scatter.query_ray(Vector3(INF, 0, 0), Vector3.ZERO) == null, "a start that is not finite")
	check_error(["TerrainScatter3D.query_ray", "from"], "a start that is not finite")
	check(scatter.query_ray(Vector3.ZERO, Vector3(0, 0, 1e9)) == null, "too long")
	check_error(["TerrainScatter3D.query_ray", "to", "too many"], "a ray that is too long")
	check(scatter.query_nearest(Vector3.ZERO, NAN) == null, "an invalid distance")
	check_error(["TerrainScatter3D.query_nearest", "max_distance"], "an invalid distance")
	for id: int in [0, 1, -1, 1 << 62, -(1 << 63), (1 << 63) - 1]:
		check(scatter.get_instance(id) == null and not scatter.has_instance(id), "no instance has the id %d" % id)
	check_no_error("invalid ids")
	scatter.ground = null
	check(scatter.query_rect(Rect2(0, 0, 5, 5)).is_empty(), "no ground")
	check_error(["TerrainScatter3D.query_rect", "ground", "missing"], "no ground")
	await frames(1)
