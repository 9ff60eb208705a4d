extends "terrain_harness.gd"
## Tests ground that changes without a signal: re-checks of visible tiles find the changes and regenerate only the affected tiles.

const MOST_IN_A_FRAME := 16

## Flat ground with a part at another height, or without ground if `height` is NAN. Emits no signal.
class Silent extends ScatterGround:
	var part := Rect2()
	var height := 0.0
	var threaded := false
	var calls := 0
	var positions_queried := 0
	var broken := false
	var in_call := Callable()

	func _get_heights(positions: PackedVector2Array) -> PackedFloat32Array:
		calls += 1
		positions_queried += positions.size()
		if in_call.is_valid():
			in_call.call()
		var heights := PackedFloat32Array()
		for at in positions:
			heights.push_back(height if part.has_point(at) else 0.0)
		if broken:
			heights.resize(1)
		return heights

	func _is_thread_safe() -> bool:
		return threaded


## A node with ground like `Silent`.
class SilentNode extends Node3D:
	var part := Rect2()
	var height := 0.0

	func get_height(at: Vector3) -> float:
		return height if part.has_point(Vector2(at.x, at.z)) else 0.0


func small_tiles() -> ScatterLayer:
	var layer := make_layer(1.0)
	layer.tile_size = 8.0
	layer.view_distance = 32.0
	return layer


## Returns the number of instances that are not at a silent ground's current height.
func wrong(scatter: TerrainScatter3D, ground: Object) -> int:
	var part: Rect2 = ground.get("part")
	var height: float = ground.get("height")
	var count := 0
	for one in all_transforms(scatter):
		var expected := height if part.has_point(on_map(one)) else 0.0
		count += int(not absf(one.origin.y - expected) < 1e-4)
	return count


## Waits until `count` instances exist, all at the right height. Returns the tiles that were regenerated during that time.
func regenerated(scatter: TerrainScatter3D, ground: Object, count: int, context: String) -> Array[Vector2i]:
	var made: Array[Vector2i] = []
	var note := func(_layer: ScatterLayer, tile: Vector2i) -> void: made.push_back(tile)
	scatter.tile_shown.connect(note)
	await until(func() -> bool:
			return scatter.is_settled() and wrong(scatter, ground) == 0 and all_transforms(scatter).size() == count, context)
	scatter.tile_shown.disconnect(note)
	return made


## Changes a part of a silent ground and checks that only tiles in this part are regenerated, once each. `all` are the instances on the
## ground.
func check_silent_change(
		scatter: TerrainScatter3D, ground: Object, all: Array[Transform3D], part: Rect2, height: float, context: String) -> void:
	ground.set("part", part)
	ground.set("height", height)
	var stay := func(one: Transform3D) -> bool: return not (is_nan(height) and part.has_point(on_map(one)))
	var regenerated_tiles := await regenerated(scatter, ground, all.filter(stay).size(), context)
	check(regenerated_tiles.size() > 0, context + ": regenerated")
	for tile in regenerated_tiles:
		check(part.intersects(Rect2(tile * 8.0, Vector2(8.0, 8.0))), "%s: tile %s is in the part" % [context, tile])
		check_equal(regenerated_tiles.count(tile), 1, "%s: tile %s once" % [context, tile])


func test_a_part_of_the_ground_changes() -> void:
	var grounds: Array[Object] = [Silent.new(), Silent.new(), SilentNode.new(), SilentNode.new()]
	(grounds[1] as Silent).threaded = true
	for index in grounds.size():
		var ground := grounds[index]
		var scatter: TerrainScatter3D
		if ground is Silent:
			scatter = make_scatter([small_tiles()], ground as Silent, make_viewer())
		else:
			scatter = make_on(ground as Node, index == 3, small_tiles())
		await settle(scatter)
		var all := all_transforms(scatter)
		var part := Rect2(0.0, 0.0, 16.0, 16.0)
		await check_silent_change(scatter, ground, all, part, 30.0, "ground %d is raised" % index)
		await check_silent_change(scatter, ground, all, part, NAN, "ground %d disappears" % index)
		check(all_transforms(scatter).size() < all.size() - 100, "no instances without ground")
		await check_silent_change(scatter, ground, all, part, 4.0, "ground %d returns" % index)
		scatter.free()
		if ground is Node:
			(ground as Node).free()


