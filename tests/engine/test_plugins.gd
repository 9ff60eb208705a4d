extends "plugins_harness.gd"
## Tests the ground of MTerrain, TerraBrush and godot_voxel, and of Terrain3D with streamed regions.

func names_of(scatter: TerrainScatter3D) -> String:
	return (scatter.ground as ScatterGroundNode).recognized


## Returns the instances above or below a rectangle of x and z.
func within(scatter: TerrainScatter3D, area: Rect2) -> Dictionary:
	var found := {}
	var all := by_id(scatter)
	for id: int in all:
		var at: Vector3 = all[id]
		if area.has_point(Vector2(at.x, at.z)):
			found[id] = all[id]
	return found


func check_on(scatter: TerrainScatter3D, height_at: Callable, area: Rect2, least: int, context: String) -> void:
	var stand := all_transforms(scatter)
	var off := 0
	for one in stand:
		off += int(not area.has_point(Vector2(one.origin.x, one.origin.z)) or not (absf(height_at.call(one.origin) - one.origin.y) < 0.01))
	check(stand.size() >= least, "%s: %d instances" % [context, stand.size()])
	check_equal(off, 0, "%s: instances off the ground" % context)


func test_mterrain() -> void:
	var node := MTerrainDouble.new()
	for x in range(20, 25):
		for y in range(20, 25):
			node.heights[Vector2i(x, y)] = NAN
	var layer := make_layer()
	layer.max_slope_degrees = 60.0 # This limit requires normals.
	var scatter := make_on(node, true, layer)
	await settle(scatter)
	check("queried position by position" in names_of(scatter), "recognized: %s" % names_of(scatter))
	check_on(scatter, node.get_height, node.area(), 1000, "a grid")
	var hole := Rect2(node.offset.x + 19.0 * 2.0, node.offset.z + 19.0 * 2.0, 12.0, 12.0).grow(-0.1)
	check(within(scatter, hole).is_empty(), "no instances in a hole")
	check_equal(node.stray_calls, 0, "calls that the plug-in does not survive")
	check(not node.on_worker, "only the main thread calls it, even if it is marked as thread-safe")
	check_equal(scatter.get_problems().size(), 0, "problems: %s" % scatter.get_problems())
	var terrain: ScatterGround = scatter.ground
	check(is_nan(terrain.get_height(Vector3(-60.0, 0.0, 0.0))) and is_nan(terrain.get_height(Vector3(60.0, 0.0, 0.0))), "no ground beyond the grid")
	var normal := terrain.get_normal(Vector3(20.0, 0.0, 20.0))
	check(normal.distance_to(Vector3(-0.125, 1.0, -0.2 * cos(0.2 * 30.0)).normalized()) < 0.05, "a normal from heights: %s" % normal)


func test_mterrain_is_sculpted() -> void:
	var node := MTerrainDouble.new()
	var scatter := make_on(node)
	await settle(scatter)
	var hill := Rect2(-8.0, -8.0, 16.0, 16.0)
	for x in range(18, 32):
		for y in range(14, 28):
			node.heights[Vector2i(x, y)] = 30.0
	await until(func() -> bool:
			var on := within(scatter, hill.grow(-3.0))
			return not on.is_empty() and on.values().all(func(at: Vector3) -> bool: return absf(at.y - 30.0) < 0.01),
			"the hill is detected by re-checks")
	for x in range(18, 32):
		for y in range(14, 28):
			node.heights[Vector2i(x, y)] = 20.0
	scatter.ground.ground_changed.emit(hill.grow(4.0))
	await settle(scatter)
	check(within(scatter, hill.grow(-3.0)).values().all(func(at: Vector3) -> bool: return absf(at.y - 20.0) < 0.01), "immediately after the signal")


