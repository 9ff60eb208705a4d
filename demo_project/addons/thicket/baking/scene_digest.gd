extends RefCounted
## Hashes everything that determines a scene's instances, part by part. A bake that continues after an interruption compares the
## hashes to find out which parts of the scene have changed.
##
## The hashes cover the version of the add-on, the node's seed, water and world offset, and the instances that its state removes or adds. They cover
## the stored properties of the node's layers, biomes, regions and ground. They include all resources in these, the files and scripts from which they
## are loaded, and heights of the ground and densities of rule scripts throughout a rectangle. The appearance of instances is not included. Data that
## a script reads from elsewhere is only covered by those heights and densities.

## The number of cells along each edge of the rectangle. The height at the center of each cell is hashed.
const PROBES := 33
## The file that contains the version of the add-on.
const PLUGIN := "res://addons/thicket/plugin.cfg"
## Resources of which only the class and the path are hashed, because they only determine the appearance of instances.
const APPEARANCE_CLASSES: Array[StringName] = [&"Mesh", &"PackedScene", &"ScatterModel", &"Material", &"Shader", &"Shape3D", &"PhysicsMaterial"]

var _hashing: HashingContext
var _object_ids: Dictionary[Object, int] = {}


## Returns the hashes of all parts in hexadecimal digits, by readable names. The ground is sampled in [param rect] (x and z in meters).
static func parts_of(scatter: TerrainScatter3D, rect: Rect2) -> Dictionary[String, String]:
	var digests: Dictionary[String, String] = {}
	var add := func(name: String, values: Array) -> void: digests[name] = new()._digest(values)
	add.call("the add-on", [version()])
	add.call("the seed", [scatter.seed])
	add.call("the water", [scatter.water_enabled, scatter.water_level])
	add.call("the world's offset", [scatter.world_offset])
	var layers := scatter.get_all_layers()
	for index in layers.size():
		var layer := layers[index]
		if layer != null:
			add.call("layer %d (%s)" % [index, layer.resource_name], [layer] + _paths_of(scatter, layer))
	add.call("the biomes", [scatter.biomes] + _biome_names_of(scatter))
	add.call("the regions", scatter.find_children("*", "ScatterRegion3D", true, false))
	add.call("the ground", [scatter.ground])
	var heights := PackedFloat64Array()
	var probes := PackedVector3Array()
	for row in PROBES:
		for column in PROBES:
			var probe_xz := rect.position + rect.size * Vector2(column + 0.5, row + 0.5) / PROBES
			probes.append(Vector3(probe_xz.x, 0.0, probe_xz.y))
			heights.append(scatter.ground.get_height(probes[-1]))
	add.call("the heights of the ground", [heights])
	for index in layers.size():
		if layers[index] != null and not layers[index].density_rules.is_empty():
			add.call("the rules of layer %d (%s)" % [index, layers[index].resource_name], _densities_of(layers[index], scatter.ground, probes, heights))
	var changes := scatter.state
	add.call("instances removed and placed by hand", [changes.get_digest() if changes != null and _has_changes(changes) else 0])
	return digests


## Returns the densities of each rule of a layer at those positions that have ground.
static func _densities_of(layer: ScatterLayer, ground: ScatterGround, probes: PackedVector3Array, heights: PackedFloat64Array) -> Array:
	var positions := PackedVector3Array()
	var normals := PackedVector3Array()
	var slopes := PackedFloat32Array()
	var weights := PackedFloat32Array()
	for index in probes.size():
		if is_finite(heights[index]):
			positions.append(Vector3(probes[index].x, heights[index], probes[index].z))
			normals.append(ground.get_normal(probes[index]))
			slopes.append(rad_to_deg(normals[-1].angle_to(Vector3.UP)))
			weights.append(1.0)
	var densities := []
	for rule in layer.density_rules:
		if rule != null and rule.has_method(&"_get_densities"):
			densities.append(rule.call(&"_get_densities", positions, normals, slopes, weights))
	return densities


## Returns the names and nodes of the paths along which the rows of a layer run.
static func _paths_of(scatter: TerrainScatter3D, layer: ScatterLayer) -> Array:
	var result := []
	if layer.rows != null and scatter.is_inside_tree():
		for node in scatter.get_tree().get_nodes_in_group(layer.rows.path_group):
			if node is Path3D:
				result.append_array([str(scatter.get_path_to(node)), node])
	return result


