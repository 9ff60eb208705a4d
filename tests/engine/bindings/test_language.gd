extends "../harness.gd"
## Tests how scripts see the library's classes through the bindings: calls, properties, references, overrides, signals and threads.

const OURS: PackedStringArray = [
	"ScatterImpostorBaker", "PoissonPoints", "PoissonSampler", "ScatterLayer", "ScatterMask", "ScatterGround", "ScatterGroundFlat",
	"ScatterGroundHeightmap", "TerrainScatter3D",
]

## Properties whose default of zero means that they are unset. Their setters reject zero.
const UNSET: PackedStringArray = ["ScatterGroundHeightmap.post_count"]


class Slope extends ScatterGround:
	func _get_heights(positions: PackedVector2Array) -> PackedFloat32Array:
		var heights := PackedFloat32Array()
		for at in positions:
			heights.push_back(at.x)
		return heights


class Leaning extends Slope:
	func _get_normals(positions: PackedVector2Array) -> PackedVector3Array:
		var normals := PackedVector3Array()
		normals.resize(positions.size())
		normals.fill(Vector3(3, 0, 4))
		return normals


class Wrong extends ScatterGround:
	@warning_ignore("untyped_declaration")
	func _get_heights(_positions):
		return "no heights"


func test_classes() -> void:
	for name in OURS:
		check(ClassDB.class_exists(name) and ClassDB.can_instantiate(name), name + " exists")
		check_equal(ClassDB.class_get_api_type(name), ClassDB.API_EXTENSION, name + " belongs to the extension")
		var object: Object = ClassDB.instantiate(name)
		check_equal(object.get_class(), name, "class name")
		check(object.is_class(ClassDB.get_parent_class(name)), name + " inherits")
		if object is Node:
			object.free()


## In the classes of OURS, every property has the inspector's default and the declared type. All properties except those in UNSET accept
## this default and return it.
func test_properties() -> void:
	for name in OURS:
		var object: Object = ClassDB.instantiate(name)
		for property: Dictionary in ClassDB.class_get_property_list(name, true):
			if not property["usage"] & PROPERTY_USAGE_EDITOR:
				continue
			var label := "%s.%s" % [name, property["name"]]
			var value: Variant = object.get(property["name"])
			check_equal(value, ClassDB.class_get_property_default_value(name, property["name"]), label + " starts at its default")
			var type: int = typeof(value) if value != null else TYPE_OBJECT
			var any: bool = property["usage"] & PROPERTY_USAGE_NIL_IS_VARIANT
			check(any or type == property["type"], "%s has its type: got %d" % [label, type])
			if label in UNSET:
				continue
			object.set(property["name"], value)
			check_equal(object.get(property["name"]), value, label + " reads back")
		if object is Node:
			object.free()


func test_hints() -> void:
	var hints := {}
	for name in OURS:
		for property: Dictionary in ClassDB.class_get_property_list(name, true):
			hints["%s.%s" % [name, property["name"]]] = property
	var layers: Dictionary = hints["TerrainScatter3D.layers"]
	check_equal(layers["type"], TYPE_ARRAY, "layers")
	check_equal(layers["hint"], PROPERTY_HINT_ARRAY_TYPE, "layers is a typed array")
	check_equal(layers["hint_string"], "%d/%d:ScatterLayer" % [TYPE_OBJECT, PROPERTY_HINT_RESOURCE_TYPE], "of layers")
	var terrain: Dictionary = hints["TerrainScatter3D.ground"]
	check_equal(terrain["class_name"], &"ScatterGround", "class of the ground")
	check_equal(terrain["hint"], PROPERTY_HINT_RESOURCE_TYPE, "the ground is chosen in the inspector")
	check_equal(hints["ScatterLayer.radius"]["hint"], PROPERTY_HINT_RANGE, "radius has a range")
	check("Rules" in hints.keys().map(func(key: String) -> String: return key.get_slice(".", 1)), "groups exist")


func test_typed_arrays() -> void:
	var scatter := TerrainScatter3D.new()
	var layer := ScatterLayer.new()
	scatter.layers = [layer, null]
	check_equal(scatter.layers.get_typed_builtin(), TYPE_OBJECT, "layers contains objects")
	check_equal(scatter.layers.get_typed_class_name(), &"ScatterLayer", "of the class")
	check(scatter.layers[0] == layer and scatter.layers[1] == null, "the same layers")
	scatter.set("layers", [layer] as Array)
	check_equal(scatter.layers.get_typed_class_name(), &"ScatterLayer", "an untyped array becomes typed")
	check_equal(scatter.layers.size(), 1, "with its contents")
	scatter.viewers = [^"a", ^"b/c"]
	check_equal(scatter.viewers, [^"a", ^"b/c"] as Array[NodePath], "viewers")
	var mesh := BoxMesh.new()
	layer.meshes = [mesh, SphereMesh.new()]
	check(layer.meshes[0] == mesh and layer.meshes[1] is SphereMesh, "meshes of derived classes")
	scatter.free()


