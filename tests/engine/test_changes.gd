extends "harness.gd"
## What a game changes: instances that are removed, restored and placed by hand, and data of theirs.

## What was told by which signal.
class Told:
	var events: Array[Array] = []

	func _init(scatter: TerrainScatter3D) -> void:
		for event: String in ["instance_removed", "instance_restored", "instance_added", "instance_moved", "instance_data_changed"]:
			scatter.connect(event, func(id: int, layer: int, at: Transform3D) -> void: events.push_back([event, id, layer, at]))

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


## The id that stands nearest to a place, by the picture.
func id_near(standing: Dictionary[int, Transform3D], place: Vector3) -> int:
	var best := 0
	for id in standing:
		if best == 0 or standing[id].origin.distance_to(place) < standing[best].origin.distance_to(place):
			best = id
	return best


func stats_uploads(scatter: TerrainScatter3D) -> int:
	return scatter.get_stats()["uploads"]


func test_what_is_removed_is_gone_at_once_and_nothing_else_is_touched() -> void:
	var scatter := make_wood()
	await settle(scatter)
	var told := Told.new(scatter)
	var before := instances(scatter, 0)
	var all_digests := [digests(scatter, 0), digests(scatter, 1)]
	var uploads := stats_uploads(scatter)
	var id := id_near(before, Vector3(5, 0, 7))
	check(scatter.has_instance(id), "it stands")
	check(scatter.remove_instance(id), "it can be removed")
	check_equal(told.take(), [["instance_removed", id, 0, before[id]]], "one signal")
	check(not scatter.has_instance(id) and scatter.get_instance(id) == null, "no query finds it in the same frame")
	var after := instances(scatter, 0)
	check(not after.has(id), "the picture has lost it in the same frame")
	before.erase(id)
	check(after == before, "all others stand as they did")
	check_equal(stats_uploads(scatter) - uploads, 1, "buffers uploaded")
	var tile := Vector2i(0, 0)
	for layer in 2:
		var now := digests(scatter, layer)
		for other: Vector2i in now:
			check(layer == 0 and other == tile or now[other] == all_digests[layer][other], "tile %s of layer %d" % [other, layer])
	check(not scatter.remove_instance(id), "it cannot be removed twice")
	await frames(3)
	check(instances(scatter, 0) == before, "it stays away")
	check(scatter.restore_instance(id), "it can be restored")
	check_equal(told.take().size(), 1, "signals of restoring")
	check(digests(scatter, 0) == all_digests[0], "the picture is what it was, to the bit")
	check(not scatter.restore_instance(id), "it cannot be restored twice")


func test_the_picture_follows_without_being_asked() -> void:
	var scatter := make_wood()
	await settle(scatter)
	var uploads := stats_uploads(scatter)
	var standing := instances(scatter, 1)
	var removed := scatter.remove_in_sphere(Vector3(16, 0, 16), 10.0, [1])
	var expected := 0
	for id in standing:
		expected += 1 if standing[id].origin.distance_to(Vector3(16, 0, 16)) <= 10.0 else 0
	check(removed.size() == expected and expected > 50, "all within the sphere: %d of %d" % [removed.size(), expected])
	check_equal(stats_uploads(scatter), uploads, "uploads before the end of the frame")
	await frames(1)
	check_equal(stats_uploads(scatter) - uploads, 1, "one upload for a tile, however many were removed")


func test_a_removed_instance_stays_away_when_tiles_come_again() -> void:
	var scatter := make_wood()
	await settle(scatter)
	var id := id_near(instances(scatter, 0), Vector3(-3, 0, 4))
	scatter.remove_instance(id)
	var changed := digests(scatter, 0)
	var viewer: Node3D = scatter.get_node(scatter.viewers[0])
	viewer.global_position.x = 1000.0
	await settle(scatter)
	check(not digests(scatter, 0).has(Vector2i(-1, 0)), "the tile is dropped")
	check(not scatter.has_instance(id), "no query finds it where nothing is loaded")
	viewer.global_position.x = 0.0
	await settle(scatter)
	var again := digests(scatter, 0)
	for tile: Vector2i in changed:
		check(again.get(tile) == changed[tile], "tile %s is the same made anew" % tile)
	scatter.regenerate()
	await settle(scatter)
	check(not instances(scatter, 0).has(id), "nor does it come back with all made anew")


