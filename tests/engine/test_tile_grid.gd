extends "harness.gd"
## Tests tile positions for scripts, and code that divides the world into tiles: bakes and parts of tiles.

const Bake := preload("res://addons/thicket/bake.gd")
const BakeGrid := preload("res://addons/thicket/baking/bake_grid.gd")


func grid_of(size: float) -> ScatterTileGrid:
	var grid := ScatterTileGrid.new()
	grid.tile_size = size
	return grid


func test_tiles_share_their_edges() -> void:
	var random := RandomNumberGenerator.new()
	random.seed = 3
	for size: float in [0.7, 33.3, 64.0, 1000.0 / 3.0]:
		var grid := grid_of(size)
		for index in 200:
			var x := random.randf_range(-1.0, 1.0) * 5e6
			var z := random.randf_range(-1.0, 1.0) * 5e6
			var tile := grid.get_tile_at(x, z)
			var bounds := grid.get_tile_bounds(tile)
			check(bounds[0] <= x and x < bounds[2] and bounds[1] <= z and z < bounds[3], "%s is in %s" % [[x, z], bounds])
			check_equal(bounds[2], grid.get_tile_bounds(tile + Vector2i.ONE)[0], "both tiles share the edge")
			check_equal(grid.get_tile_at(bounds[2], bounds[3]), tile + Vector2i.ONE, "an edge belongs to the tile that begins there")
			check_equal(grid.get_tiles_in(bounds), Rect2i(tile, Vector2i.ONE), "a tile's bounds contain no other tile")
			bounds[2] += 1e-6 * size
			check_equal(grid.get_tiles_in(bounds), Rect2i(tile, Vector2i(2, 1)), "slightly larger bounds contain a second tile")
	check_equal(grid_of(10.0).get_tiles_in([-10.0, 0.0, 25.0, 10.0]), Rect2i(-1, 0, 4, 1), "negative coordinates")
	check_equal(grid_of(10.0).get_tiles_in([0.0, 0.0, 0.0, 10.0]), Rect2i(), "an empty area contains no tiles")


func test_invalid_arguments_are_rejected() -> void:
	var grid := grid_of(2.0)
	grid.tile_size = 0.01
	check_error(["ScatterTileGrid", "tile_size", 0.01], "an invalid size")
	check_equal(grid.tile_size, 2.0, "the last valid size stays")
	check_equal(grid.get_tile_at(NAN, 0.0), Vector2i.ZERO, "an invalid position")
	check_error(["x", "nan"], "an invalid position")
	check_equal(grid.get_tile_at(0.0, 3e9), Vector2i.ZERO, "a position that is too far away")
	check_error(["z"], "a position that is too far away")
	check_equal(grid.get_tiles_in([0.0, 1.0]), Rect2i(), "incomplete bounds")
	check_error(["bounds", 2], "incomplete bounds")
	check_equal(grid.get_tiles_in([0.0, 0.0, INF, 1.0]), Rect2i(), "infinite bounds")
	check_error(["bounds"], "infinite bounds")


## Far from the origin, single-precision rectangles of tiles would overlap or leave gaps, because their edges are rounded.
func test_parts_of_tiles_share_no_instance() -> void:
	var layer := make_layer(1.0)
	layer.tile_size = 33.3
	var far := Vector3(4_000_000.0, 0.0, -3_000_000.0)
	var scatter := make_scatter([layer], ScatterGroundFlat.new(), make_viewer(far))
	await frames(2)
	var rect := Rect2(far.x - 40.0, far.z - 30.0, 97.25, 88.5)
	var whole := ids_of(scatter.build_rect(scatter.layers[0], rect))[0] as PackedInt64Array
	var parts := PackedInt64Array()
	var grid := grid_of(layer.tile_size)
	var x := float(rect.position.x)
	var z := float(rect.position.y)
	var tiles := grid.get_tiles_in([x, z, x + rect.size.x, z + rect.size.y])
	for tile_z in range(tiles.position.y, tiles.end.y):
		for tile_x in range(tiles.position.x, tiles.end.x):
			parts.append_array(ids_of(scatter.build_tile(scatter.layers[0], Vector2i(tile_x, tile_z), rect))[0])
	var sorted := Array(parts)
	sorted.sort()
	var expected := Array(whole)
	expected.sort()
	check(whole.size() > 1000 and sorted == expected, "%d instances in parts, %d in all" % [parts.size(), whole.size()])
	check_equal(ids_of(scatter.build_tile(scatter.layers[0], tiles.position, Rect2())), ids_of(scatter.build_tile(scatter.layers[0], tiles.position)), "without a rectangle, the whole tile")
	# A bake divides the rectangle in the same way.
	var bake := Bake.new()
	check_equal(bake.begin(scatter, rect, "res://baked/far", "far"), OK, "started: " + bake.problem)
	while bake.step(20.0):
		pass
	check_equal(bake.problem, "", "no problem")
	check_equal(bake.instances, whole.size(), "instances of the bake")


## With a world offset, a bake has the same tiles as the game.
func test_bakes_use_the_tiles_of_a_moved_world() -> void:
	var scatter := make_scatter([make_layer()], ScatterGroundFlat.new(), make_viewer())
	scatter.world_offset = Vector3(1000.0, 0.0, 2000.0)
	await settle(scatter)
	var bake := Bake.new()
	check_equal(bake.begin(scatter, Rect2(-8.0, -16.0, 32.0, 32.0), "res://baked/moved", "moved"), OK, "started: " + bake.problem)
	while bake.step(20.0):
		pass
	var whole := ids_of(scatter.build_rect(scatter.layers[0], Rect2(-8.0, -16.0, 32.0, 32.0)))[0] as PackedInt64Array
	check_equal(bake.instances, whole.size(), "the bake contains all instances")
	var scene := (load("res://baked/moved/moved.tscn") as PackedScene).instantiate()
	check_equal(scene.get_child_count(), 1, "one tile: x from 992 to 1024, z from 1984 to 2016")
	scene.free()


func test_tile_sizes_of_bakes() -> void:
	var oak := 0.7 / 5.0 ** 2
	var fitting := func(side: float, sizes: Array, density: float) -> float: return BakeGrid.default_size([0.0, 0.0, side, side], sizes, density)
	check_equal(fitting.call(1000.0, [192.0], oak), 384.0, "whole tiles of at least 256 m")
	check_equal(fitting.call(1000.0, [192.0, 128.0], 2.0 * oak), 384.0, "whole tiles of both layers")
	check_equal(fitting.call(100_000.0, [192.0], oak), 1536.0, "larger tiles for a larger world")
	check_equal(fitting.call(100_000.0, [192.0, 64.0], oak + 0.7 / 0.4 ** 2), 384.0, "but not for dense grass")
	check_equal(fitting.call(1000.0, [192.0, 100.5], oak), 384.0, "a size that no multiple matches is ignored")
	var layer := make_layer(5.0)
	check(absf(layer.get_point_density() - oak) < 0.01 * oak, "points per squared radius: %s" % layer.get_point_density())
	var layers: Array[Dictionary] = [{"index": 0, "tile_size": 32.0}]
	check("too far" in BakeGrid.new([1e12, 0.0, 5.0, 5.0], 1.0, layers).problem, "too far away")
	errors.take()
	check("tiles are more" in BakeGrid.new([0.0, 0.0, 1e7, 1e7], 32.0, layers).problem, "too many")
