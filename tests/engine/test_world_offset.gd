extends "harness.gd"
## Tests games that recenter: only the engine's origin moves in the world.

const FAR := Vector3(1048576.0, 0.0, -1048576.0) # 2^20 m, about 1000 km, which floats represent exactly.


func make_rock(radius := 2.0) -> ScatterLayer:
	var layer := make_layer(radius)
	layer.min_scale = 0.7
	layer.max_scale = 1.4
	layer.align_to_normal = 1.0
	return layer


func make_noise() -> ScatterGroundNoise:
	var terrain := ScatterGroundNoise.new()
	var noise := FastNoiseLite.new()
	noise.frequency = 0.01
	terrain.noise = noise
	return terrain


func test_a_recenter_moves_instances_and_regenerates_nothing() -> void:
	var viewer := make_viewer(Vector3(300.0, 0.0, 100.0))
	var scatter := make_scatter([make_rock()], ScatterGroundFlat.new(), viewer)
	await settle(scatter)
	var before := instances(scatter, 0)
	var digest := digests(scatter, 0)
	var stats := scatter.get_stats()
	var events := []
	scatter.tile_shown.connect(func(_layer: ScatterLayer, tile: Vector2i) -> void: events.push_back(tile))
	scatter.tile_hidden.connect(func(_layer: ScatterLayer, tile: Vector2i) -> void: events.push_back(tile))
	var shift := Vector3(256.0, 16.0, -1024.0)
	viewer.global_position -= shift
	scatter.world_offset = shift
	check_equal(scatter.world_offset, shift, "the property")
	var at_once := instances(scatter, 0)
	await frames(20)
	check(scatter.is_settled(), "a recenter leaves no work to do")
	check_equal(scatter.get_stats()["tiles_made"], stats["tiles_made"], "tiles generated for a recenter")
	check_equal(scatter.get_stats()["uploads"], stats["uploads"], "uploads for a recenter")
	check_equal(events.size(), 0, "tiles that were shown or hidden")
	check_equal(digests(scatter, 0), digest, "digests")
	for state: Dictionary[int, Transform3D] in [at_once, instances(scatter, 0)]:
		var worst := 0.0
		check_equal(state.size(), before.size(), "instances")
		for id in before:
			worst = maxf(worst, state[id].origin.distance_to(before[id].origin - shift))
			if state[id].basis != before[id].basis:
				check(false, "instance %d has a different basis" % id)
		check(worst < 1e-3, "an instance is off by %f m" % worst)
	for tile: Vector2i in scatter.get_shown_tiles(scatter.layers[0]):
		check_equal(scatter.get_tile(scatter.layers[0], tile).get_origin().x, (tile.x + 0.5) * 32.0 - shift.x, "origin of tile %s" % tile)


func test_a_recenter_during_a_flight() -> void:
	var viewer := make_viewer()
	var scatter := make_scatter([make_rock()], make_noise(), viewer)
	var made := {}
	scatter.tile_shown.connect(func(_layer: ScatterLayer, tile: Vector2i) -> void: made[tile] = made.get(tile, 0) + 1)
	var at := Vector3.ZERO # The viewer's position in the world.
	for step in 60:
		at.x += 9.0
		if step % 7 == 3:
			scatter.world_offset = Vector3(snappedf(at.x, 64.0), 0.0, 0.0)
		viewer.global_position = at - scatter.world_offset
		await process_frame
	await settle(scatter)
	for tile: Vector2i in made:
		if made[tile] != 1:
			check(false, "tile %s was shown %d times" % [tile, made[tile]])
	check(made.size() > 60, "%d tiles" % made.size())
	var still := make_scatter([make_rock()], make_noise(), make_viewer(at))
	await settle(still)
	var expected := instances(still, 0)
	var got := instances(scatter, 0)
	var found := 0
	for id in expected:
		if got.has(id):
			found += 1
			var off := got[id].origin.distance_to(expected[id].origin - scatter.world_offset)
			if off > 1e-3:
				check(false, "instance %d is off by %f m" % [id, off])
	check_equal(found, expected.size(), "instances in both")


