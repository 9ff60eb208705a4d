extends "terrain_harness.gd"
## Tests ground from the scene's nodes. The ground tracks them: adding, removing, moving or changing a node regenerates the affected tiles
## and no others.

const CROWD := 1000
## The maximum number of nodes that a frame checks.
const LOOKS := 64


func put_plane(at: Vector3, size := Vector2(30.0, 30.0), group := &"ground") -> MeshInstance3D:
	var instance := MeshInstance3D.new()
	var plane := PlaneMesh.new()
	plane.size = size
	instance.mesh = plane
	if group:
		instance.add_to_group(group)
	root.add_child(instance)
	instance.global_position = at
	return instance


## Returns a settled scatter on the meshes in the group "ground". Tiles are 8 m wide.
func make_on_meshes() -> TerrainScatter3D:
	var terrain := ScatterGroundMeshes.new()
	terrain.group = &"ground"
	return await _settled_on(terrain)


func make_on_colliders() -> TerrainScatter3D:
	var terrain := ScatterGroundColliders.new()
	terrain.rays_per_frame = 5000
	return await _settled_on(terrain)


func _settled_on(terrain: ScatterGround) -> TerrainScatter3D:
	var layer := make_layer(1.0)
	layer.tile_size = 8.0
	var scatter := make_scatter([layer], terrain, make_viewer())
	await physics_frame
	await settle(scatter)
	return scatter


func put_body(shape: Shape3D, at: Vector3, body: CollisionObject3D = StaticBody3D.new()) -> CollisionObject3D:
	var collision := CollisionShape3D.new()
	collision.shape = shape
	body.add_child(collision)
	body.position = at
	root.add_child(body)
	return body


func slab(width := 20.0) -> BoxShape3D:
	var box := BoxShape3D.new()
	box.size = Vector3(width, 2.0, width)
	return box


## Returns the 8 m tiles that touch one of these rectangles, or the meter around it in which slopes may change.
func tiles_under(areas: Array[Rect2]) -> Array[Vector2i]:
	var result: Array[Vector2i] = []
	for x in range(-10, 10):
		for z in range(-10, 10):
			var tile := Rect2(x * 8.0, z * 8.0, 8.0, 8.0)
			if areas.any(func(area: Rect2) -> bool: return area.grow(1.01).intersects(tile, true)):
				result.push_back(Vector2i(x, z))
	return result


## Runs `edit` and checks that exactly the visible tiles under the areas were regenerated.
func check_regenerated(scatter: TerrainScatter3D, areas: Array[Rect2], context: String, edit: Callable) -> void:
	await check_regenerated_under(scatter, tiles_under(areas), not areas.is_empty(), context, edit)


## Returns the largest vertical distance in meters between an instance and the expected ground. `height` is a function of the position
## that returns NAN where no instance is allowed.
func farthest_off(scatter: TerrainScatter3D, height: Callable) -> float:
	var worst := 0.0
	for one in all_transforms(scatter):
		var expected: float = height.call(one.origin)
		worst = maxf(worst, INF if is_nan(expected) else absf(one.origin.y - expected))
	return worst


func square(at: Vector2, half: float) -> Rect2:
	return Rect2(at.x - half, at.y - half, 2.0 * half, 2.0 * half)


