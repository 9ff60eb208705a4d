extends "harness.gd"
## Tests a layer's properties in the inspector: their order, groups and units, and when they are hidden.


func scene_of_a_node() -> PackedScene:
	var node := Node3D.new()
	var scene := PackedScene.new()
	scene.pack(node)
	node.free()
	return scene


## Returns the names of the properties that the inspector shows, in the order of the inspector.
func shown_properties(object: Object) -> PackedStringArray:
	var result := PackedStringArray()
	for property: Dictionary in object.get_property_list():
		if property["usage"] & PROPERTY_USAGE_EDITOR:
			result.push_back(property["name"])
	return result


func test_important_properties_come_first() -> void:
	var shown := Array(shown_properties(make_layer()))
	var own := shown.slice(shown.find("meshes"))
	check_equal(own.slice(0, 4), ["meshes", "radius", "density", "min_scale"], "the most important properties come first")
	var advanced := ["progressive_levels", "tile_size", "layer_id"]
	var first := own.find("progressive_levels")
	check_equal(own.slice(first, first + 3), advanced, "the advanced properties are adjacent")
	check(first > own.find("scene") and first > own.find("view_distance"), "the advanced properties come last")


## Properties without effect are hidden but stored. They appear once they have an effect or a value.
func test_properties_without_effect_are_hidden() -> void:
	var uses := {
		"mesh_weights": ["meshes", [BoxMesh.new(), SphereMesh.new()] as Array[Mesh]],
		"mesh_density_expressions": ["meshes", [BoxMesh.new(), SphereMesh.new()] as Array[Mesh]],
		"scale_curve": ["max_scale", 2.0], "scale_value": ["max_scale", 2.0], "noise_curve": ["noise", FastNoiseLite.new()],
		"mask_texture_rect": ["mask_texture", GradientTexture2D.new()], "mask_texture_edge": ["mask_texture", GradientTexture2D.new()],
		"mask_texture_channel": ["mask_texture", GradientTexture2D.new()], "clump_coverage": ["clump_size", 9.0],
		"clump_softness": ["clump_size", 9.0], "surface_layers": ["on_surfaces", true], "proximity_distance": ["proximity_layer", "Oaks"],
		"proximity_curve": ["proximity_layer", "Oaks"], "color_value": ["use_colors", true], "variation_value": ["use_custom_data", true],
		"thin_begin": ["thin_density", 0.5], "thin_end": ["thin_density", 0.5], "thin_scale_up": ["thin_density", 0.5],
		"collision_distance": ["collision_shape", ScatterLayer.COLLISION_BOX], "collision_layer": ["collision_shape", ScatterLayer.COLLISION_BOX],
		"collision_mask": ["collision_shape", ScatterLayer.COLLISION_BOX], "physics_material": ["collision_shape", ScatterLayer.COLLISION_BOX],
		"affect_navigation_mesh": ["collision_shape", ScatterLayer.COLLISION_BOX], "scene_distance": ["scene", scene_of_a_node()],
	}
	for name: String in uses:
		var layer := make_layer()
		var notifications: Array[int] = [0]
		check(not name in shown_properties(layer), name + " is hidden")
		layer.property_list_changed.connect(func() -> void: notifications[0] += 1)
		layer.set(uses[name][0], uses[name][1])
		check(name in shown_properties(layer), "%s is visible for %s" % [name, uses[name][0]])
		check_equal(notifications[0], 1, "one notification of the inspector for " + name)
		layer.set(uses[name][0], uses[name][1])
		check_equal(notifications[0], 1, "no further notification for " + name)
	for property: Dictionary in make_layer().get_property_list():
		if property["name"] in uses:
			check(property["usage"] & PROPERTY_USAGE_STORAGE != 0, property["name"] + " is stored")
	var bare := make_layer()
	bare.scale_curve = Curve.new()
	check("scale_curve" in shown_properties(bare), "a property with a value is visible even if it has no effect")


## Rows replace the radius, and their direction replaces the yaw.
func test_properties_without_effect_in_rows_are_hidden() -> void:
	var layer := make_layer()
	layer.rows = ScatterRows.new()
	for name in ["radius", "progressive_levels", "min_yaw_degrees", "max_yaw_degrees"]:
		check(name in shown_properties(make_layer()) and not name in shown_properties(layer), name + " is hidden in rows")
	layer.rows.align_to_rows = false
	check("min_yaw_degrees" in shown_properties(layer), "the yaw is visible if instances do not face along their row")
	var rows := ScatterRows.new()
	check("offsets" in shown_properties(rows) and not "row_distance" in shown_properties(rows), "rows along paths have offsets")
	rows.fill_area = true
	check(not "offsets" in shown_properties(rows) and "row_distance" in shown_properties(rows), "rows over areas have a distance")
	rows.align_to_rows = false
	check(not "yaw_degrees" in shown_properties(rows), "rows without alignment have no yaw")