func test_a_thousand_kilometers_out_is_as_exact_as_the_origin() -> void:
	var scatter := make_scatter([make_rock()], ScatterGroundFlat.new(), make_viewer())
	scatter.world_offset = FAR
	await settle(scatter)
	var standing := instances(scatter, 0)
	check(standing.size() > 2000, "%d instances" % standing.size())
	# There are no seams. Even across tiles, no two instances are closer than the radius, and each position has an instance within it.
	var closest := INF
	var grid := {}
	for id in standing:
		var position := on_map(standing[id])
		var cell := Vector2i((position / 2.0).floor())
		for x in range(cell.x - 1, cell.x + 2):
			for y in range(cell.y - 1, cell.y + 2):
				for other: Vector2 in grid.get(Vector2i(x, y), []):
					closest = minf(closest, position.distance_to(other))
		grid.get_or_add(cell, []).push_back(position)
	check(closest > 1.9999, "the closest two are %f apart" % closest)
	check(closest < 2.02, "the closest two are %f apart" % closest)
	var gap := 0.0
	for x in range(-20, 20):
		for y in range(-20, 20):
			var nearest := INF
			for cx in range(x - 3, x + 4):
				for cy in range(y - 3, y + 4):
					for other: Vector2 in grid.get(Vector2i(cx, cy), []):
						nearest = minf(nearest, other.distance_to(Vector2(x, y) * 2.0))
			gap = maxf(gap, nearest)
	check(gap < 2.0, "no instance within %f m of a position" % gap)
	# Near the viewer, positions are as precise as at the origin, because the engine's coordinates are small.
	var fine := 0
	for id in standing:
		fine += 1 if absf(fmod(standing[id].origin.x, 0.0625)) > 1e-4 else 0
	check(fine > standing.size() * 9 / 10, "positions are not multiples of 6 cm: %d" % fine)


func test_tiles_are_bit_identical_at_any_offset() -> void:
	var here := make_scatter([make_rock()], make_noise(), make_viewer(FAR))
	var there := make_scatter([make_rock()], make_noise(), make_viewer())
	there.world_offset = FAR
	await settle(here)
	await settle(there)
	var got := digests(there, 0)
	var expected := digests(here, 0)
	for tile: Vector2i in expected:
		check_equal(got.get(tile), expected[tile], "tile %s" % tile)
	check(expected.size() > 10, "more than 10 tiles are compared")


func test_queries_and_changes_use_the_engines_space() -> void:
	var viewer := make_viewer()
	var scatter := make_scatter([make_rock()], ScatterGroundFlat.new(), viewer)
	scatter.world_offset = FAR
	await settle(scatter)
	var found := scatter.query_sphere(Vector3(5.0, 0.0, 5.0), 20.0)
	var standing := instances(scatter, 0)
	var inside := 0
	for id in standing:
		inside += 1 if standing[id].origin.distance_to(Vector3(5.0, 0.0, 5.0)) < 20.0 else 0
	check_equal(found.ids.size(), inside, "instances within 20 m")
	check(inside > 50, "%d instances" % inside)
	for index in found.ids.size():
		var off := standing[found.get_id(index)].origin.distance_to(found.get_position(index))
		if off > 1e-3:
			check(false, "a query's position is off by %f m" % off)
	var built := scatter.build_rect(scatter.layers[0], Rect2(-8.0, -8.0, 16.0, 16.0))
	var ids := built.get_ids(0)
	var buffer := built.get_buffer(0)
	check(ids.size() > 20, "build_rect")
	for index in ids.size():
		var local := Vector3(buffer[12 * index + 3], buffer[12 * index + 7], buffer[12 * index + 11])
		check(standing[ids[index]].origin.distance_to(local + built.get_origin()) < 1e-3, "build_rect's position")
	# When the game recenters, a removed instance stays removed, and an added one keeps its position in the world.
	var nearest := scatter.query_nearest(Vector3.ZERO, 10.0)
	check(scatter.remove_instance(nearest["id"]), "removed")
	var planted := scatter.add_instance(scatter.layers[0], Transform3D(Basis(), Vector3(1.0, 0.0, 2.0)))
	var shift := Vector3(128.0, 0.0, 64.0)
	viewer.global_position -= shift
	scatter.world_offset = FAR + shift
	await frames(3)
	check(not scatter.has_instance(nearest["id"]), "still removed")
	var seen: Transform3D = scatter.get_instance(planted).transform
	check(seen.origin.distance_to(Vector3(1.0, 0.0, 2.0) - shift) < 1e-3, "the added instance is at %s" % seen.origin)
	check(instances(scatter, 0)[planted].origin.distance_to(seen.origin) < 1e-3, "drawn there")


