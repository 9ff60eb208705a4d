extends "queries_harness.gd"
## Tests methods that take layers. They accept a layer or its name and reject everything else. Results, signals and predicates contain the
## layer itself.

const RECT := Rect2(-20, -20, 40, 40)
const HERE := Vector3(3, 0, 4)


## Returns a settled forest with the layers "trees" and "ferns".
func make_forest() -> TerrainScatter3D:
	var scatter := make_wood(make_viewer())
	scatter.layers[1].resource_name = "ferns"
	await settle(scatter)
	return scatter


func added(scatter: TerrainScatter3D, ids: PackedInt64Array) -> PackedInt64Array:
	scatter.remove_instances(ids)
	return ids


## Returns a callable for each method that takes one layer, by the method's name. Equal calls have equal results.
func calls_for_a_layer(scatter: TerrainScatter3D) -> Dictionary[String, Callable]:
	return {
		"get_shown_tiles": scatter.get_shown_tiles,
		"get_shown_count": scatter.get_shown_count,
		"get_tile": func(layer: Variant) -> int: return scatter.get_tile(layer, Vector2i.ZERO).get_digest(),
		"build_rect": func(layer: Variant) -> int: return scatter.build_rect(layer, RECT).get_digest(),
		"build_tile": func(layer: Variant) -> int: return scatter.build_tile(layer, Vector2i.ZERO).get_digest(),
		"get_density_map": func(layer: Variant) -> PackedFloat32Array: return scatter.get_density_map(layer, RECT, Vector2i(4, 4)),
		"get_rank_map": func(layer: Variant) -> PackedFloat32Array: return scatter.get_rank_map(layer, RECT, Vector2i(4, 4)),
		"add_instance": func(layer: Variant) -> PackedInt64Array:
			var id := scatter.add_instance(layer, Transform3D(Basis.IDENTITY, HERE))
			return added(scatter, [id] if id != 0 else []),
		"add_instances": func(layer: Variant) -> PackedInt64Array:
			return added(scatter, scatter.add_instances(layer, PackedFloat32Array([1, 0, 0, 3, 0, 1, 0, 0, 0, 0, 1, 4]))),
	}


## Returns a callable for each of the node's methods that take several layers, by the method's name.
func calls_for_layers(scatter: TerrainScatter3D) -> Dictionary[String, Callable]:
	var calls := queries_of(scatter)
	calls["remove_in_sphere"] = func(layers: Variant) -> PackedInt64Array:
		var ids := scatter.remove_in_sphere(HERE, 10.0, layers)
		for id in ids:
			scatter.restore_instance(id)
		return ids
	calls["explain_position"] = func(layers: Variant) -> Array:
		return scatter.explain_position(HERE, layers).map(func(one: ScatterExplanation) -> Array: return [one.layer, one.id])
	return calls


## Returns a callable for each query that both a node and its snapshot have.
func queries_of(target: Variant) -> Dictionary[String, Callable]:
	return {
		"query_rect": func(layers: Variant) -> PackedInt64Array: return target.query_rect(RECT, layers).ids,
		"query_sphere": func(layers: Variant) -> PackedInt64Array: return target.query_sphere(HERE, 10.0, layers).ids,
		"query_ray": func(layers: Variant) -> Array: return seen(target.query_ray(Vector3(-60, 1, -3), Vector3(60, 1, 8), layers)),
		"query_nearest": func(layers: Variant) -> Array: return seen(target.query_nearest(HERE, 30.0, layers)),
	}


func seen(instance: ScatterInstance) -> Array:
	return [instance.layer, instance.id] if instance != null else []


func finds(result: Variant) -> bool:
	return result != 0 if result is int else not result.is_empty()


## Returns values that do not refer to any layer, each with a part of its error message.
func refused() -> Array[Array]:
	var foreign := make_layer()
	var named := make_layer()
	named.resource_name = "larch"
	return [
		[0, "not the index 0"], [-1, "not the index -1"], ["larch", "No layer is named \"larch\": the names are \"trees\", \"ferns\""],
		["", "No layer is named \"\""], [foreign, "A ScatterLayer without a name is not in the list"],
		[named, "The ScatterLayer \"larch\" is not in the list"], [null, "a ScatterLayer or its name, not <null>"], [0.5, "not 0.5"],
	]