func test_a_mesh_joins_later_and_leaves() -> void:
	put_plane(Vector3(-20.0, 0.0, 0.0))
	var later := put_plane(Vector3(25.0, 3.0, 0.0), Vector2(20.0, 20.0), &"")
	var scatter := await make_on_meshes()
	var on_later := func(at: Vector3) -> bool: return at.x > 14.0
	check(not all_transforms(scatter).any(func(one: Transform3D) -> bool: return on_later.call(one.origin)), "a mesh outside of the group is not ground")
	var area: Array[Rect2] = [square(Vector2(25.0, 0.0), 10.0)]
	await check_regenerated(scatter, area, "joins the group", func() -> void: later.add_to_group(&"ground"))
	var stand := all_transforms(scatter).filter(func(one: Transform3D) -> bool: return on_later.call(one.origin))
	check(stand.size() > 100, "%d instances on the new mesh" % stand.size())
	check(stand.all(func(one: Transform3D) -> bool: return absf(one.origin.y - 3.0) < 1e-4), "the instances are at the mesh's height")
	await check_regenerated(scatter, area, "leaves the group", func() -> void: later.remove_from_group(&"ground"))
	check(not all_transforms(scatter).any(func(one: Transform3D) -> bool: return on_later.call(one.origin)), "no instances after it has left")
	await check_regenerated(scatter, area, "joins again", func() -> void: later.add_to_group(&"ground"))
	await check_regenerated(scatter, area, "one leaves, another one joins", func() -> void:
			later.remove_from_group(&"ground")
			put_plane(later.position, Vector2(20.0, 20.0)))
	check_equal(scatter.get_problems().size(), 0, "no problems")


func test_the_first_mesh_is_added_last() -> void:
	var scatter := await make_on_meshes()
	check("\"ground\"" in "\n".join(scatter.get_problems()), "a warning without meshes")
	var plane := put_plane(Vector3.ZERO, Vector2(30.0, 30.0), &"")
	plane.mesh = null
	plane.add_to_group(&"ground")
	await frames(10)
	plane.mesh = PlaneMesh.new()
	(plane.mesh as PlaneMesh).size = Vector2(30.0, 30.0)
	await settle(scatter)
	check(all_transforms(scatter).size() > 300, "instances on the first mesh")
	check_equal(scatter.get_problems().size(), 0, "no warning")
	plane.free()
	await settle(scatter)
	check_equal(all_transforms(scatter).size(), 0, "no instances after it was freed")
	check("\"ground\"" in "\n".join(scatter.get_problems()), "the warning returns")


func test_a_mesh_moves_rotates_and_changes() -> void:
	put_plane(Vector3.ZERO, Vector2(100.0, 100.0))
	var rock := put_plane(Vector3(-20.0, 2.0, -12.0), Vector2(10.0, 10.0))
	var scatter := await make_on_meshes()
	var reads: int = scatter.get_stats()["ground_reads"]
	await check_regenerated(scatter, [square(Vector2(-20.0, -12.0), 5.0), square(Vector2(28.0, 20.0), 5.0)], "moved",
			func() -> void: rock.position = Vector3(28.0, 2.0, 20.0))
	check_equal(scatter.get_stats()["ground_reads"], reads, "a moved mesh is not read again")
	var over_rock := func(at: Vector3) -> float:
		var local := rock.global_transform.affine_inverse() * at
		return rock.position.y if absf(local.x) < 4.99 and absf(local.z) < 4.99 else at.y if absf(at.y) < 0.01 or absf(at.y - rock.position.y) < 0.01 else NAN
	check(farthest_off(scatter, over_rock) < 1e-3, "no instances in the air")
	await check_regenerated(scatter, [square(Vector2(28.0, 20.0), 5.0 * sqrt(2.0))], "turned",
			func() -> void: rock.rotation.y = PI / 4.0)
	check(farthest_off(scatter, over_rock) < 1e-3, "no instances next to the rotated mesh")
	await check_regenerated(scatter, [], "moved and back", func() -> void:
			rock.position.x += 1.0
			await frames(2)
			rock.position.x -= 1.0)
	rock.rotation.y = 0.0
	await settle(scatter)
	await check_regenerated(scatter, [square(Vector2(28.0, 20.0), 8.0)], "a larger mesh",
			func() -> void: (rock.mesh as PlaneMesh).size = Vector2(16.0, 16.0))
	var small := PlaneMesh.new()
	small.size = Vector2(5.0, 5.0)
	await check_regenerated(scatter, [square(Vector2(28.0, 20.0), 8.0)], "a new mesh", func() -> void: rock.mesh = small)
	await check_regenerated(scatter, [square(Vector2(28.0, 20.0), 2.5)], "no mesh", func() -> void: rock.mesh = null)
	rock.mesh = small
	await settle(scatter)
	await check_regenerated(scatter, [], "hidden", rock.hide)
	await check_regenerated(scatter, [], "renamed", func() -> void: rock.name = "Other")
	var parent := Node3D.new()
	root.add_child(parent)
	await check_regenerated(scatter, [], "moved in the tree", func() -> void: rock.reparent(parent))
	await check_regenerated(scatter, [square(Vector2(28.0, 20.0), 2.5), square(Vector2(8.0, 20.0), 2.5)], "moved by its parent",
			func() -> void: parent.position.x = -20.0)
	await check_regenerated(scatter, [square(Vector2(8.0, 20.0), 2.5)], "freed", rock.queue_free)


