extends "collision_harness.gd"
## Tests contacts with a game's other bodies, removals during physics signals, and cleanup.

func make_ball(at: Vector3, velocity: Vector3) -> RigidBody3D:
	var ball := RigidBody3D.new()
	ball.gravity_scale = 0.0
	ball.contact_monitor = true
	ball.max_contacts_reported = 4
	var shape := CollisionShape3D.new()
	shape.shape = SphereShape3D.new()
	(shape.shape as SphereShape3D).radius = 0.2
	ball.add_child(shape)
	ball.position = at
	ball.linear_velocity = velocity
	root.add_child(ball)
	return ball


func make_area(at: Vector3, radius: float) -> Area3D:
	var area := Area3D.new()
	var shape := CollisionShape3D.new()
	shape.shape = SphereShape3D.new()
	(shape.shape as SphereShape3D).radius = radius
	area.add_child(shape)
	area.position = at
	root.add_child(area)
	return area


func physics_frames(count: int) -> void:
	for frame in count:
		await physics_frame


func test_a_character_walks_into_an_instance() -> void:
	var scatter := make_solid([make_solid_layer()])
	await settle(scatter)
	var instance := nearest(scatter)
	var walker := CharacterBody3D.new()
	var shape := CollisionShape3D.new()
	shape.shape = CapsuleShape3D.new()
	(shape.shape as CapsuleShape3D).radius = 0.3
	(shape.shape as CapsuleShape3D).height = 1.8
	walker.add_child(shape)
	root.add_child(walker)
	walker.position = middle(instance) + Vector3(1.6, 0, 0)
	await physics_frames(2)
	var hit := walker.move_and_collide(Vector3(-1.5, 0, 0))
	if check(hit != null, "stopped"):
		check(hit.get_collider() == scatter, "the collider is the scatter")
		check_equal(scatter.get_body_instance(hit.get_collider_rid()), instance["id"], "the collider's body belongs to the instance")
		var away := on_map(walker.transform).distance_to(on_map(instance["transform"]))
		check(absf(away - 0.9) < 0.03, "it stops %f m away" % away)
	scatter.remove_instance(instance["id"])
	check(walker.move_and_collide(Vector3(-1.0, 0, 0)) == null, "after the removal, nothing is in the way in the same frame")


func test_a_ball_hits_an_instance() -> void:
	var scatter := make_solid([make_solid_layer()])
	await settle(scatter)
	var instance := nearest(scatter)
	var ball := make_ball(middle(instance) + Vector3(1.6, 0, 0), Vector3(-8, 0, 0))
	var hit_ids: PackedInt64Array = []
	ball.body_shape_entered.connect(func(rid: RID, body: Node, _shape: int, _own: int) -> void:
		check(body == scatter, "the scatter is the body")
		hit_ids.push_back(scatter.get_body_instance(rid)))
	await physics_frames(30)
	check_equal(hit_ids, PackedInt64Array([instance["id"]]), "the instances that the ball hit")
	check(ball.position.x > (instance["transform"] as Transform3D).origin.x + 0.7, "the ball did not pass through")


func test_an_instance_removed_by_a_ball() -> void:
	var scatter := make_solid([make_solid_layer()])
	await settle(scatter)
	var instance := nearest(scatter)
	var ball := make_ball(middle(instance) + Vector3(1.6, 0, 0), Vector3(-8, 0, 0))
	var counts := [0, 0]
	ball.body_shape_entered.connect(func(rid: RID, _body: Node, _shape: int, _own: int) -> void:
		counts[0] += 1
		check(scatter.remove_instance(scatter.get_body_instance(rid)), "removed during the contact signal")
		check_equal(hit_id(scatter, instance["transform"]), 0, "the body is gone during the contact signal"))
	ball.body_shape_exited.connect(func(rid: RID, _body: Node, _shape: int, _own: int) -> void:
		check_equal(scatter.get_body_instance(rid), instance["id"], "the exit signal names the removed instance")
		counts[1] += 1)
	await physics_frames(30)
	check_equal(counts, [1, 1], "one contact and its end")


func test_an_area_removes_all_instances_in_it() -> void:
	var scatter := make_solid([make_solid_layer()])
	await settle(scatter)
	var area := make_area(Vector3(0, 1, 0), 8.0)
	var entered: PackedInt64Array = []
	var exited: PackedInt64Array = []
	area.body_shape_entered.connect(func(rid: RID, _body: Node, _shape: int, _own: int) -> void:
		var id := scatter.get_body_instance(rid)
		entered.push_back(id)
		check(scatter.remove_instance(id), "removed while the physics server emits signals"))
	area.body_shape_exited.connect(func(rid: RID, _body: Node, _shape: int, _own: int) -> void:
		exited.push_back(scatter.get_body_instance(rid)))
	await physics_frames(10)
	entered.sort()
	exited.sort()
	check(entered.size() > 8, "%d were removed" % entered.size())
	check_equal(exited, entered, "every body that entered the area exited it")
	check_equal(area.get_overlapping_bodies().size(), 0, "the area is empty")
	await settle(scatter)
	for id in bodies(scatter):
		check(not entered.has(id), "the body is removed")
	var felled := entered.duplicate()
	for id in felled:
		scatter.restore_instance(id)
	await settle(scatter)
	area.position.y += 0.01 # Godot Physics checks static bodies only after the area has moved.
	await physics_frames(10)
	check_equal(entered.size(), 2 * felled.size(), "restored instances enter and are removed again")
	check_equal(exited.size(), 2 * felled.size(), "restored instances exit when they are removed again")


