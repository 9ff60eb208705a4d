extends "harness.gd"
## What a game changes: instances that are removed, restored and placed by hand, and data of theirs.

## What was told by which signal.
class Told:
	var events: Array[Array] = []

	func _init(scatter: TerrainScatter3D) -> void:
		for event: String in ["instance_removed", "instance_restored", "instance_added", "instance_data_changed"]:
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
	return make_scatter([oak, fern], ScatterTerrainFlat.new(), make_viewer())


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
	check_error(["has_instance", "terrain"], "a node without terrain")
	bare.free()