## While a mesh keeps moving, plants are updated at a limited rate. They are correct after it stops.
func test_a_mesh_that_keeps_moving() -> void:
	put_plane(Vector3.ZERO, Vector2(100.0, 100.0))
	var rock := put_plane(Vector3(-30.0, 2.0, 0.0), Vector2(10.0, 10.0))
	var scatter := await make_on_meshes()
	var signals: Array[Rect2] = []
	scatter.ground.ground_changed.connect(func(rect: Rect2) -> void: signals.push_back(rect))
	var moves := 0
	var until_msec := Time.get_ticks_msec() + 1500
	while Time.get_ticks_msec() < until_msec:
		rock.position.x = -30.0 + 60.0 * (1.0 - (until_msec - Time.get_ticks_msec()) / 1500.0)
		moves += 1
		await process_frame
	check(signals.size() >= 2, "plants are updated during the movement: %d signals" % signals.size())
	check(signals.size() <= 10 and moves > 20, "fewer signals than the %d frames: %d" % [moves, signals.size()])
	await settle(scatter)
	var on_rock := all_transforms(scatter).filter(func(one: Transform3D) -> bool: return one.origin.y > 1.0)
	check(on_rock.size() > 40, "%d instances on the rock" % on_rock.size())
	check(on_rock.all(func(one: Transform3D) -> bool: return absf(one.origin.x - rock.position.x) < 5.01), "the instances are at the rock's final position")


## A node checks a limited number of meshes per frame, regardless of how many there are, and reads those that have changed.
func test_a_thousand_meshes_cost_little_each_frame() -> void:
	var crowd: Array[MeshInstance3D] = []
	for index in CROWD:
		crowd.push_back(put_plane(Vector3(index % 40 - 20, 0.0, index / 40 - 12) * 4.0, Vector2(4.0, 4.0)))
	var scatter := await make_on_meshes()
	var reads: int = scatter.get_stats()["ground_reads"]
	check_equal(reads, CROWD, "each mesh is read once")
	var checked := 0
	for frame in 40:
		await process_frame
		var checks: int = scatter.get_stats()["ground_checks"]
		check(checks <= LOOKS, "%d meshes checked in a frame" % checks)
		checked += checks
	check(checked >= 30 * LOOKS, "all meshes are checked in turn: %d" % checked)
	check_equal(scatter.get_stats()["ground_reads"], reads, "meshes read without a change")
	for index: int in [3, 500, 998]:
		crowd[index].position.y = 5.0
	await until(func() -> bool: return not scatter.is_settled(), "noticed")
	await settle(scatter)
	check_equal(scatter.get_stats()["ground_reads"], reads, "meshes read after they moved")
	check(absf(scatter.ground.get_height(crowd[500].position) - 5.0) < 1e-5, "moved meshes are ground at their new positions")
	for index: int in [3, 500, 998]:
		(crowd[index].mesh as PlaneMesh).center_offset.y = 1.0
	await until(func() -> bool: return not scatter.is_settled(), "noticed")
	await settle(scatter)
	check_equal(scatter.get_stats()["ground_reads"], reads + 3, "meshes read after three of them changed")
	check(absf(scatter.ground.get_height(crowd[500].position) - 6.0) < 1e-5, "changed meshes are ground")


