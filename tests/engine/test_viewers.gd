extends "harness.gd"
## Tests several viewers with different radii, teleports, and fast flight. A far tile never appears before a near one.

const STEP := 16.0 ## The distance in meters that a fast viewer moves at once.


## Returns the distance on the map, in meters, from a viewer to the nearest point of a tile.
func distance(tile: Vector2i, size: float, from: Vector3) -> float:
	var rect := Rect2(Vector2(tile) * size, Vector2(size, size))
	var at := Vector2(from.x, from.z)
	return at.distance_to(at.clamp(rect.position, rect.end))


## Watches a layer's tiles. `worst` is the largest distance, in meters, by which a new tile is farther away than a tile that is still
## missing.
class OrderWatch:
	var size: float
	var view: float
	var viewer: Node3D
	var shown := {}
	var worst := -INF
	var count := 0

	func _init(scatter: TerrainScatter3D, layer: int, of: Node3D) -> void:
		size = scatter.layers[layer].tile_size
		view = scatter.layers[layer].view_distance
		viewer = of
		scatter.tile_shown.connect(func(which: ScatterLayer, tile: Vector2i) -> void:
			if which == scatter.layers[layer]:
				_on_shown(tile))
		scatter.tile_hidden.connect(func(which: ScatterLayer, tile: Vector2i) -> void:
			if which == scatter.layers[layer]:
				shown.erase(tile))

	func away(tile: Vector2i) -> float:
		var from := Vector2(viewer.global_position.x, viewer.global_position.z)
		return from.distance_to(from.clamp(Vector2(tile) * size, Vector2(tile + Vector2i.ONE) * size))

	func nearest_missing() -> float:
		var middle := Vector2i((Vector2(viewer.global_position.x, viewer.global_position.z) / size).floor())
		var reach := ceili(view / size) + 1
		var nearest := INF
		for x in range(middle.x - reach, middle.x + reach + 1):
			for y in range(middle.y - reach, middle.y + reach + 1):
				if not Vector2i(x, y) in shown:
					var off := away(Vector2i(x, y))
					nearest = minf(nearest, off if off <= view else INF)
		return nearest

	func _on_shown(tile: Vector2i) -> void:
		if not tile in shown:
			count += 1
			worst = maxf(worst, away(tile) - nearest_missing())
			shown[tile] = true


func test_default_viewer_is_the_camera() -> void:
	var camera := Camera3D.new()
	root.add_child(camera)
	camera.global_position = Vector3(400.0, 3.0, 400.0)
	camera.make_current()
	var scatter := make_scatter([make_layer()], ScatterGroundFlat.new(), camera)
	scatter.viewers = []
	await settle(scatter)
	check(Vector2i(12, 12) in scatter.get_shown_tiles(scatter.layers[0]), "the camera's tile is visible")


func test_two_viewers() -> void:
	var scatter := make_scatter([make_layer()], ScatterGroundFlat.new(), make_viewer())
	scatter.viewers = scatter.viewers + [scatter.get_path_to(make_viewer(Vector3(-960.0, 0.0, 0.0)))]
	await settle(scatter)
	check(Vector2i(0, 0) in scatter.get_shown_tiles(scatter.layers[0]), "the first viewer's tile")
	check(Vector2i(-30, 0) in scatter.get_shown_tiles(scatter.layers[0]), "the second viewer's tile")


## With as many viewers as on a server, each one has its own tiles.
func test_two_hundred_viewers() -> void:
	var layer := make_layer(8.0)
	layer.view_distance = 20.0
	var paths: Array[NodePath] = []
	var players: Array[Node3D] = []
	for index in 200:
		players.append(make_viewer(Vector3(200.0 * index + 16.0, 0.0, 16.0)))
		paths.append(players[index].get_path())
	var scatter := make_scatter([layer], ScatterGroundFlat.new(), players[0])
	scatter.viewers = paths
	await settle(scatter)
	var visible_tiles := scatter.get_shown_tiles(scatter.layers[0])
	var served := players.filter(func(player: Node3D) -> bool:
		return Vector2i((Vector2(player.position.x, player.position.z) / 32.0).floor()) in visible_tiles)
	check_equal(served.size(), 200, "players with their tile")
	check_equal(scatter.get_problems(), PackedStringArray(), "problems")


## A viewer that has fallen out of the world must not stop streaming for the others.
func test_a_viewer_out_of_reach_does_not_affect_the_others() -> void:
	var lost := make_viewer(Vector3(1e30, 0.0, 0.0))
	var viewer := make_viewer()
	var scatter := make_scatter([make_layer()], ScatterGroundFlat.new(), viewer)
	scatter.viewers = scatter.viewers + [scatter.get_path_to(lost)]
	await settle(scatter)
	check(Vector2i.ZERO in scatter.get_shown_tiles(scatter.layers[0]), "the other viewer's tile is visible")
	check_error(["viewer.x"], "a viewer out of reach")
	check("viewer.x" in "".join(scatter.get_problems()), "a problem: %s" % scatter.get_problems())
	lost.position.x = 1000.0
	await settle(scatter)
	check_equal(scatter.get_problems(), PackedStringArray(), "problems after it has returned")


