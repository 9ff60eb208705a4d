extends "harness.gd"
## Tests handlers of change signals that make more changes, or that remove the state that emitted the signal.


func make_wood() -> TerrainScatter3D:
	return make_scatter([make_layer(3.0), make_layer(1.5)], ScatterGroundFlat.new(), make_viewer())


## Returns the IDs of the first layer's instances near the origin.
func near_ids(scatter: TerrainScatter3D, radius := 20.0) -> PackedInt64Array:
	return scatter.query_sphere(Vector3.ZERO, radius, scatter.layers[0]).ids


func test_a_handler_removes_the_state() -> void:
	for other: ScatterState in [null, ScatterState.new()]:
		var scatter := make_wood()
		await settle(scatter)
		var ids := near_ids(scatter)
		var signal_count := [0]
		scatter.instance_removed.connect(func(_id: int, _layer: ScatterLayer, _at: Transform3D) -> void:
			signal_count[0] += 1
			scatter.state = other)
		check(scatter.remove_instance(ids[0]), "removed")
		check_equal(signal_count[0], 1, "one signal")
		check(scatter.state == other and scatter.has_instance(ids[0]), "the instance exists in the other state")
		check_equal(scatter.remove_in_sphere(Vector3.ZERO, 10.0, scatter.layers[0]).size() > 2, true, "removed in a sphere")
		await settle(scatter)
		check(other != null or scatter.state == null, "the state is removed")


func test_a_handler_releases_the_last_reference_to_a_state() -> void:
	var held: Array[ScatterState] = [ScatterState.new()]
	held[0].instances_changed.connect(func(_ids: PackedInt64Array) -> void: held.clear())
	check(held[0].remove(5 << 48 | 77), "removed")
	check(held.is_empty(), "the state is freed")


func test_each_second_is_counted_once() -> void:
	var scatter := make_wood()
	var other := make_wood()
	await settle(scatter)
	await settle(other)
	scatter.state = ScatterState.new()
	other.state = scatter.state
	var before := scatter.state.get_time()
	var seconds := 0.0
	for frame in 20:
		await process_frame
		seconds += root.get_process_delta_time()
	var share := (scatter.state.get_time() - before) / seconds
	check(share > 0.8 and share < 1.2, "two nodes advance the time of their state at %f of the normal speed" % share)
	root.remove_child(scatter)
	before = scatter.state.get_time()
	await frames(3)
	check(scatter.state.get_time() > before, "the second node continues alone")
	scatter.free()


func test_nested_removals_emit_signals_in_order() -> void:
	var scatter := make_wood()
	await settle(scatter)
	var ids := near_ids(scatter, 60.0)
	check(ids.size() > 800, "%d instances" % ids.size())
	scatter.state = ScatterState.new()
	var events: Array[Array] = []
	var depth := [0, 0]
	scatter.instance_removed.connect(func(id: int, _layer: ScatterLayer, _at: Transform3D) -> void:
		depth[0] += 1
		depth[1] = maxi(depth[1], depth[0])
		events.push_back(["removed", id])
		check(not scatter.has_instance(id), "removed immediately")
		var next := ids.find(id) + 1
		if next < ids.size():
			check(scatter.remove_instance(ids[next]) and not scatter.has_instance(ids[next]), "the handler removes the next instance immediately")
		depth[0] -= 1)
	scatter.state.instances_changed.connect(func(changed: PackedInt64Array) -> void:
		events.push_back(["changed", changed[0]]))
	scatter.remove_instance(ids[0])
	check_equal(depth[1], 1, "nested handlers")
	var expected: Array[Array] = []
	for id in ids:
		expected.append_array([["removed", id], ["changed", id]])
	check_equal(events, expected, "the events are in order and not interleaved")


func test_nested_restorations_emit_signals_afterwards() -> void:
	var scatter := make_wood()
	await settle(scatter)
	var id := near_ids(scatter)[0]
	var events: PackedStringArray
	scatter.instance_removed.connect(func(_id: int, _layer: ScatterLayer, _at: Transform3D) -> void:
		events.push_back("removed")
		check(scatter.restore_instance(id), "restored")
		events.push_back("handled"))
	scatter.instance_restored.connect(func(_id: int, _layer: ScatterLayer, _at: Transform3D) -> void: events.push_back("restored"))
	scatter.remove_instance(id)
	check_equal(events, PackedStringArray(["removed", "handled", "restored"]), "events")
	check(scatter.has_instance(id), "the restored instance exists")
