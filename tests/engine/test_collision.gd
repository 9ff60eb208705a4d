extends "collision_harness.gd"
## Tests the bodies of instances: their positions and properties, the instances they belong to, and when they are added and removed.

const ROUND_SHAPES := [ScatterLayer.COLLISION_CAPSULE, ScatterLayer.COLLISION_CYLINDER, ScatterLayer.COLLISION_BOX]


func test_rays_hit_what_query_ray_hits() -> void:
	for shape: ScatterLayer.CollisionShape in ROUND_SHAPES:
		var layer := make_solid_layer(shape)
		layer.min_scale = 0.6
		layer.max_scale = 1.7
		layer.min_tilt_degrees = 0.0
		layer.max_tilt_degrees = 25.0
		var scatter := make_solid([layer])
		await settle(scatter)
		var standing := instances(scatter, 0)
		var seen := 0
		for id in standing:
			var at := standing[id]
			if at.origin.length() > DISTANCE:
				continue
			# Along the body's local axes, all three shapes are as wide as the cylinder.
			var size := at.basis.get_scale().x
			for axis: Vector3 in [at.basis.x, -at.basis.x, at.basis.z, -at.basis.z]:
				var target := at * Vector3(0, 1.5, 0)
				var from := target + axis.normalized() * 1.6 * size
				var expected := scatter.query_ray(from, target)
				var hit := cast(from, target)
				if expected != null and expected.distance == 0.0:
					continue # The ray starts inside a neighbor, which the physics server does not report.
				if not check(not hit.is_empty() and expected != null, "shape %d: both hit" % shape):
					continue
				check(hit["collider"] == scatter, "the collider is the scatter")
				check_equal(scatter.get_body_instance(hit["rid"]), expected.id, "the body belongs to the instance that query_ray returns")
				if expected.id == id:
					seen += 1
					var apart := (hit["position"] as Vector3).distance_to(expected.hit_position)
					check(apart < SIZE_ERROR * 0.6 * size + 2e-3, "shape %d: %.4f m apart" % [shape, apart])
			# Casts down onto the center of the top.
			var top := at * Vector3(0, 3.0, 0)
			var above := cast(top + at.basis.y.normalized() * 0.5, at.origin)
			if check(not above.is_empty(), "a ray from above hits the top"):
				var apart := (above["position"] as Vector3).distance_to(top)
				check(apart < SIZE_ERROR * 3.0 * size + 2e-3, "shape %d: top %.4f m apart" % [shape, apart])
		check(seen > 100, "%d rays hit their instance" % seen)
		scatter.free()
		await frames(2)


func test_rays_miss_what_query_ray_misses() -> void:
	var scatter := make_solid([make_solid_layer()])
	await settle(scatter)
	var random := RandomNumberGenerator.new()
	random.seed = 3
	var hits := 0
	var differ := 0
	for round in 2000:
		var from := Vector3(random.randf_range(-10, 10), random.randf_range(0.1, 4.0), random.randf_range(-10, 10))
		var to := from + Vector3(random.randf_range(-6, 6), random.randf_range(-2, 2), random.randf_range(-6, 6))
		var expected := scatter.query_ray(from, to)
		var hit := cast(from, to)
		if expected != null and expected.distance == 0.0:
			continue # The physics server reports no hit for a ray that starts inside a shape.
		hits += int(expected != null)
		if hit.is_empty() != (expected == null):
			differ += 1 # The ray grazes the surface, so rounding decides.
		elif hit:
			check_equal(scatter.get_body_instance(hit["rid"]), expected.id, "hit")
			check((hit["position"] as Vector3).distance_to(expected.hit_position) < 0.05, "position")
	check(hits > 200, "%d hits" % hits)
	check(differ < 10, "%d of 2000 rays differ" % differ)