## The ground behaves like a terrain that returns a low height until its regions are loaded.
func test_regions_that_are_loaded_later() -> void:
	var ground := Silent.new()
	ground.part = Rect2(-64.0, -64.0, 128.0, 128.0)
	ground.height = -30.0
	var fine := small_tiles()
	var coarse := make_layer(3.0)
	coarse.tile_size = 24.0
	coarse.view_distance = 48.0
	coarse.layer_id = 9
	var scatter := make_scatter([fine, coarse], ground, make_viewer())
	await settle(scatter)
	var visible_count := scatter.get_shown_tiles(scatter.layers[0]).size() + scatter.get_shown_tiles(scatter.layers[1]).size()
	var tiles_made: int = scatter.get_stats()["tiles_made"]
	ground.height = 0.0
	await until(func() -> bool:
			return scatter.is_settled() and all_transforms(scatter, 0).all(is_at_height_0) \
					and all_transforms(scatter, 1).all(is_at_height_0),
			"all tiles of both layers are updated")
	tiles_made = scatter.get_stats()["tiles_made"] - tiles_made
	check(tiles_made >= visible_count and tiles_made <= 2 * visible_count, "%d tiles regenerated, %d visible" % [tiles_made, visible_count])


func is_at_height_0(one: Transform3D) -> bool:
	return absf(one.origin.y) < 1e-4


func test_unchanged_ground_costs_few_calls_and_no_tile() -> void:
	var ground := Silent.new()
	var scatter := make_scatter([small_tiles()], ground, make_viewer())
	await settle(scatter)
	var tiles_made: int = scatter.get_stats()["tiles_made"]
	var rechecks: int = scatter.get_stats()["ground_rechecks"]
	var calls := ground.calls
	for frame in 120:
		var queried := ground.positions_queried
		await process_frame
		check(scatter.is_settled(), "settled in frame %d" % frame)
		check(ground.positions_queried - queried <= MOST_IN_A_FRAME, "%d positions in one frame" % (ground.positions_queried - queried))
	check(scatter.get_stats()["ground_rechecks"] > rechecks + 50, "the ground is re-checked")
	check(ground.calls - calls <= 121, "at most one call per frame")
	check_equal(scatter.get_stats()["tiles_made"], tiles_made, "tiles generated for unchanged ground")
	ground.recheck_enabled = false
	await frames(2)
	calls = ground.calls
	await frames(60)
	check_equal(ground.calls, calls, "calls after re-checks were disabled")


func test_ground_that_reports_its_changes_is_not_rechecked() -> void:
	var map := ScatterGroundHeightmap.new()
	map.image = Image.create_empty(16, 16, false, Image.FORMAT_RF)
	map.rect = Rect2(-64.0, -64.0, 128.0, 128.0)
	var noise := ScatterGroundNoise.new()
	noise.noise = FastNoiseLite.new()
	var meshes := ScatterGroundMeshes.new()
	meshes.group = &"floor"
	var plane := MeshInstance3D.new()
	plane.mesh = PlaneMesh.new()
	plane.scale = Vector3(50.0, 1.0, 50.0)
	plane.add_to_group(&"floor")
	root.add_child(plane)
	for terrain: ScatterGround in [ScatterGroundFlat.new(), map, noise, meshes]:
		var scatter := make_scatter([small_tiles()], terrain, make_viewer())
		await settle(scatter)
		await frames(60)
		check(scatter.get_stats()["instances"] > 100, "instances on a %s" % terrain.get_class())
		check_equal(scatter.get_stats()["ground_rechecks"], 0, terrain.get_class())
		scatter.free()


func test_a_script_that_fails_is_reported_once() -> void:
	var ground := Silent.new()
	var scatter := make_scatter([small_tiles()], ground, make_viewer())
	await settle(scatter)
	ground.broken = true
	var calls := ground.calls
	await frames(60)
	check_error(["_get_heights"], "a wrong number of heights")
	check_equal(ground.calls, calls + 1, "calls after the failed call")
	ground.broken = false
	ground.emit_changed()
	await settle(scatter)
	var all := all_transforms(scatter)
	await check_silent_change(scatter, ground, all, Rect2(0.0, 0.0, 16.0, 16.0), 2.0, "re-checked again")


