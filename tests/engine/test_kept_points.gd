extends "harness.gd"
## What neighboring tiles share is decided once and kept: whoever makes tiles finds it there.

## How many points were decided while `make` ran.
func decided(scatter: TerrainScatter3D, make: Callable) -> int:
	var before: int = scatter.get_stats()["points_computed"]
	await make.call()
	return scatter.get_stats()["points_computed"] - before


## Small tiles beside each other, twice as many points around each as in it.
func make_small_tiles() -> TerrainScatter3D:
	var layer := make_layer(1.0)
	layer.tile_size = 8.0
	layer.view_distance = 50.0
	return make_scatter([layer], ScatterGroundFlat.new(), make_viewer())


func test_tiles_on_show_take_points_that_are_kept() -> void:
	var scatter := make_small_tiles()
	var make_all := func() -> void:
		scatter.layers[0].density -= 0.1
		await settle(scatter)
	var first := await decided(scatter, make_all)
	await decided(scatter, make_all) # A block that one window alone has touched is made for the second.
	var tiles: int = scatter.get_stats()["tiles_made"]
	var sampled: int = scatter.get_stats()["points_sampled"]
	check(first >= sampled / 2, "%d decided for %d" % [first, sampled])
	check_equal(await decided(scatter, make_all), 0, "decided for tiles that are made for the third time")
	check_equal(scatter.get_stats()["tiles_made"], tiles / 2 * 3, "made anew")
	check_equal(scatter.get_stats()["points_sampled"], sampled / 2 * 3, "of all points")
	scatter.free()


func test_queries_take_points_that_are_kept() -> void:
	var scatter := make_small_tiles()
	var found: Array[int] = []
	var ask := func() -> void:
		scatter.layers[0].density -= 0.1 # All that is known is outdated.
		found.push_back(scatter.query_rect(Rect2(1000, 1000, 60, 60)).size())
	check(await decided(scatter, ask) > found[0], "decided for %d" % found[0])
	await decided(scatter, ask)
	check_equal(await decided(scatter, ask), 0, "decided for tiles that are made for the third time")
	check(found[2] > 1000 and found[2] < found[1] and found[1] < found[0], "found %s" % [found])
	scatter.free()


func test_rectangles_take_points_that_are_kept() -> void:
	var scatter := make_small_tiles()
	var found: Array[int] = []
	for place in 3: # Within one block.
		var build := func() -> void:
			found.push_back(scatter.build_rect(0, Rect2(500 + 8 * place, 500, 8, 8)).get_ids(0).size())
		var points := await decided(scatter, build)
		check(points == 0 if place == 2 else points > found[place], "%d decided for rectangle %d" % [points, place])
		check(found[place] > 30, "%d stand" % found[place])
	scatter.free()