func test_a_missing_viewer_is_a_problem() -> void:
	var scatter := make_scatter([make_layer()], ScatterGroundFlat.new(), make_viewer())
	scatter.viewers = []
	await frames(3)
	check(not scatter.is_settled(), "without visible tiles, it is not settled")
	check("No viewer" in "".join(scatter.get_problems()), "a problem: %s" % scatter.get_problems())
	var camera := Camera3D.new()
	root.add_child(camera)
	camera.make_current()
	await scatter.settled
	check(scatter.is_settled(), "it settles around the camera")
	check_equal(scatter.get_problems(), PackedStringArray(), "problems with a camera")


func test_a_teleport_unsettles_in_the_same_frame() -> void:
	var viewer := make_viewer()
	var scatter := make_scatter([make_layer()], ScatterGroundFlat.new(), viewer)
	await settle(scatter)
	viewer.position.x = 5000.0
	check(not scatter.is_settled(), "not settled in the frame of a teleport")
	await scatter.settled
	check(Vector2i(156, 0) in scatter.get_shown_tiles(scatter.layers[0]), "`settled` waits for the tiles at the new position")
	check(scatter.is_settled(), "the node is settled then")
	paused = true
	viewer.position.x = 0.0
	await frames(3)
	check(not scatter.is_settled(), "not settled while the tree is paused")
	paused = false
	await scatter.settled
	check(Vector2i(0, 0) in scatter.get_shown_tiles(scatter.layers[0]), "the tiles appear when it continues")


## `settled` is emitted even after changes that take only one frame. Otherwise, a caller that awaits the signal would wait forever.
func test_settled_is_emitted_after_each_change() -> void:
	var viewer := make_viewer()
	var layer := make_layer()
	var scatter := make_scatter([layer], ScatterGroundFlat.new(), viewer)
	await settle(scatter)
	var count := [0]
	scatter.settled.connect(func() -> void: count[0] += 1)
	await frames(5)
	check_equal(count[0], 0, "signals while nothing changes")
	var changes: Dictionary[String, Callable] = {
		"quality": func() -> void: scatter.quality = 0.5,
		"a step within the visible tiles": func() -> void: viewer.position.x += 4.5,
		"viewer_distance_scales": func() -> void: scatter.viewer_distance_scales = PackedFloat32Array([0.9]),
		"world_offset": func() -> void: scatter.world_offset = Vector3(64.0, 0.0, 0.0),
	}
	for change in changes:
		count[0] = 0
		changes[change].call()
		check(not scatter.is_settled(), "%s: not settled in the same frame" % change)
		await until(func() -> bool: return count[0] > 0, "%s: the signal is emitted" % change)
		check(scatter.is_settled(), "%s: settled then" % change)


## When a node in the interaction group jumps, the scatter is unsettled in the same frame, until bodies surround the node again.
func test_a_jump_of_a_body_unsettles_in_the_same_frame() -> void:
	var layer := make_layer()
	layer.collision_shape = ScatterLayer.COLLISION_CYLINDER
	layer.collision_distance = 10.0
	var scatter := make_scatter([layer], ScatterGroundFlat.new(), make_viewer())
	var body := make_viewer(Vector3(0.0, 500.0, 0.0))
	body.add_to_group(&"scatter_interaction")
	await settle(scatter)
	body.position = Vector3(40.0, 0.0, 0.0)
	check(not scatter.is_settled(), "not settled in the frame of the jump")
	await scatter.settled
	check(scatter.is_settled(), "the node is settled then")


## A node reports a problem if its global transform is not the identity, because its instances keep their positions in the world.
func test_a_transform_is_a_problem() -> void:
	var parent := make_viewer()
	var scatter := make_scatter([make_layer()], ScatterGroundFlat.new(), make_viewer())
	scatter.reparent(parent)
	scatter.viewers = [scatter.get_path_to(make_viewer())]
	await settle(scatter)
	check_equal(scatter.get_problems(), PackedStringArray(), "problems of a node at the origin")
	var transforms: Dictionary[String, Transform3D] = {
		"moved": Transform3D(Basis(), Vector3(10.0, 0.0, 0.0)),
		"rotated": Transform3D(Basis(Vector3.UP, 0.5), Vector3.ZERO),
		"scaled": Transform3D(Basis().scaled(Vector3.ONE * 2.0), Vector3.ZERO),
	}
	for kind in transforms:
		for node: Node3D in [scatter, parent]:
			node.transform = transforms[kind]
			var problems := "".join(scatter.get_problems())
			check("global_transform" in problems and kind in problems, "%s: %s" % [kind, problems])
			node.transform = Transform3D()
	scatter.world_offset = Vector3(1000.0, 0.0, -2000.0)
	parent.position = Vector3(-1000.0, 0.0, 2000.0)
	check_equal(scatter.get_problems(), PackedStringArray(), "problems of a recentered world")


