extends "harness.gd"
## Tests ScatterState: changes, signals, diffs for peers, files, and rejected input.

const LAYER := 3

## A file name unique to this run, because engines that share user:// may run the same tests at the same time.
var _spot := "user://thicket_state_%d" % randi()

## Records a state's signals in order.
class SignalLog:
	var events: Array = []

	func _init(state: ScatterState) -> void:
		state.instances_changed.connect(func(ids: PackedInt64Array) -> void: events.push_back(ids))
		state.changed.connect(func() -> void: events.push_back("changed"))

	func take() -> Array:
		var taken := events
		events = []
		return taken


## Returns the ID of the point in a cell (x, y) of the test's layer.
func point(x: int, y := 0) -> int:
	return LAYER << 48 | (x + (1 << 23)) << 24 | (y + (1 << 23))


func make_state(count := 20) -> ScatterState:
	var state := ScatterState.new()
	for x in count:
		state.remove(point(x, x * x), 0.0 if x % 2 else 100.0)
	state.set_instance_data(point(1, 1), {"name": "Old oak", "age": 312})
	state.set_instance_data(point(-1), [Vector3.UP, "standing"])
	state.advance(1.5)
	return state


func check_same(got: ScatterState, expected: ScatterState, context: String) -> void:
	check_equal(got.get_digest(), expected.get_digest(), context + ": digest")
	check_equal(got.to_bytes(), expected.to_bytes(), context + ": bytes")
	check_equal(got.get_removed(), expected.get_removed(), context + ": removed")
	check_equal(got.get_time(), expected.get_time(), context + ": time")
	check_equal(got.get_instance_data(point(1, 1)), expected.get_instance_data(point(1, 1)), context + ": data")


func test_changes_emit_signals() -> void:
	var state := ScatterState.new()
	var signals := SignalLog.new(state)
	check(state.remove(point(5)), "removed")
	check_equal(signals.take(), [PackedInt64Array([point(5)]), "changed"], "the ids, then changed")
	check(state.is_removed(point(5)) and not state.is_removed(point(6)), "only the instance with this ID is removed")
	check(not state.remove(point(5)), "only once")
	check(not state.restore(point(6)), "restore returns false if the instance is not removed")
	check(state.set_instance_data(point(6), "x"), "data")
	check_equal(signals.take(), [PackedInt64Array([point(6)]), "changed"], "signals of a change to the data")
	check(state.set_instance_data(point(6), "x"), "setting the same data succeeds")
	check_equal(signals.take(), [], "signals after setting the same data")
	check(state.restore(point(5)), "restored")
	signals.take()
	state.clear()
	check_equal(signals.take(), [PackedInt64Array([point(6)]), "changed"], "clearing")
	check_equal([state.get_removed_count(), state.get_added_count()], [0, 0], "counts")


func test_ids_by_layer() -> void:
	var state := make_state()
	check_equal(state.get_removed_count(), 20, "removed")
	var layer := make_layer()
	layer.layer_id = LAYER
	check_equal(state.get_removed(layer), state.get_removed(), "removed instances of the only layer")
	var other := make_layer()
	for id: int in [0, 4, 32767]:
		other.layer_id = id
		check(state.get_removed(other).is_empty() and state.get_added(other).is_empty(), "no instance belongs to layer %d" % id)
	check_equal(state.get_removed([other, layer, layer]), state.get_removed(), "removed instances of two layers, one of them listed twice")
	for wrong: Array in [[LAYER, "not the index %d" % LAYER], ["oaks", "No layer is named \"oaks\""], [null, "<null>"],
			[[layer, "oaks"], "\"oaks\""], [make_layer(), "without a layer_id"]]:
		check_equal(state.get_removed(wrong[0]), PackedInt64Array(), "no layer %s" % [wrong[0]])
		check_error(["ScatterState.get_removed: ", wrong[1]], "no layer %s" % [wrong[0]])
		check_equal(state.get_added(wrong[0]), PackedInt64Array(), "no layer %s" % [wrong[0]])
		check_error(["ScatterState.get_added: ", wrong[1]], "no layer %s" % [wrong[0]])
	var sorted := state.get_removed()
	sorted.sort()
	check_equal(state.get_removed(), sorted, "ascending")


