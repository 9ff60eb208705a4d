extends "harness.gd"
## Tests diffs that a thread applies: the result, the state during the call, and callbacks that change the state.

const LAYER := 5 << 48
const MANY := 200_000

var results: Array[Error] = []


func note(error: Error) -> void:
	results.push_back(error)


## Returns a diff with `count` removals of consecutive IDs in a layer, starting at `first`.
func removals(count: int, first := 0) -> PackedByteArray:
	var state := ScatterState.new()
	for index in count:
		state.remove(LAYER | (first + index))
	return state.diff_since(0)


func wait_for_callbacks(count: int) -> void:
	await until(func() -> bool: return results.size() == count, "%d callbacks" % count)
	await frames(2)
	check_equal(results.size(), count, "callbacks")


func clean() -> void:
	results.clear()
	await super()


func test_a_diff_is_applied_later_and_completely() -> void:
	var state := ScatterState.new()
	var signals := []
	state.instances_changed.connect(func(ids: PackedInt64Array) -> void: signals.push_back(ids.size()))
	state.changed.connect(func() -> void: signals.push_back("changed"))
	state.apply_diff_async(removals(MANY), func(error: Error) -> void:
		signals.push_back("callback")
		note(error))
	check_equal(state.get_removed_count(), 0, "removed instances immediately after the call")
	check_equal(state.get_revision(), 0, "the revision immediately after the call")
	check(state.remove(LAYER | 7), "an instance can be removed while the diff is pending")
	check(state.remove(3), "a second instance can be removed while the diff is pending")
	var seen := {}
	while results.is_empty():
		seen[state.get_removed_count()] = true
		await process_frame
	check_equal(seen.keys(), [2], "the removals before the callback")
	check_equal(results, [OK] as Array[Error], "the callback")
	check_equal(state.get_removed_count(), MANY + 1, "all removals")
	check_equal(signals.slice(4), [MANY, "changed", "callback"], "one signal of each kind, then the callback")
	var at_once := ScatterState.new()
	at_once.apply_diff(removals(MANY))
	at_once.remove(3)
	check_equal(state.to_bytes(), at_once.to_bytes(), "the state equals the result of apply_diff")
	state.apply_diff_async(removals(3, MANY))
	await until(func() -> bool: return state.get_removed_count() == MANY + 4, "a diff without a callback is applied")


func test_changes_during_the_call_are_applied_after_it() -> void:
	var server := ScatterState.new()
	for index in 50:
		server.remove(LAYER | index, 100.0 if index % 2 else 0.0)
		server.set_instance_data(LAYER | index, index)
	var diff := server.diff_since(0)
	var states: Array[ScatterState] = [ScatterState.new(), ScatterState.new()]
	states[0].apply_diff(diff)
	states[1].apply_diff_async(diff, note)
	for state in states:
		state.restore(LAYER | 3)
		state.remove(LAYER | 4, 20.0)
		state.set_instance_data(LAYER | 5, "mine")
		state.set_instance_data(LAYER | 70, "mine, too")
		state.advance(30.0)
	check_equal(states[1].get_time(), 30.0, "the time that was added while the diff was pending")
	await wait_for_callbacks(1)
	check_equal(states[1].to_bytes(), states[0].to_bytes(), "the state equals the result of apply_diff")
	check(not states[1].is_removed(LAYER | 3) and not states[1].is_removed(LAYER | 4), "restored, and regrown")
	check_equal(states[1].get_instance_data(LAYER | 5), "mine", "data")
	check_equal(states[1].get_instance_data(LAYER | 6), 6, "the data in the diff")


func test_several_diffs_are_applied_in_order() -> void:
	var server := ScatterState.new()
	var state := ScatterState.new()
	var order := []
	for round in 6:
		var revision := server.get_revision()
		for index in 3000:
			if (index + round) % 3:
				server.remove(LAYER | index)
			else:
				server.restore(LAYER | index)
		state.apply_diff_async(server.diff_since(revision), func(error: Error) -> void:
			order.push_back(round)
			note(error))
	await wait_for_callbacks(6)
	check_equal(order, range(6), "the order")
	check_equal(state.get_digest(), server.get_digest(), "the state")
	var peer := ScatterState.new()
	peer.apply_diff(state.diff_since(0))
	check_equal(peer.get_digest(), server.get_digest(), "the diffs that it returns")