## A viewer inside a tile is at distance 0, exactly where thinning begins and an LOD may begin.
func test_a_viewer_at_distance_zero_settles() -> void:
	var layer := make_layer()
	layer.thin_end = 60.0
	layer.thin_density = 0.25
	layer.meshes = with_lods(layer.meshes, [[SphereMesh.new()]], [1e-30])
	var viewer := make_viewer(Vector3(5.0, 0.5, 5.0))
	var scatter := make_scatter([layer], ScatterGroundFlat.new(), viewer)
	await settle(scatter)
	check(scatter.get_stats()["drawn"] > 0, "some instances are drawn")
	viewer.global_position.x = 1.0
	await settle(scatter)


func test_each_viewer_has_its_own_radius() -> void:
	var scatter := make_scatter([make_layer()], ScatterGroundFlat.new(), make_viewer())
	var others := [make_viewer(Vector3(2000.0, 0.0, 0.0)), make_viewer(Vector3(-2000.0, 0.0, 0.0))]
	for other: Node3D in others:
		scatter.viewers = scatter.viewers + [scatter.get_path_to(other)]
	scatter.viewer_distance_scales = PackedFloat32Array([0.5, 2.0])
	await settle(scatter)
	var farthest := [0.0, 0.0, 0.0]
	var points := [Vector3.ZERO, others[0].global_position, others[1].global_position]
	for tile: Vector2i in scatter.get_shown_tiles(scatter.layers[0]):
		for index in 3:
			var off := distance(tile, 32.0, points[index])
			if off < 500.0:
				farthest[index] = maxf(farthest[index], off)
	check(farthest[0] <= 36.1 and farthest[0] > 20.0, "tiles within half the distance: %f" % farthest[0])
	check(farthest[1] <= 132.1 and farthest[1] > 100.0, "tiles within twice the distance: %f" % farthest[1])
	check(farthest[2] <= 68.1 and farthest[2] > 40.0, "tiles within the layer's distance: %f" % farthest[2])
	scatter.viewer_distance_scales = PackedFloat32Array([1.0, 0.0, 1.0])
	await settle(scatter)
	await frames(10)
	var around := 0
	for tile: Vector2i in scatter.get_shown_tiles(scatter.layers[0]):
		around += 1 if distance(tile, 32.0, points[1]) < 500.0 else 0
	check(around <= 9, "a viewer with distance 0 keeps %d tiles" % around)
	scatter.viewer_distance_scales = PackedFloat32Array([1e6])
	await frames(2)
	check_no_error("the largest distance")


func test_bad_radius_scales() -> void:
	var scatter := make_scatter([], ScatterGroundFlat.new(), make_viewer())
	scatter.viewer_distance_scales = PackedFloat32Array([0.0, 2.0])
	for bad: float in [NAN, INF, -1.0, 2e6]:
		scatter.viewer_distance_scales = PackedFloat32Array([1.0, bad])
		check_error(["TerrainScatter3D", "viewer_distance_scales[1]"], "a scale of %f" % bad)
		check_equal(scatter.viewer_distance_scales, PackedFloat32Array([0.0, 2.0]), "scales after a rejected value")


func test_split_screen_shows_the_tiles_of_both_viewers() -> void:
	var ends := [Vector3(10.0, 0.0, 5.0), Vector3(90.0, 0.0, -30.0)]
	var both := make_scatter([make_layer()], ScatterGroundFlat.new(), make_viewer(ends[0]))
	both.viewers = both.viewers + [both.get_path_to(make_viewer(ends[1]))]
	await settle(both)
	var got := digests(both, 0)
	for at: Vector3 in ends:
		var one := make_scatter([make_layer()], ScatterGroundFlat.new(), make_viewer(at))
		await settle(one)
		var expected := digests(one, 0)
		for tile: Vector2i in expected:
			check_equal(got.get(tile), expected[tile], "tile %s" % tile)


