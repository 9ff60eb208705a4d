extends "harness.gd"
## Tests the properties of a layer: saving and loading, rejected values, change signals, and warnings.

const SPOT := "user://thicket_layer"

## The properties that full_layer() changes from the defaults in the class reference.
const PROPERTIES: Array[StringName] = [
	&"mesh_density_expressions", &"density_expression", &"density_rules", &"density_over_height", &"density_over_slope", &"ground_textures", &"noise", &"noise_curve", &"mask",
	&"mask_texture", &"mask_texture_rect", &"mask_texture_channel", &"mask_texture_edge", &"clump_size",
	&"clump_coverage", &"clump_softness", &"edge_feather", &"proximity_layer", &"proximity_distance",
	&"proximity_curve", &"scale_curve", &"scale_value", &"min_tilt_degrees", &"max_tilt_degrees", &"offset_along_normal", &"use_colors",
	&"color_value", &"variation_value", &"use_custom_data", &"layer_id",
	&"instance_radius", &"instance_height", &"regrowth_time", &"collision_shape", &"collision_distance",
	&"collision_layer", &"collision_mask", &"physics_material", &"affect_navigation_mesh", &"scene", &"scene_distance",
]

## The resources of a layer by property: [class, property to change, new value].
var sources := {
	"density_over_height": ["Curve", "max_domain", 500.0], "density_over_slope": ["Curve", "max_domain", 60.0],
	"noise": ["FastNoiseLite", "frequency", 0.5], "noise_curve": ["Curve", "min_domain", -1.0],
	"mask": ["ScatterMask", "background", 0.5], "mask_texture": ["GradientTexture2D", "width", 16],
	"proximity_curve": ["Curve", "max_domain", 9.0], "scale_curve": ["Curve", "max_domain", 2.0],
	"color_value": ["ScatterValueSource", "max_value", 0.5], "variation_value": ["ScatterValueSource", "randomness", 0.5],
	"scale_value": ["ScatterValueSource", "min_value", -0.5],
	"physics_material": ["PhysicsMaterial", "friction", 0.25],
}


func made(type: String) -> Resource:
	return ClassDB.instantiate(type)


## Returns a layer in which every property in PROPERTIES differs from its default.
func full_layer() -> ScatterLayer:
	var layer := make_layer()
	layer.resource_name = "Ferns"
	layer.density_over_height = make_line(Vector2(100, 0), Vector2(900, 1))
	layer.density_expression = "slope < 45"
	layer.density_rules = [ScatterRule.new()]
	layer.mesh_density_expressions = ["height < 100", "", "noise(20)"]
	layer.density_over_slope = make_line(Vector2(0, 1), Vector2(90, 0))
	layer.ground_textures = [3, 0, 255]
	layer.noise = FastNoiseLite.new()
	layer.noise_curve = make_line(Vector2(-1, 0), Vector2(1, 1))
	layer.mask = ScatterMask.new()
	layer.mask.paint(Vector2(30, 40), 9.0, 1.0, 0.5, ScatterMask.MODE_ERASE)
	layer.mask_texture = GradientTexture2D.new()
	layer.mask_texture_rect = Rect2(-50, -60, 70, 80)
	layer.mask_texture_channel = ScatterLayer.MASK_CHANNEL_LUMINANCE
	layer.mask_texture_edge = ScatterLayer.MASK_EDGE_REPEAT
	layer.clump_size = 25.0
	layer.clump_coverage = 0.75
	layer.clump_softness = 0.5
	layer.edge_feather = 4.0
	layer.spacing = {"Oaks": 4.0, "Stones": 1.5}
	layer.proximity_layer = "Oaks"
	layer.proximity_distance = 12.0
	layer.proximity_curve = make_line(Vector2(0, 1), Vector2(12, 0))
	layer.scale_curve = make_line(Vector2(0, 0), Vector2(1, 1))
	layer.scale_value = ScatterValueSource.new()
	layer.scale_value.source = ScatterValueSource.SOURCE_SLOPE
	layer.scale_value.max_value = 60.0
	layer.min_tilt_degrees = 5.0
	layer.max_tilt_degrees = 15.0
	layer.offset_along_normal = -0.25
	layer.use_colors = true
	layer.color_value = ScatterValueSource.new()
	layer.color_value.gradient = Gradient.new()
	layer.color_value.curve = make_line(Vector2(0, 1), Vector2(1, 0))
	layer.color_value.source = ScatterValueSource.SOURCE_HEIGHT
	layer.color_value.layer = "Oaks"
	layer.color_value.noise = FastNoiseLite.new()
	layer.color_value.min_value = -20.0
	layer.color_value.max_value = 350.0
	layer.color_value.randomness = 0.25
	layer.use_custom_data = true
	layer.variation_value = ScatterValueSource.new()
	layer.variation_value.source = ScatterValueSource.SOURCE_DISTANCE
	layer.variation_value.layer = "Stones"
	layer.layer_id = 32767
	layer.instance_radius = 0.4
	layer.instance_height = 12.0
	layer.regrowth_time = 3600.0
	layer.collision_shape = ScatterLayer.COLLISION_CONVEX
	layer.collision_distance = 60.0
	layer.collision_layer = 0xffffffff
	layer.collision_mask = 6
	layer.physics_material = PhysicsMaterial.new()
	layer.affect_navigation_mesh = false
	layer.scene = scene_of_a_node()
	layer.scene_distance = 15.0
	return layer