func test_refresh_ground_reads_in_portions() -> void:
	for index in 200:
		put_plane(Vector3(index % 20 - 10, 0.0, index / 20 - 5) * 4.0, Vector2(4.0, 4.0))
	var scatter := await make_on_meshes()
	var reads: int = scatter.get_stats()["ground_reads"]
	var maximum := 0
	var regenerated_tiles := await regenerated_by(scatter, func() -> void:
			scatter.refresh_ground()
			var last := reads
			while not scatter.is_settled():
				await process_frame
				maximum = maxi(maximum, scatter.get_stats()["ground_reads"] - last)
				last = scatter.get_stats()["ground_reads"])
	check_equal(regenerated_tiles.size(), 0, "tiles regenerated by refresh_ground")
	await until(func() -> bool: return scatter.get_stats()["ground_reads"] == reads + 200, "all meshes are read again")
	check(maximum <= LOOKS, "at most %d meshes are read in a frame" % maximum)


func test_moved_bodies_are_detected() -> void:
	put_body(slab(100.0), Vector3(0.0, -1.0, 0.0)) # Its top is at height 0.
	var rock := put_body(slab(10.0), Vector3(-20.0, 1.0, -12.0))
	var rocks := [rock] # A lambda captures local variables by value.
	var scatter := await make_on_colliders()
	var height := func(at: Vector3) -> float:
		var away: Vector3 = at - rocks[0].position
		return at.y if absf(at.y) < 0.001 or absf(away.y - 1.0) < 0.001 and maxf(absf(away.x), absf(away.z)) < 5.1 else NAN
	check(farthest_off(scatter, height) < 0.01, "the instances are on the ground at first")
	await check_regenerated(scatter, [square(Vector2(-20.0, -12.0), 5.0), square(Vector2(28.0, 20.0), 5.0)], "moved",
			func() -> void: rock.position = Vector3(28.0, 1.0, 20.0))
	check(farthest_off(scatter, height) < 0.01, "no instances in the air")
	check(all_transforms(scatter).any(func(one: Transform3D) -> bool: return absf(one.origin.y - 2.0) < 0.01), "some instances are on the rock")
	var collision: CollisionShape3D = rock.get_child(0)
	await check_regenerated(scatter, [square(Vector2(28.0, 20.0), 8.0)], "a larger shape",
			func() -> void: (collision.shape as BoxShape3D).size = Vector3(16.0, 2.0, 16.0))
	await check_regenerated(scatter, [square(Vector2(28.0, 20.0), 8.0)], "a new shape", func() -> void: collision.shape = slab(10.0))
	await check_regenerated(scatter, [square(Vector2(28.0, 20.0), 5.0)], "disabled", func() -> void: collision.disabled = true)
	await check_regenerated(scatter, [square(Vector2(28.0, 20.0), 5.0)], "enabled", func() -> void: collision.disabled = false)
	await check_regenerated(scatter, [square(Vector2(28.0, 20.0), 5.0)], "on another collision layer", func() -> void: rock.collision_layer = 2)
	await check_regenerated(scatter, [square(Vector2(28.0, 20.0), 5.0)], "on the same collision layer", func() -> void: rock.collision_layer = 1)
	await check_regenerated(scatter, [square(Vector2(28.0, 20.0), 5.0)], "freed", rock.queue_free)
	await check_regenerated(scatter, [square(Vector2(0.0, 0.0), 5.0)], "a new one", func() -> void:
			rocks[0] = put_body(slab(10.0), Vector3(0.0, 1.0, 0.0)))
	check(farthest_off(scatter, height) < 0.01, "the instances are on the new body")
	var hills := HeightMapShape3D.new()
	hills.map_width = 5
	hills.map_depth = 5
	await check_regenerated(scatter, [square(Vector2.ZERO, 5.0)], "hills", func() -> void: rocks[0].get_child(0).shape = hills)
	var heights := hills.map_data
	heights.fill(3.0)
	await check_regenerated(scatter, [square(Vector2.ZERO, 2.0)], "new heights", func() -> void: hills.map_data = heights)
	check(all_transforms(scatter).any(func(one: Transform3D) -> bool: return absf(one.origin.y - 4.0) < 0.01), "some instances are on the hills")


