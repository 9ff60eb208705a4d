extends "collision_harness.gd"
## Instances that move and rotate with their node: drawn, queried, felled, with bodies, scenes and regions, without regeneration.

const HALF := Vector2(20.0, 10.0) ## Half the size of the deck, in meters.

var ship: Node3D


func make_ship(ground: ScatterGround = null) -> TerrainScatter3D:
	ship = Node3D.new()
	root.add_child(ship)
	var deck := MeshInstance3D.new()
	var box := BoxMesh.new()
	box.size = Vector3(2.0 * HALF.x, 1.0, 2.0 * HALF.y)
	deck.mesh = box
	deck.position.y = -0.5
	deck.add_to_group(&"deck")
	ship.add_child(deck)
	if ground == null:
		ground = ScatterGroundMeshes.new()
		ground.group = &"deck"
	viewer = Node3D.new()
	ship.add_child(viewer)
	var layer := make_layer(1.0)
	layer.tile_size = 16.0
	layer.view_distance = 40.0
	var scatter := TerrainScatter3D.new()
	scatter.local_coords = true
	scatter.ground = ground
	scatter.layers = [layer]
	ship.add_child(scatter)
	scatter.viewers = [scatter.get_path_to(viewer)] as Array[NodePath]
	return scatter


func clean() -> void:
	if is_instance_valid(ship):
		ship.free()
	await super()


## Returns the transforms of all instances in the ship's space, by ID, as queries find them.
func on_deck(scatter: TerrainScatter3D) -> Dictionary[int, Transform3D]:
	var found := scatter.query_rect(Rect2(-2.0 * HALF, 4.0 * HALF))
	var result: Dictionary[int, Transform3D] = {}
	for index in found.size():
		result[found.get_id(index)] = ship.global_transform.affine_inverse() * found.get_transform(index)
	return result


func check_same(before: Dictionary[int, Transform3D], after: Dictionary[int, Transform3D], context: String) -> void:
	var worst := 0.0
	for id in before:
		if not check(after.has(id), "%s: instance %d is still there" % [context, id]):
			return
		for axis in 3:
			worst = maxf(worst, before[id].basis[axis].distance_to(after[id].basis[axis]))
		worst = maxf(worst, before[id].origin.distance_to(after[id].origin))
	check_equal(after.size(), before.size(), "%s: number of instances" % context)
	check(worst < 2e-3, "%s: instances keep their positions on the deck, to within %s m" % [context, worst])


func poses() -> Array[Transform3D]:
	return [Transform3D(Basis(), Vector3(120.0, 3.0, -40.0)), Transform3D(Basis(Vector3.UP, 1.1), Vector3(-30.0, 0.0, 500.0)),
			Transform3D(Basis.from_euler(Vector3(0.3, 2.0, -0.4)), Vector3(7.0, 80.0, 9.0))]


func test_instances_move_and_turn_with_the_node() -> void:
	var scatter := make_ship()
	await settle(scatter)
	var before := on_deck(scatter)
	check(before.size() > 300, "the deck has more than 300 instances: %d" % before.size())
	var made: int = scatter.get_stats().tiles_made
	for pose in poses():
		ship.global_transform = pose
		check_same(before, on_deck(scatter), "immediately after a move to %s" % pose.origin)
		await settle(scatter)
		check_same(before, on_deck(scatter), "later at %s" % pose.origin)
	await create_timer(0.6).timeout
	await settle(scatter)
	check_equal(scatter.get_stats().tiles_made, made, "tiles made while the ship moved")
	check_equal(scatter.get_problems().size(), 0, "problems: %s" % scatter.get_problems())