func scene_of_a_node() -> PackedScene:
	var node := Node3D.new()
	var scene := PackedScene.new()
	scene.pack(node)
	node.free()
	return scene


func check_full(layer: ScatterLayer, from: String) -> void:
	var expected := full_layer()
	for property in PROPERTIES:
		var value: Variant = layer.get(property)
		check(value != ClassDB.class_get_property_default_value(&"ScatterLayer", property), "%s from %s is not the default" % [property, from])
		if not value is Resource and property != &"density_rules":
			check_equal(value, expected.get(property), String(property) + " from " + from)
	check_equal(layer.spacing, {"Oaks": 4.0, "Stones": 1.5} as Dictionary[String, float], "spacing from " + from)
	check_equal(layer.resource_name, "Ferns", "name from " + from)
	check(layer.density_rules.size() == 1 and layer.density_rules[0] is ScatterRule, "a rule from " + from)
	check(is_equal_approx(layer.density_over_height.sample(300.0), 0.25), "a curve from " + from)
	check_equal(layer.mask.data, expected.mask.data, "mask pixels from " + from)


func test_files() -> void:
	var layer := full_layer()
	check_full(layer, "memory")
	for ending: String in [".tres", ".res"]:
		check_equal(ResourceSaver.save(layer, SPOT + ending), OK, "the layer is saved")
		check_full(ResourceLoader.load(SPOT + ending, "", ResourceLoader.CACHE_MODE_IGNORE_DEEP), ending)
		DirAccess.remove_absolute(SPOT + ending)
	check_full(layer.duplicate(), "a copy")
	check_full(layer.duplicate_deep(Resource.DEEP_DUPLICATE_ALL), "a deep copy")
	var scatter := TerrainScatter3D.new()
	scatter.layers = [layer]
	var scene := PackedScene.new()
	scene.pack(scatter)
	check_equal(ResourceSaver.save(scene, SPOT + ".tscn"), OK, "saved in a scene")
	var loaded: PackedScene = ResourceLoader.load(SPOT + ".tscn", "", ResourceLoader.CACHE_MODE_IGNORE_DEEP)
	var copy: TerrainScatter3D = loaded.instantiate()
	check_full(copy.layers[0], ".tscn")
	DirAccess.remove_absolute(SPOT + ".tscn")
	copy.free()
	scatter.free()


func refuse(layer: ScatterLayer, property: StringName, value: Variant, words := []) -> void:
	var changes: Array[int] = [0]
	var count := func() -> void: changes[0] += 1
	var before: Variant = layer.get(property)
	layer.changed.connect(count)
	layer.set(property, value)
	layer.changed.disconnect(count)
	check_error(["ScatterLayer.%s" % property] + words, "%s = %s" % [property, value])
	check_equal(layer.get(property), before, "%s after %s" % [property, value])
	check_equal(changes[0], 0, "no signal")


