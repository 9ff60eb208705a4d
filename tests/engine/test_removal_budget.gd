extends "collision_harness.gd"
## Tests that bodies, scenes and multimeshes are removed over several frames, regardless of the reason. Bodies near the viewer are removed first.

## The maximum number of bodies that one step removes. With a budget of 1 µs, a frame does one step.
const MOST_IN_A_STEP := 16

## A scene's root node that counts its existing instances, including pooled ones.
class Counted extends Node3D:
	static var alive := 0

	func _init() -> void:
		alive += 1

	func _notification(context: int) -> void:
		alive -= int(context == NOTIFICATION_PREDELETE)


func make_dense_layer() -> ScatterLayer:
	var layer := make_solid_layer()
	layer.radius = 1.5
	layer.collision_distance = 30.0
	return layer


## Returns a settled scatter with hundreds of bodies and a budget for one step per frame.
func make_dense(layers: Array[ScatterLayer]) -> TerrainScatter3D:
	var scatter := make_solid(layers)
	await settle(scatter)
	check(scatter.get_stats()["bodies"] > 500, "%d bodies" % scatter.get_stats()["bodies"])
	scatter.frame_budget_usec = 1
	return scatter


## Calls `change` and checks the removals. No frame may remove more bodies than one step does, and the nearest bodies must be removed first.
## If `wanted` new bodies replace them, the order is not checked, because the new bodies have the same IDs.
func check_removal(scatter: TerrainScatter3D, context: String, change: Callable, wanted := 0) -> void:
	var standing := bodies(scatter)
	var distances: Dictionary[int, float] = {}
	for id in standing:
		var at: Transform3D = PhysicsServer3D.body_get_state(standing[id], PhysicsServer3D.BODY_STATE_TRANSFORM)
		distances[id] = at.origin.distance_to(viewer.global_position)
	await process_frame
	change.call()
	check_equal(bodies(scatter).size(), standing.size(), context + ": the call itself removes no body")
	var previous := standing.size()
	var maximum := 0
	for frame in 40:
		await process_frame
		var left := bodies(scatter)
		maximum = maxi(maximum, previous - left.size())
		previous = left.size()
		if wanted == 0 and standing.size() - previous < 100:
			var nearest_left := INF
			var farthest_gone := 0.0
			for id in distances:
				if left.get(id, RID()) == standing[id]:
					nearest_left = minf(nearest_left, distances[id])
				else:
					farthest_gone = maxf(farthest_gone, distances[id])
			# Frames check cells by their distance from the viewer. Within a cell, the order is exact.
			check(farthest_gone < nearest_left + 12.0, "%s: a body %.1f m away is removed, one at %.1f m is not" % [context, farthest_gone, nearest_left])
	check(maximum > 0 and maximum <= MOST_IN_A_STEP, "%s: %d bodies in one frame" % [context, maximum])
	scatter.frame_budget_usec = 20000
	await settle(scatter)
	check(scatter.get_stats()["bodies"] >= wanted, "%s: %d bodies at the end" % [context, scatter.get_stats()["bodies"]])
	if wanted == 0:
		check_equal(bodies(scatter).size(), 0, context + ": bodies at the end")
	scatter.free()
	viewer.free()
	await frames(2)


func test_collision_off() -> void:
	var layer := make_dense_layer()
	var scatter := await make_dense([layer])
	await check_removal(scatter, "collision off", func() -> void: layer.collision_shape = ScatterLayer.COLLISION_NONE)


func test_a_new_seed() -> void:
	var scatter := await make_dense([make_dense_layer()])
	await check_removal(scatter, "a new seed", func() -> void: scatter.seed += 1, 500)


func test_no_layers() -> void:
	var scatter := await make_dense([make_dense_layer()])
	await check_removal(scatter, "no layers", func() -> void: scatter.layers = [])


func test_no_ground() -> void:
	var scatter := await make_dense([make_dense_layer()])
	await check_removal(scatter, "no ground", func() -> void: scatter.ground = null)


func test_a_removed_layer() -> void:
	var scatter := await make_dense([make_layer(), make_dense_layer()])
	await check_removal(scatter, "a removed layer", func() -> void: scatter.layers = [scatter.layers[0]])


func test_a_state_with_many_removals() -> void:
	var scatter := await make_dense([make_dense_layer()])
	var state := ScatterState.new()
	var other := make_scatter(scatter.layers, scatter.ground, viewer)
	await settle(other)
	other.state = state
	check(other.remove_in_sphere(Vector3.ZERO, 60.0).size() > 1024, "the other node removes its instances")
	other.free()
	await check_removal(scatter, "a state", func() -> void: scatter.state = state)


## After a teleport, all bodies are far away. They may remain for a while, but one frame must not remove all of them.
func test_a_teleport() -> void:
	var scatter := await make_dense([make_dense_layer()])
	var previous := bodies(scatter).size()
	viewer.position.x = 3000.0
	var maximum := 0
	for frame in 40:
		await process_frame
		var now := bodies(scatter).size()
		maximum = maxi(maximum, previous - now)
		previous = now
	check(maximum > 0 and maximum <= MOST_IN_A_STEP, "%d bodies in one frame" % maximum)
	scatter.frame_budget_usec = 20000
	await settle(scatter)
	check_equal(bodies(scatter).size(), 0, "bodies at the old position")