func test_restored_and_removed_in_one_frame() -> void:
	var scatter := make_solid([make_solid_layer()])
	await settle(scatter)
	var id: int = nearest(scatter)["id"]
	for round in 20:
		scatter.remove_instance(id)
		scatter.restore_instance(id)
		if round % 3:
			await frames(1)
	await settle(scatter)
	check(bodies(scatter).has(id), "the body exists")
	check_bodies(scatter, instances(scatter, 0), [Vector3.ZERO], "after 20 rounds")


## The body pool does not grow without limit.
func test_bodies_are_reused() -> void:
	var scatter := make_solid([make_solid_layer()])
	await settle(scatter)
	var seen: Dictionary[RID, bool] = {}
	var shown_count := 0
	for round in 40:
		viewer.position.x = 30.0 * (round % 2)
		await settle(scatter)
		var now := bodies(scatter, viewer.position)
		shown_count += now.size()
		for rid: RID in now.values():
			seen[rid] = true
		await frames(40)
	check(seen.size() < shown_count / 4.0, "%d bodies for %d instances" % [seen.size(), shown_count])
	var stats := scatter.get_stats()
	check(stats["bodies_pooled"] < 600, "%d pooled bodies" % stats["bodies_pooled"])


func test_leaving_the_tree_and_changing_the_world() -> void:
	var scatter := make_solid([make_solid_layer()])
	await settle(scatter)
	check(bodies(scatter).size() > 50, "bodies")
	root.remove_child(scatter)
	check_equal(scatter.get_stats()["bodies"], 0, "bodies outside of the tree")
	var nothing := PhysicsShapeQueryParameters3D.new()
	nothing.shape = SphereShape3D.new()
	(nothing.shape as SphereShape3D).radius = 100.0
	check_equal(space().intersect_shape(nothing), [] as Array[Dictionary], "no bodies in the space that it left")
	root.add_child(scatter)
	await settle(scatter)
	check(bodies(scatter).size() > 50, "bodies after entering the tree again")

	var other_world := SubViewport.new()
	other_world.own_world_3d = true
	root.add_child(other_world)
	scatter.reparent(other_world)
	check_equal(space().intersect_shape(nothing), [] as Array[Dictionary], "no bodies in the world that it left")
	scatter.viewers = [scatter.get_path_to(viewer)]
	await settle(scatter)
	check(other_world.find_world_3d().direct_space_state.intersect_shape(nothing).size() > 30, "bodies in the new world")


func test_freed_while_bodies_are_added() -> void:
	for round in 8:
		var scatter := make_solid([make_solid_layer(), make_solid_layer(ScatterLayer.COLLISION_CONVEX)])
		scatter.frame_budget_usec = 50
		if round % 2:
			await settle(scatter)
			for id in bodies(scatter).keys().slice(0, 10):
				scatter.remove_instance(id)
		await frames(round)
		scatter.free()
		await physics_frames(1)
	var query := PhysicsShapeQueryParameters3D.new()
	query.shape = SphereShape3D.new()
	(query.shape as SphereShape3D).radius = 100.0
	check_equal(space().intersect_shape(query), [] as Array[Dictionary], "no bodies are left")


func test_freed_by_an_area_that_it_enters() -> void:
	var scatter := make_solid([make_solid_layer()])
	await settle(scatter)
	var area := make_area(Vector3(0, 1, 0), 6.0)
	area.body_entered.connect(func(body: Node) -> void: body.queue_free())
	await physics_frames(4)
	check(not is_instance_valid(scatter), "freed")
	check_equal(area.get_overlapping_bodies().size(), 0, "the area is empty")


func test_many_removals_and_restorations() -> void:
	var scatter := make_solid([make_solid_layer()])
	var random := RandomNumberGenerator.new()
	random.seed = 9
	await settle(scatter)
	var objects := Performance.get_monitor(Performance.OBJECT_COUNT)
	for round in 60:
		viewer.position += Vector3(random.randf_range(-6, 6), 0, random.randf_range(-6, 6))
		scatter.remove_in_sphere(viewer.position + Vector3(random.randf_range(-9, 9), 0, 0), 4.0)
		if round % 10 == 9:
			scatter.state.clear()
		await frames(2)
	await settle(scatter)
	var standing: Dictionary[int, Transform3D] = {}
	var found := scatter.query_sphere(viewer.position, 60.0)
	for index in (found["ids"] as PackedInt64Array).size():
		standing[found["ids"][index]] = Transform3D(Basis(), found["positions"][index])
	check_bodies(scatter, standing, [viewer.position], "after 60 rounds")
	check(Performance.get_monitor(Performance.OBJECT_COUNT) < objects + 20, "objects")


## The rays that find the ground ignore the bodies of instances.
func test_bodies_are_not_ground() -> void:
	var floor_body := StaticBody3D.new()
	var shape := CollisionShape3D.new()
	shape.shape = BoxShape3D.new()
	(shape.shape as BoxShape3D).size = Vector3(400, 2, 400)
	floor_body.add_child(shape)
	root.add_child(floor_body)
	for kind: ScatterLayer.CollisionShape in [ScatterLayer.COLLISION_CYLINDER, ScatterLayer.COLLISION_CONVEX]:
		var scatter := make_solid([make_solid_layer(kind), make_solid_layer(kind)])
		scatter.ground = ScatterGroundColliders.new()
		await settle(scatter)
		check(scatter.get_stats()["bodies"] > 50, "bodies on colliders")
		scatter.regenerate() # Now the bodies are in the path of the rays.
		await settle(scatter)
		var standing := instances(scatter, 0)
		for id in standing:
			if absf(standing[id].origin.y - 1.0) > 1e-3:
				check(false, "an instance at a height of %f m" % standing[id].origin.y)
		check(standing.size() > 100, "instances")
		scatter.free()
		await frames(2)