func test_tiles_are_drawn_at_the_position_of_the_node() -> void:
	var scatter := make_ship()
	await settle(scatter)
	for pose in poses():
		ship.global_transform = pose
		await settle(scatter)
		var known := on_deck(scatter)
		var drawn := 0
		for tile in scatter.get_shown_tiles(scatter.layers[0]):
			var displayed_tile := scatter.get_tile(scatter.layers[0], tile)
			for mesh in displayed_tile.get_mesh_count():
				var ids := displayed_tile.get_ids(mesh)
				var buffer := displayed_tile.get_buffer(mesh)
				for index in ids.size():
					var at := Vector3(buffer[12 * index + 3], buffer[12 * index + 7], buffer[12 * index + 11])
					var expected := known[ids[index]].origin
					var got := ship.global_transform.affine_inverse() * (displayed_tile.get_origin() + ship.global_basis * at)
					drawn += 1 if got.distance_to(expected) < 2e-3 else 0
		check_equal(drawn, known.size(), "instances drawn at their positions")


func test_queries_take_engine_positions() -> void:
	var scatter := make_ship()
	await settle(scatter)
	var before := on_deck(scatter)
	for pose in poses():
		ship.global_transform = pose
		var id: int = before.keys()[17]
		var at := pose * before[id].origin
		check_equal(scatter.query_nearest(at, 5.0).id, id, "the instance nearest to the position")
		var above := pose * (before[id].origin + Vector3(0.0, 5.0, 0.0))
		var below := pose * (before[id].origin - Vector3(0.0, 5.0, 0.0))
		check_equal(scatter.query_ray(above, below).id, id, "the first instance that a ray down the mast hits")
		var near := scatter.query_sphere(at, 3.0)
		for index in near.size():
			check(near.get_position(index).distance_to(at) <= 3.001, "instance %d is in the sphere" % near.get_id(index))
		check(near.size() > 5, "%d instances are in the sphere" % near.size())
		check(scatter.get_instance(id).transform.origin.distance_to(at) < 2e-3, "the position of an instance by its ID")


func test_felled_and_placed_instances_stay_with_the_node() -> void:
	var scatter := make_ship()
	scatter.state = ScatterState.new()
	await settle(scatter)
	var before := on_deck(scatter)
	ship.global_transform = poses()[2]
	var felled: int = before.keys()[3]
	scatter.remove_instance(felled)
	var added := scatter.add_instance(scatter.layers[0], ship.global_transform * Transform3D(Basis(), Vector3(1.0, 0.0, 2.0)))
	ship.global_transform = poses()[1]
	var after := on_deck(scatter)
	check(not after.has(felled), "the felled instance is gone")
	check(after.has(added) and after[added].origin.distance_to(Vector3(1.0, 0.0, 2.0)) < 2e-3,
			"a placed instance moved with the ship: %s" % after.get(added))


func test_regions_below_the_node_keep_their_position_on_it() -> void:
	var scatter := make_ship()
	var region := ScatterRegion3D.new()
	region.shape = ScatterRegion3D.SHAPE_BOX
	region.size = Vector3(10.0, 20.0, 10.0)
	scatter.add_child(region)
	await settle(scatter)
	var before := on_deck(scatter)
	check(before.values().all(func(at: Transform3D) -> bool: return absf(at.origin.x) > 4.9 or absf(at.origin.z) > 4.9), "no instances are in the region")
	var made: int = scatter.get_stats().tiles_made
	for pose in poses():
		ship.global_transform = pose
		await settle(scatter)
		check_same(before, on_deck(scatter), "after the ship moved with a region")
	check_equal(scatter.get_stats().tiles_made, made, "tiles made while the region moved with the ship")


func make_trunks_solid(layer: ScatterLayer, distance: float) -> void:
	layer.collision_shape = ScatterLayer.COLLISION_CYLINDER
	layer.instance_radius = 0.2
	layer.instance_height = 2.0
	layer.collision_distance = distance


