extends RefCounted
## Writes the tiles that a scatter shows to a file. build/.../analysis/tile_digests regenerates them without the engine.

var _lines: PackedStringArray


## Returns a number's bits as an integer, because an exact decimal would be long.
func _exact(value: float) -> String:
	var bytes := PackedByteArray()
	bytes.resize(8)
	bytes.encode_double(0, value)
	return str(bytes.decode_s64(0))


func add_terrain(terrain: ScatterGround) -> void:
	if terrain is ScatterGroundFlat:
		_lines.push_back("flat " + _exact(terrain.height))
		return
	var rect: Rect2 = terrain.rect
	var numbers := [rect.position.x, rect.position.y, rect.size.x, rect.size.y, terrain.min_height, terrain.max_height]
	_lines.push_back("heightmap %s %d %d %s" % [ProjectSettings.globalize_path(terrain.heightmap_path),
			terrain.post_count.x, terrain.post_count.y, " ".join(numbers.map(_exact))])


func add_layer(index: int, scatter_seed: int, layer: ScatterLayer) -> void:
	var numbers := [layer.radius, layer.density, layer.min_slope_degrees, layer.max_slope_degrees, layer.slope_falloff_degrees,
			layer.min_height, layer.max_height, layer.height_falloff, layer.min_yaw_degrees, layer.max_yaw_degrees, layer.min_scale,
			layer.max_scale, layer.align_to_normal, layer.height_offset, layer.clump_size, layer.clump_coverage, layer.clump_softness]
	for mesh in layer.meshes.size():
		numbers.push_back(layer.mesh_weights[mesh] if mesh < layer.mesh_weights.size() else 1.0)
	_lines.push_back("layer %d %d %d %d %s" % [index, scatter_seed, layer.progressive_levels,
			layer.layer_id if layer.layer_id >= 0 else index, " ".join(numbers.map(_exact))])


func add_tile(index: int, tile_size: float, tile: Vector2i, digest: int) -> void:
	_lines.push_back("tile %d %s %d %d %d" % [index, _exact(tile_size), tile.x, tile.y, digest])


func save(path: String) -> bool:
	var file := FileAccess.open(path, FileAccess.WRITE)
	return file != null and file.store_string("\n".join(_lines) + "\n")
