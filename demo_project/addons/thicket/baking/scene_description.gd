extends RefCounted
## Describes the bake of a scene: its layers, its rectangle and its tiles.

const SceneDigest := preload("res://addons/thicket/baking/scene_digest.gd")
const BakeGrid := preload("res://addons/thicket/baking/bake_grid.gd")

## The reason why the scene cannot be baked; empty if it can.
var problem := ""
## The description as plain values: the scene's seed, hashes and other properties, the requested layers, [code]rect[/code], and the description of the
## tiles from [code]bake_grid.gd[/code]. [code]density[/code] is the number of points of these layers per square meter before the rules remove any.
var values: Dictionary = {}
## The tiles; null before [method describe], and if there is a [member problem].
var grid: BakeGrid

var _rect: Array = [] # World x, z, width and depth in meters; empty for the rectangle of the ground.
var _tile_size := 0.0 # The edge length of a tile in meters; 0 for a size that fits the layers.
var _layers := PackedStringArray() # The names or indices of the layers to bake; empty for all layers.


## Reads the request: [code]rect[/code], [code]tile_size[/code] and [code]layers[/code], each a string as on the command
## line. [method describe] chooses values for missing or empty strings. If a string is invalid, sets [member problem].
func _init(request: Dictionary) -> void:
	if request.get("rect"):
		_rect = numbers_in(request["rect"], ",")
		if _rect.size() != 4 or _rect[2] <= 0.0 or _rect[3] <= 0.0 or _rect.any(func(number: float) -> bool: return absf(number) >= 1e12):
			problem = "rect must be X,Z,WIDTH,DEPTH in meters, with a width and a depth above 0 and all below 1e12, got '%s'." % request["rect"]
	if request.get("tile_size"):
		var text: String = request["tile_size"]
		_tile_size = text.to_float() if text.is_valid_float() else 0.0
		if not (_tile_size >= 1.0 and _tile_size <= 1e6):
			problem = "tile_size must be between 1 and 1000000 meters, got '%s'." % text
	var layers: String = request.get("layers", "")
	for layer in layers.split(",", false):
		_layers.append(layer.strip_edges())


## Returns the numbers in a string, separated by [param separator], or an empty array if one of them is invalid.
static func numbers_in(text: String, separator: String) -> Array:
	var fields := Array(text.split(separator))
	if not fields.all(func(field: String) -> bool: return field.is_valid_float()):
		return []
	return fields.map(func(field: String) -> float: return field.to_float())


## Fills [member values] and [member grid]. On an error, returns false and sets [member problem]. The ground is sampled in the baked rectangle.
func describe(scatter: TerrainScatter3D) -> bool:
	var layers := _requested_layers(_layers_of(scatter))
	var ground_rect: Variant = scatter.ground.get(&"rect") # Some kinds of ground have no rect.
	var rect := _rect
	if rect.is_empty() and ground_rect is Rect2:
		var ground: Rect2 = ground_rect
		if ground.has_area():
			rect = [ground.position.x, ground.position.y, ground.size.x, ground.size.y]
	if not problem and rect.is_empty():
		problem = "The ground does not report its extent: set rect to X,Z,WIDTH,DEPTH in meters, or set the rect of a ground that has one."
	if not problem and SceneDigest.version().is_empty():
		problem = "%s cannot be read or has no version: install all files of the add-on in the project." % SceneDigest.PLUGIN
	if problem:
		return false
	var density := _density_of(scatter, layers)
	grid = BakeGrid.new(rect, _tile_size if _tile_size > 0.0 else _fitting_size(rect, layers, density), layers)
	problem = grid.problem
	if problem:
		return false
	var digests := SceneDigest.parts_of(scatter, Rect2(rect[0], rect[1], rect[2], rect[3]))
	var offset := scatter.world_offset
	var all_layers := scatter.get_all_layers()
	var columns := {}
	for layer in layers:
		columns[str(layer.index)] = all_layers[layer.index].get_row_columns()
	values = {
		"seed": str(scatter.seed), "layers": layers, "parts": digests, "world_offset": [offset.x, offset.y, offset.z], "rect": rect,
		"problems": scatter.get_problems(), "scene_digest": JSON.stringify(digests, "", true).sha256_text(), "thicket": SceneDigest.version(), "columns": columns,
		"density": density,
	}.merged(grid.description())
	return true


static func _fitting_size(rect: Array, layers: Array[Dictionary], density: float) -> float:
	var sizes := PackedFloat64Array()
	for layer in layers:
		sizes.append(layer["tile_size"])
	return BakeGrid.default_size(rect, sizes, density)


static func _density_of(scatter: TerrainScatter3D, layers: Array[Dictionary]) -> float:
	var all_layers := scatter.get_all_layers()
	var density := 0.0
	for layer in layers:
		density += all_layers[layer.index].get_point_density()
	return density


static func _layers_of(scatter: TerrainScatter3D) -> Array[Dictionary]:
	var layers: Array[Dictionary] = []
	var all_layers := scatter.get_all_layers()
	for index in all_layers.size():
		var layer := all_layers[index]
		if layer != null:
			layers.append({
				"index": index, "name": layer.resource_name, "radius": layer.radius, "levels": layer.progressive_levels,
				"tile_size": layer.tile_size, "colored": layer.use_colors, "custom_data": layer.use_custom_data,
				"view_distance": layer.view_distance, "cast_shadow": layer.cast_shadow, "render_layers": layer.render_layers,
			})
	return layers


func _requested_layers(layers: Array[Dictionary]) -> Array[Dictionary]:
	var selected: Dictionary[int, bool] = {}
	for name in _layers:
		var matches := layers.filter(func(layer: Dictionary) -> bool: return str(layer.index) == name)
		if matches.is_empty():
			matches = layers.filter(func(layer: Dictionary) -> bool: return layer.name == name)
		if matches.is_empty():
			var available := layers.map(func(layer: Dictionary) -> String: return ("%d %s" % [layer.index, layer.name]).strip_edges())
			problem = "The scene has no layer '%s'. It has: %s. Set layers to the indices or names of layers." % [name, ", ".join(available)]
		for layer: Dictionary in matches:
			selected[layer.index] = true
	var result := layers.filter(func(layer: Dictionary) -> bool: return selected.is_empty() or layer.index in selected)
	if result.is_empty() and not problem:
		problem = "The scene has no layers: add one to TerrainScatter3D.layers."
	return result