func test_rejected() -> void:
	var layer := full_layer()
	refuse(layer, "clump_size", 0.05, ["range", "0.05"])
	for property: String in ["clump_coverage", "clump_softness"]:
		refuse(layer, property, -0.1, ["range"])
		refuse(layer, property, 1.1, ["range"])
	refuse(layer, "edge_feather", 1001.0, ["range"])
	refuse(layer, "edge_feather", -1.0, ["range"])
	refuse(layer, "proximity_distance", 1001.0, ["range"])
	for property: String in ["min_tilt_degrees", "max_tilt_degrees"]:
		refuse(layer, property, 91.0, ["range"])
		refuse(layer, property, -1.0, ["range"])
	refuse(layer, "offset_along_normal", -10001.0, ["range"])
	for number: int in [-1, 6, 1 << 40]:
		refuse(layer, "mask_texture_channel", number, ["range"])
		refuse(layer, "mask_texture_edge", number if number != 6 else 4, ["range"])
	for rect: Rect2 in [Rect2(0, 0, 0, 5), Rect2(0, 0, 5, -1), Rect2(0, 0, NAN, 5), Rect2(INF, 0, 5, 5), Rect2(2e9, 0, 5, 5)]:
		refuse(layer, "mask_texture_rect", rect)
	for property: String in ["instance_radius", "instance_height"]:
		refuse(layer, property, 0.0, ["between 0.001 and 10000"])
		refuse(layer, property, 10001.0, ["range"])
	for property: String in ["collision_distance", "scene_distance"]:
		refuse(layer, property, -1.0, ["range"])
		refuse(layer, property, 10001.0, ["range"])
	refuse(layer, "regrowth_time", -1.0, ["range"])
	for property: String in ["collision_layer", "collision_mask"]:
		refuse(layer, property, -1, ["range"])
		refuse(layer, property, 1 << 32, ["range"])
	for number: int in [-1, 6, 1 << 40]:
		refuse(layer, "collision_shape", number, ["range"])
	refuse(layer, "ground_textures", PackedInt32Array([1, -1]), ["-1"])
	refuse(layer, "density_expression", "heigth > 3", ["\"heigth > 3\", column 1", "the inputs are height, slope"])
	refuse(layer, "mesh_density_expressions", PackedStringArray(["1", "heigth"]), ["[1]: \"heigth\", column 1", "the inputs are height, slope", "is kept"])
	refuse(layer, "density_expression", "smoothstep(0, 1", ["column 16", "expected \")\""])
	refuse(layer, "ground_textures", PackedInt32Array([256]), ["256"])
	var many := PackedInt32Array()
	many.resize(257)
	refuse(layer, "ground_textures", many, ["wrong size", "257"])
	check_full(layer, "before all rejected values")


func test_rejected_values_of_a_source() -> void:
	var value := ScatterValueSource.new()
	for refused: Array in [["source", [-1, 6, 1 << 40]], ["min_value", [NAN, INF, 1000001.0]], ["max_value", [NAN, -INF, -1000001.0]],
			["randomness", [-0.1, 1.1, NAN]], ["layer", [2.5, BoxMesh.new()]]]:
		var before: Variant = value.get(refused[0])
		for number: Variant in refused[1]:
			value.set(refused[0], number)
			check_error(["ScatterValueSource." + refused[0]], "%s = %s" % [refused[0], number])
			check_equal(value.get(refused[0]), before, "%s is unchanged" % refused[0])