func test_convex_bodies_match_their_meshes() -> void:
	var layer := make_solid_layer(ScatterLayer.COLLISION_CONVEX)
	var wedge := PrismMesh.new()
	wedge.size = Vector3(2.0, 1.0, 3.0)
	var ball := SphereMesh.new()
	layer.meshes = [wedge, null, ball]
	layer.min_scale = 0.7
	layer.max_scale = 1.4
	var scatter := make_solid([layer])
	await settle(scatter)
	var counts := {0: 0, 1: 0, 2: 0}
	for id in instances(scatter, 0):
		var instance := scatter.get_instance(id)
		var at: Transform3D = instance["transform"]
		if at.origin.length() > DISTANCE:
			continue
		counts[instance["mesh"]] += 1
		var hit := cast(at * Vector3(0.0, 3.0, 0.4), at * Vector3(0.0, -0.3, 0.4))
		match instance["mesh"]:
			0: # On the ridge of the prism, 0.5 m high.
				check(hit and (hit["position"] as Vector3).distance_to(at * Vector3(0, 0.5, 0.4)) < 0.03, "ridge")
			1:
				check(hit.is_empty(), "no mesh, no body")
			2: # At height 0.3 m on a ball with a radius of 0.5 m, approximated with 64 vertices.
				check(hit and (hit["position"] as Vector3).distance_to(at * Vector3(0, 0.3, 0.4)) < 0.08, "ball")
	check(counts[0] > 5 and counts[1] > 5 and counts[2] > 5, "meshes: %s" % counts)

	wedge.size.y = 2.0
	await settle(scatter)
	for id in instances(scatter, 0):
		var instance := scatter.get_instance(id)
		var at: Transform3D = instance["transform"]
		if at.origin.length() < DISTANCE and instance["mesh"] == 0:
			var hit := cast(at * Vector3(0.0, 3.0, 0.4), at * Vector3(0.0, -0.3, 0.4))
			check(hit and (hit["position"] as Vector3).distance_to(at * Vector3(0, 1.0, 0.4)) < 0.04, "a ray hits the body of a taller mesh at its surface")


func test_only_nearby_instances_have_bodies() -> void:
	var scatter := make_solid([make_solid_layer()])
	await settle(scatter)
	check_bodies(scatter, instances(scatter, 0), [viewer.position], "at first")
	for round in 12:
		viewer.position += Vector3(3.0, 0.0, -2.0)
		await settle(scatter)
		check_bodies(scatter, instances(scatter, 0), [viewer.position], "walk %d" % round)
		check_equal(scatter.get_stats()["bodies"], bodies(scatter).size(), "bodies in the stats")
	viewer.position.y = DISTANCE + 5.0 # The viewer is too high for any instance to be near.
	await settle(scatter)
	check_equal(bodies(scatter).size(), 0, "bodies below a high viewer")
	viewer.position = Vector3(9000, 0, 9000)
	await settle(scatter)
	viewer.position = Vector3.ZERO
	await settle(scatter)
	check_bodies(scatter, instances(scatter, 0), [Vector3.ZERO], "after a leap and back")
	scatter.layers[0].collision_shape = ScatterLayer.COLLISION_NONE
	await settle(scatter)
	check_equal(scatter.get_stats()["bodies"], 0, "bodies without a shape")


func test_small_movements_keep_bodies() -> void:
	var scatter := make_solid([make_solid_layer()])
	await settle(scatter)
	var before := bodies(scatter)
	for round in 60:
		viewer.position.x = 0.45 * sin(round * 1.7)
		await frames(1)
	await settle(scatter)
	var after := bodies(scatter)
	for id in before:
		check(after.get(id, RID()) == before[id], "the instance keeps its body")