## Returns the names of the biomes if an expression refers to a biome, possibly by its name.
static func _biome_names_of(scatter: TerrainScatter3D) -> Array:
	var names := []
	for layer in scatter.get_all_layers():
		if layer != null and (layer.density_expression + "".join(layer.mesh_density_expressions)).contains("biome"):
			for biome: ScatterBiome in scatter.biomes.biomes if scatter.biomes != null else []:
				names.append(biome.resource_name if biome != null else "")
			return names
	return names


static func _has_changes(state: ScatterState) -> bool:
	return state.get_removed_count() > 0 or state.get_added_count() > 0


## Returns the version of the add-on, or an empty string if [constant PLUGIN] cannot be read.
static func version() -> String:
	var config := ConfigFile.new()
	return config.get_value("plugin", "version", "") if config.load(PLUGIN) == OK else ""


func _digest(values: Array) -> String:
	_hashing = HashingContext.new()
	_hashing.start(HashingContext.HASH_SHA256)
	for value: Variant in values:
		_add(value)
	return _hashing.finish().hex_encode()


func _add(value: Variant) -> void:
	match typeof(value):
		TYPE_OBJECT:
			_add_object(value)
		TYPE_ARRAY:
			_add_plain((value as Array).size())
			for element: Variant in value as Array:
				_add(element)
		TYPE_DICTIONARY:
			for key: Variant in value as Dictionary:
				_add(key)
				_add((value as Dictionary)[key])
		TYPE_STRING:
			_add_plain(value)
			if (value as String).begins_with("res://") or (value as String).begins_with("user://"):
				_add_file(value)
		TYPE_CALLABLE, TYPE_SIGNAL, TYPE_RID:
			pass
		_:
			_add_plain(value)


func _add_plain(value: Variant) -> void:
	_hashing.update(var_to_bytes(value))


func _add_file(path: String) -> void:
	if FileAccess.file_exists(path):
		_add_plain(FileAccess.get_sha256(path))


func _add_object(object: Object) -> void:
	if object == null or _object_ids.has(object):
		_add_plain(_object_ids.get(object, -1))
		return
	_object_ids[object] = _object_ids.size()
	_add_plain(object.get_class())
	if object is Resource:
		var path := (object as Resource).resource_path
		_add_plain(path.get_slice("::", 0) if path.begins_with("res://") else "")
		if APPEARANCE_CLASSES.any(func(type: StringName) -> bool: return object.is_class(type)):
			return
		if not "::" in path:
			_add_file(path)
	if object is Image:
		var image := object as Image
		_add_plain([image.get_format(), image.get_size()])
		_hashing.update(image.get_data())
		return
	if object is Texture2D and not object.get_class() == "NoiseTexture2D":
		_add((object as Texture2D).get_image())
	if object is Node3D:
		_add_plain((object as Node3D).global_transform)
		_add(object.get(&"curve"))
		if not object is ScatterRegion3D:
			return
	_add_script(object.get_script())
	for property: Dictionary in object.get_property_list():
		if property.usage & PROPERTY_USAGE_STORAGE and not _is_ignored(object, property.name):
			_add_plain(property.name)
			_add(object.get(property.name))
			if object is Node and property.type == TYPE_NODE_PATH: # The Path3D of a region.
				_add_object((object as Node).get_node_or_null(object.get(property.name)))


func _is_ignored(object: Object, property: StringName) -> bool:
	return property in [&"script", &"resource_name", &"resource_path", &"resource_local_to_scene"] \
			or (object is ScatterLayer and not (object as ScatterLayer).affects_placement(property))


func _add_script(script: Script) -> void:
	while script != null and not _object_ids.has(script):
		_object_ids[script] = _object_ids.size()
		_add_plain(script.source_code)
		if not script.resource_path.is_empty():
			for dependency in ResourceLoader.get_dependencies(script.resource_path):
				_add_file(dependency.get_slice("::", dependency.get_slice_count("::") - 1))
		script = script.get_base_script()