func test_mterrain_loads_regions() -> void:
	var node := MTerrainDouble.new()
	var last := Vector2i(2, 2)
	node.loaded[last] = false
	var scatter := make_on(node)
	scatter.state = ScatterState.new()
	await settle(scatter)
	var inside := node.area_of(last).grow(-2.5)
	check(within(scatter, inside).is_empty(), "no instances, and none at height 0, in a region that is not loaded")
	node.loaded[last] = true
	await until(func() -> bool: return within(scatter, inside).size() > 20, "instances come when the region is loaded")
	await create_timer(2.0).timeout # In this time, re-checks find the region in each tile.
	await settle(scatter)
	check_on(scatter, node.get_height, node.area(), 1000, "all loaded")
	var felled: int = within(scatter, inside).keys()[0]
	scatter.remove_instance(felled)
	await settle(scatter)
	var before := within(scatter, inside)
	node.loaded[last] = false
	await create_timer(2.0).timeout
	await settle(scatter)
	check_equal(within(scatter, inside), before, "instances stay while the region is unloaded")
	node.loaded[last] = true
	scatter.regenerate()
	await settle(scatter)
	check_equal(within(scatter, inside), before, "the same instances when it is loaded again, without the removed one")


func test_mterrain_creates_its_grid_later() -> void:
	var node := MTerrainDouble.new()
	node.grid_created = false
	var scatter := make_on(node)
	await settle(scatter)
	check_error(["MTerrain", "create"], "no grid yet")
	check("create" in "\n".join(scatter.get_problems()), "reported: %s" % scatter.get_problems())
	node.grid_created = true
	await frames(3)
	await settle(scatter)
	check_on(scatter, node.get_height, node.area(), 1000, "a late grid")
	var before := by_id(scatter)
	node.grid_created = false
	await frames(3)
	await settle(scatter)
	check_error(["MTerrain"], "the grid is removed")
	check_equal(by_id(scatter), before, "the instances do not change without a grid")
	node.offset.x += 16.0
	node.grid_created = true
	await frames(3)
	await settle(scatter)
	check_on(scatter, node.get_height, node.area(), 1000, "a moved grid")
	check_no_error("moved")


func zone_area(node: TerraBrushDouble, zone: Vector2i) -> Rect2:
	var first := node.place_of(zone, Vector2i.ZERO)
	return Rect2(first.x + node.position.x, first.y + node.position.z, node.zones_size - 1.0, node.zones_size - 1.0)


## Returns the height that TerraBrush draws. It is interpolated between samples, unlike the result of getHeightAtPosition().
func drawn_height(node: TerraBrushDouble, at: Vector3) -> float:
	var step := (node.zones_size - 1.0) / (node.image_size() - 1.0)
	var origin := zone_area(node, Vector2i.ZERO).position
	var place := (Vector2(at.x, at.z) - origin) / step
	var first := place.floor()
	var posts: Array[float] = []
	for corner in 4:
		var post := (first + Vector2(corner % 2, floori(corner / 2.0))) * step + origin - Vector2(node.position.x, node.position.z)
		posts.push_back(node.shape(post.x, post.y) + node.position.y)
	var part := place - first
	return lerpf(lerpf(posts[0], posts[1], part.x), lerpf(posts[2], posts[3], part.x), part.y)


func test_terrabrush() -> void:
	for case: Array in [[65, 1], [64, 1], [65, 2]]:
		var node := TerraBrushDouble.new()
		node.zones_size = case[0]
		node.resolution = case[1]
		node.position = Vector3(3.0, -2.0, 5.0)
		node.add_zone(Vector2i(0, 0))
		node.add_zone(Vector2i(-1, 0))
		var scatter := make_on(node)
		await settle(scatter)
		var context := "zones of %d, resolution %d" % case
		check("TerraBrush" in names_of(scatter), "%s: recognized: %s" % [context, names_of(scatter)])
		check_on(scatter, func(at: Vector3) -> float: return drawn_height(node, at),
				zone_area(node, Vector2i(-1, 0)).merge(zone_area(node, Vector2i.ZERO)), 1000, context)
		for post: Vector2i in [Vector2i(3, 4), Vector2i(20, 0), Vector2i(0, 9)]:
			var place := node.place_of(Vector2i.ZERO, post) + Vector2(node.position.x, node.position.z)
			var height: float = scatter.ground.get_height(Vector3(place.x, 0.0, place.y))
			check(absf(height - node.getHeightAtPosition(place.x, place.y, true)) < 1e-3, "%s: its own height at sample %s" % [context, post])
		check_equal(scatter.get_problems().size(), 0, "%s: problems: %s" % [context, scatter.get_problems()])
		scatter.free()
		node.free()