func test_a_bad_diff_has_no_effect() -> void:
	var state := ScatterState.new()
	state.remove(LAYER | 1)
	var before := state.to_bytes()
	var bad := removals(1000)
	bad[500] ^= 1
	for bytes: PackedByteArray in [bad, PackedByteArray(), removals(9).slice(0, 40)]:
		state.apply_diff_async(bytes, note)
	state.apply_diff_async(removals(20), note)
	await until(func() -> bool: return results.size() == 4, "callbacks")
	check_equal(results, [ERR_FILE_CORRUPT, ERR_FILE_CORRUPT, ERR_FILE_CORRUPT, OK] as Array[Error], "errors")
	var messages := errors.take()
	check_equal(messages.size(), 3, "messages")
	for message in messages:
		check("ScatterState.apply_diff_async" in message and "data" in message, message)
	state.restore(LAYER | 0)
	for index in range(2, 20):
		state.restore(LAYER | index)
	check_equal(state.to_bytes(), before, "the state after the invalid diffs")


func test_the_array_may_be_changed_after_the_call() -> void:
	var state := ScatterState.new()
	var diff := removals(MANY)
	state.apply_diff_async(diff, note)
	diff.fill(0)
	await wait_for_callbacks(1)
	check_equal(results, [OK] as Array[Error], "the result for the bytes at the time of the call")


func test_methods_that_replace_everything_wait_for_it() -> void:
	var other := ScatterState.new()
	other.remove(LAYER | (1 << 40))
	var bytes := other.to_bytes()
	for case: Array in [
		["apply_diff", func(state: ScatterState) -> void: state.apply_diff(other.diff_since(0)), MANY + 1],
		["merge", func(state: ScatterState) -> void: state.merge(other), MANY + 1],
		["from_bytes", func(state: ScatterState) -> void: state.from_bytes(bytes), 1],
		["data", func(state: ScatterState) -> void: state.data = bytes, 1],
		["clear", func(state: ScatterState) -> void: state.clear(), 0],
	]:
		results.clear()
		var state := ScatterState.new()
		state.apply_diff_async(removals(10), note)
		state.apply_diff_async(removals(MANY), note)
		(case[1] as Callable).call(state)
		check_equal(state.get_removed_count(), case[2], case[0])
		check_equal(results.size(), 2, "%s: both callbacks" % case[0])
		await frames(5)
		check_equal(results.size(), 2, "%s: calls of the callback" % case[0])
		check_equal(state.get_removed_count(), case[2], case[0])


## Until a pending diff is applied, reading and saving return the state without the diff.
func test_reading_during_the_call() -> void:
	var state := ScatterState.new()
	state.remove(9)
	var bytes := state.to_bytes()
	var digest := state.get_digest()
	var revision := state.get_revision()
	state.apply_diff_async(removals(MANY), note)
	check_equal(state.to_bytes(), bytes, "to_bytes")
	check_equal(state.data, bytes, "data")
	check_equal(state.get_digest(), digest, "get_digest")
	var peer := ScatterState.new()
	peer.apply_diff(state.diff_since(0))
	check_equal(peer.get_digest(), digest, "diff_since")
	await wait_for_callbacks(1)
	peer.apply_diff(state.diff_since(revision))
	check_equal(peer.get_digest(), state.get_digest(), "a peer that has read during the call gets the rest")


func test_callbacks_may_do_anything() -> void:
	# The callback frees the state.
	var held: Array[ScatterState] = [ScatterState.new()]
	held[0].apply_diff_async(removals(100), func(error: Error) -> void:
		held.clear()
		note(error))
	await wait_for_callbacks(1)
	# The callback calls other methods, including synchronous ones.
	var state := ScatterState.new()
	state.apply_diff_async(removals(100), func(_error: Error) -> void:
		state.apply_diff_async(removals(50, 1000), func(error: Error) -> void:
			state.clear()
			state.apply_diff(removals(7))
			note(error))
		state.apply_diff_async(removals(5, 2000), note)
		check_equal(state.get_removed_count(), 100, "not yet"))
	await wait_for_callbacks(3)
	check_equal(state.get_removed_count(), 7, "in order")
	# Signal handlers do the same.
	var once := [true]
	state.instances_changed.connect(func(_ids: PackedInt64Array) -> void:
		if once[0]:
			once[0] = false
			state.apply_diff_async(removals(30, 300), note)
			state.clear())
	state.apply_diff_async(removals(9, 100), note)
	await wait_for_callbacks(5)
	check_equal(state.get_removed_count(), 0, "removed instances after a handler cleared the state")


func test_callbacks_that_cannot_be_called() -> void:
	var state := ScatterState.new()
	var gone := Node.new()
	state.apply_diff_async(removals(10), gone.set_meta.bind("called"))
	state.apply_diff_async(removals(10), gone.queue_free.unbind(1))
	gone.free()
	await until(func() -> bool: return state.get_removed_count() == 10, "applied")
	await frames(3)
	check_no_error("a callback of a freed object")
	state.apply_diff_async(removals(20), func() -> void: pass)
	await until(func() -> bool: return state.get_removed_count() == 20, "applied")
	await frames(3)
	var messages := errors.take()
	check("callback must take (error: Error)" in messages[-1], str(messages))