func test_rejected_spacing() -> void:
	var layer := full_layer()
	for meters: float in [NAN, INF, 0.0, -1.0, 1000.5]:
		refuse(layer, "spacing", {"Oaks": 2.0, "Firs": meters} as Dictionary[String, float])
	var many: Dictionary[String, float] = {}
	for index in 17:
		many[str(index)] = 1.0
	refuse(layer, "spacing", many, ["wrong size", "17"])
	layer.set("spacing", {"Oaks": "near"})
	check_error(["ScatterLayer.spacing", "finite"], "a string is not a number")
	for bad: Variant in [[1, 2], "text", 5]:
		layer.set("spacing", bad)
	check_no_error("values of another type are never set")
	layer.spacing.set("Oaks", -7.0)
	check_error(["read-only"], "an edit that bypasses the checks")
	layer.spacing = {"Oaks": 1000.0, "Stones": 1}
	check_equal(layer.spacing, {"Oaks": 1000.0, "Stones": 1.0} as Dictionary[String, float], "spacing")
	var mine: Dictionary[String, float] = {"Oaks": 3.0}
	layer.spacing = mine
	mine["Oaks"] = -3.0
	check_equal(layer.spacing["Oaks"], 3.0, "the layer has a copy")
	var edited := layer.spacing.duplicate()
	edited["Firs"] = 2.0
	layer.spacing = edited
	check_equal(layer.spacing.size(), 2, "edits by a script")


## When a resource changes, the layer emits `changed` once per property that uses it.
func test_changes_within_resources() -> void:
	for property: String in sources:
		var layer := ScatterLayer.new()
		var changes: Array[int] = [0]
		layer.changed.connect(func() -> void: changes[0] += 1)
		var source := made(sources[property][0])
		layer.set(property, source)
		check_equal(changes[0], 1, property + " set")
		layer.set(property, source)
		check_equal(changes[0], 1, property + " set to the same value")
		source.set(sources[property][1], sources[property][2])
		check(changes[0] == 2, "%s edited: %d signals" % [property, changes[0] - 1])
		layer.set(property, null)
		check_equal(changes[0], 3, property + " removed")
		source.emit_changed()
		check_equal(changes[0], 3, property + " is disconnected")
	var curve := Curve.new()
	var layer := ScatterLayer.new()
	var changes: Array[int] = [0]
	layer.density_over_height = curve
	layer.density_over_slope = curve
	layer.changed.connect(func() -> void: changes[0] += 1)
	layer.density_over_height = null
	curve.emit_changed()
	check_equal(changes[0], 2, "clearing one of two uses of a curve and then editing the curve emit one signal each")


## Checks that `edit` causes exactly one warning, which contains `words`, on a valid layer. Expects no warning if `words` is empty.
func check_warning(edit: Callable, words: String) -> void:
	var layer := make_layer()
	edit.call(layer)
	var scatter := TerrainScatter3D.new()
	scatter.ground = ScatterGroundFlat.new()
	scatter.layers = [layer]
	var problems := scatter.get_problems()
	scatter.free()
	if words:
		check("Layer 0" in problems[0] and words in problems[0] if problems.size() == 1 else false, "'%s' in %s" % [words, problems])
	else:
		check_equal(problems, PackedStringArray(), "no warnings")


func test_a_mesh_without_surfaces_is_reported() -> void:
	check_warning(func(layer: ScatterLayer) -> void: layer.meshes = [BoxMesh.new(), ArrayMesh.new()], "meshes[1] has no surfaces")


func check_gameplay_warnings() -> void:
	check_warning(func(layer: ScatterLayer) -> void: layer.collision_shape = ScatterLayer.COLLISION_CONVEX, "")
	check_warning(func(layer: ScatterLayer) -> void: layer.instance_height = 0.5, "")
	check_warning(func(layer: ScatterLayer) -> void:
		layer.collision_shape = ScatterLayer.COLLISION_CAPSULE
		layer.instance_height = 0.5, "two times instance_radius")
	check_warning(func(layer: ScatterLayer) -> void:
		layer.collision_shape = ScatterLayer.COLLISION_BOX
		layer.collision_distance = 0.0, "")
	check_warning(func(layer: ScatterLayer) -> void:
		layer.collision_shape = ScatterLayer.COLLISION_BOX
		layer.affect_navigation_mesh = false
		layer.collision_distance = 0.0, "collision_distance is 0")
	check_warning(func(layer: ScatterLayer) -> void:
		layer.collision_shape = ScatterLayer.COLLISION_BOX
		layer.collision_layer = 0
		layer.collision_mask = 0, "collides with nothing")
	check_warning(func(layer: ScatterLayer) -> void: layer.collision_shape = ScatterLayer.COLLISION_MODEL, "no model in meshes")
	check_warning(func(layer: ScatterLayer) -> void: layer.physics_material = PhysicsMaterial.new(), "physics_material is not used")
	check_warning(func(layer: ScatterLayer) -> void:
		layer.scene = scene_of_a_node()
		layer.scene_distance = 0.0, "scene_distance is 0")
	var bare := ScatterLayer.new()
	bare.collision_shape = ScatterLayer.COLLISION_CONVEX
	var scatter := TerrainScatter3D.new()
	scatter.layers = [bare]
	check("no mesh to build a hull from" in "\n".join(scatter.get_problems()), "a hull without a mesh")
	scatter.free()


