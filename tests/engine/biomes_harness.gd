extends "harness.gd"
## Base class for the biome and water tests: a map of 256 by 256 meters around the origin.

const MEADOW := Color.LIME
const FOREST := Color.BLUE
const SWAMP := Color.RED
const EXTENT := Rect2(-128, -128, 256, 256)
const PIXELS := 64


func named(layer_name: String, radius := 3.0) -> ScatterLayer:
	var layer := make_layer(radius)
	layer.resource_name = layer_name
	return layer


func make_biome(color: Color, layers: Array[ScatterLayer]) -> ScatterBiome:
	var biome := ScatterBiome.new()
	biome.color = color
	biome.layers = layers
	return biome


## Returns an image with pixels of 4 by 4 m. Meadow is on the left and forest on the right. A swamp crosses both from z = 64 on.
func make_image() -> Image:
	var image := Image.create_empty(PIXELS, PIXELS, false, Image.FORMAT_RGB8)
	image.fill(MEADOW)
	image.fill_rect(Rect2i(32, 0, 32, PIXELS), FOREST)
	image.fill_rect(Rect2i(0, 48, PIXELS, 16), SWAMP)
	return image


## Returns a map of these biomes with sharp, straight borders.
func make_map(biomes: Array[ScatterBiome]) -> ScatterBiomeMap:
	var map := ScatterBiomeMap.new()
	map.biomes = biomes
	map.map_image = make_image()
	map.map_rect = EXTENT
	map.border_width = 0.0
	map.border_noise = 0.0
	return map


func three_biomes() -> ScatterBiomeMap:
	return make_map([make_biome(MEADOW, [named("grass", 2.0)]), make_biome(FOREST, [named("oak", 5.0), named("fern")]),
			make_biome(SWAMP, [named("reed")])])


func make_world(map: ScatterBiomeMap, layers: Array[ScatterLayer] = []) -> TerrainScatter3D:
	var scatter := make_scatter(layers, ScatterGroundFlat.new(), make_viewer(Vector3(0, 0, 40)))
	scatter.biomes = map
	return scatter


func index_of(scatter: TerrainScatter3D, layer_name: String) -> int:
	return scatter.get_all_layers().find_custom(
			func(layer: ScatterLayer) -> bool: return layer != null and layer.resource_name == layer_name)


## Returns {ID: map position (world x and z)} for a layer's visible instances.
func places(scatter: TerrainScatter3D, layer: String) -> Dictionary[int, Vector2]:
	var result: Dictionary[int, Vector2] = {}
	for tile: Vector2i in scatter.get_shown_tiles(layer):
		add_places(scatter.get_tile(layer, tile), result)
	return result


func places_in(scatter: TerrainScatter3D, layer: String, rect: Rect2) -> Dictionary[int, Vector2]:
	var result: Dictionary[int, Vector2] = {}
	add_places(scatter.build_rect(layer, rect), result)
	return result


func add_places(tile: ScatterTile, result: Dictionary[int, Vector2]) -> void:
	for mesh in tile.get_mesh_count():
		var buffer := tile.get_buffer(mesh)
		var ids := tile.get_ids(mesh)
		for index in ids.size():
			result[ids[index]] = Vector2(
					tile.get_origin().x + buffer[12 * index + 3], tile.get_origin().z + buffer[12 * index + 11])


func all_within(found: Dictionary[int, Vector2], test: Callable) -> bool:
	return found.values().all(test)


## Returns {layer name: {tile: digest}} for all visible tiles.
func digests_by_name(scatter: TerrainScatter3D) -> Dictionary:
	var result := {}
	for layer in scatter.get_all_layers():
		if layer:
			result[layer.resource_name] = {}
			for tile in scatter.get_shown_tiles(layer):
				result[layer.resource_name][tile] = scatter.get_tile(layer, tile).get_digest()
	var visible_digests := result.values().map(func(tiles: Dictionary) -> Array: return tiles.values())
	check(visible_digests.any(func(all: Array) -> bool: return all.any(func(digest: int) -> bool: return digest != 0)), "instances are visible to compare")
	return result


## Runs `edit`, waits until the scatter settles, and returns the tiles that appeared during that time: {layer name: {tile: true}}.
func shown_by(scatter: TerrainScatter3D, edit: Callable) -> Dictionary:
	var shown := {}
	var count := func(layer: ScatterLayer, tile: Vector2i) -> void:
		shown.get_or_add(layer.resource_name, {})[tile] = true
	scatter.tile_shown.connect(count)
	edit.call()
	await settle(scatter)
	scatter.tile_shown.disconnect(count)
	return shown