func test_bodies_around_an_interaction_group() -> void:
	var scatter := make_solid([make_solid_layer()])
	check_equal(scatter.interaction_group, &"scatter_interaction", "group")
	var walkers: Array[Node3D] = []
	for point: Vector3 in [Vector3(700, 0, 0), Vector3(-400, 0, 900), Vector3(704, 0, 3)]:
		var walker := make_viewer(point)
		walker.add_to_group("scatter_interaction")
		walkers.push_back(walker)
	await settle(scatter)
	check_bodies(scatter, instances(scatter, 0), [viewer.position], "around the viewer")
	for walker in walkers:
		var there := bodies(scatter, walker.position, 1.5 * DISTANCE)
		var expected := scatter.query_sphere(walker.position, DISTANCE)
		var ids: PackedInt64Array = expected["ids"]
		check(ids.size() > 20, "%d instances around a walker" % ids.size())
		for id in ids:
			check(there.has(id), "a body around a walker")
	walkers[1].free()
	await settle(scatter)
	check_equal(bodies(scatter, Vector3(-400, 0, 900), 30.0).size(), 0, "bodies around a freed walker")
	check(bodies(scatter, Vector3(700, 0, 0), 30.0).size() > 20, "bodies around a remaining walker")
	scatter.interaction_group = &"others"
	await settle(scatter)
	check_equal(bodies(scatter, Vector3(700, 0, 0), 30.0).size(), 0, "bodies around nodes of another group")


func test_the_budget_is_kept() -> void:
	var scatter := make_solid([make_solid_layer()])
	scatter.frame_budget_usec = 1
	var largest := 0
	var count := 0
	var steps := 0
	var deadline := Time.get_ticks_msec() + IDLE_TIMEOUT_MSEC
	while not scatter.is_settled() or count == 0:
		await process_frame
		var now: int = scatter.get_stats()["bodies"]
		largest = maxi(largest, now - count)
		steps += int(now > count)
		count = now
		if Time.get_ticks_msec() > deadline:
			check(false, "it does not settle")
			return
	check(count > 50, "%d bodies" % count)
	check(largest <= 2, "%d bodies in one frame" % largest)
	check(steps >= count / 2.0, "over %d frames" % steps)


func test_nearest_first() -> void:
	var scatter := make_solid([make_solid_layer()])
	await settle(scatter)
	var standing := instances(scatter, 0)
	viewer.position = Vector3(20, 0, 0)
	scatter.frame_budget_usec = 1
	var had := bodies(scatter)
	var farthest := 0.0
	for frame in 30:
		await process_frame
		var has := bodies(scatter)
		for id in has:
			if not had.has(id):
				var away := viewer.position.distance_to(standing[id].origin)
				check(away > farthest - 1e-3, "%f m after %f m" % [away, farthest])
				farthest = maxf(farthest, away)
		had = has
	check(farthest > 0.0, "some bodies were added")


func test_removal_and_restoration() -> void:
	var scatter := make_solid([make_solid_layer()])
	await settle(scatter)
	var instance := nearest(scatter)
	var id: int = instance["id"]
	var at: Transform3D = instance["transform"]
	check_equal(hit_id(scatter, at), id, "the body exists")
	var rid: RID = bodies(scatter)[id]
	check(scatter.remove_instance(id), "removed")
	check_equal(hit_id(scatter, at), 0, "no body in the same frame")
	check(not bodies(scatter).has(id), "no body")
	check_equal(scatter.get_body_instance(rid), id, "the ID of a removed body is still known")
	await settle(scatter)
	check_equal(hit_id(scatter, at), 0, "no body later")

	viewer.position = Vector3(2000, 0, 0) # The instance's tile is removed.
	await settle(scatter)
	viewer.position = Vector3.ZERO
	await settle(scatter)
	check_equal(hit_id(scatter, at), 0, "no body after its tile was regenerated")
	check(bodies(scatter).size() > 50, "other bodies exist")
	scatter.regenerate()
	await settle(scatter)
	check_equal(hit_id(scatter, at), 0, "no body after everything was regenerated")

	check(scatter.restore_instance(id), "restored")
	await settle(scatter)
	check_equal(hit_id(scatter, at), id, "the body is back")


func test_removal_before_the_body_is_added() -> void:
	var scatter := make_solid([make_solid_layer()])
	await settle(scatter)
	var ids: PackedInt64Array = scatter.query_sphere(Vector3(40, 0, 0), 10.0).ids
	check(ids.size() > 5, "some instances")
	scatter.frame_budget_usec = 1
	viewer.position = Vector3(40, 0, 0)
	await frames(2)
	for id in ids:
		scatter.remove_instance(id)
	await settle(scatter)
	var found := bodies(scatter)
	for id in ids:
		check(not found.has(id), "no body for an instance that was removed while it waited for one")
	scatter.state.clear()
	await settle(scatter)
	found = bodies(scatter)
	for id in ids:
		check(found.has(id), "all bodies are back")