func test_hand_placed_instances() -> void:
	var scatter := make_wood(true)
	await settle(scatter)
	var told := Told.new(scatter)
	var before := digests(scatter, 0)
	var at := Transform3D(Basis.from_euler(Vector3(0.1, 2.0, 0.0)).scaled(Vector3.ONE * 1.5), Vector3(10.25, 1.5, 12.5))
	var id := scatter.add_instance(0, at, 1)
	check(id < 0, "its id is negative")
	check_equal(told.take(), [["instance_added", id, 0, at]], "one signal")
	check(instances(scatter, 0)[id].is_equal_approx(at), "the picture shows it where it was placed")
	check_equal((tile_ids(scatter, 0, Vector2i(0, 0))[1] as PackedInt64Array)[0], id, "the first of its mesh")
	var found := scatter.get_instance(id)
	check(found.added and found.mesh == 1 and found.transform.is_equal_approx(at), "by id")
	check((scatter.query_rect(Rect2(10, 12, 1, 1), [0]).ids as PackedInt64Array).has(id), "in its rectangle")
	var viewer: Node3D = scatter.get_node(scatter.viewers[0])
	viewer.global_position.x = 1000.0
	await settle(scatter)
	viewer.global_position.x = 0.0
	await settle(scatter)
	check(instances(scatter, 0)[id].is_equal_approx(at), "it comes again with its tile")
	check(scatter.remove_instance(id), "it can be removed")
	check(digests(scatter, 0) == before, "then all is as it was, to the bit")
	check(not scatter.has_instance(id) and not scatter.restore_instance(id), "it does not come back")
	check(scatter.add_instance(0, at, 1) == id, "placed again it has the same id")


## The instance whose body a ray from above meets at a place; 0 for none.
func body_at(scatter: TerrainScatter3D, place: Vector3) -> int:
	var ray := PhysicsRayQueryParameters3D.create(place + Vector3(0.0, 20.0, 0.0), place)
	var hit := root.world_3d.direct_space_state.intersect_ray(ray)
	return scatter.get_body_instance(hit.rid) if not hit.is_empty() else 0


func test_a_hand_placed_instance_moves() -> void:
	var scatter := make_wood(true)
	scatter.layers[0].collision_shape = ScatterLayer.COLLISION_CYLINDER
	await settle(scatter)
	var at := Transform3D(Basis(), Vector3(10.25, 1.5, 12.5))
	# Into another tile, leaning, with numbers that are no round ones.
	var to := Transform3D(Basis.from_euler(Vector3(0.3, 1.1, -0.2)).scaled(Vector3(1.1, 1.7, 0.9)), Vector3(-21.7, 0.1, 23.3))
	for place in [at, to]:
		scatter.remove_in_sphere(place.origin, 6.0, [0])
	var id := scatter.add_instance(0, at, 1)
	scatter.set_instance_data(id, "sown")
	await settle(scatter)
	var told := Told.new(scatter)
	check_equal(body_at(scatter, at.origin), id, "its body")
	check_equal(scatter.set_instance_transform(id, to), id, "its id stays")
	check_equal(told.take(), [["instance_moved", id, 0, to]], "one signal")
	var found := scatter.get_instance(id)
	check(found.transform == to and found.mesh == 1 and found.data == "sown", "it stands there to the bit, with its mesh and data")
	check(not (scatter.query_rect(Rect2(10, 12, 1, 1), [0]).ids as PackedInt64Array).has(id), "and not here")
	await frames(2)
	check(instances(scatter, 0)[id].is_equal_approx(to), "the picture follows")
	await settle(scatter)
	check_equal([body_at(scatter, at.origin), body_at(scatter, to.origin)], [0, id], "its body went along")
	var loaded := ScatterState.new()
	check_equal(loaded.from_bytes(scatter.state.to_bytes()), OK, "saved")
	var other := make_wood(true)
	await settle(other)
	other.state = loaded
	check(other.get_instance(id).transform == to, "and loaded, to the bit")
	check_equal(scatter.set_instance_transform(id - 1, to), 0, "one that does not stand")
	check_equal(scatter.set_instance_transform(id, Transform3D(Basis(), Vector3(0, INF, 0))), 0, "no such place")
	check_error(["set_instance_transform", "position"], "a place that is not finite")
	check(scatter.get_instance(id).transform == to, "leaves it where it was")


