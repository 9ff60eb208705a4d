extends "threads_harness.gd"
## Tests calls on worker threads: queries of a ScatterSnapshot and requests.


## Returns the results of several queries of a node or its snapshot. `layers` are the node's layers.
func answers_of(target: Variant, layers: Array[ScatterLayer], ids: PackedInt64Array) -> Array:
	var answers := []
	for question: Callable in [
			func() -> Variant: return target.query_rect(Rect2(-50, -50, 100, 100)),
			func() -> Variant: return target.query_rect(Rect2(700, -300, 60, 60), "trees"),
			func() -> Variant: return target.query_sphere(Vector3(10, 0, 5), 40.0, layers),
			func() -> Variant: return target.query_sphere(Vector3(0, 0, 0), 40.0, layers[0], func(id: int, _layer: ScatterLayer, at: Transform3D) -> bool:
				return id % 2 == 0 and at.origin.x > 0.0)]:
		var found: ScatterInstances = question.call()
		answers.append_array([found.ids, found.layers, found.layer_indices, found.meshes, found.transforms])
	var hit: ScatterInstance = target.query_ray(Vector3(-60, 1, -3), Vector3(60, 1, 8))
	answers.append_array([hit.id, hit.transform, hit.distance, hit.hit_position, hit.data] if hit else [null])
	for at: Vector3 in [Vector3.ZERO, Vector3(400, 0, 20)]:
		var nearest: ScatterInstance = target.query_nearest(at, 60.0)
		answers.append_array([nearest.id, nearest.transform, nearest.distance, nearest.data] if nearest else [null])
	for id in ids:
		var instance: ScatterInstance = target.get_instance(id)
		answers.append_array([target.has_instance(id), target.get_instance_data(id)])
		answers.append_array([instance.transform, instance.mesh, instance.added, instance.data] if instance else [null])
	return answers


func test_a_snapshot_returns_what_the_node_did() -> void:
	var viewer := make_viewer()
	var scatter := make_wood(viewer)
	scatter.state = ScatterState.new()
	await settle(scatter)
	var some := scatter.query_sphere(Vector3.ZERO, 40.0, "trees").ids
	scatter.remove_instances(some.slice(0, 3))
	scatter.set_instance_data(some[4], {"name": "old oak"})
	var placed := scatter.add_instance("trees", Transform3D(Basis(), Vector3(3, 0, 4)))
	var ids := some.slice(0, 8) + PackedInt64Array([placed, 12345])
	var layers := scatter.layers.duplicate()
	var expected := answers_of(scatter, layers, ids)
	var snapshots: Array[ScatterSnapshot] = [scatter.make_snapshot()]
	# Later changes must not affect the snapshot.
	scatter.remove_in_sphere(Vector3.ZERO, 50.0)
	scatter.remove_instance(placed)
	var next := answers_of(scatter, layers, ids)
	snapshots.push_back(scatter.make_snapshot())
	scatter.state.clear()
	scatter.seed = 1234
	scatter.layers[0].radius = 7.0
	viewer.position.x = 500.0
	var threads: Array[Thread] = []
	for index in 6:
		var thread := Thread.new()
		thread.start(answers_of.bind(snapshots[index % 2], layers, ids))
		threads.push_back(thread)
	for frame in 3:
		await process_frame
		scatter.query_sphere(Vector3.ZERO, 100.0)
		scatter.remove_in_sphere(Vector3(frame * 10.0, 0, 0), 3.0)
	for index in threads.size():
		check_equal(threads[index].wait_to_finish(), [expected, next][index % 2], "results of the snapshot on thread %d" % index)
	scatter.free()
	check_equal(answers_of(snapshots[0], layers, ids), expected, "after the node was freed")
	check(expected != next, "the snapshots differ")


func test_a_snapshot_rejects_as_the_node_does() -> void:
	var scatter := make_wood(make_viewer())
	await settle(scatter)
	var snapshot := scatter.make_snapshot()
	check_equal(snapshot.query_rect(Rect2(0, 0, 5, 5), "bushes").size(), 0, "no such layer")
	check_error(["ScatterSnapshot.query_rect", "bushes"], "no such layer")
	check_equal(snapshot.query_sphere(Vector3.ZERO, -1.0).size(), 0, "a negative radius")
	check_error(["ScatterSnapshot.query_sphere", "radius"], "a negative radius")
	check_equal(snapshot.query_rect(Rect2(0, 0, 1e5, 1e5)).size(), 0, "too much")
	check_error(["ScatterSnapshot.query_rect", "too many points"], "too much")
	check_equal(snapshot.query_sphere(Vector3.ZERO, 9.0, [], func() -> void: pass).size(), 0, "a predicate")
	check_error(["ScatterSnapshot.query_sphere", "predicate"], "a predicate")
	var empty := TerrainScatter3D.new()
	var nothing := empty.make_snapshot()
	check_error(["TerrainScatter3D.make_snapshot", "ground"], "a node without ground")
	check_equal(nothing.query_sphere(Vector3.ZERO, 9.0).size(), 0, "an empty snapshot")
	check_error(["ScatterSnapshot.query_sphere", "missing"], "an empty snapshot")
	empty.free()


class Plateau extends ScatterGround:
	func _get_heights(positions: PackedVector2Array) -> PackedFloat32Array:
		var heights := PackedFloat32Array()
		heights.resize(positions.size())
		return heights