func test_hand_placed_instances_have_bodies() -> void:
	var scatter := make_solid([make_solid_layer()])
	await settle(scatter)
	var at := Transform3D(Basis().scaled(Vector3(0.5, 2.0, 0.5)), Vector3(1.25, 30.0, 2.5))
	viewer.position.y = 25.0
	var id := scatter.add_instance(scatter.layers[0], at)
	check(id != 0, "placed")
	await settle(scatter)
	check_equal(bodies(scatter).keys(), [id], "the only body nearby")
	var hit := cast(Vector3(5, 35.5, 2.5), Vector3(1.25, 35.5, 2.5))
	check(hit and (hit["position"] as Vector3).distance_to(Vector3(1.55, 35.5, 2.5)) < 0.01, "its scale: %s" % hit)
	check(cast(Vector3(5, 36.2, 2.5), Vector3(1.25, 36.2, 2.5)).is_empty(), "its height")
	scatter.remove_instance(id)
	check_equal(bodies(scatter).size(), 0, "the body is removed immediately")


func test_flat_instances_have_no_bodies() -> void:
	var scatter := make_solid([make_solid_layer()], Vector3(0, 500, 0))
	await settle(scatter)
	for basis: Basis in [Basis.from_scale(Vector3(1, 0, 1)), Basis(Vector3.ZERO, Vector3.ZERO, Vector3.ZERO)]:
		check(scatter.add_instance(scatter.layers[0], Transform3D(basis, Vector3(0, 500, 0))) != 0, "placed")
	var mirrored := scatter.add_instance(scatter.layers[0], Transform3D(Basis.from_scale(Vector3(-1, 1, 1)), Vector3(5, 500, 0)))
	await settle(scatter)
	check_equal(bodies(scatter, Vector3(0, 500, 0)).keys(), [mirrored], "only the instance with a volume")


func test_property_changes_are_applied() -> void:
	var layer := make_solid_layer()
	var scatter := make_solid([layer])
	await settle(scatter)
	var instance := nearest(scatter)
	var id: int = instance["id"]
	var at: Transform3D = instance["transform"]
	var body: RID = bodies(scatter)[id]
	check_equal(PhysicsServer3D.body_get_param(body, PhysicsServer3D.BODY_PARAM_FRICTION), 1.0, "friction by default")
	check_equal(PhysicsServer3D.body_get_param(body, PhysicsServer3D.BODY_PARAM_BOUNCE), 0.0, "bounce by default")
	check_equal(PhysicsServer3D.body_get_mode(body), PhysicsServer3D.BODY_MODE_STATIC, "mode")

	layer.collision_layer = 1 << 31 | 1 << 3
	layer.collision_mask = 0
	var material := PhysicsMaterial.new()
	material.friction = 0.25
	material.rough = true
	material.bounce = 0.5
	layer.physics_material = material
	await frames(2)
	check(bodies(scatter)[id] == body, "the instance keeps its body")
	check_equal(PhysicsServer3D.body_get_collision_layer(body), 1 << 31 | 1 << 3, "layer")
	check_equal(PhysicsServer3D.body_get_collision_mask(body), 0, "mask")
	check(is_equal_approx(PhysicsServer3D.body_get_param(body, PhysicsServer3D.BODY_PARAM_FRICTION), -0.25), "rough")
	check(is_equal_approx(PhysicsServer3D.body_get_param(body, PhysicsServer3D.BODY_PARAM_BOUNCE), 0.5), "bounce")
	material.absorbent = true
	material.rough = false
	await frames(2)
	check(is_equal_approx(PhysicsServer3D.body_get_param(body, PhysicsServer3D.BODY_PARAM_FRICTION), 0.25), "smooth")
	check(is_equal_approx(PhysicsServer3D.body_get_param(body, PhysicsServer3D.BODY_PARAM_BOUNCE), -0.5), "absorbent")
	var from := at * Vector3(3, 1.5, 0)
	check(cast(from, at.origin + Vector3(0, 1.5, 0), 1).is_empty(), "a ray with another mask")
	check(not cast(from, at.origin + Vector3(0, 1.5, 0), 1 << 3).is_empty(), "a ray with that mask")

	layer.instance_radius = 0.3
	layer.instance_height = 1.0
	await settle(scatter)
	check(cast(from, at.origin + Vector3(0, 1.5, 0)).is_empty(), "lower")
	var hit := cast(at * Vector3(3, 0.5, 0), at * Vector3(0, 0.5, 0))
	check(hit and (hit["position"] as Vector3).distance_to(at * Vector3(0.3, 0.5, 0)) < 0.01, "thinner")
	layer.collision_distance = 8.0
	await settle(scatter)
	check_bodies(scatter, instances(scatter, 0), [Vector3.ZERO], "a shorter distance", 8.0)
	layer.collision_distance = 0.0
	await settle(scatter)
	check_equal(bodies(scatter).size(), 0, "no distance, no bodies")


