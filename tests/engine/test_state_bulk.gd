extends "harness.gd"
## Tests very many changes in one call. Queries are up to date immediately. Tiles, bodies, scenes and signals are updated over several frames.


func make_wood(viewer: Node3D, collide := true) -> TerrainScatter3D:
	var layer := make_layer(0.5)
	layer.view_distance = 100.0
	if collide:
		layer.collision_shape = ScatterLayer.COLLISION_CYLINDER
		layer.collision_distance = 10.0
	return make_scatter([layer], ScatterGroundFlat.new(), viewer)


## Returns a copy of the node's state in which half of these instances, and `far` more points of the layer, are removed.
func remove_many(scatter: TerrainScatter3D, standing: PackedInt64Array, far: int) -> ScatterState:
	var server := ScatterState.new()
	server.from_bytes(scatter.state.to_bytes())
	for index in range(0, standing.size(), 2):
		server.remove(standing[index])
	for index in far:
		server.remove((standing[0] & ~0xffffffffffff) | (index << 3))
	return server


func test_many_changes_in_one_call() -> void:
	var viewer := make_viewer()
	var scatter := make_wood(viewer)
	scatter.state = ScatterState.new()
	await settle(scatter)
	var standing: PackedInt64Array = scatter.query_rect(Rect2(-60, -60, 120, 120)).ids
	var server := remove_many(scatter, standing, 300_000)
	var reported_ids := {}
	scatter.instance_removed.connect(func(id: int, _layer: ScatterLayer, _at: Transform3D) -> void: reported_ids[id] = true)
	var diff := server.diff_since(0)
	check_equal(scatter.state.apply_diff(diff), OK, "the diff")
	check_equal(scatter.state.get_digest(), server.get_digest(), "the state is up to date immediately")
	var left: PackedInt64Array = scatter.query_rect(Rect2(-60, -60, 120, 120)).ids
	check_equal(left.size(), standing.size() / 2, "instances that a query finds immediately")
	check(not scatter.has_instance(standing[0]) and scatter.has_instance(standing[1]), "has_instance is up to date immediately")
	check(reported_ids.size() < 5000, "%d signals in one call" % reported_ids.size())
	# Direct calls emit their signals immediately.
	check(scatter.remove_instance(standing[1]), "by hand")
	check(reported_ids.has(standing[1]), "reported immediately")
	check(scatter.restore_instance(standing[2]), "restored before its removal was reported")
	scatter.frame_budget_usec = 1000
	var longest := 0
	var waited := 0
	while not (scatter.is_settled() and reported_ids.size() >= standing.size() / 2):
		await process_frame
		longest = maxi(longest, scatter.get_stats()["frame_usec"])
		waited += 1
		if not check(waited < 20000, "still not settled") :
			break
	print("very many changes: %d frames, the longest %d us" % [waited, longest])
	check(waited > 2, "the changes take several frames")
	check(not reported_ids.has(standing[2]), "a restored instance is not reported as removed")
	for index in range(4, standing.size(), 2):
		if not reported_ids.has(standing[index]):
			check(false, "every removal of a loaded instance is reported")
			break
	var new_scatter := make_wood(viewer)
	new_scatter.state = scatter.state
	await settle(new_scatter)
	check_equal(digests(scatter, 0), digests(new_scatter, 0), "the visible tiles")
	check_equal(scatter.get_stats()["bodies"], new_scatter.get_stats()["bodies"], "bodies")


func test_clearing_restores_everything() -> void:
	var viewer := make_viewer()
	var scatter := make_wood(viewer)
	await settle(scatter)
	var before := digests(scatter, 0)
	var bodies: int = scatter.get_stats()["bodies"]
	var standing: PackedInt64Array = scatter.query_rect(Rect2(-60, -60, 120, 120)).ids
	scatter.remove_in_sphere(Vector3.ZERO, 50.0)
	await settle(scatter)
	check(digests(scatter, 0) != before, "the tiles have changed")
	scatter.state.clear()
	check_equal(scatter.query_rect(Rect2(-60, -60, 120, 120)).ids, standing, "instances that a query finds immediately after clear")
	await settle(scatter)
	check_equal(digests(scatter, 0), before, "the tiles are the same as before")
	check_equal(scatter.get_stats()["bodies"], bodies, "the bodies, too")


