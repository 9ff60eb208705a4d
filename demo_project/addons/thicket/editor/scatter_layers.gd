@tool
extends RefCounted
## The layers that a scatter shows: those of its own, and behind them those of its biomes.


## All of them, by the index that the scatter knows them by; null where an entry is empty.
static func of(scatter: Object) -> Array:
	var own: Array = scatter.get(&"layers")
	if scatter.get(&"biomes") == null or not scatter.has_method(&"get_layer_count"):
		return own
	var result := own.duplicate()
	for index in range(own.size(), scatter.call(&"get_layer_count")):
		result.append(scatter.call(&"get_layer", index))
	return result


## Those of these layers that are in the scatter's own list, which is the one that the panel changes.
static func own(scatter: Object, layers: Array[Resource]) -> Array[Resource]:
	var listed: Array = scatter.get(&"layers")
	return layers.filter(func(layer: Resource) -> bool: return layer in listed)


## The name of the first biome that has a layer; empty for a layer of the scatter's own.
static func biome_name(scatter: Object, layer: Resource) -> String:
	var map: Resource = scatter.get(&"biomes")
	if map == null or layer in scatter.get(&"layers"):
		return ""
	var biomes: Array = map.get(&"biomes")
	for index in biomes.size():
		var biome: Resource = biomes[index]
		if biome != null and layer in biome.get(&"layers"):
			return _title(biome, index)
	return ""


static func _title(biome: Resource, index: int) -> String:
	if biome.resource_name:
		return biome.resource_name
	var is_file := not biome.resource_path.is_empty() and not "::" in biome.resource_path
	return biome.resource_path.get_file().get_basename().capitalize() if is_file else "Biome %d" % index