func test_regions_that_move_along_are_no_edit() -> void:
	var world := Node3D.new()
	root.add_child(world)
	var layer := make_rock()
	var viewer := make_viewer(Vector3(3.3, 0.0, 1.1))
	var scatter := make_scatter([layer], ScatterGroundFlat.new(), viewer)
	scatter.reparent(world)
	scatter.viewers = [scatter.get_path_to(viewer)]
	var box := ScatterRegion3D.new()
	box.exclude = true
	box.size = Vector3(20.0, 10.0, 30.0)
	scatter.add_child(box)
	box.global_position = Vector3(10.37, 0.0, 3.21)
	var path := Path3D.new()
	path.curve = Curve3D.new()
	path.curve.add_point(Vector3(-30.0, 0.0, -20.0))
	path.curve.add_point(Vector3(30.0, 0.0, -25.0))
	scatter.add_child(path)
	path.global_position = Vector3(0.7, 0.0, 0.3)
	var road := ScatterRegion3D.new()
	road.shape = ScatterRegion3D.SHAPE_PATH
	road.exclude = true
	path.add_child(road)
	await settle(scatter)
	var before := digests(scatter, 0)
	var tiles_made: int = scatter.get_stats()["tiles_made"]
	for shift: Vector3 in [Vector3(1024.0, 0.0, -512.0), Vector3(1234.567, 0.0, 77.7)]:
		viewer.global_position -= shift - scatter.world_offset
		world.global_position -= shift - scatter.world_offset
		scatter.world_offset = shift
		await settle(scatter)
		await frames(5)
		check_equal(scatter.get_stats()["tiles_made"], tiles_made, "tiles generated after a recenter to %s" % shift)
		check_equal(digests(scatter, 0), before, "digests after a recenter to %s" % shift)
	box.global_position.x += 4.0
	await settle(scatter)
	check(scatter.get_stats()["tiles_made"] > tiles_made, "a region that moves in the world is an edit")
	tiles_made = scatter.get_stats()["tiles_made"]
	scatter.world_offset += Vector3(64.0, 0.0, 0.0) # The scene does not move along.
	await settle(scatter)
	check(scatter.get_stats()["tiles_made"] > tiles_made, "a region that does not move with the origin is an edit")


func test_ground_in_the_scene_moves_along() -> void:
	var ground := StaticBody3D.new()
	var shape := CollisionShape3D.new()
	shape.shape = BoxShape3D.new()
	(shape.shape as BoxShape3D).size = Vector3(400.0, 2.0, 400.0)
	ground.add_child(shape)
	root.add_child(ground)
	ground.global_position.y = 6.0 # The top is at 7 m.
	var viewer := make_viewer()
	var scatter := make_scatter([make_rock()], ScatterGroundColliders.new(), viewer)
	await settle(scatter)
	var before := instances(scatter, 0)
	check(before.size() > 1000, "%d instances" % before.size())
	var shift := Vector3(512.0, 256.0, -128.0)
	ground.global_position -= shift
	viewer.global_position -= shift
	scatter.world_offset = shift
	await frames(5)
	scatter.regenerate()
	await settle(scatter)
	var after := instances(scatter, 0)
	check_equal(after.size(), before.size(), "instances on ground that moved along")
	for id in before:
		if not after.has(id) or after[id].origin.distance_to(before[id].origin - shift) > 2e-3:
			check(false, "an instance has moved: %s" % before[id].origin)
			break


## A node that returns heights in the engine's space.
class Slope extends Node3D:
	func get_height(at: Vector3) -> float:
		return 0.5 * at.x - 0.25 * at.z


## Returns the same slope, 0.5 x - 0.25 z in the engine's space, as each kind of ground that uses nodes in the scene.
func make_slopes() -> Dictionary[String, ScatterGround]:
	var result: Dictionary[String, ScatterGround] = {}
	var node := Slope.new()
	node.name = "Slope"
	root.add_child(node)
	for thread_safe: bool in [false, true]:
		var of_object := ScatterGroundNode.new()
		of_object.node = ^"../Slope"
		of_object.thread_safe = thread_safe
		result["an object, thread_safe %s" % thread_safe] = of_object
	var mesh := ArrayMesh.new()
	var arrays := []
	arrays.resize(Mesh.ARRAY_MAX)
	var corners := PackedVector3Array()
	for at: Vector2 in [Vector2(-300, -300), Vector2(300, -300), Vector2(300, 300), Vector2(-300, -300),
			Vector2(300, 300), Vector2(-300, 300)]:
		corners.push_back(Vector3(at.x, 0.5 * at.x - 0.25 * at.y, at.y))
	arrays[Mesh.ARRAY_VERTEX] = corners
	mesh.add_surface_from_arrays(Mesh.PRIMITIVE_TRIANGLES, arrays)
	var instance := MeshInstance3D.new()
	instance.mesh = mesh
	instance.add_to_group(&"slope")
	root.add_child(instance)
	instance.create_trimesh_collision()
	result["meshes"] = ScatterGroundMeshes.new()
	(result["meshes"] as ScatterGroundMeshes).group = &"slope"
	result["colliders"] = ScatterGroundColliders.new()
	(result["colliders"] as ScatterGroundColliders).rays_per_frame = 5000
	return result