## Rays hit an animated body at its current position, but the ground does not track it. Plants at its old position disappear.
func test_moving_bodies_are_not_tracked() -> void:
	if ProjectSettings.get_setting("threading/worker_pool/max_threads") == 0:
		check(true, "not run: the engine's physics crashes without threads when such a body moves")
		return
	put_body(slab(100.0), Vector3(0.0, -1.0, 0.0))
	var platform := put_body(slab(10.0), Vector3(-20.0, 1.0, -12.0), AnimatableBody3D.new())
	var scatter := await make_on_colliders()
	var rides := func(one: Transform3D) -> bool: return one.origin.y > 1.0
	check(all_transforms(scatter).any(rides), "some instances are on the platform at first")
	var under := tiles_under([square(on_map(platform.transform), 5.0)])
	var regenerated_tiles := await regenerated_by(scatter, func() -> void:
			platform.position.x += 30.0
			await until(func() -> bool: return not all_transforms(scatter).any(rides), "no instances in the air"))
	check(regenerated_tiles.all(func(tile: Vector2i) -> bool: return under.has(tile)), "only tiles at the platform's old position are regenerated: %s" % [regenerated_tiles])
	var tiles: int = scatter.get_stats()["tiles_made"]
	await frames(60)
	check(scatter.is_settled(), "still settled")
	check_equal(scatter.get_stats()["tiles_made"], tiles, "tiles generated while the platform rests")
	regenerated_tiles = await regenerated_by(scatter, scatter.refresh_ground)
	check_equal(regenerated_tiles.size(), scatter.get_shown_tiles(scatter.layers[0]).size(), "refresh_ground casts all rays again")
	var on_it := all_transforms(scatter).filter(func(one: Transform3D) -> bool: return one.origin.y > 1.0)
	check(on_it.size() > 40 and on_it.all(func(one: Transform3D) -> bool: return absf(one.origin.x - 10.0) < 5.1), "instances are on the platform at its new position")


## refresh_ground finds changes in the physics server that no node or resource reports.
func test_refresh_ground_finds_unreported_changes() -> void:
	var body := PhysicsServer3D.body_create()
	var shape := PhysicsServer3D.box_shape_create()
	PhysicsServer3D.shape_set_data(shape, Vector3(20.0, 1.0, 20.0))
	PhysicsServer3D.body_set_mode(body, PhysicsServer3D.BODY_MODE_STATIC)
	PhysicsServer3D.body_add_shape(body, shape)
	PhysicsServer3D.body_set_space(body, root.get_world_3d().space)
	var scatter := await make_on_colliders()
	scatter.ground.recheck_enabled = false
	check(farthest_off(scatter, func(_at: Vector3) -> float: return 1.0) < 0.01, "the instances are on the box")
	PhysicsServer3D.body_set_state(body, PhysicsServer3D.BODY_STATE_TRANSFORM, Transform3D(Basis(), Vector3(0.0, 4.0, 0.0)))
	await physics_frame
	await physics_frame
	await settle(scatter)
	check(farthest_off(scatter, func(_at: Vector3) -> float: return 1.0) < 0.01, "an unreported change moves no instances")
	scatter.refresh_ground()
	await settle(scatter)
	check(all_transforms(scatter).size() > 500, "more than 500 instances are visible")
	check(farthest_off(scatter, func(_at: Vector3) -> float: return 5.0) < 0.01, "after refresh_ground, the instances are on the moved box")
	scatter.ground = null
	PhysicsServer3D.free_rid(body)
	PhysicsServer3D.free_rid(shape)


