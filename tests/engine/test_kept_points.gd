extends "harness.gd"
## Tests that points near tile borders are cached for all tiles that need them.

## Runs `make` and returns the number of points computed during the call.
func points_computed_by(scatter: TerrainScatter3D, make: Callable) -> int:
	var before: int = scatter.get_stats()["points_computed"]
	await make.call()
	return scatter.get_stats()["points_computed"] - before


## Creates a scatter with small tiles. Each tile needs twice as many points around it as inside it.
func make_small_tiles() -> TerrainScatter3D:
	var layer := make_layer(1.0)
	layer.tile_size = 8.0
	layer.view_distance = 50.0
	return make_scatter([layer], ScatterGroundFlat.new(), make_viewer())


func test_visible_tiles_reuse_points() -> void:
	var scatter := make_small_tiles()
	var make_all := func() -> void:
		scatter.layers[0].density -= 0.1
		await settle(scatter)
	var first := await points_computed_by(scatter, make_all)
	# The second window that needs a block computes it again. From then on, the block is cached.
	await points_computed_by(scatter, make_all)
	var tiles: int = scatter.get_stats()["tiles_made"]
	var sampled: int = scatter.get_stats()["points_sampled"]
	check(first >= sampled / 2, "%d points are computed for %d sampled points" % [first, sampled])
	check_equal(await points_computed_by(scatter, make_all), 0, "points computed for tiles that are generated for the third time")
	check_equal(scatter.get_stats()["tiles_made"], tiles / 2 * 3, "regenerated tiles")
	check_equal(scatter.get_stats()["points_sampled"], sampled / 2 * 3, "sampled points")
	scatter.free()


func test_queries_reuse_points() -> void:
	var scatter := make_small_tiles()
	var found: Array[int] = []
	var query := func() -> void:
		scatter.layers[0].density -= 0.1 # This change makes all cached tiles outdated.
		found.push_back(scatter.query_rect(Rect2(1000, 1000, 60, 60)).size())
	check(await points_computed_by(scatter, query) > found[0], "more points are computed than the %d that the query finds" % found[0])
	await points_computed_by(scatter, query)
	check_equal(await points_computed_by(scatter, query), 0, "points computed for tiles that are generated for the third time")
	check(found[2] > 1000 and found[2] < found[1] and found[1] < found[0], "numbers of instances found: %s" % [found])
	scatter.free()


func test_rectangles_reuse_points() -> void:
	var scatter := make_small_tiles()
	var found: Array[int] = []
	for rectangle in 3: # All rectangles are in one block.
		var build := func() -> void:
			found.push_back(scatter.build_rect(scatter.layers[0], Rect2(500 + 8 * rectangle, 500, 8, 8)).get_ids(0).size())
		var points := await points_computed_by(scatter, build)
		check(points == 0 if rectangle == 2 else points > found[rectangle], "%d points are computed for rectangle %d" % [points, rectangle])
		check(found[rectangle] > 30, "%d instances" % found[rectangle])
	scatter.free()