## Colors a layer with a gradient over a value source whose maximum is `to`.
func follow(layer: ScatterLayer, source: ScatterValueSource.Source, to := 90.0) -> void:
	layer.use_colors = true
	layer.color_value = value_of(source)
	layer.color_value.gradient = Gradient.new()
	layer.color_value.max_value = to


func value_of(source: ScatterValueSource.Source) -> ScatterValueSource:
	var value := ScatterValueSource.new()
	value.source = source
	return value


func test_warnings_of_sources() -> void:
	for source: ScatterValueSource.Source in [ScatterValueSource.SOURCE_HEIGHT, ScatterValueSource.SOURCE_SLOPE, ScatterValueSource.SOURCE_RANK]:
		check_warning(func(layer: ScatterLayer) -> void: follow(layer, source), "")
	check_warning(func(layer: ScatterLayer) -> void: follow(layer, ScatterValueSource.SOURCE_HEIGHT, 1.0), "0 to 1 meters of height")
	check_warning(func(layer: ScatterLayer) -> void: follow(layer, ScatterValueSource.SOURCE_SLOPE, 1.0), "0 to 1 degrees of slope")
	check_warning(func(layer: ScatterLayer) -> void: follow(layer, ScatterValueSource.SOURCE_RANK, 1.0), "")
	check_warning(func(layer: ScatterLayer) -> void: follow(layer, ScatterValueSource.SOURCE_NOISE, 1.0), "there is no noise")
	check_warning(func(layer: ScatterLayer) -> void: follow(layer, ScatterValueSource.SOURCE_DISTANCE), "names no layer")
	check_warning(func(layer: ScatterLayer) -> void:
		follow(layer, ScatterValueSource.SOURCE_DISTANCE)
		layer.color_value.layer = "Oaks", "\"Oaks\", and no layer has that name")
	check_warning(func(layer: ScatterLayer) -> void:
		follow(layer, ScatterValueSource.SOURCE_HEIGHT)
		layer.color_value.randomness = 1.0, "the randomness is 1")
	check_warning(func(layer: ScatterLayer) -> void:
		follow(layer, ScatterValueSource.SOURCE_HEIGHT)
		layer.color_value.layer = "Oaks", "color_value.layer is not used: the source is not Distance")
	check_warning(func(layer: ScatterLayer) -> void:
		follow(layer, ScatterValueSource.SOURCE_HEIGHT)
		layer.color_value.noise = FastNoiseLite.new(), "color_value.noise is not used")
	check_warning(func(layer: ScatterLayer) -> void: layer.color_value = value_of(ScatterValueSource.SOURCE_RANK), "without use_colors")
	check_warning(func(layer: ScatterLayer) -> void:
		layer.use_colors = true
		layer.color_value = value_of(ScatterValueSource.SOURCE_RANK), "color_value has no gradient: all instances are white")
	check_warning(func(layer: ScatterLayer) -> void: layer.variation_value = value_of(ScatterValueSource.SOURCE_RANK), "without use_custom_data")
	check_warning(func(layer: ScatterLayer) -> void:
		layer.use_custom_data = true
		layer.variation_value = value_of(ScatterValueSource.SOURCE_RANK), "")
	check_warning(func(layer: ScatterLayer) -> void:
		follow(layer, ScatterValueSource.SOURCE_HEIGHT, -5.0), "color_value.max_value must be at least 0 (the start of its range), got -5")


