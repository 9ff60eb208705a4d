extends "plugins_harness.gd"
## Tests the ground of MTerrain, and of Terrain3D with streamed regions.

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
	check_equal(node.stray_calls, 0, "calls that the plugin does not survive")
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
