extends "harness.gd"
## Tests states that follow an authority, merged states, and limits for the diffs that a receiver accepts.

const LAYER := 3


## Returns the ID of the point in a cell (x, y) of the test's layer.
func point(x: int, y := 0) -> int:
	return LAYER << 48 | (x + (1 << 23)) << 24 | (y + (1 << 23))


func removals(count: int, first := 0) -> ScatterState:
	var state := ScatterState.new()
	for x in count:
		state.remove(point(first + x))
	return state


## Returns a hand-made diff that lists `count` points with consecutive codes, in about one bit per point.
func oversized_diff(count: int) -> PackedByteArray:
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
	check(server.get_origin() != 0 and server.get_origin() != client.get_origin(), "each state has its own origin")
	var diffs: Array[PackedByteArray] = []
	for x in 3:
		var known := server.get_revision()
		server.remove(point(x))
		diffs.push_back(server.diff_since(known))
	check_equal(client.get_missing_since(diffs[0]), -1, "the missing revision for the first diff")
	check_equal(client.get_missing_since(diffs[1]), 0, "the missing revision for the second diff")
	check_equal(client.apply_diff(diffs[1]), ERR_UNAVAILABLE, "a diff is missing")
	check_error(["ScatterState.apply_diff: base_revision must be at most 0", "got 1", "get_missing_since"], "a diff is missing")
	check_equal(client.get_removed_count(), 0, "removed instances after the rejected diff")
	check_equal(client.apply_diff(diffs[0]), OK, "in order")
	check_equal(client.get_known_revision(server.get_origin()), 1, "the known revision")
	check_equal(client.get_missing_since(diffs[2]), 1, "the revision to request")
	check_equal(client.apply_diff(server.diff_since(1)), OK, "the requested diff")
	check_equal(client.get_digest(), server.get_digest(), "the same")
	client.restore(point(0))
	check_equal(client.apply_diff(diffs[0]), OK, "a late diff")
	check_equal(client.get_removed_count(), 2, "a late diff has no effect")
	check_equal(client.apply_diff(server.diff_of([point(0)])), OK, "an authoritative diff")
	check_equal(client.get_digest(), server.get_digest(), "the digest after an authoritative diff corrected a wrong prediction")
	check_equal(client.get_missing_since(PackedByteArray([1, 2])), -1, "not a diff")
	check_error(["ScatterState.get_missing_since: data"], "not a diff")
	client.clear()
	check_equal(client.get_known_revision(server.get_origin()), 0, "cleared")
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
	check_equal(errors, [ERR_UNAVAILABLE, OK, OK], "the results of diffs out of order, then in order")
	check_error(["ScatterState.apply_diff_async: base_revision"], "the first")
	check_equal(client.get_digest(), server.get_digest(), "the same")


func test_limits() -> void:
	var limits := ScatterDiffLimits.new()
	check_equal([limits.max_changes, limits.max_total_changes, limits.max_added, limits.max_data_size, limits.allow_replacement, limits.max_clock_advance],
		[65536, 1_000_000, 65536, 4096, false, 0.0], "the limits for a server")
	var state := removals(3, 1000)
	var before := state.to_bytes()
	var large := oversized_diff(8_000_000)
	check(large.size() < 1_100_000, "%d bytes" % large.size())
	check_equal(state.apply_diff(large), ERR_UNAUTHORIZED, "a diff with too many changes")
	check_error(["ScatterState.apply_diff: changes must be at most 2097152 (max_changes of diff_limits), got 8000000"], "a diff with too many changes")
	state.diff_limits = limits
	check_equal(state.merge_diff(large), ERR_UNAUTHORIZED, "too many changes for the limits")
	check_error(["ScatterState.merge_diff: changes must be at most 65536"], "too many changes for the limits")
	var errors: Array[Error] = []
	state.apply_diff_async(large, func(error: Error) -> void: errors.push_back(error))
	while errors.is_empty():
		await process_frame
	check_equal(errors, [ERR_UNAUTHORIZED], "on a thread")
	check_error(["ScatterState.apply_diff_async: changes"], "on a thread")
	check_equal(state.apply_diff(removals(2).to_bytes()), ERR_UNAUTHORIZED, "a diff that replaces everything")
	check_error(["ScatterState.apply_diff: replaces_everything must be 0 (allow_replacement of diff_limits)"], "a diff that replaces everything")
	var ahead := removals(1)
	ahead.advance(1e12)
	check_equal(state.apply_diff(ahead.diff_since(0)), OK, "a diff with a later time")
	check_equal(state.get_time(), 0.0, "the time does not change")
	state.restore(point(0))
	check_equal(state.get_removed_count(), 3, "removed instances after the rejected diffs")
	check_equal(state.to_bytes(), before, "the state's bytes after the rejected diffs")
	# Limits can be saved with a scene. Their properties reject values that are out of range.
	limits.max_changes = -1
	check_error(["ScatterDiffLimits.max_changes must be between 0"], "a count")
	limits.area = Rect2(0.0, 0.0, NAN, 1.0)
	check_error(["ScatterDiffLimits.area"], "an area")
	limits.area = Rect2(0.0, 0.0, -5.0, 1.0)
	check_error(["ScatterDiffLimits.area.size must be at least 0", "got -5"], "an area")
	limits.max_clock_advance = INF
	check_error(["ScatterDiffLimits.max_clock_advance"], "a clock")
	check_equal([limits.max_changes, limits.area, limits.max_clock_advance], [65536, Rect2(), 0.0], "the last valid values stay")
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
	# A state that no node uses cannot determine the positions of a layer's points.
	var alone := ScatterState.new()
	alone.diff_limits = limits
	check_equal(alone.apply_diff(wishes.diff_since(0)), ERR_UNAUTHORIZED, "unknown positions")
	check_error(["ScatterState.apply_diff: the position of points of a layer is missing. Assign the state"], "unknown positions")
	scatter.state = ScatterState.new()
	scatter.state.diff_limits = limits
	await settle(scatter)
	check_equal(scatter.state.apply_diff(wishes.diff_since(0)), OK, "within the area")
	check(not scatter.has_instance(near), "the instance in the area is removed")
	var seen: Dictionary = scatter.state.inspect_diff(wishes.diff_since(0)).layers[0]
	check_equal([seen.layer, seen.layer_id], [scatter.layers[0], near >> 48], "its layer")
	var bounds: Rect2 = seen.bounds
	check(limits.area.encloses(bounds), "its cell: %s" % bounds)
	wishes.remove(far)
	check_equal(scatter.state.apply_diff(wishes.diff_since(0)), ERR_UNAUTHORIZED, "outside of the area")
	check_error(["ScatterState.apply_diff: x must be between -50 and 50 (area of diff_limits)"], "outside of the area")
	check(scatter.has_instance(far), "it stays")


