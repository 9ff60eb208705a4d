extends "harness.gd"
## Tests a game's changes: instances that are removed, restored and placed by hand, and their data.

## Records a scatter's signals as [name, id, layer, transform].
class SignalLog:
	var events: Array[Array] = []

	func _init(scatter: TerrainScatter3D) -> void:
		for event: String in ["instance_removed", "instance_restored", "instance_added", "instance_moved", "instance_data_changed"]:
			scatter.connect(event, func(id: int, layer: ScatterLayer, at: Transform3D) -> void: events.push_back([event, id, layer, at]))

	func take() -> Array[Array]:
		var taken := events
		events = []
		return taken


func make_wood(two_meshes := false) -> TerrainScatter3D:
	var oak := make_layer(3.0)
	if two_meshes:
		oak.meshes = [BoxMesh.new(), SphereMesh.new()]
	oak.max_scale = 2.0
	var fern := make_layer(1.5)
	return make_scatter([oak, fern], ScatterGroundFlat.new(), make_viewer())


## Returns the ID of the visible instance nearest to a position.
func id_near(standing: Dictionary[int, Transform3D], point: Vector3) -> int:
	var best := 0
	for id in standing:
		if best == 0 or standing[id].origin.distance_to(point) < standing[best].origin.distance_to(point):
			best = id
	return best


func stats_uploads(scatter: TerrainScatter3D) -> int:
	return scatter.get_stats()["uploads"]


func test_removal_is_immediate_and_has_no_other_effect() -> void:
	var scatter := make_wood()
	await settle(scatter)
	var signals := SignalLog.new(scatter)
	var before := instances(scatter, 0)
	var all_digests := [digests(scatter, 0), digests(scatter, 1)]
	var uploads := stats_uploads(scatter)
	var id := id_near(before, Vector3(5, 0, 7))
	check(scatter.has_instance(id), "it exists")
	check(scatter.remove_instance(id), "remove_instance removes it")
	check_equal(signals.take(), [["instance_removed", id, scatter.layers[0], before[id]]], "one signal")
	check(not scatter.has_instance(id) and scatter.get_instance(id) == null, "queries in the same frame do not find it")
	var after := instances(scatter, 0)
	check(not after.has(id), "it disappears in the same frame")
	before.erase(id)
	check(after == before, "all other instances are unchanged")
	check_equal(stats_uploads(scatter) - uploads, 1, "buffers uploaded")
	var tile := Vector2i(0, 0)
	for layer in 2:
		var now := digests(scatter, layer)
		for other: Vector2i in now:
			check(layer == 0 and other == tile or now[other] == all_digests[layer][other], "tile %s of layer %d" % [other, layer])
	check(not scatter.remove_instance(id), "a second removal returns false")
	await frames(3)
	check(instances(scatter, 0) == before, "it stays removed")
	check(scatter.restore_instance(id), "restore_instance restores it")
	check_equal(signals.take().size(), 1, "signals of restoring")
	check(digests(scatter, 0) == all_digests[0], "the tiles are bit-identical to those before")
	check(not scatter.restore_instance(id), "a second restoration returns false")


func test_tiles_update_at_the_end_of_the_frame() -> void:
	var scatter := make_wood()
	await settle(scatter)
	var uploads := stats_uploads(scatter)
	var standing := instances(scatter, 1)
	var removed := scatter.remove_in_sphere(Vector3(16, 0, 16), 10.0, scatter.layers[1])
	var expected := 0
	for id in standing:
		expected += 1 if standing[id].origin.distance_to(Vector3(16, 0, 16)) <= 10.0 else 0
	check(removed.size() == expected and expected > 50, "%d of %d instances within the sphere are removed" % [removed.size(), expected])
	check_equal(stats_uploads(scatter), uploads, "uploads before the end of the frame")
	await frames(1)
	check_equal(stats_uploads(scatter) - uploads, 1, "one upload for a tile, regardless of the number of removals")


func test_a_removed_instance_stays_removed_when_its_tile_returns() -> void:
	var scatter := make_wood()
	await settle(scatter)
	var id := id_near(instances(scatter, 0), Vector3(-3, 0, 4))
	scatter.remove_instance(id)
	var changed := digests(scatter, 0)
	var viewer: Node3D = scatter.get_node(scatter.viewers[0])
	viewer.global_position.x = 1000.0
	await settle(scatter)
	check(not digests(scatter, 0).has(Vector2i(-1, 0)), "the tile is no longer loaded")
	check(not scatter.has_instance(id), "queries do not find it without a loaded tile")
	viewer.global_position.x = 0.0
	await settle(scatter)
	var again := digests(scatter, 0)
	for tile: Vector2i in changed:
		check(again.get(tile) == changed[tile], "tile %s is the same when regenerated" % tile)
	scatter.regenerate()
	await settle(scatter)
	check(not instances(scatter, 0).has(id), "it stays removed when everything is regenerated")