func test_data_can_be_any_value() -> void:
	var state := ScatterState.new()
	for value: Variant in [true, 7, 2.5, "text", Vector3(1, 2, 3), [1, [2, 3]], {"a": {"b": PackedByteArray([1, 2])}}, &"name"]:
		check(state.set_instance_data(point(0), value), "%s can be stored" % [value])
		check_equal(state.get_instance_data(point(0)), value, "the data after it was set")
	check(state.set_instance_data(point(0), null) and state.get_instance_data(point(0)) == null, "null stores nothing")
	check_equal(state.get_digest(), ScatterState.new().get_digest(), "the digest after the data was deleted")
	var large := PackedByteArray()
	large.resize(65536 - 8)
	check(state.set_instance_data(point(0), large), "data of the maximum size can be stored")
	large.resize(65536)
	check(not state.set_instance_data(point(0), large), "too large")
	check_error(["ScatterState.set_instance_data: data", "wrong size", "65544"], "too large")
	check_equal((state.get_instance_data(point(0)) as PackedByteArray).size(), 65536 - 8, "the last valid data")
	check(not state.set_instance_data(point(0), RefCounted.new()), "an object")
	check_error(["ScatterState.set_instance_data: data"], "an object")
	for id: int in [0, -5]:
		check(not state.set_instance_data(id, 1), "no instance has the id %d" % id)
		check_error(["ScatterState.set_instance_data: id is missing"], "ID %d" % id)


func test_times() -> void:
	var state := ScatterState.new()
	state.remove(point(0), 10.0)
	state.remove(point(1))
	var signals := SignalLog.new(state)
	state.advance(9.0)
	check_equal(signals.take(), [], "too early")
	state.advance(1.0)
	check_equal(signals.take(), [PackedInt64Array([point(0)]), "changed"], "signals of the regrowth")
	check_equal(state.get_removed(), PackedInt64Array([point(1)]), "the instance that is still removed")
	for wrong: float in [NAN, -2.0, 2e12]:
		check(not state.remove(point(2), wrong), "an invalid time of %f is rejected" % wrong)
		check_error(["ScatterState.remove: until"], "until %f" % wrong)
	for wrong: float in [NAN, -1.0, 0.0]:
		state.advance(wrong)
	check_equal(state.get_time(), 10.0, "time")
	check(not state.remove(0) and not state.remove(-77), "no instances")


func test_peers_are_updated_by_diffs() -> void:
	var server := make_state()
	var client := ScatterState.new()
	check_equal(client.apply_diff(server.diff_since(0)), OK, "a complete diff")
	check_same(client, server, "a new peer")
	var known := server.get_revision()
	server.restore(point(1, 1))
	server.remove(point(1000))
	var diff := server.diff_since(known)
	check(diff.size() < 160, "a small diff: %d bytes" % diff.size())
	var signals := SignalLog.new(client)
	check_equal(client.apply_diff(diff), OK, "a diff of the changes")
	var emitted := signals.take()
	check_equal(emitted.size(), 2, "signals")
	check_equal(Array(emitted[0] as PackedInt64Array).size(), 2, "two ids")
	check_same(client, server, "the peer")
	client.apply_diff(diff)
	check_equal(signals.take(), [], "the same diff has no effect the second time")
	var other := ScatterState.new()
	other.remove(point(-50))
	check_equal(client.merge(other), OK, "merged")
	check_equal(signals.take(), [PackedInt64Array([point(-50)]), "changed"], "the merged change")
	check_equal(client.merge(null), ERR_INVALID_DATA, "no state")
	check_error(["ScatterState.merge: other is missing"], "no state")
	# A server that has loaded a state has no earlier revisions, so it sends the whole state, which replaces the client's state.
	server.from_bytes(make_state(3).to_bytes())
	client.apply_diff(server.diff_since(known))
	check_same(client, server, "after the server has loaded")


func test_files() -> void:
	for count: int in [0, 20]:
		var state := make_state(count)
		for ending: String in [".tres", ".res"]:
			check_equal(ResourceSaver.save(state, _spot + ending), OK, "saved")
			var loaded: ScatterState = ResourceLoader.load(_spot + ending, "", ResourceLoader.CACHE_MODE_IGNORE)
			check_same(loaded, state, ending)
			DirAccess.remove_absolute(_spot + ending)
		check_same(state.duplicate(), state, "a copy")
		check_same(state.duplicate(true), state, "the deep copy")
	var blank := ScatterState.new()
	check_equal(blank.data, PackedByteArray(), "a blank state stores nothing")
	blank.data = make_state().data
	check_same(blank, make_state(), "a state whose data property was set")
	blank.data = PackedByteArray()
	check_equal(blank.get_removed_count(), 0, "removed instances after data was set to an empty array")