## With very many changes, tiles are updated over several frames, but only tiles near the changes are updated.
func test_many_changes_in_a_few_areas() -> void:
	var viewer := make_viewer()
	var scatter := make_wood(viewer, false)
	await settle(scatter)
	var points: Array[Vector3] = [Vector3(-45.0, 0.0, 20.0), Vector3(50.0, 0.0, -50.0), Vector3(-40.0, 0.0, 45.0)]
	var removed := PackedInt64Array()
	for point in points: # All removals are in one frame.
		var ids := scatter.remove_in_sphere(point, 16.0)
		check(ids.size() > 1024 and ids.size() < 16384, "%d removed" % ids.size())
		removed.append_array(ids)
	await settle(scatter)
	var new_scatter := make_wood(viewer, false)
	new_scatter.state = scatter.state
	await settle(new_scatter)
	check_equal(digests(scatter, 0), digests(new_scatter, 0), "the visible tiles")
	var back := ScatterState.new()
	back.from_bytes(scatter.state.to_bytes())
	var revision := back.get_revision()
	for id in removed:
		back.restore(id)
	check_equal(scatter.state.apply_diff(back.diff_since(revision, false)), OK, "all restored by a diff")
	await settle(scatter)
	new_scatter.state = null
	await settle(new_scatter)
	check_equal(digests(scatter, 0), digests(new_scatter, 0), "the visible tiles after the restoration")


## A worker thread can read hundreds of thousands of changes, such as those that a late-joining peer receives.
func test_a_whole_state_is_read_on_a_thread() -> void:
	var scatter := make_wood(make_viewer())
	scatter.state = ScatterState.new()
	await settle(scatter)
	var standing: PackedInt64Array = scatter.query_rect(Rect2(-60, -60, 120, 120)).ids
	var server := remove_many(scatter, standing, 300_000)
	var whole := ScatterState.new()
	var thread_ids := []
	var bytes := server.to_bytes()
	var task := WorkerThreadPool.add_task(func() -> void:
		thread_ids.push_back(OS.get_thread_caller_id())
		thread_ids.push_back(whole.from_bytes(bytes)))
	while not WorkerThreadPool.is_task_completed(task):
		await process_frame
	WorkerThreadPool.wait_for_task_completion(task)
	check(thread_ids[0] != OS.get_main_thread_id(), "the state is read on a worker thread")
	check_equal(thread_ids[1], OK, "the bytes")
	scatter.state = whole
	check_equal(scatter.state.get_digest(), server.get_digest(), "the node's state equals the state that was read")
	@warning_ignore("integer_division")
	check_equal(scatter.query_rect(Rect2(-60, -60, 120, 120)).ids.size(), standing.size() / 2, "queries are up to date immediately")
	await settle(scatter)
	check(scatter.remove_instance(standing[1]), "remaining instances can be removed")


func test_changes_outside_of_the_tree() -> void:
	var viewer := make_viewer()
	var scatter := make_wood(viewer, false)
	scatter.state = ScatterState.new()
	await settle(scatter)
	var standing: PackedInt64Array = scatter.query_rect(Rect2(-60, -60, 120, 120)).ids
	var server := remove_many(scatter, standing, 20_000)
	scatter.state.apply_diff(server.diff_since(0))
	root.remove_child(scatter)
	check(not scatter.has_instance(standing[0]), "queries work outside of the tree")
	scatter.state.clear()
	check(scatter.has_instance(standing[0]), "the query finds a restored instance outside of the tree")
	root.add_child(scatter)
	await settle(scatter)
	var new_scatter := make_wood(viewer, false)
	await settle(new_scatter)
	check_equal(digests(scatter, 0), digests(new_scatter, 0), "the visible tiles")
