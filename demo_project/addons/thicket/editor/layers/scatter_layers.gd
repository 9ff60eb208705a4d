@tool
extends RefCounted
## Finds the layers that a scatter shows: its own, followed by those of its biomes.


## Returns all layers as [method TerrainScatter3D.get_all_layers] does, with null for empty entries. Returns an empty
## array if the scatter is null.
static func of(scatter: TerrainScatter3D) -> Array[ScatterLayer]:
	if scatter == null:
		return []
	return scatter.layers if scatter.biomes == null else scatter.get_all_layers()


## Returns those of the layers that are in the scatter's list, which the panel can change.
static func own(scatter: TerrainScatter3D, layers: Array[ScatterLayer]) -> Array[ScatterLayer]:
	var listed := scatter.layers
	return layers.filter(func(layer: ScatterLayer) -> bool: return layer in listed)


## Returns the name of the first biome that contains a layer, or an empty string for a layer in the scatter's list.
static func biome_name(scatter: TerrainScatter3D, layer: ScatterLayer) -> String:
	var map := scatter.biomes
	if map == null or layer in scatter.layers:
		return ""
	var biomes := map.biomes
	for index in biomes.size():
		var biome := biomes[index]
		if biome != null and layer in biome.layers:
			return _title(biome, index)
	return ""


static func _title(biome: ScatterBiome, index: int) -> String:
	if biome.resource_name:
		return biome.resource_name
	var is_file := not biome.resource_path.is_empty() and not "::" in biome.resource_path
	return biome.resource_path.get_file().get_basename().capitalize() if is_file else "Biome %d" % index