## If only the main thread can query the ground, a snapshot contains the loaded tiles and prints an error for all others.
func test_a_snapshot_of_ground_for_the_main_thread_only() -> void:
	var scatter := make_scatter([make_layer(4.0)], Plateau.new(), make_viewer())
	await settle(scatter)
	var near := scatter.query_sphere(Vector3.ZERO, 20.0).ids
	var snapshot := scatter.make_snapshot()
	check_equal(on_thread(func() -> PackedInt64Array: return snapshot.query_sphere(Vector3.ZERO, 20.0).ids), near, "loaded tiles")
	check_equal(on_thread(func() -> int: return snapshot.query_sphere(Vector3(900, 0, 0), 20.0).size()), 0, "tiles that are not loaded")
	check_error(["ScatterSnapshot.query_sphere", "main thread", "request_sphere()"], "tiles that are not loaded")


func test_requests_from_other_threads() -> void:
	var scatter := make_wood(make_viewer())
	await settle(scatter)
	var rect := Rect2(500, -40, 80, 80)
	var layers := ["trees"]
	var requests: Array[ScatterRequest] = []
	var threads: Array[Thread] = []
	for index in 4:
		var thread := Thread.new()
		thread.start(func() -> Array: return [scatter.request_rect(rect, layers), scatter.request_sphere(Vector3(0, 0, 300), 30.0)])
		threads.push_back(thread)
	for thread in threads:
		for request: ScatterRequest in thread.wait_to_finish():
			check(not request.is_completed() and request.get_result().is_empty(), "not completed immediately")
			requests.push_back(request)
	layers[0] = "no such layer"
	var signal_count: Array[int] = [0]
	for request in requests:
		request.completed.connect(func(found: ScatterInstances) -> void: signal_count[0] += int(found.size() > 0))
	await until(func() -> bool: return requests.all(func(request: ScatterRequest) -> bool: return request.is_completed()), "all requests are completed")
	check_equal(signal_count[0], 8, "signals with a result")
	check_equal(requests[0].get_result().ids, scatter.query_rect(rect, "trees").ids, "IDs of a rectangle, requested and queried")
	check_equal(requests[1].get_result().ids, scatter.query_sphere(Vector3(0, 0, 300), 30.0).ids, "IDs of a sphere, requested and queried")


func test_failed_and_canceled_requests() -> void:
	var scatter := make_wood(make_viewer())
	await settle(scatter)
	var request: ScatterRequest = on_thread(func() -> ScatterRequest: return scatter.request_rect(Rect2(0, 0, 9, 9), "bushes"))
	await until(request.is_completed, "a missing layer")
	check_error(["TerrainScatter3D.request_rect", "bushes"], "a missing layer")
	check_equal(request.get_result().size(), 0, "instances in the result of a failed request")
	var canceled: Array = on_thread(func() -> Array:
		var mine := scatter.request_sphere(Vector3(2000, 0, 0), 50.0)
		return [mine, mine.cancel(), mine.cancel()])
	check_equal(canceled.slice(1), [true, false], "cancel on the thread of the request returns true only once")
	var later := scatter.request_sphere(Vector3(3000, 0, 0), 50.0)
	check_equal(on_thread(later.cancel), true, "cancel on another thread returns true")
	var signal_count: Array[int] = [0]
	later.completed.connect(func(found: ScatterInstances) -> void: signal_count[0] += 1 + found.size())
	await frames(5)
	check(later.is_canceled() and later.is_completed() and (canceled[0] as ScatterRequest).is_completed(), "canceled requests are completed")
	check_equal(signal_count[0], 1, "one signal with an empty result")
	var left: ScatterRequest = on_thread(func() -> ScatterRequest: return scatter.request_sphere(Vector3(4000, 0, 0), 50.0))
	root.remove_child(scatter)
	await frames(2)
	check(left.is_completed() and not left.is_canceled(), "leaving the tree completes requests")
	scatter.free()


## Requests, snapshots and queries on threads while a game streams tiles, removes instances and makes edits.
func test_threads_during_a_game() -> void:
	var viewer := make_viewer()
	var scatter := make_wood(viewer)
	scatter.state = ScatterState.new()
	await settle(scatter)
	var shared: Array[ScatterSnapshot] = [scatter.make_snapshot()]
	var mutex := Mutex.new()
	var open: Array[ScatterRequest] = []
	var query := func() -> void:
		mutex.lock()
		var snapshot := shared[0]
		mutex.unlock()
		var found := snapshot.query_sphere(Vector3(randf() * 200.0, 0, 0), 20.0)
		for id in found.ids:
			snapshot.has_instance(id)
	var request := func() -> void:
		var made := scatter.request_sphere(Vector3(randf() * 400.0, 0, 50), 10.0)
		if randi() % 3 == 0:
			made.cancel()
		mutex.lock()
		open.push_back(made)
		mutex.unlock()
		OS.delay_msec(1)
	await on_threads_for(1500, [query, query, request], func() -> void:
		viewer.position.x += 2.0
		scatter.remove_in_sphere(viewer.position, 4.0)
		scatter.add_instance("trees", Transform3D(Basis(), viewer.position))
		if randi() % 8 == 0:
			scatter.layers[1].density = randf_range(0.5, 1.0)
		mutex.lock()
		shared[0] = scatter.make_snapshot()
		mutex.unlock())
	check(open.size() > 10, "%d requests" % open.size())
	await until(func() -> bool: return open.all(func(made: ScatterRequest) -> bool: return made.is_completed()), "all requests are completed")
