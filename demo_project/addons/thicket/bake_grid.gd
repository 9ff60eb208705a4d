extends RefCounted
## Which tiles a bake has, and of which tiles of the game each of them consists; as [code]tools/bake/baking/grid.py[/code] counts them.

## Rows that a tile should not have by far, for the sake of who reads it.
const COMFORTABLE_ROWS := 1.5e6
## Points of a set in the square of its radius, about.
const POINTS_PER_RADIUS_SQUARED := 0.7


## The tile that a coordinate lies in, as the engine counts them: tile n goes from n * size to (n + 1) * size, its end excluded.
static func tile_at(size: float, along: float) -> int:
	var tile := floori(along / size)
	if along < tile * size: # The division rounds; the edges decide.
		return tile - 1
	return tile + 1 if along >= (tile + 1) * size else tile


## The first of the tiles that a half-open interval touches, and the one after the last.
static func tiles_along(size: float, low: float, high: float) -> PackedInt64Array:
	if not low < high:
		return PackedInt64Array([0, 0])
	var last := tile_at(size, high)
	return PackedInt64Array([tile_at(size, low), last + (1 if last * size < high else 0)])


## First column, first row, columns and rows of the tiles that a rectangle (x, z, width, depth) touches.
static func grid_of(rect: Array, size: float) -> PackedInt64Array:
	var columns := tiles_along(size, rect[0], rect[0] + rect[2])
	var rows := tiles_along(size, rect[1], rect[1] + rect[3])
	return PackedInt64Array([columns[0], rows[0], columns[1] - columns[0], rows[1] - rows[0]])


## What a tile covers, cut by the bake's rectangle: low x, low z, high x, high z in meters, the high ends excluded.
static func area_of(rect: Array, size: float, tile: PackedInt64Array) -> PackedFloat64Array:
	return PackedFloat64Array([
		maxf(tile[0] * size, rect[0]), maxf(tile[1] * size, rect[1]),
		minf((tile[0] + 1) * size, rect[0] + rect[2]), minf((tile[1] + 1) * size, rect[1] + rect[3]),
	])


## The tiles of a layer, of a size in meters, that an area touches, row by row.
static func game_tiles(area: PackedFloat64Array, size: float) -> Array[Vector2i]:
	var columns := tiles_along(size, area[0], area[2])
	var rows := tiles_along(size, area[1], area[3])
	var tiles: Array[Vector2i] = []
	for y in range(rows[0], rows[1]):
		for x in range(columns[0], columns[1]):
			tiles.append(Vector2i(x, y))
	return tiles


## Meters of a tile that holds whole tiles of all layers, where that is possible below a kilometer: from 256 m on, larger where there
## would be more than 4,096 of them, up to 2,048 m, and to [constant COMFORTABLE_ROWS] if instances stood everywhere.
static func default_size(rect: Array, layers: Array) -> float:
	var base := 0.0
	var common := 1
	var density := 0.0
	for layer: Dictionary in layers:
		base = maxf(base, layer.tile_size)
		density += POINTS_PER_RADIUS_SQUARED / layer.radius ** 2
		if common > 0:
			common = _least_common_multiple(common, int(layer.tile_size)) if layer.tile_size == int(layer.tile_size) else 0
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
		var rest := a % b
		a = b
		b = rest
	return product / a