func test_hand_placed_instances() -> void:
	var scatter := make_wood(true)
	await settle(scatter)
	var signals := SignalLog.new(scatter)
	var before := digests(scatter, 0)
	var at := Transform3D(Basis.from_euler(Vector3(0.1, 2.0, 0.0)).scaled(Vector3.ONE * 1.5), Vector3(10.25, 1.5, 12.5))
	var id := scatter.add_instance(scatter.layers[0], at, 1)
	check(id < 0, "its ID is negative")
	check_equal(signals.take(), [["instance_added", id, scatter.layers[0], at]], "one signal")
	check(instances(scatter, 0)[id].is_equal_approx(at), "it is visible where it was placed")
	check_equal((tile_ids(scatter, 0, Vector2i(0, 0))[1] as PackedInt64Array)[0], id, "it is the first of its mesh")
	var found := scatter.get_instance(id)
	check(found.added and found.mesh == 1 and found.transform.is_equal_approx(at), "get_instance")
	check((scatter.query_rect(Rect2(10, 12, 1, 1), scatter.layers[0]).ids as PackedInt64Array).has(id), "a query of its rectangle finds it")
	var viewer: Node3D = scatter.get_node(scatter.viewers[0])
	viewer.global_position.x = 1000.0
	await settle(scatter)
	viewer.global_position.x = 0.0
	await settle(scatter)
	check(instances(scatter, 0)[id].is_equal_approx(at), "it returns with its tile")
	check(scatter.remove_instance(id), "remove_instance removes it")
	check(digests(scatter, 0) == before, "the tiles are bit-identical to those before")
	check(not scatter.has_instance(id) and not scatter.restore_instance(id), "it cannot be restored")
	check(scatter.add_instance(scatter.layers[0], at, 1) == id, "when placed again, it has the same id")


## Returns the ID of the instance whose body a vertical ray hits above a position, or 0.
func body_at(scatter: TerrainScatter3D, point: Vector3) -> int:
	var ray := PhysicsRayQueryParameters3D.create(point + Vector3(0.0, 20.0, 0.0), point)
	var hit := root.world_3d.direct_space_state.intersect_ray(ray)
	return scatter.get_body_instance(hit.rid) if not hit.is_empty() else 0


func test_a_hand_placed_instance_moves() -> void:
	var scatter := make_wood(true)
	scatter.layers[0].collision_shape = ScatterLayer.COLLISION_CYLINDER
	await settle(scatter)
	var at := Transform3D(Basis(), Vector3(10.25, 1.5, 12.5))
	# In another tile and tilted, with numbers that floats cannot represent exactly.
	var to := Transform3D(Basis.from_euler(Vector3(0.3, 1.1, -0.2)).scaled(Vector3(1.1, 1.7, 0.9)), Vector3(-21.7, 0.1, 23.3))
	for target in [at, to]:
		scatter.remove_in_sphere(target.origin, 6.0, scatter.layers[0])
	var id := scatter.add_instance(scatter.layers[0], at, 1)
	scatter.set_instance_data(id, "sown")
	await settle(scatter)
	var signals := SignalLog.new(scatter)
	check_equal(body_at(scatter, at.origin), id, "its body")
	check_equal(scatter.set_instance_transform(id, to), id, "it keeps its id")
	check_equal(signals.take(), [["instance_moved", id, scatter.layers[0], to]], "one signal")
	var found := scatter.get_instance(id)
	check(found.transform == to and found.mesh == 1 and found.data == "sown", "it is at the new position, bit for bit, with its mesh and data")
	check(not (scatter.query_rect(Rect2(10, 12, 1, 1), scatter.layers[0]).ids as PackedInt64Array).has(id), "a query at the old position does not find it")
	await frames(2)
	check(instances(scatter, 0)[id].is_equal_approx(to), "the tiles are updated")
	await settle(scatter)
	check_equal([body_at(scatter, at.origin), body_at(scatter, to.origin)], [0, id], "its body is moved")
	var loaded := ScatterState.new()
	check_equal(loaded.from_bytes(scatter.state.to_bytes()), OK, "saved")
	var other := make_wood(true)
	await settle(other)
	other.state = loaded
	check(other.get_instance(id).transform == to, "another node loads its new position, bit for bit")
	check_equal(scatter.set_instance_transform(id - 1, to), 0, "an ID without an instance")
	check_equal(scatter.set_instance_transform(id, Transform3D(Basis(), Vector3(0, INF, 0))), 0, "an invalid position")
	check_error(["set_instance_transform", "position"], "a position that is not finite")
	check(scatter.get_instance(id).transform == to, "invalid calls do not move it")


