extends "harness.gd"
## Which changes of a scene a bake notices: those that instances follow from, and no others.

const SceneDigest := preload("res://addons/thicket/baking/scene_digest.gd")

const RECT := Rect2(-32.0, -32.0, 64.0, 64.0)
## Stored properties that are the engine's, not a layer's.
const OF_RESOURCES: Array[StringName] = [&"script", &"resource_name", &"resource_path", &"resource_local_to_scene", &"resource_scene_unique_id"]
## For properties of which a changed value has to be a particular one.
const CHANGED: Dictionary[StringName, Variant] = {
	&"layer_id": 5, &"meshes": [], &"spacing": {"Other": 1.0}, &"proximity_layer": "Other", &"color_source_layer": "Other",
	&"variation_source_layer": "Other", &"ground_textures": [1], &"mesh_weights": [2.0], &"lod_distances": [10.0],
	&"draw_cell_size": 16.0, &"max_scale": 1.5, &"min_scale": 0.5, &"progressive_levels": 2, &"radius": 3.0, &"density": 0.5,
}


func layer_part(scatter: TerrainScatter3D) -> String:
	return SceneDigest.parts_of(scatter, RECT)["layer 0 ()"]


## Another value than that of a property, which its setter takes.
func other_value(layer: ScatterLayer, property: Dictionary) -> Variant:
	var value: Variant = layer.get(property.name)
	if CHANGED.has(property.name):
		return CHANGED[property.name]
	match property.type:
		TYPE_BOOL:
			return not value
		TYPE_INT:
			return value - 1 if value >= 1 else value + 1
		TYPE_FLOAT:
			return 0.5 * value if value != 0.0 else 0.25
		TYPE_RECT2:
			return Rect2(1.0, 2.0, 3.0, 4.0)
		TYPE_ARRAY:
			return [BoxMesh.new()]
		TYPE_OBJECT:
			var kind: String = property.hint_string.get_slice(",", 0)
			match kind:
				"BaseMaterial3D":
					return StandardMaterial3D.new()
				"Texture2D":
					return ImageTexture.create_from_image(Image.create(2, 2, false, Image.FORMAT_L8))
				"Noise":
					return FastNoiseLite.new()
			return ClassDB.instantiate(kind)
	return null


func stored_properties(layer: ScatterLayer) -> Array[Dictionary]:
	return layer.get_property_list().filter(func(property: Dictionary) -> bool:
		return property.usage & PROPERTY_USAGE_STORAGE and not property.name in OF_RESOURCES)


## Each property by itself: the digest follows it exactly if the layer says that instances do, and where it says that they do not,
## the rows of a tile stay as they are to the bit.
func test_each_property_counts_if_instances_follow_from_it() -> void:
	var layer := make_layer()
	layer.thin_end = 100.0
	var scatter := make_scatter([layer], ScatterGroundFlat.new(), make_viewer())
	await settle(scatter)
	var placement := 0
	var properties := stored_properties(layer)
	for property in properties:
		var before: Variant = layer.get(property.name)
		var digest := layer_part(scatter)
		var rows := scatter.build_tile(0, Vector2i.ZERO).get_rows()
		layer.set(property.name, other_value(layer, property))
		check(layer.get(property.name) != before, "%s takes another value" % property.name)
		var counts := layer.affects_placement(property.name)
		placement += int(counts)
		check_equal(layer_part(scatter) != digest, counts, "the digest and %s" % property.name)
		if not counts:
			check(scatter.build_tile(0, Vector2i.ZERO).get_rows() == rows, "%s moves nothing" % property.name)
		layer.set(property.name, before)
		errors.take()
	check(placement > 40 and properties.size() - placement > 30, "%d of %d properties" % [placement, properties.size()])
	check(not layer.affects_placement(&"regrowth_time") and layer.affects_placement(&"tile_size"), "two of them")
	check(layer.affects_placement(&"of_a_script"), "what the layer does not know counts")


## What the layer says of the properties of the engine's instances holds for both: they are there, of one type, and drawing alone follows from them.
func test_geometry_properties_are_the_engines() -> void:
	var layer := make_layer()
	var instance := MultiMeshInstance3D.new()
	var types := {}
	for property: Dictionary in layer.get_property_list() + instance.get_property_list():
		types.get_or_add(property.name, []).append(property.type)
	var properties := layer.get_geometry_properties()
	for own: StringName in properties:
		check(types.has(String(own)) and types.has(String(properties[own])), "%s and %s are there" % [own, properties[own]])
		check_equal(types[String(own)][0], types[String(properties[own])][-1], "the type of %s" % own)
		check(not layer.affects_placement(own), "%s is how a layer is drawn" % own)
		check(layer.get(own) == instance.get(properties[own]), "%s is at first as the engine's" % own)
	check_equal(properties.get(&"render_layers"), &"layers", "the one with another name")
	instance.free()
