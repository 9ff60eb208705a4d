extends "collision_harness.gd"
## Tests layers that grow on all surfaces of meshes: levels, walls and ceilings. Covers screenshots, queries, bodies, removals, saved states,
## and ground that changes.

const RADIUS := 1.0
const SIZE := 24.0
const DENSITY := 0.547 / (PI * 0.25) ## The number of points per square meter of surface at a radius of 1 m.


func put(mesh: Mesh, at: Transform3D) -> MeshInstance3D:
	var instance := MeshInstance3D.new()
	instance.mesh = mesh
	instance.transform = at
	instance.add_to_group(&"ground")
	root.add_child(instance)
	return instance


## Adds a square of ground, rotated about the x axis: 0 degrees faces up, 90 is a wall that faces +z, 180 faces down.
func put_square(height: float, degrees := 0.0) -> MeshInstance3D:
	var mesh := PlaneMesh.new()
	mesh.size = Vector2(SIZE, SIZE)
	return put(mesh, Transform3D(Basis(Vector3.RIGHT, deg_to_rad(degrees)), Vector3(0.0, height, 0.0)))


func make_grower() -> ScatterLayer:
	var layer := make_layer(RADIUS)
	layer.on_surfaces = true
	layer.align_to_normal = 1.0
	layer.tile_size = 16.0
	layer.view_distance = 48.0
	return layer


func make_growing(layers: Array[ScatterLayer]) -> TerrainScatter3D:
	var ground := ScatterGroundMeshes.new()
	ground.group = &"ground"
	viewer = make_viewer()
	return make_scatter(layers, ground, viewer)


func clean() -> void:
	for node in get_nodes_in_group(&"ground"):
		node.free()
	await super()


## Returns the IDs of the instances between two heights.
func between(standing: Dictionary[int, Transform3D], low: float, high: float) -> Array[int]:
	var result: Array[int] = []
	for id in standing:
		if standing[id].origin.y > low and standing[id].origin.y < high and absf(standing[id].basis.y.z) < 0.5 or low < -0.5:
			result.push_back(id)
	return result


func check_full(found: Array[int], context: String) -> void:
	var expected := SIZE * SIZE * DENSITY
	check(absf(found.size() - expected) < 0.08 * expected, "%s has %d instances, expected about %d" % [context, found.size(), expected])


func test_every_level_of_a_house_has_plants() -> void:
	for height: float in [0.0, 3.0, 6.0]:
		put_square(height)
	var scatter := make_growing([make_grower()])
	await settle(scatter)
	var standing := instances(scatter, 0)
	for height: float in [0.0, 3.0, 6.0]:
		check_full(between(standing, height - 0.1, height + 0.1), "the level at %.0f m" % height)
	check_equal(scatter.get_problems().size(), 0, "problems: %s" % scatter.get_problems())
	scatter.layers[0].on_surfaces = false
	await settle(scatter)
	standing = instances(scatter, 0)
	check_equal(between(standing, 5.9, 6.1).size(), standing.size(), "without on_surfaces, only the top has plants")


func test_slopes_select_walls_and_ceilings_and_instances_align_to_them() -> void:
	put_square(0.0)
	put_square(30.0, 180.0)
	put_square(15.0, 90.0)
	var layer := make_grower()
	layer.max_slope_degrees = 180.0
	var scatter := make_growing([layer])
	for limits: Array in [[0.0, 45.0, Vector3.UP], [60.0, 120.0, Vector3.BACK], [135.0, 180.0, Vector3.DOWN]]:
		layer.min_slope_degrees = 0.0
		layer.max_slope_degrees = limits[1]
		layer.min_slope_degrees = limits[0]
		await settle(scatter)
		var standing := instances(scatter, 0)
		check_full(between(standing, -1.0, 31.0), "the surface that faces %s" % limits[2])
		for id in standing:
			if not check(standing[id].basis.y.distance_to(limits[2]) < 1e-4, "an instance on it points that way"):
				break


func test_a_mirrored_mesh_keeps_its_front() -> void:
	var square := put_square(0.0)
	square.scale = Vector3(-1.0, 1.0, 1.0)
	var layer := make_grower()
	var scatter := make_growing([layer])
	await settle(scatter)
	check_full(between(instances(scatter, 0), -0.1, 0.1), "the mirrored square")