func test_an_instance_of_rules_moves() -> void:
	var scatter := make_wood(true)
	scatter.layers[0].regrowth_time = 5.0
	await settle(scatter)
	var id := id_near(instances(scatter, 0), Vector3(5.0, 0.0, 5.0))
	scatter.set_instance_data(id, {"age": 3})
	var before := scatter.get_instance(id)
	var told := Told.new(scatter)
	var batches: Array[PackedInt64Array] = []
	scatter.state.instances_changed.connect(func(ids: PackedInt64Array) -> void: batches.push_back(ids))
	var to := before.transform.translated(Vector3(1.25, 0.0, -0.5))
	var moved := scatter.set_instance_transform(id, to)
	check(moved < 0, "it has an id of its own")
	check_equal(batches.size(), 1, "changes are told at once")
	var signals := told.take().map(func(event: Array) -> Array: return [event[0], event[1]])
	check_equal(signals.slice(0, 2), [["instance_added", moved], ["instance_data_changed", moved]], "signals of the one that stands")
	check_equal(signals.slice(2), [["instance_removed", id], ["instance_data_changed", id]], "and of the one that is gone")
	check(not scatter.has_instance(id) and scatter.state.is_removed(id), "the other is removed")
	var after := scatter.get_instance(moved)
	check(after.transform == to and after.mesh == before.mesh, "as it was, elsewhere")
	check_equal([after.data, scatter.get_instance_data(id)], [{"age": 3}, null], "data go along")
	scatter.state.advance(100.0)
	check(scatter.state.is_removed(id), "and it does not grow again where it was")


## A diff of ids takes a step back, whatever it was.
func test_a_step_of_undo() -> void:
	var scatter := make_wood()
	await settle(scatter)
	var planted := scatter.add_instance(0, Transform3D(Basis(), Vector3(4, 0, 4)))
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
		func() -> PackedInt64Array: return [scatter.add_instance(0, Transform3D(Basis(), Vector3(4, 0, 4)))],
	]
	for index in steps.size():
		var before := state.diff_of([planted, standing])
		var ids: PackedInt64Array = steps[index].call()
		check(state.to_bytes() != bytes, "step %d does something" % index)
		var after := state.diff_of(ids)
		var changed := state.to_bytes()
		for again in 2:
			check_equal(state.apply_diff(ScatterState.new().diff_of(ids)), OK, "what was not there goes")
			check_equal(state.apply_diff(before), OK, "back")
			check(state.to_bytes() == bytes, "step %d is undone, to the byte" % index)
			check_equal(state.apply_diff(after), OK, "and forth")
			check(state.to_bytes() == changed, "step %d is redone" % index)
		state.apply_diff(ScatterState.new().diff_of(ids))
		state.apply_diff(before)
	await frames(2)
	check(digests(scatter, 0) == picture, "the picture is as it was, to the bit")


func test_another_radius_keeps_what_is_placed_by_hand() -> void:
	var scatter := make_wood()
	await settle(scatter)
	var id := scatter.add_instance(0, Transform3D(Basis(), Vector3(4, 0, 4)))
	scatter.layers[0].radius = 2.0
	scatter.seed = 99
	await settle(scatter)
	check(scatter.has_instance(id) and instances(scatter, 0).has(id), "it stands")
	check(scatter.get_problems().is_empty(), "and is no problem: %s" % scatter.get_problems())
	scatter.remove_instance(id_near(instances(scatter, 1), Vector3.ZERO))
	scatter.seed = 98
	await settle(scatter)
	check(not scatter.get_problems().is_empty(), "what is removed means another")
	check(scatter.has_instance(id), "but what is placed stands")


func test_what_is_built_at_once_follows() -> void:
	var scatter := make_wood()
	await settle(scatter)
	var rect := Rect2(-20, -20, 40, 40)
	var full := scatter.build_rect(0, rect)
	var gone := id_near(instances(scatter, 0), Vector3.ZERO)
	scatter.remove_instance(gone)
	var id := scatter.add_instance(0, Transform3D(Basis(), Vector3(4, 0, 4)))
	scatter.add_instance(0, Transform3D(Basis(), Vector3(40, 0, 4)))
	var ids: PackedInt64Array = scatter.build_rect(0, rect).get_ids(0)
	check(not ids.has(gone) and ids[0] == id and ids.size() == full.get_ids(0).size(), "without what is removed, with what is placed there")
	scatter.remove_instance(id)
	scatter.restore_instance(gone)
	check_equal(scatter.build_rect(0, rect).get_digest(), full.get_digest(), "to the bit")


