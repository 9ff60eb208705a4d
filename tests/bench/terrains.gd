extends SceneTree
## Measures the time to fill a view on the ground of terrain plugins, compared with a ScatterGroundHeightmap of the same heights.
## Prints rows of a Markdown table.
##   tools/godot --headless --path demo_project --script tests/bench/terrains.gd [-- ROUNDS]
##
## Contenders take turns in each round, and ratios are computed within a round, so that a busy machine affects all
## equally. The plugins are replaced with test doubles, whose queries of single positions run in GDScript. Terrain3D's real
## methods are therefore faster.

const Terrain3D := preload("../engine/terrain3d_harness.gd")
const HTerrain := preload("../engine/hterrain_harness.gd")

const SIDE := 513
const RADIUS := 0.5
const VIEW := 150.0
const DEFAULT_ROUNDS := 9

var _heights := Image.create_empty(SIDE, SIDE, false, Image.FORMAT_RF)
var _viewer := Node3D.new()


func _initialize() -> void:
	_run.call_deferred()


func _run() -> void:
	RenderingServer.render_loop_enabled = false
	root.add_child(_viewer)
	var noise := FastNoiseLite.new()
	noise.frequency = 0.01
	for row in SIDE:
		for column in SIDE:
			_heights.set_pixel(column, row, Color(20.0 * noise.get_noise_2d(column, row), 0.0, 0.0))
	var arguments := OS.get_cmdline_user_args()
	var rounds := maxi(1, arguments[0].to_int()) if arguments.size() > 0 else DEFAULT_ROUNDS
	await _fill(_make_heightmap) # The first round warms up.
	var base: Array[float] = []
	var contenders: Dictionary[String, Callable] = {
		"Terrain3D": _make_terrain3d, "HTerrain": _make_hterrain, "HTerrain, with holes": _make_hterrain.bind(true),
	}
	var times: Dictionary[String, Array] = {"ScatterGroundHeightmap": base}
	for round in rounds:
		base.push_back(await _fill(_make_heightmap))
		for label in contenders:
			times.get_or_add(label, []).push_back(await _fill(contenders[label]))
	for label in times:
		_report(label, times[label], base)
	_report("HTerrain, queried point by point", [await _fill(_make_asked)], [await _fill(_make_heightmap)])
	quit()


## Returns the seconds until all tiles around the viewer are visible.
func _fill(make: Callable) -> float:
	var nodes: Array[Node] = []
	var terrain: ScatterGround = make.call(nodes)
	var layer := ScatterLayer.new()
	layer.radius = RADIUS
	layer.tile_size = 32.0
	layer.view_distance = VIEW
	layer.max_slope_degrees = 40.0
	layer.meshes = [BoxMesh.new()]
	var scatter := TerrainScatter3D.new()
	scatter.layers = [layer]
	scatter.ground = terrain
	scatter.frame_budget_usec = 1_000_000
	root.add_child(scatter)
	scatter.viewers = [scatter.get_path_to(_viewer)]
	var start := Time.get_ticks_usec()
	await process_frame
	await process_frame
	while not scatter.is_settled():
		await process_frame
	var seconds := (Time.get_ticks_usec() - start) / 1e6
	assert(scatter.get_stats()["instances"] > 10_000)
	scatter.free()
	for node in nodes:
		node.free()
	return seconds


func _make_heightmap(_nodes: Array[Node]) -> ScatterGround:
	var terrain := ScatterGroundHeightmap.new()
	terrain.heights_in_meters = true
	terrain.image = _heights
	terrain.rect = Rect2(-256.0, -256.0, 512.0, 512.0)
	return terrain


func _on(node: Node, nodes: Array[Node]) -> ScatterGroundNode:
	node.name = "Ground"
	root.add_child(node)
	nodes.push_back(node)
	var terrain := ScatterGroundNode.new()
	terrain.node = node.get_path()
	return terrain


func _make_terrain3d(nodes: Array[Node]) -> ScatterGround:
	var node := Terrain3D.Terrain3DDouble.new()
	var data := node.make_data()
	data.region_size = 256
	for at: Vector2i in [Vector2i(-1, -1), Vector2i(0, -1), Vector2i(-1, 0), Vector2i(0, 0)]:
		var region := Terrain3D.Terrain3DRegionDouble.new(at, 256)
		region.maps[0].blit_rect(_heights, Rect2i((at + Vector2i.ONE) * 256, Vector2i(256, 256)), Vector2i.ZERO)
		data.add_region(region, false)
	return _on(node, nodes)


func _make_hterrain(nodes: Array[Node], holes := false) -> ScatterGround:
	var data := HTerrain.HTerrainMasterData.new()
	data.resolution = SIDE
	data.maps[0] = [_heights.duplicate()]
	if holes:
		data.add_map(HTerrain.CHANNEL_COLOR, Image.FORMAT_RGBA8, Color.WHITE)
	var node := HTerrain.HTerrainDouble.new()
	node.set_data(data)
	return _on(node, nodes)


## Creates a ground that queries HTerrain for each position on the main thread, as earlier versions did.
func _make_asked(nodes: Array[Node]) -> ScatterGround:
	_make_hterrain(nodes)
	var asked := Asked.new()
	asked.name = "Asked"
	asked.of = nodes[0]
	root.add_child(asked)
	nodes.push_back(asked)
	var terrain := ScatterGroundNode.new()
	terrain.node = asked.get_path()
	return terrain


class Asked extends Node3D:
	var of: Node3D

	func get_height(at: Vector3) -> float:
		return of.ground_at(at)


func _report(label: String, times: Array, base: Array) -> void:
	var ratios: Array[float] = []
	for round in times.size():
		ratios.push_back(times[round] / base[round])
	times = times.duplicate()
	times.sort()
	ratios.sort()
	print("| first fill on %s | %.2f s | %.2f to %.2f times the heightmap's, median %.2f | %d |" % [
		label, times[floori(times.size() / 2.0)], ratios[0], ratios[-1], ratios[floori(ratios.size() / 2.0)], times.size()])