func test_noise_is_three_dimensional_on_a_wall() -> void:
	put_square(0.0, 90.0)
	var layer := make_grower()
	layer.max_slope_degrees = 180.0
	var noise := FastNoiseLite.new()
	noise.frequency = 0.1
	layer.noise = noise
	# The density is 1 where the noise is positive, otherwise 0.
	var step := Curve.new()
	step.min_domain = -1.0
	step.add_point(Vector2(-1.0, 0.0))
	step.add_point(Vector2(-0.001, 0.0), 0.0, 0.0, Curve.TANGENT_LINEAR, Curve.TANGENT_LINEAR)
	step.add_point(Vector2(0.001, 1.0), 0.0, 0.0, Curve.TANGENT_LINEAR, Curve.TANGENT_LINEAR)
	step.add_point(Vector2(1.0, 1.0))
	layer.noise_curve = step
	var scatter := make_growing([layer])
	await settle(scatter)
	var standing := instances(scatter, 0)
	layer.noise = null
	await settle(scatter)
	var all := instances(scatter, 0)
	check(standing.size() > 100 and all.size() > standing.size() + 100, "%d of %d instances are where the noise permits them" % [standing.size(), all.size()])
	for id in all:
		var at := all[id].origin
		var value := noise.get_noise_3d(at.x, at.y, at.z)
		if absf(value) > 0.02:
			check_equal(standing.has(id), value > 0.0, "instance at %s, where the noise is %f" % [at, value])


func test_queries_bodies_and_rays_find_hanging_instances() -> void:
	put_square(8.0, 180.0)
	var layer := make_grower()
	layer.min_slope_degrees = 90.0
	layer.max_slope_degrees = 180.0
	layer.min_slope_degrees = 90.0
	layer.collision_shape = ScatterLayer.COLLISION_CYLINDER
	layer.collision_distance = DISTANCE
	layer.instance_radius = 0.3
	layer.instance_height = 2.0
	var scatter := make_growing([layer])
	await settle(scatter)
	var standing := instances(scatter, 0)
	var found := scatter.query_rect(Rect2(-SIZE, -SIZE, 2.0 * SIZE, 2.0 * SIZE))
	check_equal(found.ids.size(), standing.size(), "a query finds all instances")
	for known: int in standing:
		var instance := scatter.get_instance(known)
		if not check(instance != null and instance.transform.origin.distance_to(standing[known].origin) < 1e-4, "each instance is found by its ID"):
			break
	await frames(4)
	await physics_frame
	var id: int = standing.keys()[0]
	for candidate in standing:
		if standing[candidate].origin.distance_to(Vector3(0.0, 8.0, 0.0)) < standing[id].origin.distance_to(Vector3(0.0, 8.0, 0.0)):
			id = candidate
	var hit := cast(standing[id].origin + Vector3(-3.0, -1.0, 0.0), standing[id].origin + Vector3(3.0, -1.0, 0.0))
	check(not hit.is_empty(), "a body hangs below the ceiling")
	var ray := scatter.query_ray(standing[id].origin + Vector3(0.0, -6.0, 0.0), standing[id].origin)
	check(ray != null and ray.id == id, "a ray from below hits the hanging instance")


func test_removed_instances_stay_removed() -> void:
	put_square(0.0)
	put_square(4.0)
	var layer := make_grower()
	var scatter := make_growing([layer])
	scatter.state = ScatterState.new()
	await settle(scatter)
	var standing := instances(scatter, 0)
	var felled := between(standing, -0.1, 0.1).slice(0, 20)
	for id: int in felled:
		check(scatter.state.remove(id), "the state removes the instance")
	await settle(scatter)
	check_equal(instances(scatter, 0).size(), standing.size() - felled.size(), "only the removed instances are missing")
	check(scatter.remove_instance(between(instances(scatter, 0), 3.9, 4.1)[0]), "the node removes an instance on the upper level")
	await settle(scatter)
	check_equal(instances(scatter, 0).size(), standing.size() - felled.size() - 1, "that instance is missing, too")
	var saved := scatter.state.to_bytes()
	scatter.state = ScatterState.new()
	await settle(scatter)
	check_equal(instances(scatter, 0).size(), standing.size(), "all instances exist with a new state")
	check_equal(scatter.state.from_bytes(saved), OK, "the saved state is loaded")
	await settle(scatter)
	var after := instances(scatter, 0)
	check(felled.all(func(id: int) -> bool: return not after.has(id)), "the loaded state removes the same instances")


