extends "harness.gd"
## Very many changes at once: answers are exact from then on; pictures, bodies, scenes and signals follow over the frames.


func make_wood(viewer: Node3D, collide := true) -> TerrainScatter3D:
	var layer := make_layer(0.5)
	layer.view_distance = 100.0
	if collide:
		layer.collision_shape = ScatterLayer.COLLISION_CYLINDER
		layer.collision_distance = 10.0
	return make_scatter([layer], ScatterGroundFlat.new(), viewer)


## Removes a part of what stands, and as many more points of the layer that are nowhere near.
func fell_everywhere(scatter: TerrainScatter3D, standing: PackedInt64Array, far: int) -> ScatterState:
	var server := ScatterState.new()
	server.from_bytes(scatter.state.to_bytes())
	for index in range(0, standing.size(), 2):
		server.remove(standing[index])
	for index in far:
		server.remove((standing[0] & ~0xffffffffffff) | (index << 3))
	return server


func test_very_many_changes() -> void:
	var viewer := make_viewer()
	var scatter := make_wood(viewer)
	scatter.state = ScatterState.new()
	await settle(scatter)
	var standing: PackedInt64Array = scatter.query_rect(Rect2(-60, -60, 120, 120)).ids
	var server := fell_everywhere(scatter, standing, 300_000)
	var told := {}
	scatter.instance_removed.connect(func(id: int, _layer: int, _at: Transform3D) -> void: told[id] = true)
	var diff := server.diff_since(0)
	check_equal(scatter.state.apply_diff(diff), OK, "the diff")
	check_equal(scatter.state.get_digest(), server.get_digest(), "the state is exact at once")
	var left: PackedInt64Array = scatter.query_rect(Rect2(-60, -60, 120, 120)).ids
	check_equal(left.size(), standing.size() / 2, "and so are queries")
	check(not scatter.has_instance(standing[0]) and scatter.has_instance(standing[1]), "by id, too")
	check(told.size() < 5000, "%d signals in one call" % told.size())
	# What is done by hand meanwhile is told at once.
	check(scatter.remove_instance(standing[1]), "by hand")
	check(told.has(standing[1]), "told at once")
	check(scatter.restore_instance(standing[2]), "restored before it was told that it was removed")
	scatter.frame_budget_usec = 1000
	var longest := 0
	var waited := 0
	while not (scatter.is_settled() and told.size() >= standing.size() / 2):
		await process_frame
		longest = maxi(longest, scatter.get_stats()["frame_usec"])
		waited += 1
		if not check(waited < 20000, "still not settled") :
			break
	print("very many changes: %d frames, the longest %d us" % [waited, longest])
	check(waited > 2, "over several frames")
	check(not told.has(standing[2]), "what stands by then is not told as removed")
	for index in range(4, standing.size(), 2):
		if not told.has(standing[index]):
			check(false, "told of all that were known")
			break
	var fresh := make_wood(viewer)
	fresh.state = scatter.state
	await settle(fresh)
	check_equal(digests(scatter, 0), digests(fresh, 0), "the picture")
	check_equal(scatter.get_stats()["bodies"], fresh.get_stats()["bodies"], "bodies")


func test_everything_comes_back() -> void:
	var viewer := make_viewer()
	var scatter := make_wood(viewer)
	await settle(scatter)
	var before := digests(scatter, 0)
	var bodies: int = scatter.get_stats()["bodies"]
	var standing: PackedInt64Array = scatter.query_rect(Rect2(-60, -60, 120, 120)).ids
	scatter.remove_in_sphere(Vector3.ZERO, 50.0)
	await settle(scatter)
	check(digests(scatter, 0) != before, "another picture")
	scatter.state.clear()
	check_equal(scatter.query_rect(Rect2(-60, -60, 120, 120)).ids, standing, "all stand at once")
	await settle(scatter)
	check_equal(digests(scatter, 0), before, "the picture is what it was")
	check_equal(scatter.get_stats()["bodies"], bodies, "bodies, too")


## So many that the picture follows over frames, and so few that only tiles near them are drawn anew.
func test_many_changes_in_some_places() -> void:
	var viewer := make_viewer()
	var scatter := make_wood(viewer, false)
	await settle(scatter)
	var places: Array[Vector3] = [Vector3(-45.0, 0.0, 20.0), Vector3(50.0, 0.0, -50.0), Vector3(-40.0, 0.0, 45.0)]
	var removed := PackedInt64Array()
	for place in places: # No frame lies between them.
		var ids := scatter.remove_in_sphere(place, 16.0)
		check(ids.size() > 1024 and ids.size() < 16384, "%d removed" % ids.size())
		removed.append_array(ids)
	await settle(scatter)
	var fresh := make_wood(viewer, false)
	fresh.state = scatter.state
	await settle(fresh)
	check_equal(digests(scatter, 0), digests(fresh, 0), "the picture")
	var back := ScatterState.new()
	back.from_bytes(scatter.state.to_bytes())
	var revision := back.get_revision()
	for id in removed:
		back.restore(id)
	check_equal(scatter.state.apply_diff(back.diff_since(revision, false)), OK, "all restored by a diff")
	await settle(scatter)
	fresh.state = null
	await settle(fresh)
	check_equal(digests(scatter, 0), digests(fresh, 0), "the picture once all came back")


## How a peer joins late: nobody waits for a million changes.
func test_a_whole_state_is_read_on_a_thread() -> void:
	var scatter := make_wood(make_viewer())
	scatter.state = ScatterState.new()
	await settle(scatter)
	var standing: PackedInt64Array = scatter.query_rect(Rect2(-60, -60, 120, 120)).ids
	var server := fell_everywhere(scatter, standing, 300_000)
	var whole := ScatterState.new()
	var thread_ids := []
	var bytes := server.to_bytes()
	var task := WorkerThreadPool.add_task(func() -> void:
		thread_ids.push_back(OS.get_thread_caller_id())
		thread_ids.push_back(whole.from_bytes(bytes)))
	while not WorkerThreadPool.is_task_completed(task):
		await process_frame
	WorkerThreadPool.wait_for_task_completion(task)
	check(thread_ids[0] != OS.get_main_thread_id(), "on another thread")
	check_equal(thread_ids[1], OK, "the bytes")
	scatter.state = whole
	check_equal(scatter.state.get_digest(), server.get_digest(), "the same state")
	@warning_ignore("integer_division")
	check_equal(scatter.query_rect(Rect2(-60, -60, 120, 120)).ids.size(), standing.size() / 2, "queries know it at once")
	await settle(scatter)
	check(scatter.remove_instance(standing[1]), "what stands can be removed")


func test_changes_outside_of_the_tree() -> void:
	var viewer := make_viewer()
	var scatter := make_wood(viewer, false)
	scatter.state = ScatterState.new()
	await settle(scatter)
	var standing: PackedInt64Array = scatter.query_rect(Rect2(-60, -60, 120, 120)).ids
	var server := fell_everywhere(scatter, standing, 20_000)
	scatter.state.apply_diff(server.diff_since(0))
	root.remove_child(scatter)
	check(not scatter.has_instance(standing[0]), "answers outside of the tree")
	scatter.state.clear()
	check(scatter.has_instance(standing[0]), "and after all came back")
	root.add_child(scatter)
	await settle(scatter)
	var fresh := make_wood(viewer, false)
	await settle(fresh)
	check_equal(digests(scatter, 0), digests(fresh, 0), "the picture")