func check_on_slope(scatter: TerrainScatter3D, context: String) -> void:
	var wrong := 0
	var stand := instances(scatter, 0)
	for id in stand:
		var at := stand[id].origin
		wrong += int(absf(at.y - (0.5 * at.x - 0.25 * at.z)) > 0.02)
	check(stand.size() > 1000, "%s: %d instances" % [context, stand.size()])
	check_equal(wrong, 0, context + ": instances off the ground")


## Nodes that share a ground use it with their own world offsets.
func test_nodes_with_different_offsets_share_a_ground() -> void:
	var slopes := make_slopes()
	for kind in slopes:
		var terrain := slopes[kind]
		var here := make_scatter([make_layer()], terrain, make_viewer())
		var there := make_scatter([make_layer()], terrain, make_viewer())
		there.world_offset = Vector3(64.0, 16.0, -32.0)
		await settle(here)
		await settle(there)
		check_on_slope(here, kind + ", here")
		check_on_slope(there, kind + ", there")
		here.regenerate()
		await frames(2) # While one node's tiles are pending, the other recenters alone, so it covers a different part of the scene.
		there.world_offset = Vector3(-96.0, 0.0, 0.0)
		there.regenerate()
		if terrain is ScatterGroundMeshes:
			terrain.refresh() # The mesh has not moved along, so it must be read again at the new offset.
		await settle(here)
		await settle(there)
		check_on_slope(here, kind + ", here, after the other node recentered")
		check_on_slope(there, kind + ", recentered")
		var built := here.build_rect(here.layers[0], Rect2(-8.0, -8.0, 16.0, 16.0))
		check(absf(built.get_origin().y) < 10.0, kind + ": build_rect, around %s" % built.get_origin())
		here.free()
		there.regenerate()
		await settle(there)
		check_on_slope(there, kind + ", alone")
		there.free()
		check_no_error(kind)


func test_bodies_follow_the_world_offset() -> void:
	var viewer := make_viewer()
	var layer := make_rock(4.0)
	layer.collision_shape = ScatterLayer.COLLISION_CAPSULE
	layer.collision_distance = 30.0
	var scatter := make_scatter([layer], ScatterGroundFlat.new(), viewer)
	scatter.world_offset = FAR
	await settle(scatter)
	var shift := Vector3(-64.0, 0.0, 32.0)
	viewer.global_position -= shift
	scatter.world_offset = FAR + shift
	await frames(5)
	for frame in 3:
		await physics_frame
	var nearest := scatter.query_nearest(viewer.global_position, 20.0)
	var at: Vector3 = (nearest["transform"] as Transform3D).origin
	var ray := PhysicsRayQueryParameters3D.create(at + Vector3(0.0, 8.0, 0.0), at - Vector3(0.0, 8.0, 0.0))
	var hit := scatter.get_world_3d().direct_space_state.intersect_ray(ray)
	if check(not hit.is_empty(), "a ray hits the nearest instance after a recenter"):
		check_equal(scatter.get_body_instance(hit["rid"]), nearest["id"], "the instance that was hit")


func test_the_largest_distance_for_a_radius() -> void:
	# Base squares with edges of r / sqrt 2 are numbered from -2^23, so a layer with a radius of 2 m extends to about 11,863 km.
	var edge := 8388608.0 * 2.0 / sqrt(2.0)
	var viewer := make_viewer()
	var scatter := make_scatter([make_rock()], ScatterGroundFlat.new(), viewer)
	scatter.world_offset = Vector3(11.0e6, 0.0, 0.0)
	await settle(scatter)
	check(instances(scatter, 0).size() > 2000, "instances 11,000 km out")
	check_no_error("11,000 km out")
	scatter.world_offset = Vector3(edge + 1000.0, 0.0, 0.0)
	await frames(30)
	await settle(scatter)
	check_equal(instances(scatter, 0).size(), 0, "instances beyond the last cell")
	check_error(["TerrainScatter3D, layer 0", "must be between"], "beyond the last cell")


func test_bad_values() -> void:
	var scatter := make_scatter([], ScatterGroundFlat.new(), make_viewer())
	scatter.world_offset = Vector3(NAN, 0.0, 0.0)
	check_error(["TerrainScatter3D", "world_offset"], "not a number")
	scatter.world_offset = Vector3(0.0, 2e12, 0.0)
	check_error(["TerrainScatter3D", "world_offset"], "too far")
	check_equal(scatter.world_offset, Vector3.ZERO, "rejected values have no effect")