func test_numbers() -> void:
	var sampler := PoissonSampler.new()
	for number: int in [0, -1, 9223372036854775807, -9223372036854775807 - 1, 4294967296]:
		sampler.seed = number
		check_equal(sampler.seed, number, "64 bits")
	sampler.set("radius", 3)
	check_equal(sampler.radius, 3.0, "an integer is converted to a float")
	sampler.radius = 0.1 + 0.2
	check_equal(sampler.radius, 0.1 + 0.2, "all 53 bits of a float")


func test_wrong_values() -> void:
	var scatter := TerrainScatter3D.new()
	var flat := ScatterGroundFlat.new()
	scatter.ground = flat
	for wrong: Variant in [Resource.new(), ScatterLayer.new(), 5, "text", Vector3.ZERO]:
		scatter.set("ground", wrong)
		check(scatter.ground == flat, "%s is not a ground" % [wrong])
	scatter.set("seed", "text")
	check_equal(scatter.seed, 0, "text is not a seed")
	scatter.set("ground", null)
	check(scatter.ground == null, "null clears the ground")
	scatter.free()
	var resources: Dictionary[String, Resource] = {
		"density_over_height": Curve.new(), "density_over_slope": Curve.new(), "noise": FastNoiseLite.new(), "noise_curve": Curve.new(),
		"mask": ScatterMask.new(), "mask_texture": GradientTexture2D.new(), "proximity_curve": Curve.new(), "scale_curve": Curve.new(),
		"color_value": ScatterValueSource.new(), "variation_value": ScatterValueSource.new(), "scale_value": ScatterValueSource.new(), "physics_material": PhysicsMaterial.new(),
	}
	var layer := ScatterLayer.new()
	for property in resources:
		layer.set(property, resources[property])
		layer.set(property, BoxMesh.new())
		check(layer.get(property) == resources[property], property + " rejects a mesh")
	check_no_error("values of another class are never set")
	check(PoissonSampler.new().callv("sample_domain", ["text"]) == null, "text is not a rectangle")
	check_error(["PoissonSampler::sample_domain"], "text is not a rectangle")


func test_overrides() -> void:
	var slope := Slope.new()
	check_equal(slope.get_height(Vector3(5, 1, 2)), 5.0, "the script's heights")
	check(slope.get_normal(Vector3(5, 1, 2)).is_equal_approx(Vector3(-1, 1, 0).normalized()), "the slope of these heights")
	check(Leaning.new().get_normal(Vector3.ZERO).is_equal_approx(Vector3(0.6, 0, 0.8)), "the script's normals")
	check(is_nan(ScatterGround.new().get_height(Vector3.ZERO)), "no ground without an override")
	var virtuals: Array[StringName] = []
	for method: Dictionary in ClassDB.class_get_method_list("ScatterGround", true):
		if method["flags"] & METHOD_FLAG_VIRTUAL:
			virtuals.push_back(method["name"])
			if method["name"] == &"_get_heights":
				check_equal(method["args"][0]["name"], "positions", "named argument")
				check_equal(method["args"][0]["type"], TYPE_PACKED_VECTOR2_ARRAY, "typed argument")
				check_equal(method["return"]["type"], TYPE_PACKED_FLOAT32_ARRAY, "typed result")
	check(&"_get_heights" in virtuals and &"_get_normals" in virtuals, "the editor offers the overrides")
	errors.take()
	check(is_nan(Wrong.new().get_height(Vector3.ZERO)), "a result of a wrong type means no ground")
	check_error(["_get_heights"], "an error")