func test_changed_and_reordered_layers() -> void:
	var a := make_solid_layer()
	var b := make_solid_layer(ScatterLayer.COLLISION_BOX)
	a.layer_id = 10
	b.layer_id = 20
	a.instance_height = 1.0
	var scatter := make_solid([a, b])
	await settle(scatter)
	var before := bodies(scatter).keys()
	before.sort()
	check(before.size() > 100, "two layers")
	scatter.layers = [b, null, a]
	await settle(scatter)
	var after := bodies(scatter).keys()
	after.sort()
	check_equal(after, before, "IDs that have bodies")
	scatter.layers = [a]
	await settle(scatter)
	for id in bodies(scatter):
		check_equal(scatter.get_instance(id).layer, scatter.layers[0], "only the remaining layer has bodies")
	scatter.seed += 1
	await settle(scatter)
	check_bodies(scatter, instances(scatter, 0), [Vector3.ZERO], "a new seed")
	scatter.layers = []
	await settle(scatter)
	check_equal(scatter.get_stats()["bodies"], 0, "bodies without layers")


func test_ground_that_moves() -> void:
	var ground := ScatterGroundFlat.new()
	var scatter := make_solid([make_solid_layer()])
	scatter.ground = ground
	await settle(scatter)
	var before := bodies(scatter).size()
	ground.height = 2.5
	await settle(scatter)
	check(absi(bodies(scatter).size() - before) < 20, "the number of bodies changes by less than 20")
	for id in bodies(scatter):
		var hit := cast(scatter.get_instance(id).transform * Vector3(1.0, 2.9, 0.0),
				scatter.get_instance(id).transform * Vector3(0.0, 2.9, 0.0))
		check(hit and scatter.get_body_instance(hit["rid"]) == id, "the body is on the ground")


func test_world_offset_moves_bodies() -> void:
	var scatter := make_solid([make_solid_layer()])
	await settle(scatter)
	var standing := instances(scatter, 0)
	var before := bodies(scatter)
	scatter.world_offset = Vector3(1000, 50, -300)
	viewer.position -= scatter.world_offset
	var near := before.keys().filter(func(id: int) -> bool: return standing[id].origin.length() < 12.0)
	check(near.size() > 15, "%d bodies near the viewer" % near.size())
	for id: int in near:
		check_equal(hit_id(scatter, standing[id].translated(-scatter.world_offset)), id, "bodies move immediately")
	await settle(scatter)
	var after := bodies(scatter, viewer.position)
	for id in before:
		check(after.get(id, RID()) == before[id], "the instance keeps its body")
	scatter.world_offset = Vector3.ZERO
	viewer.position = Vector3.ZERO
	await settle(scatter)
	check_bodies(scatter, standing, [Vector3.ZERO], "back at the origin")