func test_a_server_with_16_players() -> void:
	var layer := make_layer(4.0)
	var scatter := make_scatter([layer], ScatterGroundFlat.new(), make_viewer())
	var paths := scatter.viewers
	var players: Array[Node3D] = [scatter.get_node(paths[0])]
	for player in range(1, 16):
		players.push_back(make_viewer(Vector3(700.0 * player, 0.0, -300.0 * player)))
		paths.push_back(scatter.get_path_to(players[player]))
	scatter.viewers = paths
	for step in 40:
		for player in 16:
			players[player].global_position += Vector3(3.0, 0.0, 0.0).rotated(Vector3.UP, player)
		await process_frame
	await settle(scatter)
	var visible_tiles := scatter.get_shown_tiles(scatter.layers[0])
	for player in players:
		var middle := Vector2i((on_map(player.global_transform) / 32.0).floor())
		for x in range(-2, 3):
			for y in range(-2, 3):
				var tile := middle + Vector2i(x, y)
				if distance(tile, 32.0, player.global_position) < 64.0 and not tile in visible_tiles:
					check(false, "tile %s around %s is missing" % [tile, player.global_position])
	check(visible_tiles.size() > 16 * 20, "%d tiles" % visible_tiles.size())
	# When a player leaves, nothing is regenerated for the remaining players.
	var tiles_made: int = scatter.get_stats()["tiles_made"]
	paths.remove_at(4)
	scatter.viewers = paths
	await settle(scatter)
	# Tolerates some tiles: the viewer at a removed viewer's index is evaluated again, and tiles at its border may be new.
	check(scatter.get_stats()["tiles_made"] - tiles_made <= 16, "tiles generated when a player left")


func test_a_teleport_shows_near_tiles_first() -> void:
	var viewer := make_viewer()
	var layer := make_layer(1.5)
	layer.view_distance = 300.0
	var scatter := make_scatter([layer], ScatterGroundFlat.new(), viewer)
	scatter.frame_budget_usec = 500
	var watch := OrderWatch.new(scatter, 0, viewer)
	await settle(scatter)
	for jump: Vector3 in [Vector3(5e4, 0.0, -3e4), Vector3(200.0, 0.0, 0.0), Vector3(-90.0, 0.0, 110.0)]:
		viewer.global_position += jump
		await frames(4) # The next jump comes before all tiles are visible.
		viewer.global_position += 0.7 * jump
		await settle(scatter)
	check(watch.count > 500, "%d tiles were shown" % watch.count)
	check(watch.worst <= 32.01, "a tile was shown although a tile %f m nearer was missing" % watch.worst)
	check_equal(watch.nearest_missing(), INF, "no tile is missing at the end")


## Moves the viewer by 16 m as soon as six more tiles are shown, or no tile is missing. So it flies about as fast as the machine can generate
## tiles: crossing 16 m needs six new tiles. Returns the number of frames without a far tile nearby.
func fly(scatter: TerrainScatter3D, viewer: Node3D, watches: Array, steps: int) -> int:
	var empty := 0
	var deadline := Time.get_ticks_msec() + IDLE_TIMEOUT_MSEC
	for step in steps:
		viewer.global_position += Vector3(0.6, 0.0, 0.8) * STEP
		var before: int = watches[0].count + watches[1].count
		while true:
			await process_frame
			empty += int(scatter.get_shown_tiles(scatter.layers[1]).all(func(tile: Vector2i) -> bool:
				return distance(tile, 128.0, viewer.global_position) >= 300.0))
			if watches[0].count + watches[1].count - before >= 6 or scatter.is_settled():
				break
			if Time.get_ticks_msec() > deadline:
				check(false, "only %d steps in %d ms" % [step, IDLE_TIMEOUT_MSEC])
				return empty
	return empty


## Flies as fast as tiles can be generated, over 4 km. tests/bench/flight.gd measures the time per frame at a fixed speed.
func test_fast_flight() -> void:
	var viewer := make_viewer()
	var near := make_layer(3.0)
	near.view_distance = 128.0
	var far := make_layer(8.0)
	far.tile_size = 128.0
	far.view_distance = 700.0
	var scatter := make_scatter([near, far], ScatterGroundFlat.new(), viewer)
	scatter.frame_budget_usec = 500
	await settle(scatter)
	var watches := [OrderWatch.new(scatter, 0, viewer), OrderWatch.new(scatter, 1, viewer)]
	for layer in 2:
		for tile: Vector2i in scatter.get_shown_tiles(scatter.layers[layer]):
			watches[layer].shown[tile] = true
	check_equal(await fly(scatter, viewer, watches, 250), 0, "frames without a nearby tile")
	check(watches[0].count > 500 and watches[1].count > 250, "tiles shown on the way: %d and %d" % [watches[0].count, watches[1].count])
	# Allows the size of a tile plus the distance flown while it was generated.
	for index in 2:
		var limit: float = watches[index].size + 4.0 * STEP
		check(watches[index].worst <= limit, "layer %d: a tile was shown although a tile %.1f m nearer was missing" % [index, watches[index].worst])
	await settle(scatter)
	check_equal(watches[1].nearest_missing(), INF, "no tile is missing at the end")