func test_a_generated_instance_moves() -> void:
	var scatter := make_wood(true)
	scatter.layers[0].regrowth_time = 5.0
	await settle(scatter)
	var id := id_near(instances(scatter, 0), Vector3(5.0, 0.0, 5.0))
	scatter.set_instance_data(id, {"age": 3})
	var before := scatter.get_instance(id)
	var signals := SignalLog.new(scatter)
	var batches: Array[PackedInt64Array] = []
	scatter.state.instances_changed.connect(func(ids: PackedInt64Array) -> void: batches.push_back(ids))
	var to := before.transform.translated(Vector3(1.25, 0.0, -0.5))
	var moved := scatter.set_instance_transform(id, to)
	check(moved < 0, "it gets a new id")
	check_equal(batches.size(), 1, "one signal for all changes")
	var names := signals.take().map(func(event: Array) -> Array: return [event[0], event[1]])
	check_equal(names.slice(0, 2), [["instance_added", moved], ["instance_data_changed", moved]], "signals of the new instance")
	check_equal(names.slice(2), [["instance_removed", id], ["instance_data_changed", id]], "signals of the old instance")
	check(not scatter.has_instance(id) and scatter.state.is_removed(id), "the old instance is removed")
	var after := scatter.get_instance(moved)
	check(after.transform == to and after.mesh == before.mesh, "unchanged except for its position")
	check_equal([after.data, scatter.get_instance_data(id)], [{"age": 3}, null], "its data moves with it")
	scatter.state.advance(100.0)
	check(scatter.state.is_removed(id), "the old instance does not regrow")


## A diff of the affected IDs can undo and redo any change.
func test_undo_and_redo_by_diffs() -> void:
	var scatter := make_wood()
	await settle(scatter)
	var planted := scatter.add_instance(scatter.layers[0], Transform3D(Basis(), Vector3(4, 0, 4)))
	scatter.set_instance_data(planted, 7)
	var standing := id_near(instances(scatter, 0), Vector3(-5.0, 0.0, 5.0))
	await settle(scatter)
	var bytes := scatter.state.to_bytes()
	var picture := digests(scatter, 0)
	var state := scatter.state
	var steps: Array[Callable] = [
		func() -> PackedInt64Array: scatter.set_instance_transform(planted, Transform3D(Basis(), Vector3(9, 1, 9))); return [planted],
		func() -> PackedInt64Array: scatter.remove_instance(planted); return [planted],
		func() -> PackedInt64Array: scatter.remove_instance(standing); return [standing],
		func() -> PackedInt64Array: return [standing, scatter.set_instance_transform(standing, Transform3D())],
		func() -> PackedInt64Array: return [scatter.add_instance(scatter.layers[0], Transform3D(Basis(), Vector3(4, 0, 4)))],
	]
	for index in steps.size():
		var before := state.diff_of([planted, standing])
		var ids: PackedInt64Array = steps[index].call()
		check(state.to_bytes() != bytes, "step %d changes the state" % index)
		var after := state.diff_of(ids)
		var changed := state.to_bytes()
		for again in 2:
			check_equal(state.apply_diff(ScatterState.new().diff_of(ids)), OK, "a diff that undoes the change can be applied")
			check_equal(state.apply_diff(before), OK, "undo")
			check(state.to_bytes() == bytes, "step %d is undone, byte for byte" % index)
			check_equal(state.apply_diff(after), OK, "redo")
			check(state.to_bytes() == changed, "step %d is redone" % index)
		state.apply_diff(ScatterState.new().diff_of(ids))
		state.apply_diff(before)
	await frames(2)
	check(digests(scatter, 0) == picture, "the tiles are bit-identical to those before")


