extends "harness.gd"
## States that follow an authority, states that are joined, and what a receiver lets others do.

const LAYER := 3


## The id of a cell.
func point(x: int, y := 0) -> int:
	return LAYER << 48 | (x + (1 << 23)) << 24 | (y + (1 << 23))


func removals(count: int, first := 0) -> ScatterState:
	var state := ScatterState.new()
	for x in count:
		state.remove(point(first + x))
	return state


## A diff of few bytes that names very many points, by hand: the points of neighboring codes from the first on.
func bomb(count: int) -> PackedByteArray:
	var bytes := "TSTA".to_ascii_buffer()
	bytes.append_array(PackedByteArray([2, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0]))
	bytes.append_array(PackedByteArray([1, 0, 0, 0, 0, 0, 0, 0, 0, 0]))
	var rest := count
	while rest >= 0x80:
		bytes.append(rest & 0x7f | 0x80)
		rest >>= 7
	bytes.append_array(PackedByteArray([rest, 0, 0, 0, 0, 0]))
	var list := PackedByteArray()
	@warning_ignore("integer_division")
	list.resize((6 * ((count + 127) / 128) + count + 7) / 8 + 8)
	list.fill(0)
	return bytes + list


func test_order() -> void:
	var server := ScatterState.new()
	var client := ScatterState.new()
	check(server.get_origin() != 0 and server.get_origin() != client.get_origin(), "each state has a name")
	var diffs: Array[PackedByteArray] = []
	for x in 3:
		var known := server.get_revision()
		server.remove(point(x))
		diffs.push_back(server.diff_since(known))
	check_equal(client.get_missing_since(diffs[0]), -1, "the first can be applied")
	check_equal(client.get_missing_since(diffs[1]), 0, "the second cannot")
	check_equal(client.apply_diff(diffs[1]), ERR_UNAVAILABLE, "one is missing")
	check_error(["ScatterState.apply_diff: base_revision must be at most 0", "got 1", "get_missing_since"], "one is missing")
	check_equal(client.get_removed_count(), 0, "nothing has changed")
	check_equal(client.apply_diff(diffs[0]), OK, "in order")
	check_equal(client.get_known_revision(server.get_origin()), 1, "known")
	check_equal(client.get_missing_since(diffs[2]), 1, "what to ask for")
	check_equal(client.apply_diff(server.diff_since(1)), OK, "what was asked for")
	check_equal(client.get_digest(), server.get_digest(), "the same")
	client.restore(point(0))
	check_equal(client.apply_diff(diffs[0]), OK, "late")
	check_equal(client.get_removed_count(), 2, "what is late changes nothing")
	check_equal(client.apply_diff(server.diff_of([point(0)])), OK, "a refused prediction")
	check_equal(client.get_digest(), server.get_digest(), "is corrected")
	check_equal(client.get_missing_since(PackedByteArray([1, 2])), -1, "no diff")
	check_error(["ScatterState.get_missing_since: data"], "no diff")
	client.clear()
	check_equal(client.get_known_revision(server.get_origin()), 0, "forgotten")
	check_equal(client.apply_diff(server.diff_since(1, false)), OK, "a save of changes applies to any state")
	check_equal(client.get_removed_count(), 2, "its changes")


func test_order_of_diffs_on_threads() -> void:
	var server := removals(5)
	var client := ScatterState.new()
	var errors: Array[Error] = []
	var note := func(error: Error) -> void: errors.push_back(error)
	var known := server.get_revision()
	var first := server.diff_since(0)
	server.remove(point(77))
	client.apply_diff_async(server.diff_since(known), note)
	client.apply_diff_async(first, note)
	client.apply_diff_async(server.diff_since(known), note)
	while errors.size() < 3:
		await process_frame
	check_equal(errors, [ERR_UNAVAILABLE, OK, OK], "only in order")
	check_error(["ScatterState.apply_diff_async: base_revision"], "the first")
	check_equal(client.get_digest(), server.get_digest(), "the same")


func test_limits() -> void:
	var limits := ScatterDiffLimits.new()
	check_equal([limits.max_changes, limits.max_total_changes, limits.max_added, limits.max_data_size, limits.allow_replacement, limits.max_clock_advance],
		[65536, 1_000_000, 65536, 4096, false, 0.0], "for a server")
	var state := removals(3, 1000)
	var before := state.to_bytes()
	var large := bomb(8_000_000)
	check(large.size() < 1_100_000, "%d bytes" % large.size())
	check_equal(state.apply_diff(large), ERR_UNAUTHORIZED, "a bomb")
	check_error(["ScatterState.apply_diff: changes must be at most 2097152 (max_changes of diff_limits), got 8000000"], "a bomb")
	state.diff_limits = limits
	check_equal(state.merge_diff(large), ERR_UNAUTHORIZED, "a bomb for a server")
	check_error(["ScatterState.merge_diff: changes must be at most 65536"], "a bomb for a server")
	var errors: Array[Error] = []
	state.apply_diff_async(large, func(error: Error) -> void: errors.push_back(error))
	while errors.is_empty():
		await process_frame
	check_equal(errors, [ERR_UNAUTHORIZED], "on a thread")
	check_error(["ScatterState.apply_diff_async: changes"], "on a thread")
	check_equal(state.apply_diff(removals(2).to_bytes()), ERR_UNAUTHORIZED, "everything")
	check_error(["ScatterState.apply_diff: replaces_everything must be 0 (allow_replacement of diff_limits)"], "everything")
	var ahead := removals(1)
	ahead.advance(1e12)
	check_equal(state.apply_diff(ahead.diff_since(0)), OK, "a clock ahead")
	check_equal(state.get_time(), 0.0, "moves nothing")
	state.restore(point(0))
	check_equal(state.get_removed_count(), 3, "nothing else has changed")
	check_equal(state.to_bytes(), before, "to the byte")
	# It can be saved with a scene, and a property ignores what is out of its range.
	limits.max_changes = -1
	check_error(["ScatterDiffLimits.max_changes must be between 0"], "a count")
	limits.area = Rect2(0.0, 0.0, NAN, 1.0)
	check_error(["ScatterDiffLimits.area"], "an area")
	limits.area = Rect2(0.0, 0.0, -5.0, 1.0)
	check_error(["ScatterDiffLimits.area.size must be at least 0", "got -5"], "an area")
	limits.max_clock_advance = INF
	check_error(["ScatterDiffLimits.max_clock_advance"], "a clock")
	check_equal([limits.max_changes, limits.area, limits.max_clock_advance], [65536, Rect2(), 0.0], "ignored")
	check_equal(ResourceSaver.save(limits, "user://limits.tres"), OK, "saved")
	limits.max_changes = 7
	var loaded: ScatterDiffLimits = ResourceLoader.load("user://limits.tres", "", ResourceLoader.CACHE_MODE_IGNORE)
	check_equal(loaded.max_changes, 65536, "loaded")
	DirAccess.remove_absolute("user://limits.tres")