func test_methods_take_a_layer_or_its_name() -> void:
	var scatter := await make_forest()
	var ferns := scatter.layers[1]
	var calls := calls_for_a_layer(scatter)
	calls.merge(calls_for_layers(scatter))
	for method in calls:
		var expected: Variant = calls[method].call(ferns)
		check(finds(expected), "%s finds something" % method)
		for reference: Variant in ["ferns", &"ferns"]:
			check_equal(calls[method].call(reference), expected, "%s with a %s" % [method, type_string(typeof(reference))])
	for method in calls_for_layers(scatter):
		var both: Variant = calls[method].call([])
		for references: Variant in [scatter.layers, ["ferns", scatter.layers[0]], PackedStringArray(["trees", "ferns"]), ["trees", ferns, "ferns"]]:
			check_equal(in_order(calls[method].call(references)), in_order(both), "%s with %s" % [method, references])
	check_no_error("layers and their names")


## Sorts explanations by ID, because their order depends on the layers that were passed. Any other result is returned unchanged.
func in_order(found: Variant) -> Variant:
	if found is Array and not found.is_empty() and found[0] is Array:
		found.sort_custom(func(a: Array, b: Array) -> bool: return a[1] < b[1])
	return found


func test_methods_reject_everything_else() -> void:
	var scatter := await make_forest()
	var calls := calls_for_a_layer(scatter)
	calls.merge(calls_for_layers(scatter))
	calls["request_rect"] = func(layers: Variant) -> Array: return no_result(scatter.request_rect(RECT, layers))
	calls["request_sphere"] = func(layers: Variant) -> Array: return no_result(scatter.request_sphere(HERE, 10.0, layers))
	for method in calls:
		for wrong in refused():
			check(not finds(calls[method].call(wrong[0])), "%s finds nothing for %s" % [method, wrong[0]])
			check_error(["TerrainScatter3D.%s: " % method, wrong[1]], "%s with %s" % [method, wrong[0]])
	for method in calls_for_layers(scatter):
		for wrong in refused():
			check(not finds(calls[method].call(["trees", wrong[0]])), "%s finds nothing for a list with %s" % [method, wrong[0]])
			check_error(["TerrainScatter3D.%s: " % method, wrong[1]], "%s with a list that contains %s" % [method, wrong[0]])
		check(not finds(calls[method].call(PackedInt32Array([0]))), "%s finds nothing for an array of indices" % method)
		check_error(["TerrainScatter3D.%s: " % method, "not [0]"], "%s with an array of indices" % method)
	var queries := queries_of(scatter.make_snapshot())
	for method in queries:
		check(finds(queries[method].call("ferns")), "a snapshot's %s" % method)
		for wrong in refused():
			check(not finds(queries[method].call(wrong[0])), "a snapshot's %s finds nothing for %s" % [method, wrong[0]])
			check_error(["ScatterSnapshot.%s: " % method, wrong[1]], "a snapshot's %s with %s" % [method, wrong[0]])
	await frames(1)


func no_result(request: ScatterRequest) -> Array:
	check(request.is_completed(), "a rejected request is completed")
	return Array(request.get_result().ids)


func test_results_contain_the_layers() -> void:
	var scatter := await make_forest()
	var found := scatter.query_rect(RECT)
	check_equal(found.layers, scatter.layers, "a result contains all layers")
	for index in found.size():
		var layer := found.layers[found.layer_indices[index]]
		if layer != found.get_layer(index) or layer != scatter.get_instance(found.get_id(index)).layer:
			check(false, "instance %d has the wrong layer" % index)
	check_equal(scatter.query_rect(RECT, "ferns").layers, [scatter.layers[1]], "the layers of a result of ferns")
	check_equal(Array(scatter.query_rect(RECT, "ferns").layer_indices).max(), 0, "the indices of a result of ferns")
	check_equal(scatter.query_rect(Rect2(9000, 0, 0, 0)).layers, [], "the layers of an empty result")
	check_equal(scatter.query_rect(RECT, [], func(_id: int, layer: ScatterLayer, _at: Transform3D) -> bool:
		return layer == scatter.layers[0]).ids, scatter.query_rect(RECT, "trees").ids, "a predicate receives the layer")
	var layers := found.layers
	layers.clear()
	check_equal(found.layers.size(), 2, "a script's changes to the list have no effect")
	# A result keeps its layers after they were removed from the list, and after the node was freed.
	var fern := scatter.get_instance(found.get_id(found.size() - 1))
	var ferns := scatter.layers[1]
	scatter.layers = []
	scatter.free()
	check_equal(fern.layer, ferns, "the layer of an instance stays")
	check_equal(found.get_layer(found.size() - 1), ferns, "the layer in a result stays")