func test_bodies_move_with_the_node() -> void:
	var scatter := make_ship()
	var layer := scatter.layers[0]
	make_trunks_solid(layer, 30.0)
	await settle(scatter)
	var before := on_deck(scatter)
	var id: int = before.keys()[5]
	for pose in poses():
		ship.global_transform = pose
		await frames(3)
		await settle(scatter)
		await physics_frame
		await physics_frame
		var middle := before[id].origin + Vector3.UP
		var query := PhysicsRayQueryParameters3D.create(pose * (middle + Vector3.UP * 4.0), pose * middle)
		var hit := root.world_3d.direct_space_state.intersect_ray(query)
		check(not hit.is_empty() and hit.collider == scatter, "a ray meets the body at %s: %s" % [pose.origin, hit])


## The node moves in every frame. Bodies that do not fit into the budget of a frame must be moved in later frames, including the farthest ones.
func test_no_body_stays_behind_a_node_that_moves_in_every_frame() -> void:
	var scatter := make_ship(ScatterGroundFlat.new())
	var layer := scatter.layers[0]
	make_trunks_solid(layer, 25.0)
	await settle(scatter)
	await physics_frame
	await physics_frame
	var standing := scatter.query_rect(Rect2(-40.0, -40.0, 80.0, 80.0))
	var placed: Dictionary[int, Vector3] = {}
	for index in standing.size():
		placed[standing.get_id(index)] = standing.get_position(index)
	var rids := bodies(scatter)
	check(rids.size() > 1000, "%d bodies" % rids.size())
	var felled: Array[RID] = []
	for id: int in rids.keys().slice(0, 20):
		felled.push_back(rids[id])
		rids.erase(id)
		scatter.remove_instance(scatter.get_body_instance(felled[-1]))
	var sailed := 0.0
	for step in 240:
		sailed += 0.25
		ship.position.x = sailed
		await process_frame
	await process_frame
	var worst := 0.0
	var near := 0.0
	for id in rids:
		var at: Transform3D = PhysicsServer3D.body_get_state(rids[id], PhysicsServer3D.BODY_STATE_TRANSFORM)
		var behind := placed[id].x + sailed - at.origin.x
		worst = maxf(worst, behind)
		if placed[id].length() < 3.0:
			near = maxf(near, behind)
	check(near < 0.01, "bodies at the viewer are at their positions, to within %s m" % near)
	check(worst < 0.75 * sailed, "after %s m, no body is more than %s m behind" % [sailed, worst])
	for rid in felled:
		check(PhysicsServer3D.body_get_space(rid) == RID(), "the body of a felled instance leaves the space while the ship sails")
	await settle(scatter)
	for id in rids:
		var at: Transform3D = PhysicsServer3D.body_get_state(rids[id], PhysicsServer3D.BODY_STATE_TRANSFORM)
		if not check(absf(placed[id].x + sailed - at.origin.x) < 0.01, "at rest, all bodies are at their positions"):
			return


func test_ground_that_does_not_move_is_a_problem() -> void:
	var scatter := make_ship(ScatterGroundColliders.new())
	await frames(2)
	check("does not move with the node" in "\n".join(scatter.get_problems()), "problems: %s" % scatter.get_problems())
	scatter.ground = ScatterGroundNode.new()
	check("a ScatterGroundNode does not move with the node" in "\n".join(scatter.get_problems()), "problems: %s" % scatter.get_problems())
	scatter.ground = ScatterGroundFlat.new()
	ship.scale = Vector3(2.0, 2.0, 2.0)
	await settle(scatter)
	check("scaled" in "\n".join(scatter.get_problems()), "problems: %s" % scatter.get_problems())
	ship.scale = Vector3.ONE
	await settle(scatter)
	check_equal(scatter.get_problems().size(), 0, "problems: %s" % scatter.get_problems())


func test_turning_it_on_and_off() -> void:
	var scatter := make_ship(ScatterGroundFlat.new())
	ship.position = Vector3(8.0, 0.0, 0.0)
	await settle(scatter)
	var local := on_deck(scatter)
	scatter.local_coords = false
	await settle(scatter)
	var global := scatter.query_rect(Rect2(-2.0 * HALF, 4.0 * HALF))
	check_equal(global.size(), local.size(), "the same points of the world's set")
	for index in global.size():
		check(global.get_transform(index).origin.distance_to(local[global.get_id(index)].origin) < 2e-3, "an instance has the same position in the world without local_coords")