func test_scripts_that_change_the_node_during_a_recheck() -> void:
	for act: String in ["frees the node", "leaves the tree", "changes the layers", "replaces the ground"]:
		var ground := Silent.new()
		var scatter := make_scatter([small_tiles()], ground, make_viewer())
		await settle(scatter)
		var ran := [false]
		var once := func() -> void:
			if ran[0]:
				return
			ran[0] = true
			match act:
				"frees the node": scatter.free()
				"leaves the tree": root.remove_child(scatter)
				"changes the layers": scatter.layers = [small_tiles(), small_tiles()]
				"replaces the ground": scatter.ground = ScatterGroundFlat.new()
		ground.in_call = once
		await until(func() -> bool: return ran[0], act + ": it ran")
		ground.in_call = Callable()
		await frames(10)
		if act == "frees the node":
			was_kept_from_being_freed()
		if is_instance_valid(scatter):
			scatter.free()
		await clean()


## Creates a body in the physics server without a node, as voxel plugins do.
func serve_slab(at: Vector3, width: float) -> Array[RID]:
	var shape := PhysicsServer3D.box_shape_create()
	PhysicsServer3D.shape_set_data(shape, Vector3(0.5 * width, 1.0, 0.5 * width))
	var body := PhysicsServer3D.body_create()
	PhysicsServer3D.body_set_mode(body, PhysicsServer3D.BODY_MODE_STATIC)
	PhysicsServer3D.body_add_shape(body, shape)
	PhysicsServer3D.body_set_state(body, PhysicsServer3D.BODY_STATE_TRANSFORM, Transform3D(Basis(), at))
	PhysicsServer3D.body_set_space(body, root.get_world_3d().space)
	return [body, shape]


## Returns a settled scatter on the existing bodies.
func make_on_bodies() -> TerrainScatter3D:
	var terrain := ScatterGroundColliders.new()
	terrain.rays_per_frame = 2000
	var scatter := make_scatter([small_tiles()], terrain, make_viewer())
	await physics_frame
	await physics_frame
	await settle(scatter)
	return scatter


func test_bodies_of_the_physics_server() -> void:
	var ground := serve_slab(Vector3(0.0, -1.0, 0.0), 30.0)
	var scatter := await make_on_bodies()
	var on_both := all_transforms(scatter).size()
	check(on_both > 300, "instances on the body")
	var step := serve_slab(Vector3(8.0, 1.0, 8.0), 8.0)
	await until(func() -> bool:
			return all_transforms(scatter).any(func(one: Transform3D) -> bool: return absf(one.origin.y - 2.0) < 0.01),
			"a new body is found")
	var moved := Transform3D(Basis(), Vector3(-8.0, 2.0, -8.0))
	PhysicsServer3D.body_set_state(step[0], PhysicsServer3D.BODY_STATE_TRANSFORM, moved)
	await until(func() -> bool:
			var on_step := all_transforms(scatter).filter(func(one: Transform3D) -> bool: return one.origin.y > 0.5)
			return not on_step.is_empty() and on_step.all(func(one: Transform3D) -> bool: return absf(one.origin.y - 3.0) < 0.01),
			"a moved body is detected")
	for rid: RID in ground + step:
		PhysicsServer3D.free_rid(rid)
	await until(func() -> bool: return all_transforms(scatter).is_empty() and scatter.is_settled(), "no instances after the bodies were freed")


## Moving bodies hide the ground below them from rays, but regenerate nothing.
func test_moving_bodies_have_no_effect() -> void:
	var ground := serve_slab(Vector3(0.0, -1.0, 0.0), 60.0)
	var scatter := await make_on_bodies()
	var tiles_made: int = scatter.get_stats()["tiles_made"]
	var rigid := RigidBody3D.new()
	rigid.freeze = true
	for body: CollisionObject3D in [CharacterBody3D.new(), rigid, AnimatableBody3D.new()]:
		var shape := CollisionShape3D.new()
		shape.shape = BoxShape3D.new()
		(shape.shape as BoxShape3D).size = Vector3(12.0, 2.0, 12.0)
		body.add_child(shape)
		root.add_child(body)
		var rechecks: int = scatter.get_stats()["ground_rechecks"]
		for step in 60:
			body.position = Vector3(0.2 * step - 6.0, 2.0, 4.0)
			await physics_frame
		check(scatter.get_stats()["ground_rechecks"] > rechecks + 30, "re-checked under a %s" % body.get_class())
		body.free()
	await settle(scatter)
	check_equal(scatter.get_stats()["tiles_made"], tiles_made, "no tile is generated for moving bodies")
	scatter.free()
	for rid: RID in ground:
		PhysicsServer3D.free_rid(rid)