## A plant must not be placed on the body of its scene, even if that is on the ground's collision layer.
func test_bodies_of_scenes_are_not_ground() -> void:
	put_body(slab(100.0), Vector3(0.0, -1.0, 0.0))
	var stump := StaticBody3D.new()
	var collision := CollisionShape3D.new()
	collision.shape = slab(1.0)
	stump.add_child(collision)
	collision.owner = stump
	var scene := PackedScene.new()
	scene.pack(stump)
	stump.free()
	var terrain := ScatterGroundColliders.new()
	terrain.rays_per_frame = 5000
	var layer := make_layer(2.0)
	layer.scene = scene
	layer.scene_distance = 20.0
	var scatter := make_scatter([layer], terrain, make_viewer())
	await physics_frame
	await settle(scatter)
	check(scatter.get_stats()["scenes"] > 50, "scenes are shown")
	await create_timer(0.5).timeout
	check(scatter.is_settled(), "scenes do not change the ground")
	scatter.regenerate()
	await settle(scatter)
	check(farthest_off(scatter, func(_at: Vector3) -> float: return 0.0) < 0.01, "no plant is on top of another")


## Handlers of ground_changed may free the node or change it.
func test_handlers_may_free_or_change_the_node() -> void:
	var endings: Dictionary[String, Callable] = {
		"free": func(scatter: TerrainScatter3D) -> void: scatter.free(),
		"terrain": func(scatter: TerrainScatter3D) -> void: scatter.ground = null,
		"group": func(scatter: TerrainScatter3D) -> void: scatter.ground.group = &"none",
		"leave": func(scatter: TerrainScatter3D) -> void: root.remove_child(scatter),
	}
	for ending in endings:
		var plane := put_plane(Vector3.ZERO)
		var scatter := await make_on_meshes()
		var terrain: ScatterGroundMeshes = scatter.ground
		var signal_count := [0]
		terrain.ground_changed.connect(func(_rect: Rect2) -> void:
				signal_count[0] += 1
				endings[ending].call(scatter))
		plane.position.y = 2.0
		await until(func() -> bool: return signal_count[0] > 0, "%s: a signal" % ending)
		await frames(10)
		check(ending != "free" or not is_instance_valid(scatter) or was_kept_from_being_freed(), "freed, or refused by the engine")
		if is_instance_valid(scatter):
			scatter.free()
		await clean()


## If the world offset and the scene move together, nothing is read again.
func test_recentering_reads_nothing() -> void:
	var plane := put_plane(Vector3(0.0, 1.0, 0.0), Vector2(90.0, 90.0))
	var scatter := await make_on_meshes()
	var viewer := scatter.get_node(scatter.viewers[0]) as Node3D
	var before := by_id(scatter)
	var reads: int = scatter.get_stats()["ground_reads"]
	var shift := Vector3(1000.5, 0.0, -333.25)
	await check_regenerated(scatter, [], "recentered", func() -> void:
			scatter.world_offset = shift
			plane.position -= shift
			viewer.position -= shift)
	check_equal(scatter.get_stats()["ground_reads"], reads, "meshes read after the scene was recentered")
	check_equal(by_id(scatter).size(), before.size(), "all instances remain")
	plane.position += Vector3(0.0, 2.0, 0.0)
	await settle(scatter)
	check_equal(scatter.get_stats()["ground_reads"], reads, "the ground is moved without reading")
	check(absf(scatter.ground.get_height(Vector3.ZERO) - 3.0) < 1e-5, "the ground is at the new height")
