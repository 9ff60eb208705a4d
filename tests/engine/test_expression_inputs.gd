extends "biomes_harness.gd"
## Tests expressions that use biomes, textures of the ground, distances to other layers and channels of the mask texture.

const AROUND := Rect2(-60, -20, 120, 120)


## Ground with two textures that blend along x.
class Textured extends Node3D:
	func get_height(_at: Vector3) -> float:
		return 3.0

	func get_texture_id(at: Vector3) -> Vector3:
		return Vector3(2, 5, clampf(0.5 + at.x / 60.0, 0.0, 1.0))


## Returns a layer with a mesh for each expression, and a mesh that is used only where all expressions are 0.
func mixed(expressions: PackedStringArray) -> ScatterLayer:
	var layer := named("Forest", 2.0)
	var meshes: Array[Mesh] = []
	var weights := PackedFloat32Array()
	for expression in expressions:
		meshes.append(BoxMesh.new())
		weights.append(1.0)
	meshes.append(SphereMesh.new())
	weights.append(1e-6)
	layer.meshes = meshes
	layer.mesh_weights = weights
	layer.mesh_density_expressions = expressions
	return layer


## Checks that the mesh of each instance is `expected`, a function of its position; -1 for any mesh. Returns the number of instances by mesh.
func check_meshes(scatter: TerrainScatter3D, layer: String, expected: Callable, context: String) -> Dictionary[int, int]:
	var found := scatter.query_rect(AROUND, layer)
	var counts: Dictionary[int, int] = {}
	var wrong := 0
	for index in found.size():
		var mesh := found.get_mesh(index)
		var wanted: int = expected.call(found.get_position(index))
		wrong += int(wanted >= 0 and mesh != wanted)
		counts[mesh] = counts.get(mesh, 0) + 1
	check_equal(wrong, 0, context + ": wrong meshes of %d" % found.size())
	return counts


func test_biomes() -> void:
	var map := three_biomes()
	map.biomes[1].resource_name = "Dark forest"
	var layer := mixed(["biome('Dark forest')", "biome(2)"])
	var scatter := make_world(map, [layer])
	await settle(scatter)
	var expected := func(at: Vector3) -> int:
		return 1 if at.z >= 64 else 0 if at.x >= 0 else 2
	var counts := check_meshes(scatter, "Forest", expected, "biomes")
	check(counts.size() == 3 and counts.values().min() > 50, "all meshes occur: %s" % counts)
	check(scatter.get_problems().is_empty(), "no problems: %s" % scatter.get_problems())
	var explanation := scatter.explain_position(Vector3(20, 0, 20))[0]
	check(explanation.get_mesh_sentence(0).ends_with("gives 99.9 % (biome(\"Dark forest\") is 1)."), explanation.get_mesh_sentence(0))
	map.biomes[1].resource_name = "Light forest"
	await settle(scatter)
	check_meshes(scatter, "Forest", func(at: Vector3) -> int: return 1 if at.z >= 64 else 2, "no biome has the name any more")
	check(Array(scatter.get_problems()).any(func(text: String) -> bool:
		return "biome(\"Dark forest\") in an expression is 0 everywhere: TerrainScatter3D.biomes has no such biome" in text), "a missing biome: %s" % scatter.get_problems())
	map.biomes[1].resource_name = "Dark forest"
	layer.density_expression = "biome(0) + biome('Dark forest')"
	await settle(scatter)
	check(all_within(places(scatter, "Forest"), func(at: Vector2) -> bool: return at.y < 64), "biomes as a rule of the layer")
	layer.on_surfaces = true
	await settle(scatter)
	check_equal(scatter.get_problems().size(), 1, "flat ground has no surfaces, and biomes are allowed there: %s" % scatter.get_problems())


func test_channels_of_the_mask_texture() -> void:
	var image := Image.create_empty(64, 64, false, Image.FORMAT_RGB8)
	image.fill(Color.RED)
	image.fill_rect(Rect2i(32, 0, 32, 64), Color.GREEN)
	var layer := mixed(["mask_red > 0.6", "mask_green > 0.6", "mask_blue"])
	layer.mask_texture = ImageTexture.create_from_image(image)
	layer.mask_texture_rect = EXTENT
	layer.mask_texture_channel = ScatterLayer.MASK_CHANNEL_NONE
	layer.mask_texture_edge = ScatterLayer.MASK_EDGE_CLAMP
	var scatter := make_scatter([layer], ScatterGroundFlat.new(), make_viewer())
	await settle(scatter)
	var expected := func(at: Vector3) -> int:
		return -1 if absf(at.x) < 4.0 else 1 if at.x > 0.0 else 0
	var counts := check_meshes(scatter, "Forest", expected, "channels")
	check(counts[0] > 100 and counts[1] > 100, "both meshes occur: %s" % counts)
	check(scatter.get_problems().is_empty(), "no problems: %s" % scatter.get_problems())
	var all := scatter.query_rect(AROUND, "Forest").size()
	image.fill(Color.BLUE)
	layer.mask_texture = ImageTexture.create_from_image(image)
	await settle(scatter)
	check_meshes(scatter, "Forest", func(_at: Vector3) -> int: return 2, "another texture")
	check_equal(scatter.query_rect(AROUND, "Forest").size(), all, "the number of instances")
	layer.mask_texture_channel = ScatterLayer.MASK_CHANNEL_RED
	await settle(scatter)
	check_equal(scatter.query_rect(AROUND, "Forest").size(), 0, "with a channel, the texture is a mask as well")
	layer.mask_texture = null
	check(Array(scatter.get_problems()).any(func(text: String) -> bool: return "ScatterLayer.mask_texture is empty" in text), "no texture: %s" % scatter.get_problems())
	layer.mesh_density_expressions = []
	layer.mask_texture_channel = ScatterLayer.MASK_CHANNEL_NONE
	layer.mask_texture = ImageTexture.create_from_image(image)
	check(Array(scatter.get_problems()).any(func(text: String) -> bool: return "mask_texture has no effect: mask_texture_channel is None" in text), "an unused texture: %s" % scatter.get_problems())
	layer.mesh_density_expressions = ["mask_red"]
	layer.mask_texture = ImageTexture.new()
	check(Array(scatter.get_problems()).any(func(text: String) -> bool: return "has no readable image, so its channels are 0 in expressions" in text), "a texture without an image: %s" % scatter.get_problems())


