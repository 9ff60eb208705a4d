extends "harness.gd"
## Tests scenes and resources that release 0.2.0 saved. They open with one warning per former name, and are saved with the current names.
## Release 0.2.0 saved data/world_0.2.0.*. drawing_0.2.0.tscn was written by hand in the same format.

const DATA := "data/world_0.2.0."
## Digests of the first tiles of drawing_0.2.0.tscn, computed before its properties were renamed.
const DIGESTS := [-6414708764745442462, -693893192403766184, 583857009131101561, -7569773177193666075]
const CURRENT: Dictionary[String, String] = {
	"Flat": "ScatterGroundFlat", "Noise": "ScatterGroundNoise", "Meshes": "ScatterGroundMeshes", "Colliders": "ScatterGroundColliders",
	"Object": "ScatterGroundNode", "Heightmap": "ScatterGroundHeightmap", "Shared": "ScatterGroundFlat", "File": "ScatterGroundFlat",
}


func path_of(file: String) -> String:
	return (get_script() as Script).resource_path.get_base_dir().path_join(file)


## Checks a scene that release 0.2.0 saved.
func check_world(world: Node, context: String) -> void:
	for scatter: TerrainScatter3D in world.get_children():
		check_equal(scatter.ground.get_class() if scatter.ground != null else "nothing", CURRENT[scatter.name], "%s: the ground of %s" % [context, scatter.name])
		var layer := scatter.layers[0]
		check_equal([layer.slope_falloff_degrees, layer.thin_scale_up], [12.0, true], "%s: the layer of %s" % [context, scatter.name])
		check_equal(lods_of(layer), [[[0.0, "BoxMesh"], [25.0, "SphereMesh"]]], "%s: the LODs of %s" % [context, scatter.name])
	var ground_of := func(name: String) -> ScatterGround: return (world.get_node(name) as TerrainScatter3D).ground
	check_equal((ground_of.call("Flat") as ScatterGroundFlat).height, 3.0, context + ": a height")
	check(ground_of.call("Shared") == ground_of.call("Flat"), context + ": two nodes share their ground")
	var noise: ScatterGroundNoise = ground_of.call("Noise")
	check_equal([noise.amplitude, noise.base_height, (noise.noise as FastNoiseLite).seed], [7.0, 2.0, 5], context + ": noise")
	check_equal((ground_of.call("Meshes") as ScatterGroundMeshes).group, &"rocks", context + ": a group")
	check_equal((ground_of.call("Colliders") as ScatterGroundColliders).collision_mask, 6, context + ": a mask")
	var node: ScatterGroundNode = ground_of.call("Object")
	check_equal([node.node, node.no_ground_enabled, node.no_ground_height], [^"../Land", true, -9.0], context + ": a node")
	var heightmap: ScatterGroundHeightmap = ground_of.call("Heightmap")
	check_equal([heightmap.rect, heightmap.max_height, heightmap.image.get_size()], [Rect2(-32, -32, 64, 64), 40.0, Vector2i(8, 8)], context + ": a map")
	if world.has_node("File"):
		var file: ScatterGroundFlat = ground_of.call("File")
		check_equal([file.height, file.resource_name, file.resource_path], [11.0, "Outside", path_of("data/ground_0.2.0.tres")], context + ": a file")


func test_scenes_open_and_are_saved_with_current_names() -> void:
	var expected := ["TerrainScatter3D.terrain is named TerrainScatter3D.ground since", "ScatterLayer.slope_falloff is", "ScatterLayer.thin_scale_compensation is",
		"ScatterLayer.lod_distances is replaced by ScatterModel.lods since", "ScatterLayer.lod_meshes is replaced by ScatterModel.lods since"]
	for name: String in ["Colliders", "Flat", "Heightmap", "Meshes", "Noise", "Object"]:
		expected.append("ScatterTerrain%s is named ScatterGround" % name)
	for extension: String in ["tscn", "scn"]:
		var scene := ResourceLoader.load(path_of(DATA + extension), "", ResourceLoader.CACHE_MODE_IGNORE) as PackedScene
		var world := scene.instantiate()
		check_world(world, extension)
		var warnings := errors.take()
		check_equal(warnings.size(), expected.size(), "%s: one warning per name, the first time: %s" % [extension, warnings])
		for words: String in expected:
			check(Array(warnings).any(func(warning: String) -> bool: return words in warning), "%s: warned that %s" % [extension, words])
		expected.clear()
		var again := PackedScene.new()
		check_equal(again.pack(world), OK, "packed")
		world.free()
		var path := "user://current.tscn"
		check_equal(ResourceSaver.save(again, path), OK, "saved")
		var text := FileAccess.get_file_as_string(path)
		for word: String in ["ScatterTerrain", "\nterrain = ", "\nslope_falloff = ", "thin_scale_compensation", "lod_meshes", "lod_distances"]:
			check(not word in text, "%s: %s is not saved" % [extension, word.strip_edges()])
		var current: Node = (ResourceLoader.load(path, "", ResourceLoader.CACHE_MODE_IGNORE) as PackedScene).instantiate()
		check_no_error("a scene with current names")
		current.free()


