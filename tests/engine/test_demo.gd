extends "harness.gd"
## Streams the demo's forest along a fixed path and checks every instance in the multimeshes against the ground, the rules and its
## neighbors in all tiles. `-- out=FILE` writes the tiles to a file for analysis/tile_digests.

const TileLog := preload("tile_log.gd")
const GroundModel := preload("ground_model.gd")

## Viewer positions as world x and z.
const PATH: Array[Vector2] = [Vector2(2350.0, 150.0), Vector2(1985.0, -515.0), Vector2(1620.0, -1180.0),
		Vector2(-6000.0, 9000.0), Vector2(2350.0, 150.0)]
const EXPECTED_INSTANCES := 100000

var scatter: TerrainScatter3D
var ground: GroundModel
var tile_log := TileLog.new()

## For each layer: {cell that is one radius wide: x and z of its instances, in double precision}.
var neighbors: Array[Dictionary] = []
var known: Dictionary = {}
var count := 0
var worst_height := 0.0
var closest: Array[float] = []
var outside_rules := 0
var first_outside := ""


func find_scatter(node: Node) -> TerrainScatter3D:
	if node is TerrainScatter3D:
		return node
	for child in node.get_children():
		var found := find_scatter(child)
		if found:
			return found
	return null


func load_demo() -> void:
	var demo := (load(ProjectSettings.get_setting("application/run/main_scene")) as PackedScene).instantiate()
	scatter = find_scatter(demo)
	# Extracts the forest, because the demo's scripts would move the camera and change the settings.
	scatter.owner = null
	scatter.get_parent().remove_child(scatter)
	demo.free()
	# The program that generates the same tiles does not support regions. The removed regions belong to the path and the lake.
	for region in scatter.find_children("*", "ScatterRegion3D", true, false):
		region.free()
	root.add_child(scatter)
	ground = GroundModel.new(scatter.ground)
	tile_log.add_terrain(scatter.ground)
	for index in scatter.layers.size():
		var layer := scatter.layers[index] as ScatterLayer
		neighbors.push_back({})
		closest.push_back(INF)
		tile_log.add_layer(index, scatter.seed, layer)


func test_forest_along_a_path() -> void:
	load_demo()
	var viewer := make_viewer()
	scatter.viewers = [scatter.get_path_to(viewer)]
	await frames(1) # The plant meshes are built in the first frame.
	check_equal(scatter.get_problems(), PackedStringArray(), "warnings of the demo")
	for layer in scatter.layers:
		layer.use_colors = false # analysis/tile_digests generates the same tiles without colors.
	check(scatter.layers.size() >= 4, "layers of the demo")
	var again := 0
	for point in PATH:
		viewer.global_position = Vector3(point.x, 500.0, point.y)
		await settle(scatter)
		for layer in scatter.layers.size():
			for tile: Vector2i in scatter.get_shown_tiles(scatter.layers[layer]):
				again += check_tile(layer, tile)
	check(count >= EXPECTED_INSTANCES, "%d instances along the path" % count)
	check(again > 100, "%d tiles were checked again after they had been removed" % again)
	check(worst_height <= 0.01, "an instance is %f m off the ground" % worst_height)
	check(outside_rules == 0, "%d instances break a rule, such as %s" % [outside_rules, first_outside])
	for layer in scatter.layers.size():
		var radius: float = scatter.layers[layer].radius
		check(closest[layer] >= radius - 1e-4, "layer %d: two instances are %f m apart" % [layer, closest[layer]])
		check(closest[layer] < 1.2 * radius, "layer %d: instances have neighbors" % layer)
	print("%d instances in %d tiles, worst height %f m" % [count, known.size(), worst_height])
	scatter.free()
	for argument in arguments:
		if argument.begins_with("out="):
			check(tile_log.save(argument.trim_prefix("out=")), "writing " + argument)


## Checks all instances of a new tile and returns 0. For a tile seen before, checks only that it has not changed and returns 1.
func check_tile(layer: int, tile: Vector2i) -> int:
	var key := Vector3i(layer, tile.x, tile.y)
	var digest := scatter.get_tile(scatter.layers[layer], tile).get_digest()
	if known.has(key):
		if known[key] != digest:
			check(false, "tile %s came back changed" % key)
		return 1
	known[key] = digest
	tile_log.add_tile(layer, scatter.layers[layer].tile_size, tile, digest)
	var origin := scatter.get_tile(scatter.layers[layer], tile).get_origin()
	for buffer: PackedFloat32Array in tile_buffers(scatter, layer, tile):
		check_buffer(layer, origin, buffer)
	return 0


func check_buffer(index: int, origin: Vector3, buffer: PackedFloat32Array) -> void:
	var layer := scatter.layers[index] as ScatterLayer
	var radius := layer.radius
	var smallest := layer.min_scale - 1e-4
	var largest := layer.max_scale + 1e-4
	var cells := neighbors[index]
	for at in range(0, buffer.size(), floats_of(layer)):
		count += 1
		# Use doubles, because a Vector3 would round the sum.
		var x := origin.x + buffer[at + 3]
		var z := origin.z + buffer[at + 11]
		var height := ground.height(x, z)
		var slope := ground.slope(x, z)
		worst_height = maxf(worst_height, absf(origin.y + buffer[at + 7] - layer.height_offset - height))
		var size := Vector3(buffer[at], buffer[at + 4], buffer[at + 8]).length()
		if (height < layer.min_height - 0.01 or height > layer.max_height + 0.01
				or slope < layer.min_slope_degrees - 0.01 or slope > layer.max_slope_degrees + 0.01 or size < smallest or size > largest):
			outside_rules += 1
			first_outside = "layer %d: height %f, slope %f, scale %f" % [index, height, slope, size]
		var cell := Vector2i(floori(x / radius), floori(z / radius))
		for offset_x in [-1, 0, 1]:
			for offset_z in [-1, 0, 1]:
				var others: Array = cells.get(cell + Vector2i(offset_x, offset_z), [])
				for other in range(0, others.size(), 2):
					var distance := sqrt((others[other] - x) ** 2 + (others[other + 1] - z) ** 2)
					closest[index] = minf(closest[index], distance)
		cells.get_or_add(cell, []).append_array([x, z])