func test_inspect_diff() -> void:
	var state := removals(4)
	state.set_instance_data(point(9), "oak")
	state.advance(2.5)
	var seen := ScatterState.new().inspect_diff(state.diff_since(0))
	check_equal([seen.error, seen.message, seen.changes, seen.replaces_everything, seen.time], [OK, "", 5, false, 2.5], "the diff")
	check_equal([seen.origin, seen.base_revision, seen.revision], [state.get_origin(), 0, state.get_revision()], "its order")
	var layer: Dictionary = seen.layers[0]
	check(seen.layers.size() == 1 and layer.layer == null and layer.layer_id == LAYER, "the layer of a state without a node")
	check_equal([layer.removed, layer.restored, layer.added, layer.taken_away, layer.with_data], [4, 1, 0, 0, 1], "its layer")
	check(layer.data_bytes > 3 and not layer.bounds_are_complete and not layer.has("bounds"), "without a node, the bounds are unknown")
	check(ScatterState.new().inspect_diff(state.to_bytes()).replaces_everything, "a whole state")
	var refused := ScatterState.new().inspect_diff(oversized_diff(8_000_000))
	check_equal([refused.error, refused.changes, refused.layers], [ERR_UNAUTHORIZED, 8_000_000, []], "a diff with too many changes is not read")
	check((refused.message as String).begins_with("changes must be at most"), refused.message)
	check_equal(ScatterState.new().inspect_diff(PackedByteArray()).error, ERR_FILE_CORRUPT, "not a diff")


func test_merged_states_are_equal() -> void:
	var a := removals(5)
	var b := removals(5, 3)
	a.set_instance_data(point(1), "early")
	b.advance(10.0)
	b.set_instance_data(point(1), "late")
	var a_before := a.to_bytes()
	check_equal([a.merge(b), b.merge_diff(a_before)], [OK, OK], "merged")
	check_equal(a.get_digest(), b.get_digest(), "the digests of both merged states")
	check_equal([a.get_instance_data(point(1)), b.get_instance_data(point(1))], ["late", "late"], "the last write wins")
	check_equal(a.get_removed_count(), 8, "removed instances of both states together")
	check_equal(a.merge_diff(b.diff_since(b.get_revision())), OK, "a diff can be merged in any order")


func test_many_equal_instances() -> void:
	var scatter := make_scatter([make_layer()], ScatterGroundFlat.new(), make_viewer())
	await settle(scatter)
	var equal := PackedFloat32Array()
	for index in 20_000:
		equal.append_array([1, 0, 0, 5.0, 0, 1, 0, 0, 0, 0, 1, 7.0])
	var ids := scatter.add_instances(scatter.layers[0], equal)
	check_equal(ids.size(), 20_000, "added")
	check_equal(ids[-1], ids[0] + 19_999, "consecutive ids")
	check_equal(scatter.state.get_added_count(), 20_000, "stored")