func test_terrabrush_is_edited() -> void:
	var node := TerraBrushDouble.new()
	var zone := node.add_zone(Vector2i.ZERO)
	var scatter := make_on(node)
	await settle(scatter)
	var all := scatter.get_shown_tiles(scatter.layers[0]).size()
	var hill := Rect2(-4.0, -4.0, 8.0, 8.0)
	var sculpt := func() -> void:
		for x in range(28, 37):
			for y in range(28, 37):
				zone.image.set_pixel(x, y, Color(40.0, 0.0, 0.0))
		await frames(3)
	var made := await regenerated_by(scatter, sculpt)
	check(within(scatter, hill).values().all(func(at: Vector3) -> bool: return absf(at.y - 40.0) < 0.01), "a hill is detected without a signal")
	check(not made.is_empty() and made.size() < all, "%d of %d tiles were regenerated" % [made.size(), all])
	var nothing := await regenerated_by(scatter, func() -> void: await frames(5))
	check_equal(nothing.size(), 0, "no tile is regenerated without an edit")
	await regenerated_by(scatter, func() -> void:
		for x in range(28, 37):
			for y in range(28, 37):
				zone.image.set_pixel(x, y, Color(40.0, 1.0, 0.0))
		await frames(3))
	check(within(scatter, hill.grow(0.9)).is_empty(), "a hole has no instances")
	var before := by_id(scatter).size()
	await regenerated_by(scatter, func() -> void:
		node.add_zone(Vector2i(1, 0))
		await frames(3))
	check(by_id(scatter).size() > before + 300, "instances are placed on a new zone")
	var height: float = by_id(scatter).values()[0].y
	await regenerated_by(scatter, func() -> void:
		node.position.y += 10.0
		await frames(3))
	check(absf(by_id(scatter).values()[0].y - height - 10.0) < 0.01, "instances move with the node")


func test_terrabrush_without_a_terrain() -> void:
	var node := TerraBrushDouble.new()
	var scatter := make_on(node)
	await settle(scatter)
	check_error(["TerraBrush", "no terrain"], "no zones yet")
	node.add_zone(Vector2i.ZERO)
	await frames(3)
	await settle(scatter)
	check(all_transforms(scatter).size() > 500, "instances when the terrain is created")
	check_no_error("created")


func make_voxels() -> VoxelTerrainDouble:
	var node := VoxelTerrainDouble.new()
	node.position = Vector3(-32.0, -8.0, -32.0)
	root.add_child(node)
	for x in 4:
		for z in 4:
			node.mesh_block(Vector3i(x, 0, z), 8.0)
			node.mesh_block(Vector3i(x, 1, z), 0.0)
	return node


func test_voxel_terrain() -> void:
	var node := make_voxels()
	var terrain := ScatterGroundColliders.new()
	terrain.ray_top = 20.0
	terrain.ray_bottom = -7.0
	terrain.rays_per_frame = 2000
	var layer := make_layer()
	layer.tile_size = 16.0
	var scatter := make_scatter([layer], terrain, make_viewer())
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


func unload(node: StreamedTerrain3DDouble, at: Vector2i) -> void:
	if node.data is UnloadingDataDouble:
		(node.data as UnloadingDataDouble).unload_region(at)
	else:
		(node.data as StreamedDataDouble).evict_region(at, "")


func load_again(node: StreamedTerrain3DDouble, region: Terrain3DRegionDouble) -> void:
	if node.data is UnloadingDataDouble:
		node.data.add_region(region)
	else:
		(node.data as StreamedDataDouble).add_region_streamed(region)