func test_two_nodes_share_a_ground_in_their_local_spaces() -> void:
	var scatter := make_ship()
	var fixed := make_scatter([make_layer(1.0)], scatter.ground, make_viewer())
	await settle(scatter)
	await settle(fixed)
	var before := on_deck(scatter)
	ship.position = Vector3(0.0, 6.0, 0.0)
	await create_timer(0.6).timeout
	await settle(scatter)
	await settle(fixed)
	check_same(before, on_deck(scatter), "the instances of the node that moves")
	var still := fixed.query_rect(Rect2(-HALF, 2.0 * HALF))
	check(still.size() > 300, "the other node has %d instances" % still.size())
	for index in still.size():
		if not check(absf(still.get_position(index).y - 6.0) < 1e-3, "the other node's instances move with the deck"):
			return


## The meshes of the ground may be anywhere in the scene. Without a common Node3D ancestor, their global transforms determine their positions.
func test_ground_outside_of_the_nodes_branch() -> void:
	var scatter := make_ship()
	ship.position = Vector3(40.0, 2.0, -8.0)
	ship.rotation.y = PI / 2.0
	var mesh := PlaneMesh.new()
	mesh.size = Vector2(6.0, 6.0)
	var pier := MeshInstance3D.new()
	pier.mesh = mesh
	pier.position = Vector3(40.0, 7.0, -8.0)
	pier.add_to_group(&"deck")
	root.add_child(pier)
	await settle(scatter)
	check(absf(scatter.ground.get_height(Vector3.ZERO) - 5.0) < 1e-3, "the height of the pier above the ship: %f" % scatter.ground.get_height(Vector3.ZERO))
	var above := 0
	for at: Transform3D in on_deck(scatter).values():
		var on_pier := absf(at.origin.x) < 2.9 and absf(at.origin.z) < 2.9
		above += int(on_pier)
		if on_pier and not check(absf(at.origin.y - 5.0) < 1e-3, "an instance on the pier, in the ship's space: %s" % at.origin):
			break
	check(above > 15, "%d instances on the pier" % above)
	pier.free()


## The node moves by several meters in every frame, faster than the bodies can follow, while instances are removed. At rest, all other bodies
## are at their positions.
func test_bodies_follow_a_fast_node_while_instances_are_removed() -> void:
	var scatter := make_ship(ScatterGroundFlat.new())
	make_trunks_solid(scatter.layers[0], 25.0)
	await settle(scatter)
	await physics_frame
	await physics_frame
	var rids := bodies(scatter)
	check(rids.size() > 1000, "%d bodies" % rids.size())
	var placed: Dictionary[int, Vector3] = {}
	for id in rids:
		placed[id] = scatter.get_instance(id).transform.origin
	scatter.frame_budget_usec = 1
	for step in 60:
		ship.position.x += 5.0
		await process_frame
		var felled: int = rids.keys()[0]
		check(scatter.remove_instance(felled), "removed")
		rids.erase(felled)
	var near := 0.0
	for id in rids:
		if placed[id].length() < 2.0:
			var at: Transform3D = PhysicsServer3D.body_get_state(rids[id], PhysicsServer3D.BODY_STATE_TRANSFORM)
			near = maxf(near, at.origin.distance_to(placed[id] + ship.position))
	check(near < 0.01, "bodies at the viewer are at their positions, to within %s m" % near)
	scatter.frame_budget_usec = 20000
	await settle(scatter)
	for id in rids:
		var at: Transform3D = PhysicsServer3D.body_get_state(rids[id], PhysicsServer3D.BODY_STATE_TRANSFORM)
		if not check(at.origin.distance_to(placed[id] + ship.position) < 0.01, "the body of %d is at %s" % [id, at.origin]):
			return
