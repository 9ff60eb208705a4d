extends RefCounted
## Divides the rectangle of a bake into tiles, and determines which of the game's tiles each of them contains.

## The largest number of tiles of a bake. Readers of its manifest keep all of them in memory.
const MAX_TILES := 1_000_000
## The number of rows that a tile should not exceed by much. A row takes about 300 bytes of memory in the programs that read it.
const COMFORTABLE_ROWS := 1.5e6

## The reason why the grid is invalid; empty if it is valid.
var problem := ""
## The edge length of a tile in meters.
var tile_size := 0.0
## The first tile, and the number of tiles along x and z.
var tiles := Rect2i()

var _edges_x := PackedFloat64Array()
var _edges_z := PackedFloat64Array()
var _layers: Array[Dictionary] = []
var _grids: Array[ScatterTileGrid] = [] # The grids of the game's tiles, one for each layer.


## Divides [param rect] (world x, z, width and depth in meters) into tiles with an edge length of [param size] meters. Only [code]index[/code] and
## [code]tile_size[/code] of [param layers] are used. If there are no tiles, or too many, sets [member problem].
func _init(rect: Array, size: float, layers: Array[Dictionary]) -> void:
	tile_size = size
	var grid := ScatterTileGrid.new()
	grid.tile_size = tile_size
	tiles = grid.get_tiles_in(PackedFloat64Array([rect[0], rect[1], rect[0] + rect[2], rect[1] + rect[3]]))
	var count := tiles.size.x * tiles.size.y
	if count == 0:
		problem = "The rectangle %s is too far from the origin for tiles of %s m: use larger tiles (tile size) or a nearer rectangle." % [rect, tile_size]
	elif count > MAX_TILES:
		problem = ("%d tiles are more than the maximum of %d: choose larger tiles (tile size), or bake parts of the world, each with a " \
				+ "rectangle along tile edges and into a separate folder. Readers combine the parts.") % [count, MAX_TILES]
	if problem:
		return
	_edges_x = _edges(grid, tiles.position.x, tiles.size.x, rect[0], rect[0] + rect[2], 0)
	_edges_z = _edges(grid, tiles.position.y, tiles.size.y, rect[1], rect[1] + rect[3], 1)
	for layer in layers:
		var layer_grid := ScatterTileGrid.new()
		layer_grid.tile_size = layer["tile_size"]
		_layers.append(layer)
		_grids.append(layer_grid)


## Returns the grid as plain values: [code]tile_size[/code], [code]grid[/code] (first column, first row, number of columns, number of rows), and
## [code]edges[/code]. The edges are the positions, in meters, of the borders of all columns and rows, clipped to the rectangle.
func description() -> Dictionary:
	return {
		"tile_size": tile_size, "grid": [tiles.position.x, tiles.position.y, tiles.size.x, tiles.size.y],
		"edges": [Array(_edges_x), Array(_edges_z)],
	}


## Returns the game's tiles that a tile of the bake consists of, layer by layer and row by row. Each has the index of its [code]layer[/code], its
## column and row as [code]x[/code] and [code]y[/code], and its [code]bounds[/code] as [method ScatterTileGrid.get_tile_bounds] returns them.
func parts_of(tile: Vector2i) -> Array[Dictionary]:
	var parts: Array[Dictionary] = []
	var cell := tile - tiles.position
	var area := PackedFloat64Array([_edges_x[cell.x], _edges_z[cell.y], _edges_x[cell.x + 1], _edges_z[cell.y + 1]])
	for index in _layers.size():
		var covered := _grids[index].get_tiles_in(area)
		for y in range(covered.position.y, covered.end.y):
			for x in range(covered.position.x, covered.end.x):
				parts.append({"layer": _layers[index].index, "x": x, "y": y, "bounds": Array(_grids[index].get_tile_bounds(Vector2i(x, y)))})
	return parts


## Returns the edges of the tiles along an axis, 0 for x and 1 for z. The first edge is [param low] and the last is [param high].
static func _edges(grid: ScatterTileGrid, first: int, count: int, low: float, high: float, axis: int) -> PackedFloat64Array:
	var edges := PackedFloat64Array([low])
	for tile in range(first + 1, first + count):
		edges.append(grid.get_tile_bounds(Vector2i(tile, tile))[axis])
	edges.append(high)
	return edges


## Returns the default edge length of a tile in meters. [param sizes] are the edge lengths of the layers' tiles. If they have a common multiple of at
## most 1,024 m, a tile consists of whole tiles of all layers. The edge length begins at 256 m or more. It doubles, up to 2,048 m, while there are
## more than 4,096 tiles, unless a tile would then have more than [constant COMFORTABLE_ROWS] rows at [param density] instances per square meter.
static func default_size(rect: Array, sizes: PackedFloat64Array, density: float) -> float:
	var base := 0.0
	var common := 1
	for size in sizes:
		base = maxf(base, size)
		if common > 0:
			common = _least_common_multiple(common, int(size)) if size == int(size) else 0
			common = common if common <= 1024 else 0
	if common > 0:
		base = common
	var size := base * ceilf(256.0 / base)
	while size <= 1024.0 and rect[2] * rect[3] / size ** 2 > 4096.0 and density * (2.0 * size) ** 2 <= COMFORTABLE_ROWS:
		size *= 2.0
	return size


static func _least_common_multiple(a: int, b: int) -> int:
	var product := a * b
	while b != 0:
		var remainder := a % b
		a = b
		b = remainder
	return product / a