## New body settings are applied to one step's bodies per frame, the nearest first.
func test_new_settings_and_shapes() -> void:
	var layer := make_dense_layer()
	var scatter := await make_dense([layer])
	var standing := bodies(scatter)
	var changes: Dictionary[String, Callable] = {
		"mask": func() -> void: layer.collision_mask = 4,
		"height": func() -> void: layer.instance_height = 1.5}
	for context in changes:
		changes[context].call()
		var before := 0
		for frame in 30:
			await process_frame
			var done := 0
			var found := bodies(scatter)
			for id in standing:
				var rid: RID = found[id]
				if context == "mask":
					done += int(PhysicsServer3D.body_get_collision_mask(rid) == 4)
				else:
					done += int(rid != standing[id])
			check(done - before <= MOST_IN_A_STEP, "%s: %d bodies in one frame" % [context, done - before])
			before = done
		check(before > 0 and before < standing.size(), "%s: %d bodies after some frames" % [context, before])
		scatter.frame_budget_usec = 20000
		await settle(scatter)
		standing = bodies(scatter)
		for id in standing:
			check_equal(PhysicsServer3D.body_get_collision_mask(standing[id]), 4, "collision mask at the end")
		scatter.frame_budget_usec = 1


func place_of(body: RID) -> Vector3:
	return (PhysicsServer3D.body_get_state(body, PhysicsServer3D.BODY_STATE_TRANSFORM) as Transform3D).origin


## After an origin shift, bodies near the viewer are immediately correct. None is missing, and none remains at its old position.
func test_world_offset() -> void:
	var scatter := await make_dense([make_dense_layer()])
	var standing := bodies(scatter)
	var before: Dictionary[int, Vector3] = {}
	for id in standing:
		before[id] = place_of(standing[id])
	var shift := Vector3(12, 0, 0)
	scatter.world_offset = shift
	viewer.position -= shift
	var moved := 0
	for id in standing:
		var now := place_of(standing[id])
		var is_right := now.is_equal_approx(before[id] - shift)
		moved += int(is_right)
		check(is_right or now == before[id], "a body is at its old or at its new position")
		if not is_right:
			check(now.distance_to(viewer.position) > 4.0, "a body at its old position, %.1f m from the viewer" % now.distance_to(viewer.position))
			check((before[id] - shift).distance_to(viewer.position) > 4.0, "a body near the viewer is missing")
	check(moved <= 128, "%d bodies moved in the call" % moved)
	for frame in 20:
		await process_frame
		var now_moved := 0
		for id in standing:
			now_moved += int(place_of(standing[id]).is_equal_approx(before[id] - shift))
		check(now_moved - moved <= MOST_IN_A_STEP, "%d bodies moved in a frame" % (now_moved - moved))
		moved = now_moved
	check(moved < standing.size(), "not all bodies have moved yet")
	check(not scatter.is_settled(), "the node is not settled while bodies remain to be moved")
	scatter.frame_budget_usec = 20000
	await settle(scatter)
	for id in standing:
		check(place_of(standing[id]).is_equal_approx(before[id] - shift), "all bodies have moved at the end")
	check_equal(scatter.get_stats()["bodies"], standing.size(), "bodies after the origin shift")


func test_unused_scenes_are_freed_over_frames() -> void:
	var layer := make_layer(1.0)
	var scene := PackedScene.new()
	var root_node := Counted.new()
	scene.pack(root_node)
	root_node.free()
	layer.scene = scene
	layer.scene_distance = 12.0
	viewer = make_viewer()
	var scatter := make_scatter([layer], ScatterGroundFlat.new(), viewer)
	await settle(scatter)
	var alive := Counted.alive
	check(alive > 200, "%d scenes" % alive)
	layer.scene = null
	var maximum := 0
	var deadline := Time.get_ticks_msec() + IDLE_TIMEOUT_MSEC
	while Counted.alive > 0 and Time.get_ticks_msec() < deadline:
		await process_frame
		maximum = maxi(maximum, alive - Counted.alive)
		alive = Counted.alive
	check_equal(Counted.alive, 0, "scenes at the end")
	check(maximum <= 4, "%d scenes freed in one frame" % maximum)


func test_multimeshes_are_freed_over_frames() -> void:
	var layer := make_layer(0.5)
	layer.draw_cell_size = 4.0
	viewer = make_viewer()
	var scatter := make_scatter([layer], ScatterGroundFlat.new(), viewer)
	await settle(scatter)
	var changes: Dictionary[String, Callable] = {
		"a new seed": func() -> void: scatter.seed += 1,
		"no layers": func() -> void: scatter.layers = []}
	for context in changes:
		await until(func() -> bool: return scatter.get_stats()["multimeshes_leaving"] == 0, "all multimeshes are freed")
		check(scatter.get_stats()["multimeshes"] >= 20, "%d multimeshes" % scatter.get_stats()["multimeshes"])
		scatter.frame_budget_usec = 1
		changes[context].call()
		var leaving := 0
		var most_leaving := 0
		var maximum := 0
		for frame in 300:
			await process_frame
			var now: int = scatter.get_stats()["multimeshes_leaving"]
			maximum = maxi(maximum, leaving - now)
			most_leaving = maxi(most_leaving, now)
			leaving = now
		check(most_leaving > 0, "%s: multimeshes are being removed" % context)
		check(maximum <= 2, "%s: %d multimeshes freed in one frame" % [context, maximum])
		scatter.frame_budget_usec = 20000
		await settle(scatter)
