extends "harness.gd"
## Base class for the tests of edits and of spacing between layers. Its ferns keep a distance from oaks, on a mound that changes.

const FLOATS := 0.001 # Tolerance in meters for single-precision rounding at these distances.
const OAK := 0
const FERN := 1
const SPACING := 3.0
const FEATHER := 2.0

## Hills with a mound whose area and height a test can change. Worker threads sample it.
class Mound extends ScatterGround:
	var area := Rect2(0, 0, 1, 1)
	var height := 0.0

	func _get_heights(positions: PackedVector2Array) -> PackedFloat32Array:
		var heights := PackedFloat32Array()
		for at in positions:
			heights.push_back(sin(at.x * 0.1) + 2.0 * cos(at.y * 0.07) + (height if area.has_point(at) else 0.0))
		return heights

	func _is_thread_safe() -> bool:
		return true


## A mound that only the main thread samples.
class MainMound extends Mound:
	func _is_thread_safe() -> bool:
		return false


## Records the tiles that each layer has shown since the last call to `take`.
class Shown:
	var tiles: Array[Dictionary] = [{}, {}, {}]

	func _init(scatter: TerrainScatter3D) -> void:
		scatter.tile_shown.connect(func(layer: ScatterLayer, tile: Vector2i) -> void: tiles[scatter.layers.find(layer)][tile] = true)

	func take() -> Array[Dictionary]:
		var taken := tiles
		tiles = [{}, {}, {}]
		return taken


func named_layer(layer_name: String, id: int, radius: float) -> ScatterLayer:
	var layer := make_layer(radius)
	layer.resource_name = layer_name
	layer.layer_id = id
	return layer


func make_mask() -> ScatterMask:
	var mask := ScatterMask.new()
	mask.pixel_size = 0.5
	mask.paint(Vector2(1000, 1000), 1.0, 1.0, 1.0, ScatterMask.MODE_ERASE)
	return mask


func make_forest() -> Array[ScatterLayer]:
	var oak := named_layer("oak", 1, 4.0)
	oak.tile_size = 40.0
	oak.density = 0.8
	var fern := named_layer("fern", 2, 1.5)
	fern.spacing = {"oak": SPACING}
	fern.edge_feather = FEATHER
	oak.mask = make_mask()
	fern.mask = make_mask()
	return [oak, fern]


func tile_rect(scatter: TerrainScatter3D, layer: int, tile: Vector2i) -> Rect2:
	var size := scatter.layers[layer].tile_size
	return Rect2(Vector2(tile) * size, Vector2(size, size))


func make_clearing() -> ScatterRegion3D:
	var region := ScatterRegion3D.new()
	region.shape = ScatterRegion3D.SHAPE_CYLINDER
	region.ignore_height = true
	region.exclude = true
	region.falloff = 3.0
	region.radius = 8.0
	return region


func nearest(position: Vector2, others: PackedVector2Array) -> float:
	var minimum := INF
	for other in others:
		minimum = minf(minimum, position.distance_squared_to(other))
	return sqrt(minimum)


func map_positions(scatter: TerrainScatter3D, layer: int) -> PackedVector2Array:
	var result: PackedVector2Array
	for at: Transform3D in instances(scatter, layer).values():
		result.push_back(on_map(at))
	return result