func test_textures_of_the_ground() -> void:
	var node := Textured.new()
	root.add_child(node)
	for thread_safe: bool in [false, true]:
		var terrain := ScatterGroundNode.new()
		terrain.thread_safe = thread_safe
		var layer := mixed(["texture(5) > 0.75", "texture(2) > 0.75"])
		layer.view_distance = 80.0
		var scatter := make_scatter([layer], terrain, make_viewer())
		terrain.node = scatter.get_path_to(node)
		await settle(scatter)
		var expected := func(at: Vector3) -> int:
			return -1 if absf(absf(at.x) - 15.0) < 0.5 else 0 if at.x > 15.0 else 1 if at.x < -15.0 else 2
		var counts := check_meshes(scatter, "Forest", expected, "textures, thread_safe is %s" % thread_safe)
		check(counts.size() == 3 and counts.values().min() > 50, "all meshes occur: %s" % counts)
		layer.density_expression = "texture(5) > 0.5"
		await settle(scatter)
		var found := scatter.query_rect(AROUND, "Forest")
		check(found.size() > 100 and Array(found.positions).all(func(at: Vector3) -> bool: return at.x > -0.01), "textures as a rule of the layer")
		scatter.ground = ScatterGroundFlat.new()
		check(Array(scatter.get_problems()).any(func(text: String) -> bool:
			return "texture(5) in an expression is 1 everywhere: the ground has no textures" in text), "no textures: %s" % scatter.get_problems())
		layer.on_surfaces = true
		await settle(scatter)
		check_error(["ScatterLayer.on_surfaces must be 0 (false, because an expression uses texture()), got 1. Disable it"], "textures on surfaces")
		await clean()
		node = Textured.new()
		root.add_child(node)


func test_distances_to_other_layers() -> void:
	var rocks := named("Rocks", 12.0)
	var layer := mixed(["distance(\"Rocks\", 8) < 4"])
	var scatter := make_scatter([rocks, layer], ScatterGroundFlat.new(), make_viewer(Vector3(0, 0, 40)))
	await settle(scatter)
	var stones := scatter.query_rect(AROUND.grow(20), "Rocks").positions
	var expected := func(at: Vector3) -> int:
		var nearest: float = Array(stones).map(func(stone: Vector3) -> float: return stone.distance_to(at)).min()
		return -1 if absf(nearest - 4.0) < 0.01 else 0 if nearest < 4.0 else 1
	var counts := check_meshes(scatter, "Forest", expected, "distances")
	check(counts[0] > 100 and counts[1] > 100, "both meshes occur: %s" % counts)
	layer.density_expression = "distance('Rocks', 5) > 3"
	await settle(scatter)
	rocks.resource_name = "Old rocks"
	await settle(scatter)
	check_equal(layer.mesh_density_expressions[0], "distance(\"Old rocks\", 8) < 4", "the expression of a mesh after renaming the layer")
	check_equal(layer.density_expression, "distance(\"Old rocks\", 5) > 3", "the layer's expression after renaming the layer")
	var kept := check_meshes(scatter, "Forest", expected, "after renaming the layer")
	check(kept[0] > 20 and kept[0] < counts[0] and absi(kept[1] - counts[1]) < 3, "the distance as a rule: %s, then %s" % [counts, kept])
	check(scatter.get_problems().is_empty(), "no problems: %s" % scatter.get_problems())
	var ids := scatter.query_rect(AROUND, "Forest").ids
	rocks.density = 0.3
	await settle(scatter)
	check(scatter.query_rect(AROUND, "Forest").ids != ids, "fewer rocks")
	scatter.layers = [layer, rocks]
	check(Array(scatter.get_problems()).any(func(text: String) -> bool:
		return "distance() in an expression is \"Old rocks\", which is not before this layer in the list" in text), "a later layer: %s" % scatter.get_problems())


func test_distances_that_need_too_many_points() -> void:
	var grass := named("Grass", 0.05)
	grass.tile_size = 8.0
	grass.view_distance = 8.0
	var layer := mixed(["distance(\"Grass\", 500) < 1"])
	make_scatter([grass, layer], ScatterGroundFlat.new(), make_viewer())
	await frames(3)
	check_error(["ScatterLayer", "mesh_density_expressions", "Lower tile_size or this distance"], "too long a distance")


func test_digest_of_biomes() -> void:
	var digest := preload("res://addons/thicket/baking/scene_digest.gd")
	var map := three_biomes()
	map.biomes[1].resource_name = "Forest"
	var layer := mixed(["height > 3"])
	var scatter := make_world(map, [layer])
	var before: Dictionary = digest.parts_of(scatter, AROUND)
	map.biomes[1].resource_name = "Wood"
	check_equal(digest.parts_of(scatter, AROUND), before, "names of biomes that no expression uses")
	layer.mesh_density_expressions = ["biome('Wood')"]
	var by_name: Dictionary = digest.parts_of(scatter, AROUND)
	map.biomes[1].resource_name = "Forest"
	check(digest.parts_of(scatter, AROUND)["the biomes"] != by_name["the biomes"], "names of biomes that an expression uses")