func test_all_layers() -> void:
	var scatter := await make_forest()
	check_equal(scatter.get_all_layers(), scatter.layers, "without biomes, the node's layers")
	scatter.get_all_layers().clear()
	check_equal(scatter.layers.size(), 2, "the list is a copy")
	scatter.layers = [scatter.layers[0], null, scatter.layers[1]]
	check_equal(scatter.get_all_layers()[1], null, "an empty entry")
	check_equal(scatter.query_rect(RECT, "ferns").layers, [scatter.layers[2]], "a layer after an empty entry")
	check_equal(scatter.explain_position(HERE).map(func(one: ScatterExplanation) -> int: return one.layer.layer_id if one.layer != null else -1), [3, -1, 4],
			"explanations have the layers, and null for an empty entry")


func test_a_renamed_layer() -> void:
	var scatter := await make_forest()
	var ferns := scatter.query_rect(RECT, "ferns").ids
	var snapshot := scatter.make_snapshot()
	scatter.layers[1].resource_name = "bracken"
	check_equal(scatter.query_rect(RECT, "bracken").ids, ferns, "the new name is valid immediately")
	check_equal(scatter.query_rect(RECT, "ferns").size(), 0, "the old name is no longer valid")
	check_error(["No layer is named \"ferns\": the names are \"trees\", \"bracken\""], "the old name")
	check_equal(snapshot.query_rect(RECT, "ferns").ids, ferns, "a snapshot keeps the names from when it was made")
	check_equal(snapshot.query_rect(RECT, scatter.layers[1]).ids, ferns, "a snapshot accepts the layer itself")
	scatter.layers[1].resource_name = ""
	check_equal(scatter.query_rect(RECT, scatter.layers[1]).ids, ferns, "a layer without a name")


func test_two_layers_with_one_name() -> void:
	var scatter := await make_forest()
	var trees := scatter.query_rect(RECT, scatter.layers[0]).ids
	var ferns := scatter.query_rect(RECT, scatter.layers[1]).ids
	scatter.layers[1].resource_name = "trees"
	check_equal(scatter.query_rect(RECT, "trees").layers, [scatter.layers[0]], "the name selects the first")
	check_equal(scatter.query_rect(RECT, scatter.layers[0]).ids, trees, "passing the first layer selects it")
	check(not scatter.query_rect(RECT, scatter.layers[1]).is_empty() and not ferns.is_empty(), "passing the second layer selects it")
	check_equal(scatter.query_rect(RECT, scatter.layers[1]).layers, [scatter.layers[1]], "the result contains the second layer")
	errors.take() # The node also reports the ambiguous name.


## A request keeps its layers if the list changes while workers generate its tiles.
func test_a_request_keeps_its_layers() -> void:
	var scatter := await make_forest()
	var far := Rect2(4000, 0, 100, 100)
	var trees := scatter.layers[0]
	var expected := scatter.query_rect(far.grow(-10.0), trees).ids
	var request := scatter.request_rect(far.grow(-10.0), trees)
	var again := scatter.request_rect(Rect2(-4000, 0, 100, 100), trees)
	scatter.layers = [make_layer(3.0), trees]
	await until(func() -> bool: return request.is_completed() and again.is_completed(), "both requests")
	check_equal(request.get_result().layers, [trees], "the same layer at another index")
	check_equal(request.get_result().ids, expected, "the same instances")
	check_equal(again.get_result().layers, [trees], "the layer is kept for tiles that were not generated yet")
	var lost := scatter.request_rect(Rect2(-6000, 0, 100, 100), trees)
	scatter.layers = [scatter.layers[0]]
	await until(lost.is_completed, "a request for a layer that was removed")
	check(lost.get_result().is_empty(), "a request for a removed layer has no result")
	check_no_error("requests")


## When a layer is removed, tile_hidden is still emitted with the layer.
func test_tile_signals_have_the_layer() -> void:
	var scatter := await make_forest()
	var ferns := scatter.layers[1]
	var count := scatter.get_shown_tiles(ferns).size()
	var hidden: Array[ScatterLayer] = []
	var shown: Array[ScatterLayer] = []
	scatter.tile_hidden.connect(func(layer: ScatterLayer, _tile: Vector2i) -> void: hidden.push_back(layer))
	scatter.tile_shown.connect(func(layer: ScatterLayer, _tile: Vector2i) -> void: shown.push_back(layer))
	scatter.layers = [scatter.layers[0]]
	await settle(scatter)
	check_equal([hidden.count(ferns), hidden.size()], [count, count], "hidden tiles of the ferns")
	scatter.layers = [scatter.layers[0], ferns]
	await settle(scatter)
	check_equal([shown.count(ferns), shown.size()], [count, count], "shown tiles of the ferns")
