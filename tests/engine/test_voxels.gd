extends "plugins_harness.gd"
## Tests the ground of godot_voxel: blocks that are loaded, unloaded, edited and dug away, and terrains that come and go.

func make_voxels() -> VoxelTerrainDouble:
	var node := VoxelTerrainDouble.new()
	node.position = Vector3(-32.0, -8.0, -32.0)
	root.add_child(node)
	for x in 4:
		for z in 4:
			node.mesh_block(Vector3i(x, 0, z), 8.0)
			node.mesh_block(Vector3i(x, 1, z), 0.0)
	return node


func make_on_voxels(also: Array[ScatterGround] = []) -> TerrainScatter3D:
	var terrain := ScatterGroundColliders.new()
	terrain.ray_top = 20.0
	terrain.ray_bottom = -7.0
	terrain.rays_per_frame = 2000
	var layer := make_layer()
	layer.tile_size = 16.0
	var combined := ScatterGroundCombined.new()
	combined.grounds = ([terrain] as Array[ScatterGround]) + also
	return make_scatter([layer], terrain if also.is_empty() else combined, make_viewer())


func unload_all(node: VoxelTerrainDouble) -> void:
	for at: Vector3i in node.blocks.keys():
		node.unload_block(at)


func test_voxel_terrain() -> void:
	var node := make_voxels()
	var scatter := make_on_voxels()
	scatter.state = ScatterState.new()
	await physics_frame
	await physics_frame
	await settle(scatter)
	var flat := func(_at: Vector3) -> float: return 0.0
	check_on(scatter, flat, Rect2(-32.0, -32.0, 64.0, 64.0), 500, "on the blocks")
	var corner := Rect2(-32.0, -32.0, 16.0, 16.0)
	scatter.remove_instance(within(scatter, corner).keys()[3])
	await settle(scatter)
	var before := within(scatter, corner)
	node.unload_block(Vector3i(0, 0, 0))
	node.unload_block(Vector3i(0, 1, 0))
	await create_timer(2.0).timeout
	await settle(scatter)
	check_equal(within(scatter, corner), before, "instances stay while a block is unloaded")
	node.mesh_block(Vector3i(0, 0, 0), 8.0)
	node.mesh_block(Vector3i(0, 1, 0), 0.0)
	await create_timer(1.0).timeout
	await settle(scatter)
	check_equal(within(scatter, corner), before, "the same instances when it is loaded again")
	node.mesh_block(Vector3i(0, 0, 0), 11.0)
	await until(func() -> bool:
			var on := within(scatter, corner)
			return not on.is_empty() and on.values().all(func(at: Vector3) -> bool: return absf(at.y - 3.0) < 0.01),
			"an edited block is detected")
	node.mesh_block(Vector3i(0, 0, 0), 0.0)
	await until(func() -> bool: return within(scatter, corner).is_empty(), "a block that is dug away has no instances")
	node.mesh_block(Vector3i(4, 0, 0), 8.0)
	node.mesh_block(Vector3i(4, 1, 0), 0.0)
	await until(func() -> bool: return within(scatter, Rect2(32.0, -32.0, 16.0, 16.0)).size() > 20, "a block that is loaded later")


func test_a_voxel_terrain_is_not_a_node_with_heights() -> void:
	var node := make_voxels()
	var scatter := make_on(node)
	await settle(scatter)
	check_error(["ScatterGroundColliders"], "the error names the right ground")
	check("ScatterGroundColliders" in "\n".join(scatter.get_problems()), "problems: %s" % scatter.get_problems())


func test_a_voxel_terrain_that_leaves_and_reenters_the_tree() -> void:
	var scatter := make_on_voxels()
	await physics_frame
	await settle(scatter)
	check(all_transforms(scatter).is_empty(), "no instances without a terrain")
	var node := make_voxels()
	var area := Rect2(-32.0, -32.0, 64.0, 64.0)
	await until(func() -> bool: return within(scatter, area).size() > 500, "a terrain that is added later is ground")
	await create_timer(2.0).timeout
	await settle(scatter)
	var before := within(scatter, area)
	unload_all(node)
	await create_timer(2.0).timeout
	await settle(scatter)
	check_equal(within(scatter, area), before, "instances stay while all blocks are unloaded")
	root.remove_child(node)
	await until(func() -> bool: return within(scatter, area).is_empty(), "a terrain outside of the tree is not ground")
	root.add_child(node)
	for x in 4:
		for z in 4:
			node.mesh_block(Vector3i(x, 0, z), 8.0)
			node.mesh_block(Vector3i(x, 1, z), 0.0)
	await until(func() -> bool: return within(scatter, area) == before, "the same instances after the terrain has returned")
	unload_all(node)
	await create_timer(2.0).timeout
	await settle(scatter)
	check_equal(within(scatter, area), before, "instances stay while the blocks are unloaded again")


## Blocks outside of a terrain's bounds are never meshed, so only blocks within them count as unloaded.
func test_bounds_of_a_voxel_terrain() -> void:
	var node := VoxelLodTerrainDouble.new()
	node.position = Vector3(-32.0, -8.0, -32.0)
	node.bounds = AABB(Vector3.ZERO, Vector3(32.0, 32.0, 64.0))
	root.add_child(node)
	for x in 4:
		for z in 4:
			node.mesh_block(Vector3i(x, 0, z), 8.0)
			node.mesh_block(Vector3i(x, 1, z), 0.0)
	var scatter := make_on_voxels()
	await physics_frame
	await physics_frame
	await settle(scatter)
	var inside := Rect2(-32.0, -32.0, 32.0, 64.0)
	var outside := Rect2(0.0, -32.0, 32.0, 64.0)
	var before := within(scatter, inside)
	check(before.size() > 250 and within(scatter, outside).size() > 250, "instances within and outside of the bounds")
	unload_all(node)
	await until(func() -> bool: return within(scatter, outside).is_empty(), "without blocks, no ground is outside of the bounds")
	await create_timer(1.0).timeout
	await settle(scatter)
	check_equal(within(scatter, inside), before, "instances within the bounds stay")


## Instances do not drop to a lower ground of a combination while a block above it is unloaded.
func test_voxels_above_other_ground() -> void:
	var node := make_voxels()
	var flat := ScatterGroundFlat.new()
	flat.height = -5.0
	var scatter := make_on_voxels([flat])
	await physics_frame
	await physics_frame
	await settle(scatter)
	var corner := Rect2(-32.0, -32.0, 16.0, 16.0)
	var before := within(scatter, corner)
	check(before.size() > 30 and before.values().all(func(at: Vector3) -> bool: return absf(at.y) < 0.01), "%d instances on a block" % before.size())
	node.unload_block(Vector3i(0, 0, 0))
	node.unload_block(Vector3i(0, 1, 0))
	await create_timer(2.0).timeout
	await settle(scatter)
	check_equal(within(scatter, corner), before, "instances stay while the block is unloaded")
	node.mesh_block(Vector3i(0, 0, 0), 0.0)
	node.mesh_block(Vector3i(0, 1, 0), 0.0)
	await until(func() -> bool:
			var on := within(scatter, corner)
			return not on.is_empty() and on.values().all(func(at: Vector3) -> bool: return absf(at.y + 5.0) < 0.01),
			"instances are on the lower ground after the block is dug away")