## Returns [distance, mesh class] of each LOD of each of a layer's meshes.
func lods_of(layer: ScatterLayer) -> Array:
	return range(layer.meshes.size()).map(func(entry: int) -> Array:
		return layer.get_mesh_lods(entry).map(func(lod: ScatterLod) -> Array: return [lod.distance, lod.mesh.get_class()]))


## Converts the LODs of meshes, a scene and a model, even if a file's properties are in a different order or have too few meshes. Also
## converts visibility ranges, and the values of colors and variations.
func test_former_layers_are_drawn_as_before() -> void:
	var expected := {
		"Trees": [
			[[0.0, "BoxMesh"], [25.0, "SphereMesh"]],
			[[0.0, "CylinderMesh"], [25.0, "SphereMesh"], [40.0, "PrismMesh"], [60.5, "QuadMesh"]],
			[[0.0, "CapsuleMesh"], [25.0, "SphereMesh"], [30.0, "CapsuleMesh"], [60.5, "QuadMesh"]],
			[],
			[[0.0, "BoxMesh"]],
		],
		"Shrubs": [[[0.0, "BoxMesh"], [0.001, "SphereMesh"], [50.0, "QuadMesh"]]],
		"Flowers": [[[0.0, "BoxMesh"]]],
		"Ferns": [[[0.0, "BoxMesh"], [20.0, "SphereMesh"]], [[0.0, "CapsuleMesh"], [20.0, "QuadMesh"], [30.0, "CapsuleMesh"]]],
	}
	var path := path_of("data/drawing_0.2.0.tscn")
	for context: String in ["former", "current"]:
		var world := (ResourceLoader.load(path, "", ResourceLoader.CACHE_MODE_IGNORE) as PackedScene).instantiate() as TerrainScatter3D
		var warnings := errors.take()
		if context == "former":
			for words: String in ["visibility_range_end is replaced by ScatterLayer.view_distance", "visibility_range_begin has no effect",
					"visibility_range_fade_mode has no effect", "Use view_distance, lod_fade",
					"color_source is named ScatterLayer.color_value.source since", "color_gradient is named ScatterLayer.color_value.gradient since", "variation_source_max is named ScatterLayer.variation_value.max_value"]:
				check(words in "\n".join(warnings), "warned that %s" % words)
		for layer in world.layers:
			check_equal(lods_of(layer), expected[layer.resource_name], "%s: %s" % [context, layer.resource_name])
		var trees := world.layers[0]
		check(trees.meshes[4] is BoxMesh and trees.meshes[3] == null, context + ": entries without LODs stay")
		check((trees.meshes[1] as ScatterModel).scene != null, context + ": the model uses the scene")
		var sparse: ScatterLod = trees.get_mesh_lods(2)[2]
		check_equal([sparse.density, sparse.cast_shadow], [0.5, ScatterLod.CAST_SHADOW_DOUBLE_SIDED], context + ": the look of a model's LOD")
		var model := world.layers[2].meshes[1] as ScatterModel
		check_equal([model.lods.size(), model.far_lods.size()], [2, 1], context + ": each layer has a copy of the model")
		var flowers := world.layers[3]
		var color := flowers.color_value
		check_equal(color.gradient.colors, PackedColorArray([Color.RED, Color.BLUE]), context + ": the gradient of the color")
		check_equal([color.source, snappedf((color.noise as FastNoiseLite).frequency, 0.001), color.min_value, color.max_value, color.randomness],
				[ScatterValueSource.SOURCE_NOISE, 0.05, 0.25, 0.75, 0.125], context + ": the value of the color")
		var variation := flowers.variation_value
		check_equal([variation.source, variation.layer, variation.min_value, variation.max_value, variation.randomness],
				[ScatterValueSource.SOURCE_DISTANCE, "Trees", 1.0, 12.0, 0.25], context + ": the value of the variation")
		root.add_child(world)
		await process_frame
		check_equal(world.layers.map(func(layer: ScatterLayer) -> float: return layer.view_distance), [50.0, 70.0, 70.0, 256.0], context + ": view distances")
		world.layers[1].view_distance = 80.0
		await process_frame
		check_equal(world.layers[1].view_distance, 80.0, context + ": a later distance is used")
		world.layers[1].view_distance = 70.0
		var digests := range(4).map(func(layer: int) -> int: return world.build_tile(world.layers[layer], Vector2i.ZERO).get_digest())
		check_equal(digests, DIGESTS, context + ": the instances")
		root.remove_child(world)
		var packed := PackedScene.new()
		packed.pack(world)
		world.free()
		path = "user://drawing.tscn"
		check_equal(ResourceSaver.save(packed, path), OK, "saved")
	check_no_error("the saved scene")
	for words: String in ["visibility_range", "color_source", "color_gradient", "variation_source"]:
		check(not words in FileAccess.get_file_as_string(path), "%s is not saved" % words)