func test_terrain3d_streams_regions() -> void:
	for data_class: GDScript in [StreamedDataDouble, StatefulDataDouble, UnloadingDataDouble]:
		var node := StreamedTerrain3DDouble.new()
		node.data_class = data_class
		node.make_data()
		for at: Vector2i in [Vector2i(-1, -1), Vector2i(0, -1), Vector2i(-1, 0)]:
			var made := Terrain3DRegionDouble.new(at)
			fill_region(made)
			node.data.regions[at] = made
			if node.data is StatefulDataDouble:
				(node.data as StatefulDataDouble).on_disk[at] = true
		var region := Terrain3DRegionDouble.new(Vector2i.ZERO)
		fill_region(region)
		if node.data is StatefulDataDouble:
			(node.data as StatefulDataDouble).on_disk[Vector2i.ZERO] = true
		var scatter := make_on(node)
		scatter.state = ScatterState.new()
		await settle(scatter)
		var context := "streamed" if data_class == StreamedDataDouble else "with states" if data_class == StatefulDataDouble else "with unload_region"
		var inside := Rect2(1.0, 1.0, 60.0, 60.0)
		check(within(scatter, inside).is_empty(), "%s: nothing before the region is loaded" % context)
		await regenerated_by(scatter, func() -> void: load_again(node, region))
		check(within(scatter, inside).size() > 100, "%s: instances come with the region" % context)
		scatter.remove_instance(within(scatter, inside).keys()[2])
		await settle(scatter)
		var before := within(scatter, inside)
		var all := by_id(scatter)
		var made := await regenerated_by(scatter, func() -> void: unload(node, Vector2i.ZERO))
		check_equal(made.size(), 0, "%s: unloading regenerates nothing" % context)
		check_equal(within(scatter, inside), before, "%s: instances stay" % context)
		scatter.regenerate()
		await settle(scatter)
		check_equal(within(scatter, inside), before, "%s: even if tiles are regenerated" % context)
		check_equal(scatter.query_rect(inside).size(), before.size(), "%s: queries find them" % context)
		made = await regenerated_by(scatter, func() -> void: load_again(node, region))
		check_equal(by_id(scatter), all, "%s: the same after the region is loaded again" % context)
		check_equal(made.size(), 0, "%s: unchanged ground regenerates nothing" % context)
		unload(node, Vector2i.ZERO)
		await settle(scatter)
		var edited := Terrain3DRegionDouble.new(Vector2i.ZERO)
		fill_region(edited, func(_post: Vector2i) -> float: return 25.0)
		await regenerated_by(scatter, func() -> void: load_again(node, edited))
		check(within(scatter, inside).values().all(func(at: Vector3) -> bool: return absf(at.y - 25.0) < 0.01),
				"%s: a region that was edited elsewhere" % context)
		if not node.data is StatefulDataDouble:
			await regenerated_by(scatter, func() -> void: node.data.remove_region(edited))
			check(within(scatter, inside).is_empty(), "%s: no instances in a removed region" % context)
		scatter.free()
		node.free()


## The ground of unloaded regions far from all loaded regions is released, and returns when they are loaded again.
func test_far_regions_are_released() -> void:
	var node := StreamedTerrain3DDouble.new()
	node.make_data()
	var row: Array[Terrain3DRegionDouble] = []
	for x in 5:
		row.push_back(Terrain3DRegionDouble.new(Vector2i(x - 2, 0)))
		fill_region(row[x])
		node.data.regions[row[x].location] = row[x]
	var scatter := make_on(node)
	await settle(scatter)
	var all := by_id(scatter)
	for x in 4:
		unload(node, row[x].location)
		await settle(scatter)
	check_equal(by_id(scatter), all, "instances stay")
	check("2 regions" in names_of(scatter), "the loaded region and its neighbor are kept: %s" % names_of(scatter))
	for x in 4:
		load_again(node, row[x])
	await settle(scatter)
	check_equal(by_id(scatter), all, "the same after all regions are loaded again")
	node.data_directory = "res://other"
	for x in 4:
		unload(node, row[x].location)
	await settle(scatter)
	check(within(scatter, Rect2(-128.0, 0.0, 120.0, 64.0)).is_empty(), "regions of another directory are gone")


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