func test_a_new_radius_keeps_hand_placed_instances() -> void:
	var scatter := make_wood()
	await settle(scatter)
	var id := scatter.add_instance(scatter.layers[0], Transform3D(Basis(), Vector3(4, 0, 4)))
	scatter.layers[0].radius = 2.0
	scatter.seed = 99
	await settle(scatter)
	check(scatter.has_instance(id) and instances(scatter, 0).has(id), "it stays")
	check(scatter.get_problems().is_empty(), "and causes no problem: %s" % scatter.get_problems())
	scatter.remove_instance(id_near(instances(scatter, 1), Vector3.ZERO))
	scatter.seed = 98
	await settle(scatter)
	check(not scatter.get_problems().is_empty(), "removals of old points cause a problem")
	check(scatter.has_instance(id), "but the placed instance stays")


func test_build_rect_includes_changes() -> void:
	var scatter := make_wood()
	await settle(scatter)
	var rect := Rect2(-20, -20, 40, 40)
	var full := scatter.build_rect(scatter.layers[0], rect)
	var gone := id_near(instances(scatter, 0), Vector3.ZERO)
	scatter.remove_instance(gone)
	var id := scatter.add_instance(scatter.layers[0], Transform3D(Basis(), Vector3(4, 0, 4)))
	scatter.add_instance(scatter.layers[0], Transform3D(Basis(), Vector3(40, 0, 4)))
	var ids: PackedInt64Array = scatter.build_rect(scatter.layers[0], rect).get_ids(0)
	check(not ids.has(gone) and ids[0] == id and ids.size() == full.get_ids(0).size(), "the tile lacks the removed instance and contains the added one")
	scatter.remove_instance(id)
	scatter.restore_instance(gone)
	check_equal(scatter.build_rect(scatter.layers[0], rect).get_digest(), full.get_digest(), "bit-identical to the first result")


func test_many_instances_placed_in_one_tile() -> void:
	var scatter := make_wood()
	await settle(scatter)
	var before := instances(scatter, 0).size()
	for index in 100:
		scatter.add_instance(scatter.layers[0], Transform3D(Basis(), Vector3(0.3 * index, 0.0, 10.0)))
	await frames(2)
	check_equal(instances(scatter, 0).size(), before + 100, "all are visible")
	check_equal(scatter.get_stats()["drawn"], scatter.get_stats()["instances"], "all are drawn")


func test_data() -> void:
	var scatter := make_wood()
	await settle(scatter)
	var signals := SignalLog.new(scatter)
	var id := id_near(instances(scatter, 0), Vector3.ZERO)
	check(scatter.get_instance_data(id) == null, "no data at first")
	check(scatter.set_instance_data(id, {"name": "Old oak", "age": 312}), "set_instance_data sets the data")
	check_equal(signals.take().size(), 1, "signals")
	check_equal(scatter.get_instance_data(id), {"name": "Old oak", "age": 312}, "the data that get_instance_data returns")
	check_equal(scatter.get_instance(id).data, {"name": "Old oak", "age": 312}, "the data of the instance")
	scatter.remove_instance(id)
	check_equal(scatter.get_instance_data(id), {"name": "Old oak", "age": 312}, "a removed instance keeps its data")
	scatter.set_instance_data(id, null)
	check(scatter.get_instance_data(id) == null, "setting null deletes the data")


func test_a_state_restores_the_same_world() -> void:
	var scatter := make_wood()
	await settle(scatter)
	scatter.remove_in_sphere(Vector3(10, 0, -10), 15.0)
	scatter.add_instance(scatter.layers[0], Transform3D(Basis(), Vector3(1, 2, 3)))
	var changed := [digests(scatter, 0), digests(scatter, 1)]
	var state := ScatterState.new()
	check_equal(state.from_bytes(scatter.state.to_bytes()), OK, "the state can be loaded from its bytes")
	var other := make_wood()
	other.state = state
	await settle(other)
	check([digests(other, 0), digests(other, 1)] == changed, "a node with the loaded state has bit-identical tiles")
	other.state = null
	check(instances(other, 0).size() > instances(scatter, 0).size(), "without the state, the removed instances return")
	other.seed = 8
	await settle(other)
	other.state = state
	check_error(["TerrainScatter3D", "state", "seed"], "a state with a different seed")
	check(other.state == null, "the state is rejected")


func test_removed_instances_regrow() -> void:
	var scatter := make_wood()
	scatter.layers[0].regrowth_time = 0.4
	await settle(scatter)
	var signals := SignalLog.new(scatter)
	var oak := id_near(instances(scatter, 0), Vector3.ZERO)
	var fern := id_near(instances(scatter, 1), Vector3.ZERO)
	scatter.remove_instance(oak)
	scatter.remove_instance(fern)
	await frames(1)
	check(not scatter.has_instance(oak), "it does not regrow immediately")
	await until(func() -> bool: return scatter.has_instance(oak), "it regrows")
	check(scatter.state.get_time() >= 0.4, "it regrows no earlier than the regrowth time")
	check(instances(scatter, 0).has(oak), "it is also visible")
	check(not scatter.has_instance(fern), "a layer without a regrowth time does not regrow")
	check_equal(signals.take()[-1].slice(0, 3), ["instance_restored", oak, scatter.layers[0]], "a signal reports it")


