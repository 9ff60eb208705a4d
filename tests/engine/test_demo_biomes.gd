extends "demo_scene_harness.gd"
## Tests the demo's biome scene: each biome's plants grow only where its weight is above 0. Only reeds grow in the water, at the shore.
## Plants disappear when the lake rises, and return when it falls.

const SCENE := "res://biomes.tscn"
## An area that contains the strip of wood that extends into the meadow, and the lake's shore below it.
const AROUND := Rect2(-90.0, -10.0, 120.0, 120.0)
const MEADOW: PackedStringArray = ["Oak", "Shrub", "Meadow", "Flowers"]
const WOOD: PackedStringArray = ["Spruce", "Fern", "Undergrowth"]
const OWN: PackedStringArray = ["Boulders", "Reeds"]
const ROUNDING := 0.002


## Returns {ID: position} for a layer's instances in a part of the valley.
func standing(layer: String, rect := AROUND) -> Dictionary:
	var found := scatter.query_rect(rect, layer)
	var result := {}
	for index in found.size():
		result[found.ids[index]] = found.get_position(index)
	return result


func depth_at(point: Vector3) -> float:
	return scatter.water_level - terrain.get_height(point)


func test_each_biome_has_its_plants() -> void:
	load_scene(SCENE)
	await settle(scatter)
	check_equal(scatter.get_problems(), PackedStringArray(), "warnings of the scene")
	for biome in 2:
		var mixed := 0
		for layer: String in [MEADOW, WOOD][biome]:
			var points := standing(layer)
			check(points.size() > 10, "%d instances of %s" % [points.size(), layer])
			for point: Vector3 in points.values():
				var weight: float = scatter.biomes.get_weights_at(Vector2(point.x, point.z))[biome]
				check(weight > 0.0, "%s at %s, outside its biome" % [layer, point])
				mixed += int(weight < 1.0)
		check(mixed > 50, "plants of several biomes mix at the border: %d" % mixed)
	var straight := 0
	var image: Image = scatter.biomes.map_image
	for step in 200:
		var at := AROUND.position + AROUND.size * Vector2(fmod(step * 0.618, 1.0), step / 200.0)
		var pixel := image.get_pixelv(Vector2i((at - scatter.biomes.map_rect.position) / scatter.biomes.map_rect.size * Vector2(image.get_size())))
		straight += int((pixel.r > 0.4) == (scatter.biomes.get_biome_at(at) == scatter.biomes.biomes[0]))
	check(straight > 120 and straight < 195, "the border noise moves borders: %d of 200 positions match the image" % straight)


func test_the_lake_rises_and_falls() -> void:
	load_scene(SCENE)
	await settle(scatter)
	var before := {}
	for layer in MEADOW + WOOD + OWN:
		before[layer] = standing(layer)
	check(before["Reeds"].size() > 300, "%d reeds" % before["Reeds"].size())
	for level: float in [0.0, 1.2]:
		scatter.water_level = level
		for layer in MEADOW + WOOD:
			var deepest: float = standing(layer).values().map(depth_at).max()
			check(deepest <= -0.2 + ROUNDING, "%s at a depth of %.2f m with the lake at %.1f" % [layer, deepest, level])
		var depths: Array = standing("Reeds").values().map(depth_at)
		check(depths.min() >= -0.35 - ROUNDING and depths.max() <= 0.45 + ROUNDING, "reeds from %s to %s" % [depths.min(), depths.max()])
		check(depths.min() < 0.0 and depths.max() > 0.2, "reeds grow on both sides of the shore")
	for layer in MEADOW + WOOD:
		var left := standing(layer)
		check(left.size() < before[layer].size() or layer in ["Oak", "Spruce", "Shrub"], "%s retreats" % layer)
		for id: int in left:
			# A layer may gain instances where a layer from which it keeps a distance has lost some.
			check(before[layer].get(id, left[id]) == left[id], "%s: remaining instances do not move" % layer)
			check(before[layer].has(id) or layer in ["Shrub", "Spruce", "Fern", "Meadow", "Undergrowth"], "%s: nothing new" % layer)
	scatter.water_level = 0.0
	for layer: String in before:
		check(standing(layer) == before[layer], "%s: restored after the lake has fallen" % layer)


func test_a_key_raises_the_water() -> void:
	scene = (load(SCENE) as PackedScene).instantiate()
	root.add_child(scene)
	await frames(3)
	scatter = scene.get_node("Scatter")
	for level: float in [1.2, 0.0]:
		var event := InputEventKey.new()
		event.keycode = KEY_M
		event.pressed = true
		root.push_input(event)
		await frames(2)
		check(is_equal_approx(scatter.water_level, level), "M: the water level is %s" % scatter.water_level)
		check(is_equal_approx(scene.get_node("Lake").global_position.y, level), "the lake's mesh is moved")