func test_terrabrush_has_no_textures() -> void:
	var node := TerraBrushDouble.new()
	node.add_zone(Vector2i.ZERO)
	var layer := make_layer()
	layer.ground_textures = [0]
	var scatter := make_on(node, false, layer)
	await settle(scatter)
	check("ground_textures has no effect" in "\n".join(scatter.get_problems()), "problems: %s" % scatter.get_problems())
	check(all_transforms(scatter).size() > 500, "%d instances" % all_transforms(scatter).size())


func test_terrabrush_with_unknown_zones_is_refused() -> void:
	var cases: Dictionary[String, Callable] = {
		"zonesSize of at least 2": func(node: TerraBrushDouble) -> void: node.zones_size = 1,
		"not square": func(node: TerraBrushDouble) -> void: node.zones.zones[0].image.crop(65, 33),
		"the format RGF": func(node: TerraBrushDouble) -> void: node.zones.zones[0].image.convert(Image.FORMAT_RGBAF),
		"differs in size": func(node: TerraBrushDouble) -> void: node.add_zone(Vector2i(1, 0)).image.resize(33, 33),
		"cannot be copied": func(node: TerraBrushDouble) -> void: node.add_zone(Vector2i(1 << 20, 1 << 20)),
	}
	for words in cases:
		var node := TerraBrushDouble.new()
		node.add_zone(Vector2i.ZERO)
		cases[words].call(node)
		var scatter := make_on(node)
		await settle(scatter)
		check_error(["TerraBrush", words], "an unknown layout")
		check(words in "\n".join(scatter.get_problems()), "problems: %s" % scatter.get_problems())
		check(all_transforms(scatter).is_empty(), "%s: no instances" % words)
		scatter.free()
		node.free()


func test_terrabrush_zones_without_heightmaps_are_skipped() -> void:
	var node := TerraBrushDouble.new()
	node.add_zone(Vector2i.ZERO)
	var empty := node.add_zone(Vector2i(1, 0))
	empty.image = null
	var scatter := make_on(node)
	await settle(scatter)
	check_on(scatter, func(at: Vector3) -> float: return drawn_height(node, at), zone_area(node, Vector2i.ZERO), 500, "the other zone")
	check_equal(scatter.get_problems().size(), 0, "problems: %s" % scatter.get_problems())


func test_mterrain_with_an_unusable_grid() -> void:
	var node := MTerrainDouble.new()
	node.h_scale = 0.0
	var scatter := make_on(node)
	await settle(scatter)
	check_error(["MTerrain"], "a grid without an extent")
	check(all_transforms(scatter).is_empty(), "no instances")
	node.h_scale = 2.0
	await frames(3)
	await settle(scatter)
	check_on(scatter, node.get_height, node.area(), 1000, "a valid grid")


## In proposal 675, the data marks unloaded regions as deleted.
func test_terrain3d_marks_unloaded_regions_as_deleted() -> void:
	var node := StreamedTerrain3DDouble.new()
	node.data_class = DeletingDataDouble
	node.make_data()
	for at: Vector2i in [Vector2i(-1, 0), Vector2i.ZERO]:
		var made := Terrain3DRegionDouble.new(at)
		fill_region(made)
		node.data.regions[at] = made
	var scatter := make_on(node)
	await settle(scatter)
	var before := by_id(scatter)
	check(within(scatter, Rect2(1.0, 1.0, 60.0, 60.0)).size() > 100, "instances on the region")
	(node.data as DeletingDataDouble).evict_region(Vector2i.ZERO)
	await settle(scatter)
	scatter.regenerate()
	await settle(scatter)
	check_equal(by_id(scatter), before, "instances stay while the region is unloaded")
	node.data.add_region(node.data.regions[Vector2i.ZERO])
	await settle(scatter)
	check_equal(by_id(scatter), before, "the same instances when it is loaded again")