func test_ground_that_changes_takes_its_plants_along() -> void:
	put_square(0.0)
	var upper := put_square(5.0)
	var wall := put_square(15.0, 90.0)
	var layer := make_grower()
	var scatter := make_growing([layer])
	await settle(scatter)
	check_full(between(instances(scatter, 0), 4.9, 5.1), "the upper level")
	var lower := between(instances(scatter, 0), -0.1, 0.1)
	upper.position.y = 7.0
	wall.position.x = 3.0
	await until(func() -> bool: return between(instances(scatter, 0), 4.9, 5.1).is_empty(), "the level was moved up")
	await settle(scatter)
	var standing := instances(scatter, 0)
	check_full(between(standing, 6.9, 7.1), "the moved level")
	check_equal(between(standing, -0.1, 0.1), lower, "the lower level keeps its plants")
	var right := standing.values().filter(func(at: Transform3D) -> bool: return at.origin.x > SIZE / 2.0 + 0.1)
	check(right.size() > 50, "the wall was moved to the right")
	upper.free()
	await until(func() -> bool: return between(instances(scatter, 0), 6.9, 7.1).is_empty(), "the level was removed")


func test_a_position_on_a_ceiling_is_explained() -> void:
	put_square(0.0)
	put_square(9.0, 180.0)
	var layer := make_grower()
	layer.max_slope_degrees = 180.0
	layer.min_slope_degrees = 120.0
	var scatter := make_growing([layer])
	await settle(scatter)
	var standing := instances(scatter, 0)
	var id: int = standing.keys()[0]
	var above := scatter.explain_position(standing[id].origin)[0]
	check(above.standing and above.id == id, "the hanging instance is found: %s" % above.reason)
	check(absf(above.position.y - 9.0) < 0.01, "the explanation is about the ceiling, not about the floor: %s" % above.position)
	var below := scatter.explain_position(Vector3(standing[id].origin.x, 0.0, standing[id].origin.z))[0]
	check(not below.standing and "slope" in str(below.reason).to_lower(), "the floor below is not steep enough: %s" % below.reason)


func test_ground_without_triangles_is_reported() -> void:
	var layer := make_grower()
	var scatter := make_scatter([layer], ScatterGroundFlat.new(), make_viewer())
	await settle(scatter)
	check_equal(instances(scatter, 0).size(), 0, "the layer has no instances")
	var problems := scatter.get_problems()
	check(problems.size() == 1 and "on_surfaces" in problems[0] and "ScatterGroundFlat" in problems[0], str(problems))


func test_an_edge_feather_thins_walls_and_floors_toward_their_borders() -> void:
	put_square(0.0)
	put_square(20.0, 90.0)
	var layer := make_grower()
	layer.max_slope_degrees = 180.0
	var scatter := make_growing([layer])
	await settle(scatter)
	var before := instances(scatter, 0)
	layer.edge_feather = 3.0
	check_equal(scatter.get_problems().size(), 0, "no problem: %s" % scatter.get_problems())
	await settle(scatter)
	var after := instances(scatter, 0)
	var outer := Vector2i.ZERO # The number of instances before and after, near the borders.
	for id in before:
		var at := before[id].origin
		var along := at.z if at.y < 1.0 else at.y - 20.0
		var depth := 0.5 * SIZE - maxf(absf(at.x), absf(along))
		if depth > 3.1:
			check(after.has(id), "an instance in the middle stays: %s" % at)
		elif depth < 1.5:
			outer += Vector2i(1, int(after.has(id)))
	check(outer.x > 20 and outer.y < 0.4 * outer.x, "near the borders, %d of %d instances are left" % [outer.y, outer.x])
	var middle: int = after.keys().filter(func(id: int) -> bool: return after[id].origin.y > 15.0)[0]
	var answer := scatter.explain_position(after[middle].origin)[0]
	check(answer.standing, "the explanation agrees: %s" % answer.reason)