func test_area() -> void:
	var scatter := make_scatter([make_layer()], ScatterGroundFlat.new(), make_viewer())
	await settle(scatter)
	var near: int = scatter.query_nearest(Vector3.ZERO, 30.0).id
	var far: int = scatter.query_nearest(Vector3(200.0, 0.0, 0.0), 30.0).id
	var limits := ScatterDiffLimits.new()
	limits.area = Rect2(-50.0, -50.0, 100.0, 100.0)
	var wishes := ScatterState.new()
	wishes.remove(near)
	# Without a node nobody knows where the points of a layer are.
	var alone := ScatterState.new()
	alone.diff_limits = limits
	check_equal(alone.apply_diff(wishes.diff_since(0)), ERR_UNAUTHORIZED, "where is it?")
	check_error(["ScatterState.apply_diff: the position of points of a layer is missing. Assign the state"], "where is it?")
	scatter.state = ScatterState.new()
	scatter.state.diff_limits = limits
	await settle(scatter)
	check_equal(scatter.state.apply_diff(wishes.diff_since(0)), OK, "within")
	check(not scatter.has_instance(near), "it is felled")
	var bounds: Rect2 = scatter.state.inspect_diff(wishes.diff_since(0)).layers[near >> 48].bounds
	check(limits.area.encloses(bounds), "its cell: %s" % bounds)
	wishes.remove(far)
	check_equal(scatter.state.apply_diff(wishes.diff_since(0)), ERR_UNAUTHORIZED, "outside")
	check_error(["ScatterState.apply_diff: x must be between -50 and 50 (area of diff_limits)"], "outside")
	check(scatter.has_instance(far), "it stands")


func test_what_a_diff_names() -> void:
	var state := removals(4)
	state.set_instance_data(point(9), "oak")
	state.advance(2.5)
	var seen := ScatterState.new().inspect_diff(state.diff_since(0))
	check_equal([seen.error, seen.message, seen.changes, seen.replaces_everything, seen.time], [OK, "", 5, false, 2.5], "the diff")
	check_equal([seen.origin, seen.base_revision, seen.revision], [state.get_origin(), 0, state.get_revision()], "its order")
	var layer: Dictionary = seen.layers[LAYER]
	check_equal([layer.removed, layer.restored, layer.added, layer.taken_away, layer.with_data], [4, 1, 0, 0, 1], "its layer")
	check(layer.data_bytes > 3 and not layer.bounds_are_complete and not layer.has("bounds"), "nobody has claimed the layer")
	check(ScatterState.new().inspect_diff(state.to_bytes()).replaces_everything, "a whole state")
	var refused := ScatterState.new().inspect_diff(bomb(8_000_000))
	check_equal([refused.error, refused.changes, refused.layers], [ERR_UNAUTHORIZED, 8_000_000, {}], "a bomb is not read")
	check((refused.message as String).begins_with("changes must be at most"), refused.message)
	check_equal(ScatterState.new().inspect_diff(PackedByteArray()).error, ERR_FILE_CORRUPT, "no diff")


func test_joined_states_are_the_same() -> void:
	var a := removals(5)
	var b := removals(5, 3)
	a.set_instance_data(point(1), "early")
	b.advance(10.0)
	b.set_instance_data(point(1), "late")
	var a_before := a.to_bytes()
	check_equal([a.merge(b), b.merge_diff(a_before)], [OK, OK], "joined")
	check_equal(a.get_digest(), b.get_digest(), "both hold the same")
	check_equal([a.get_instance_data(point(1)), b.get_instance_data(point(1))], ["late", "late"], "the last write wins")
	check_equal(a.get_removed_count(), 8, "all that either has removed")
	check_equal(a.merge_diff(b.diff_since(b.get_revision())), OK, "in any order")


func test_many_equal_instances() -> void:
	var scatter := make_scatter([make_layer()], ScatterGroundFlat.new(), make_viewer())
	await settle(scatter)
	var equal := PackedFloat32Array()
	for index in 20_000:
		equal.append_array([1, 0, 0, 5.0, 0, 1, 0, 0, 0, 0, 1, 7.0])
	var ids := scatter.add_instances(0, equal)
	check_equal(ids.size(), 20_000, "placed")
	check_equal(ids[-1], ids[0] + 19_999, "one id after the other")
	check_equal(scatter.state.get_added_count(), 20_000, "held")