func test_a_million_removals_take_less_than_4_mb() -> void:
	var random := RandomNumberGenerator.new()
	random.seed = 4
	var state := ScatterState.new()
	var start := Time.get_ticks_msec()
	for index in 1_000_000:
		state.remove(LAYER << 48 | random.randi() << 16 | random.randi() & 0xffff)
	print("a million removals: %d ms" % (Time.get_ticks_msec() - start))
	check_equal(ResourceSaver.save(state, _spot + ".res"), OK, "saved")
	var size := FileAccess.open(_spot + ".res", FileAccess.READ).get_length()
	check(size < 4_000_000 and size > 3_600_000, "%d bytes in a file" % size)
	var loaded: ScatterState = ResourceLoader.load(_spot + ".res", "", ResourceLoader.CACHE_MODE_IGNORE)
	check_equal(loaded.get_digest(), state.get_digest(), "the file")
	DirAccess.remove_absolute(_spot + ".res")


func refuse(state: ScatterState, bytes: PackedByteArray, context: String) -> void:
	var before := state.to_bytes()
	var revision := state.get_revision()
	var signals := SignalLog.new(state)
	check(state.from_bytes(bytes) in [ERR_FILE_CORRUPT, ERR_INVALID_DATA], context + " is rejected")
	check_error(["ScatterState.from_bytes: "], context)
	check(state.apply_diff(bytes) in [ERR_FILE_CORRUPT, ERR_INVALID_DATA], context + " is rejected as a diff")
	check_error(["ScatterState.apply_diff: "], context)
	check(state.to_bytes() == before and state.get_revision() == revision and signals.take().is_empty(), context + " leaves the state unchanged")


func test_damaged_bytes_are_rejected() -> void:
	var state := make_state(5)
	var bytes := make_state(8).to_bytes()
	for at in bytes.size():
		var damaged := bytes.duplicate()
		damaged[at] ^= 1 << at % 8
		refuse(state, damaged, "byte %d" % at)
		refuse(state, bytes.slice(0, at), "the first %d bytes" % at)
	refuse(state, (var_to_bytes([1, 2, 3])), "unrelated bytes")
	check_equal(state.from_bytes(state.diff_since(2)), ERR_FILE_CORRUPT, "a diff is not a state")
	check_error(["ScatterState.from_bytes: data", "truncated, corrupt"], "a diff")
	state.data = bytes.slice(0, 30)
	check_error(["ScatterState.from_bytes: data"], "the property")


func test_a_damaged_file_leaves_the_running_state() -> void:
	var scatter := make_scatter([make_layer()], ScatterGroundFlat.new(), make_viewer())
	await settle(scatter)
	var id: int = scatter.query_nearest(Vector3.ZERO, 50.0).id
	scatter.remove_instance(id)
	var state := scatter.state
	var shown_digests := digests(scatter, 0)
	check_equal(ResourceSaver.save(state, _spot + ".res"), OK, "saved")
	var whole := FileAccess.get_file_as_bytes(_spot + ".res")
	whole[whole.size() - 40] ^= 16
	var file := FileAccess.open(_spot + ".res", FileAccess.WRITE)
	file.store_buffer(whole)
	file.close()
	var loaded := ResourceLoader.load(_spot + ".res", "", ResourceLoader.CACHE_MODE_IGNORE) as ScatterState
	check_error(["ScatterState.from_bytes: data"], "a damaged file")
	check_equal(loaded.get_removed_count(), 0, "removed instances after the damaged file")
	check(scatter.state == state and state.is_removed(id) and not scatter.has_instance(id), "the running state is unchanged")
	# A state of a different seed is rejected here and accepted by a node with that seed.
	var bytes := state.to_bytes()
	var elsewhere := make_scatter([make_layer()], ScatterGroundFlat.new(), make_viewer())
	elsewhere.seed = 8
	await settle(elsewhere)
	elsewhere.remove_instance(elsewhere.query_nearest(Vector3.ZERO, 50.0).id)
	check_equal(state.from_bytes(elsewhere.state.to_bytes()), ERR_INVALID_DATA, "a state of another world")
	check_error(["ScatterState.from_bytes: layer", "a different seed"], "a state of another world")
	check_equal(state.merge(elsewhere.state), ERR_INVALID_DATA, "a state of another world")
	check_error(["ScatterState.merge: layer", "a different seed"], "a state of another world")
	check_equal(digests(scatter, 0), shown_digests, "the visible tiles")
	state.clear()
	check(scatter.has_instance(id), "after a reset of the state, the instance exists again")
	check_equal(state.from_bytes(bytes), OK, "the node's state can be loaded again")
	check(not scatter.has_instance(id), "the instance is removed again")
	check_equal(digests(scatter, 0), shown_digests, "the visible tiles")
	DirAccess.remove_absolute(_spot + ".res")