## The minimum and the maximum of a value source use the source's unit.
func test_the_range_of_a_source_has_its_unit() -> void:
	var units := {
		ScatterValueSource.SOURCE_HEIGHT: "suffix:m", ScatterValueSource.SOURCE_SLOPE: "degrees", ScatterValueSource.SOURCE_NOISE: "0,1",
		ScatterValueSource.SOURCE_RANK: "0,1", ScatterValueSource.SOURCE_DISTANCE: "suffix:m",
	}
	var used := {ScatterValueSource.SOURCE_NOISE: ["noise"], ScatterValueSource.SOURCE_DISTANCE: ["layer"]}
	var value := ScatterValueSource.new()
	var notifications: Array[int] = [0]
	value.property_list_changed.connect(func() -> void: notifications[0] += 1)
	check(not "max_value" in shown_properties(value), "a random number has no range")
	for source: ScatterValueSource.Source in units:
		value.source = source
		for property in value.get_property_list():
			if property["name"] in ["min_value", "max_value"]:
				check(units[source] in property["hint_string"], "%s of %d: %s" % [property["name"], source, property["hint_string"]])
		var shown := shown_properties(value)
		check("randomness" in shown, "properties of all sources")
		for name: String in ["noise", "layer"]:
			check_equal(name in shown, name in used.get(source, []), "%s of %d" % [name, source])
	check_equal(notifications[0], units.size(), "one notification of the inspector per source")
	value.noise = FastNoiseLite.new()
	check("noise" in shown_properties(value), "a property with a value is visible even if it has no effect")


## Properties are in the right groups, and angles, lengths and times have a unit.
func test_groups_and_units() -> void:
	var group := ""
	var subgroup := ""
	var start := ""
	var groups := {}
	for property: Dictionary in ClassDB.class_get_property_list("ScatterLayer", true):
		var name: String = property["name"]
		if property["usage"] & PROPERTY_USAGE_GROUP:
			group = name
			subgroup = ""
		elif property["usage"] & PROPERTY_USAGE_SUBGROUP:
			subgroup = name
			start = property["hint_string"]
		elif property["usage"] & PROPERTY_USAGE_EDITOR:
			if not name.begins_with(start) and not start.begins_with(name): # The inspector uses the same rule to end a subgroup.
				subgroup = ""
			groups[name] = group + "/" + subgroup
			var hint: String = property["hint_string"]
			if name.ends_with("_degrees") or name == "slope_falloff_degrees":
				check("degrees" in hint, "%s has a unit: %s" % [name, hint])
			elif name in ["radius", "clump_size", "edge_feather", "mask_texture_rect", "tile_size", "instance_radius"] or name.ends_with("_distance") \
					or "offset" in name or "_height" in name and property["type"] == TYPE_FLOAT:
				check("suffix:m" in hint, "%s has a unit: %s" % [name, hint])
			elif name.ends_with("_time"):
				check("suffix:s" in hint, "%s has a unit: %s" % [name, hint])
	for expected: Array in [["radius", "/"], ["density", "/"], ["meshes", "/"], ["mesh_weights", "/"], ["mesh_density_expressions", "/"], ["density_expression", "Rules/"], ["density_rules", "Rules/"], ["density_over_height", "Rules/Height"],
			["slope_falloff_degrees", "Rules/Slope"], ["ground_textures", "Rules/Ground"], ["noise_curve", "Rules/Noise"],
			["mask", "Rules/Mask"], ["mask_texture_edge", "Rules/Mask"], ["clump_size", "Rules/Clumping"],
			["edge_feather", "Rules/Edge"], ["spacing", "Other Layers/"], ["spacing_fills", "Other Layers/"], ["proximity_curve", "Other Layers/Proximity"],
			["scale_curve", "Placement/"], ["scale_value", "Placement/"], ["offset_along_normal", "Placement/"], ["use_colors", "Drawing/"],
			["color_value", "Drawing/"], ["use_custom_data", "Drawing/"], ["variation_value", "Drawing/"],
			["instance_radius", "Gameplay/"], ["regrowth_time", "Gameplay/"], ["collision_shape", "Gameplay/Collision"],
			["physics_material", "Gameplay/Collision"], ["scene", "Gameplay/Scene"], ["scene_distance", "Gameplay/Scene"],
			["view_distance", "Distance/"], ["lod_fade", "Distance/LOD"], ["thin_end", "Distance/Thinning"],
			["render_layers", "Drawing/"], ["layer_id", "Advanced/"],
			["tile_size", "Advanced/"], ["progressive_levels", "Advanced/"]]:
		check_equal(groups[expected[0]], expected[1], "group of %s" % expected[0])