func test_warnings() -> void:
	var zero := make_line(Vector2(0, 0), Vector2(90, 0))
	check_warning(func(_layer: ScatterLayer) -> void: pass, "")
	check_warning(func(layer: ScatterLayer) -> void: layer.density_over_height = zero, "density_over_height is 0 everywhere")
	check_warning(func(layer: ScatterLayer) -> void: layer.density_over_slope = zero, "density_over_slope is 0 everywhere")
	check_warning(func(layer: ScatterLayer) -> void: layer.density_over_slope = Curve.new(), "density_over_slope has no points")
	check_warning(func(layer: ScatterLayer) -> void: layer.density_over_height = make_line(Vector2(0, 0), Vector2(1, 1)), "meters of height")
	check_warning(func(layer: ScatterLayer) -> void: layer.noise_curve = make_line(Vector2(-1, 0), Vector2(1, 1)), "noise is empty")
	check_warning(func(layer: ScatterLayer) -> void: layer.noise = FastNoiseLite.new(), "")
	check_warning(func(layer: ScatterLayer) -> void: layer.mask = ScatterMask.new(), "mask has no effect")
	check_warning(func(layer: ScatterLayer) -> void:
		layer.mask = ScatterMask.new()
		layer.mask.background = 0.0, "is not painted")
	check_warning(func(layer: ScatterLayer) -> void:
		layer.mask = ScatterMask.new()
		layer.mask.paint(Vector2.ZERO, 3.0, 1.0, 0.5, ScatterMask.MODE_ERASE), "")
	check_warning(func(layer: ScatterLayer) -> void: layer.mask_texture = NoiseTexture2D.new(), "mask_texture has no readable image")
	check_warning(func(layer: ScatterLayer) -> void: layer.mask_texture = GradientTexture2D.new(), "mask_texture has no readable image")
	check_warning(func(layer: ScatterLayer) -> void:
		var texture := GradientTexture2D.new()
		texture.gradient = Gradient.new()
		layer.mask_texture = texture, "")
	check_warning(func(layer: ScatterLayer) -> void:
		layer.clump_size = 9.0
		layer.clump_coverage = 0.0, "clump_coverage is 0")
	check_warning(func(layer: ScatterLayer) -> void: layer.edge_feather = 3.0, "")
	check_warning(func(layer: ScatterLayer) -> void:
		layer.radius = 0.1
		layer.tile_size = 64.0
		layer.edge_feather = 3.0, "lower tile_size")
	check_warning(func(layer: ScatterLayer) -> void: layer.spacing = {"": 2.0}, "without a layer's name")
	check_warning(func(layer: ScatterLayer) -> void:
		layer.resource_name = "Oaks"
		layer.spacing = {"Oaks": 2.0}, "the layer itself")
	check_warning(func(layer: ScatterLayer) -> void: layer.spacing = {0: 2.0}, "the layer itself")
	check_warning(func(layer: ScatterLayer) -> void: layer.spacing = {7: 2.0}, "layer 7, which is not in the list")
	check_warning(func(layer: ScatterLayer) -> void: layer.proximity_curve = make_line(Vector2(0, 1), Vector2(9, 0)), "names no layer")
	check_warning(func(layer: ScatterLayer) -> void: layer.scale_curve = make_line(Vector2(0, 0), Vector2(1, 1)), "scale_curve has no effect")
	check_warning(func(layer: ScatterLayer) -> void: layer.scale_value = value_of(ScatterValueSource.SOURCE_RANK), "scale_value has no effect because min_scale equals max_scale")
	check_warning(func(layer: ScatterLayer) -> void:
		layer.max_scale = 2.0
		layer.scale_value = value_of(ScatterValueSource.SOURCE_HEIGHT), "scale_value still has the default range")
	check_warning(func(layer: ScatterLayer) -> void: layer.max_tilt_degrees = 20.0, "")
	check_gameplay_warnings()
	check_warning(func(layer: ScatterLayer) -> void: layer.min_tilt_degrees = 20.0, "max_tilt_degrees must be at least 20")