func test_references() -> void:
	var scatter := TerrainScatter3D.new()
	var flat := ScatterGroundFlat.new()
	check_equal(flat.get_reference_count(), 1, "a new object")
	scatter.ground = flat
	check_equal(flat.get_reference_count(), 2, "referenced by the node")
	check(scatter.ground == flat, "the getter returns the same object")
	check_equal(flat.get_reference_count(), 2, "reading adds no reference")
	scatter.ground = null
	check_equal(flat.get_reference_count(), 1, "released")
	scatter.ground = flat
	var layer := ScatterLayer.new()
	scatter.layers = [layer]
	var mesh := BoxMesh.new()
	layer.meshes = [mesh]
	layer.material_override = StandardMaterial3D.new()
	var seen: Array[WeakRef] = [weakref(flat), weakref(layer), weakref(mesh), weakref(layer.material_override)]
	root.add_child(scatter)
	await frames(3)
	scatter.queue_free()
	await frames(2)
	flat = null
	layer = null
	mesh = null
	for reference in seen:
		check(reference.get_ref() == null, "freed with the last reference: %s" % [reference.get_ref()])


## Signals arrive with arguments of the declared types.
func test_signals() -> void:
	for signal_info: Dictionary in ClassDB.class_get_signal_list("TerrainScatter3D", true):
		if signal_info["name"] in [&"tile_shown", &"tile_hidden"]:
			var types: Array = signal_info["args"].map(func(argument: Dictionary) -> int: return argument["type"])
			check_equal(types, [TYPE_OBJECT, TYPE_VECTOR2I], "%s's arguments" % [signal_info["name"]])
	var changes: Array[int] = [0]
	var flat := ScatterGroundFlat.new()
	flat.changed.connect(func() -> void: changes[0] += 1)
	flat.height = 3.0
	check_equal(changes[0], 1, "changed is emitted")
	var shown: Array = []
	var scatter := make_scatter([make_layer(4.0)], flat, make_viewer())
	scatter.tile_shown.connect(func(layer: ScatterLayer, tile: Vector2i) -> void: shown.push_back([layer, tile]))
	await settle(scatter)
	check(shown.size() > 4 and shown[0][0] == scatter.layers[0] and shown[0][1] is Vector2i, "tiles were shown: %s" % [shown.slice(0, 3)])


func test_enumerations() -> void:
	check_equal(ClassDB.class_get_enum_list("PoissonSampler", true), PackedStringArray(["Method"]), "enumerations")
	var constants := ClassDB.class_get_enum_constants("PoissonSampler", "Method", true)
	for index in constants.size():
		check_equal(ClassDB.class_get_integer_constant("PoissonSampler", constants[index]), index, constants[index])
	check_equal(constants[PoissonSampler.METHOD_WAVEFRONT], "METHOD_WAVEFRONT", "a constant by its name")
	var sampler := PoissonSampler.new()
	sampler.method = PoissonSampler.METHOD_NAIVE
	check_equal(sampler.method, PoissonSampler.METHOD_NAIVE, "an enumeration's value")


func test_default_arguments() -> void:
	var defaults := {
		"sample_domain": [Callable()],
		"sample_domain_exact": [Callable()],
		"sample_surface": [Transform3D(), AABB()],
		"sample_faces": [AABB()],
	}
	for method: Dictionary in ClassDB.class_get_method_list("PoissonSampler", true):
		check_equal(method["default_args"], defaults.get(method["name"], []), "defaults of %s" % method["name"])
	var sampler := PoissonSampler.new()
	var reported: Array[int] = [0]
	var progress := func(_fraction: float, points: int) -> void: reported[0] = points
	var points := sampler.sample_domain(Rect2(0, 0, 9, 9))
	check_equal(sampler.sample_domain(Rect2(0, 0, 9, 9), progress), points, "the same with and without the argument")
	check_equal(reported[0], points.size(), "the argument arrives")
	check_equal(sampler.callv("sample_domain", [Rect2(0, 0, 9, 9)]), points, "by name, without the argument")
	check_equal(sampler.call("sample_domain_exact", 0.0, 0.0, 9.0, 9.0)["x"].size(), points.size(), "four of five arguments")


## Many threads make their first calls concurrently, so the lazy lookups in the bindings race.
func test_threads() -> void:
	var results: Array = []
	results.resize(16)
	var work := func(index: int) -> void:
		var sampler := PoissonSampler.new()
		sampler.radius = 1.5
		sampler.progressive_levels = 2
		results[index] = sampler.sample(Rect2(-20, -20, 40, 40)).ids
	var threads: Array[Thread] = []
	for index in results.size():
		threads.push_back(Thread.new())
		threads[index].start(work.bind(index))
	for thread in threads:
		thread.wait_to_finish()
	check((results[0] as PackedInt64Array).size() > 100, "there are points")
	for result: PackedInt64Array in results:
		check(result == results[0], "the same on every thread")