func test_a_former_property_of_a_state_is_read() -> void:
	var path := "user://designed.tres"
	var file := FileAccess.open(path, FileAccess.WRITE)
	file.store_string("[gd_resource type=\"ScatterState\" format=3]\n\n[resource]\ndesigned = true\n")
	file.close()
	var state := ResourceLoader.load(path, "", ResourceLoader.CACHE_MODE_IGNORE) as ScatterState
	check_error(["ScatterState.designed is named ScatterState.copy_at_runtime"], "a former property")
	check(state.copy_at_runtime, "the state is copied at run time")


## Scripts that extend a former class still run. A node keeps such a ground, because a script's base class cannot change.
func test_scripts_that_extend_former_classes_run() -> void:
	for name: String in ["ScatterTerrain", "ScatterTerrainFlat"]:
		var script := GDScript.new()
		script.source_code = """@tool
extends %s
func _get_heights(positions: PackedVector2Array) -> PackedFloat32Array:
	var heights := PackedFloat32Array()
	heights.resize(positions.size())
	heights.fill(7.0)
	return heights
""" % name
		check_equal(script.reload(), OK, "a script extends %s" % name)
		var ground: ScatterGround = script.new()
		var scatter := TerrainScatter3D.new()
		scatter.ground = ground
		check_error(["%s is named ScatterGround" % name, "a script extends", "Change the script"], name)
		check(scatter.ground == ground, "the node keeps the ground of %s" % name)
		scatter.ground = null
		scatter.ground = ground
		check_no_error("no second warning")
		if name == "ScatterTerrain":
			check_equal(ground.get_height(Vector3.ZERO), 7.0, "the script's heights")
		scatter.free()


## Release 0.2 also stored references to layers as indices. The node replaces each index with the layer's name, or with the layer itself if
## it has no name, and warns once for each property.
func test_indices_of_layers_become_names() -> void:
	var layers: Array[ScatterLayer] = [make_layer(9.0), make_layer(7.0), make_layer(3.0), null]
	var ferns := layers[2]
	layers[0].resource_name = "Oaks"
	ferns.resource_name = "Ferns"
	ferns.spacing = {0: 2.0, "Oaks": 1.0, 1: 3.0, 3: 4.0, 9: 5.0}
	ferns.proximity_layer = 0
	for property: StringName in [&"color_value", &"variation_value"]:
		var value := ScatterValueSource.new()
		value.layer = 0
		ferns.set(property, value)
	layers[1].proximity_layer = 1 # A reference to itself without a name, which a scene cannot store.
	var scatter := make_scatter(layers, ScatterGroundFlat.new(), make_viewer())
	var region := ScatterRegion3D.new()
	region.layers = [2, "Oaks", 1]
	scatter.add_child(region)
	check_no_error("indices alone")
	await settle(scatter)
	check_equal(ferns.spacing, {"Oaks": 2.0, layers[1]: 3.0, 3: 4.0, 9: 5.0}, "distances, of which the larger one is used")
	check_equal([ferns.proximity_layer, ferns.color_value.layer, ferns.variation_value.layer], ["Oaks", "Oaks", "Oaks"], "single references")
	check_equal(region.layers, ["Ferns", "Oaks", layers[1]], "layers of a region")
	check_equal(layers[1].proximity_layer, 1, "an index that cannot be replaced stays")
	var warnings := errors.take()
	check_equal(warnings.size(), 4, "one warning for each property: %s" % [warnings])
	for property: String in ["ScatterLayer.spacing", "ScatterLayer.proximity_layer", "ScatterValueSource.layer", "ScatterRegion3D.layers"]:
		check(Array(warnings).any(func(warning: String) -> bool: return property + " refers to layers by their names" in warning), property)
	region.layers = [0]
	await settle(scatter)
	check_equal(region.layers, ["Oaks"], "an index that is set later")
	check_no_error("no second warning")