func test_many_are_placed_in_one_tile() -> void:
	var scatter := make_wood()
	await settle(scatter)
	var before := instances(scatter, 0).size()
	for index in 100:
		scatter.add_instance(0, Transform3D(Basis(), Vector3(0.3 * index, 0.0, 10.0)))
	await frames(2)
	check_equal(instances(scatter, 0).size(), before + 100, "all are in the picture")
	check_equal(scatter.get_stats()["drawn"], scatter.get_stats()["instances"], "all are drawn")


func test_data() -> void:
	var scatter := make_wood()
	await settle(scatter)
	var told := Told.new(scatter)
	var id := id_near(instances(scatter, 0), Vector3.ZERO)
	check(scatter.get_instance_data(id) == null, "nothing at first")
	check(scatter.set_instance_data(id, {"name": "Old oak", "age": 312}), "it can be set")
	check_equal(told.take().size(), 1, "signals")
	check_equal(scatter.get_instance_data(id), {"name": "Old oak", "age": 312}, "it can be read")
	check_equal(scatter.get_instance(id).data, {"name": "Old oak", "age": 312}, "with the instance")
	scatter.remove_instance(id)
	check_equal(scatter.get_instance_data(id), {"name": "Old oak", "age": 312}, "a stump knows it, too")
	scatter.set_instance_data(id, null)
	check(scatter.get_instance_data(id) == null, "it can be forgotten")


func test_a_state_makes_the_same_world_elsewhere() -> void:
	var scatter := make_wood()
	await settle(scatter)
	scatter.remove_in_sphere(Vector3(10, 0, -10), 15.0)
	scatter.add_instance(0, Transform3D(Basis(), Vector3(1, 2, 3)))
	var changed := [digests(scatter, 0), digests(scatter, 1)]
	var state := ScatterState.new()
	check_equal(state.from_bytes(scatter.state.to_bytes()), OK, "bytes of the state")
	var other := make_wood()
	other.state = state
	await settle(other)
	check([digests(other, 0), digests(other, 1)] == changed, "the same picture, to the bit")
	other.state = null
	check(instances(other, 0).size() > instances(scatter, 0).size(), "without it all stands again")
	other.seed = 8
	await settle(other)
	other.state = state
	check_error(["TerrainScatter3D", "state", "seed"], "a state of another world")
	check(other.state == null, "is not taken")


func test_what_is_removed_grows_again() -> void:
	var scatter := make_wood()
	scatter.layers[0].regrowth_time = 0.4
	await settle(scatter)
	var told := Told.new(scatter)
	var oak := id_near(instances(scatter, 0), Vector3.ZERO)
	var fern := id_near(instances(scatter, 1), Vector3.ZERO)
	scatter.remove_instance(oak)
	scatter.remove_instance(fern)
	await frames(1)
	check(not scatter.has_instance(oak), "not at once")
	await until(func() -> bool: return scatter.has_instance(oak), "it grows again")
	check(scatter.state.get_time() >= 0.4, "after its time")
	check(instances(scatter, 0).has(oak), "in the picture, too")
	check(not scatter.has_instance(fern), "a layer without a time does not")
	check_equal(told.take()[-1].slice(0, 3), ["instance_restored", oak, 0], "a signal tells")


func test_bad_input() -> void:
	var scatter := make_wood()
	await settle(scatter)
	for id: int in [0, -1, 12345, 1 << 62, -(1 << 62)]:
		check(not scatter.has_instance(id) and not scatter.remove_instance(id), "no instance %d" % id)
	check(scatter.state == null, "nothing was changed")
	check_equal(scatter.add_instance(7, Transform3D()), 0, "no such layer")
	check_error(["add_instance", "layer", "7"], "a layer that is not there")
	check_equal(scatter.add_instance(0, Transform3D(), -1), 0, "no such mesh")
	check_error(["add_instance", "mesh", "-1"], "a negative mesh")
	check_equal(scatter.add_instance(0, Transform3D(Basis(), Vector3(NAN, 0, 0))), 0, "no such place")
	check_error(["add_instance", "position"], "a place that is not finite")
	check_equal(scatter.remove_in_sphere(Vector3.ZERO, -1.0), PackedInt64Array(), "no such sphere")
	check_error(["remove_in_sphere", "radius", "-1"], "a negative radius")
	var bare := TerrainScatter3D.new()
	check(not bare.has_instance(1), "a node without anything")
	check_error(["has_instance", "ground"], "a node without terrain")
	bare.free()