## While a node uses a state, the methods of the state apply the node's rules.
func test_changes_through_the_state() -> void:
	var scatter := make_wood()
	scatter.layers[0].resource_name = "oak"
	scatter.layers[0].regrowth_time = 50.0
	scatter.state = ScatterState.new()
	await settle(scatter)
	var state := scatter.state
	var standing := scatter.query_sphere(Vector3.ZERO, 30.0, "oak").ids
	var missing := standing[0] ^ (1 << 40)
	var signals := SignalLog.new(scatter)
	check(not scatter.has_instance(missing), "no such instance")
	check(not state.remove(missing) and not state.set_instance_data(missing, 1) and not state.restore(missing), "the state's methods reject an ID without an instance")
	check_equal([state.get_revision(), signals.take().size()], [0, 0], "changes")
	var at := scatter.get_instance(standing[0]).transform
	check(state.remove(standing[0]), "an existing instance is removed")
	check_equal(signals.take(), [["instance_removed", standing[0], scatter.layers[0], at]], "signals of the removal")
	check(not scatter.has_instance(standing[0]) and not state.remove(standing[0]), "a second removal returns false")
	check(state.remove(standing[1], 0.0) and state.remove(standing[2], 20.0), "one instance is removed permanently, another for a shorter time")
	check(not state.remove(standing[0], 80.0), "removing it again sets a new time, but returns false")
	check(state.set_instance_data(standing[3], "tall") and state.remove(standing[3], 10.0) and state.restore(standing[3]), "restored")
	check_equal(signals.take().slice(-1)[0].slice(0, 3), ["instance_restored", standing[3], scatter.layers[0]], "the signal of the restoration")
	check_equal(scatter.get_instance_data(standing[3]), "tall", "the data of the restored instance")
	check_equal(state.get_removed("oak"), state.get_removed(), "removed instances by the layer's name")
	check_equal(state.get_removed(scatter.layers[1]), PackedInt64Array(), "removed instances of the other layer")
	state.advance(21.0)
	check(scatter.has_instance(standing[2]) and not scatter.has_instance(standing[0]), "only the instance with the shorter time has regrown")
	state.advance(60.0)
	check(scatter.has_instance(standing[0]) and not scatter.has_instance(standing[1]), "only the permanently removed instance is still missing")
	var planted := scatter.add_instance("oak", Transform3D(Basis(), Vector3(4, 0, 4)))
	check_equal(state.get_added("oak"), PackedInt64Array([planted]), "hand-placed instances by the layer's name")
	check(state.remove(planted) and not scatter.has_instance(planted), "a hand-placed instance is removed")
	# While the node is outside the tree, the state changes any ID without checking it.
	root.remove_child(scatter)
	check(state.remove(missing), "any id")
	scatter.free()
	check(state.restore(missing) and state.get_removed_count() == 1, "the state restores any ID after the node was freed")


func test_bad_input() -> void:
	var scatter := make_wood()
	await settle(scatter)
	for id: int in [0, -1, 12345, 1 << 62, -(1 << 62)]:
		check(not scatter.has_instance(id) and not scatter.remove_instance(id), "no instance %d" % id)
	check(scatter.state == null, "nothing was changed")
	check_equal(scatter.add_instance("larch", Transform3D()), 0, "no such layer")
	check_error(["add_instance", "\"larch\""], "a missing layer")
	check_equal(scatter.add_instance(scatter.layers[0], Transform3D(), -1), 0, "no such mesh")
	check_error(["add_instance", "mesh", "-1"], "a negative mesh")
	check_equal(scatter.add_instance(scatter.layers[0], Transform3D(Basis(), Vector3(NAN, 0, 0))), 0, "an invalid position")
	check_error(["add_instance", "position"], "a position that is not finite")
	check_equal(scatter.remove_in_sphere(Vector3.ZERO, -1.0), PackedInt64Array(), "an invalid sphere")
	check_error(["remove_in_sphere", "radius", "-1"], "a negative radius")
	var bare := TerrainScatter3D.new()
	check(not bare.has_instance(1), "a node without ground and layers")
	check_error(["has_instance", "ground"], "a node without ground")
	bare.free()