func test_states_freed_during_the_call() -> void:
	var diff := removals(MANY)
	for round in 12:
		var state := ScatterState.new()
		state.remove(LAYER | 1)
		state.apply_diff_async(diff, note)
		state.apply_diff_async(diff, note)
		for frame in round % 4:
			await process_frame
		state = null
	await frames(10)
	check(results.size() < 24, "%d callbacks of freed states" % results.size())


func test_nodes_are_updated() -> void:
	var viewer := make_viewer()
	var layer := make_layer(0.5)
	layer.view_distance = 60.0
	layer.collision_shape = ScatterLayer.COLLISION_CYLINDER
	layer.collision_distance = 10.0
	var nodes: Array[TerrainScatter3D] = []
	for index in 2:
		nodes.push_back(make_scatter([layer], ScatterGroundFlat.new(), viewer))
		nodes[index].state = nodes[0].state if index else ScatterState.new()
	for node in nodes:
		await settle(node)
	var standing: PackedInt64Array = nodes[0].query_rect(Rect2(-40, -40, 80, 80)).ids
	var server := ScatterState.new()
	server.from_bytes(nodes[0].state.to_bytes())
	for index in range(0, standing.size(), 2):
		server.remove(standing[index])
	for index in 50_000:
		server.remove((standing[0] & ~0xffffffffffff) | (index << 3))
	var removed := {}
	nodes[0].instance_removed.connect(func(id: int, _layer: ScatterLayer, _at: Transform3D) -> void:
		check(not removed.has(id), "one signal")
		removed[id] = true)
	nodes[0].state.apply_diff_async(server.diff_since(0), note)
	check(nodes[1].has_instance(standing[0]), "not yet")
	check(nodes[0].remove_instance(standing[2]), "removed by hand and by the diff")
	check(nodes[0].remove_instance(standing[3]), "removed only by hand")
	var added := nodes[1].add_instance(nodes[1].layers[0], Transform3D(Basis(), Vector3(1.0, 0.0, 1.0)))
	await wait_for_callbacks(1)
	server.remove(standing[3])
	check(not nodes[1].has_instance(standing[0]) and not nodes[0].has_instance(standing[3]), "queries are up to date immediately")
	check(nodes[0].has_instance(standing[1]) and nodes[0].has_instance(added), "remaining instances")
	for node in nodes:
		await settle(node)
	@warning_ignore("integer_division")
	var expected := (standing.size() + 1) / 2 + 1
	var gone_count := 0
	for id in standing:
		gone_count += 1 if removed.has(id) else 0
	check_equal(gone_count, expected, "signals")
	var new_scatter := make_scatter([layer], ScatterGroundFlat.new(), viewer)
	new_scatter.state = nodes[0].state
	await settle(new_scatter)
	for node in nodes:
		check_equal(digests(node, 0), digests(new_scatter, 0), "the visible tiles")
		check_equal(node.get_stats()["bodies"], new_scatter.get_stats()["bodies"], "bodies")


## A diff of a different point set is rejected, even if the state is assigned to a node only after the call.
func test_a_diff_of_other_points() -> void:
	var layer := make_layer(1.0)
	var scatter := make_scatter([layer], ScatterGroundFlat.new(), make_viewer())
	await settle(scatter)
	var id: int = scatter.query_rect(Rect2(-5, -5, 10, 10)).ids[0]
	scatter.remove_instance(id)
	var diff := scatter.state.diff_since(0)
	scatter.state = null
	layer.radius = 2.0
	await settle(scatter)
	var state := ScatterState.new()
	state.apply_diff_async(diff, note)
	scatter.state = state
	await until(func() -> bool: return results.size() == 1, "the callback")
	check_equal(results, [ERR_INVALID_DATA] as Array[Error], "refused")
	check_error(["ScatterState.apply_diff_async", "layer"], "different points")
	check_equal(state.get_removed_count(), 0, "nothing changed")


## The copy that copy_at_runtime makes does not receive the state's pending diffs.
func test_copied_states_do_not_share_pending_diffs() -> void:
	var state := ScatterState.new()
	state.copy_at_runtime = true
	state.apply_diff_async(removals(100), note)
	var scatter := make_scatter([make_layer(2.0)], ScatterGroundFlat.new(), make_viewer())
	scatter.state = state
	check(scatter.state != state, "a copy")
	await wait_for_callbacks(1)
	check_equal(state.get_removed_count(), 100, "applied")
	check_equal(scatter.state.get_removed_count(), 0, "removed instances in the copy")
