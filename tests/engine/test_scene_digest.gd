extends "harness.gd"
## Tests a scene's digest, which a bake uses to detect changes. It depends on all properties that affect instances, and on no others.

const SceneDigest := preload("res://addons/thicket/baking/scene_digest.gd")

const RECT := Rect2(-32.0, -32.0, 64.0, 64.0)
## Properties that all resources store.
const OF_RESOURCES: Array[StringName] = [&"script", &"resource_name", &"resource_path", &"resource_local_to_scene", &"resource_scene_unique_id"]
## New values for properties for which `other_value` cannot derive a valid one.
const CHANGED: Dictionary[StringName, Variant] = {
	&"layer_id": 5, &"meshes": [], &"spacing": {"Other": 1.0}, &"proximity_layer": "Other", &"surface_layers": ["Other"],
	&"density_expression": "slope < 45", &"ground_textures": [1], &"mesh_weights": [2.0],
	&"mesh_density_expressions": ["slope < 45"],
	&"draw_cell_size": 16.0, &"max_scale": 1.5, &"min_scale": 0.5, &"progressive_levels": 2, &"radius": 3.0, &"density": 0.5,
}


func layer_part(scatter: TerrainScatter3D) -> String:
	return SceneDigest.parts_of(scatter, RECT)["layer 0 ()"]


## Returns a valid value for a property that differs from its current value.
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
			return [ScatterRule.new()] if property.name == "density_rules" else [BoxMesh.new()]
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


## Changes each property alone. The digest must change if and only if affects_placement returns true for the property. If affects_placement
## returns false, the rows of a tile must remain bit-identical.
func test_properties_that_affect_placement_change_the_digest() -> void:
	var layer := make_layer()
	layer.thin_end = 100.0
	var scatter := make_scatter([layer], ScatterGroundFlat.new(), make_viewer())
	await settle(scatter)
	var placement := 0
	var properties := stored_properties(layer)
	check(not scatter.build_tile(layer, Vector2i.ZERO).is_empty(), "the compared tile has instances")
	for property in properties:
		var before: Variant = layer.get(property.name)
		var digest := layer_part(scatter)
		var rows := scatter.build_tile(scatter.layers[0], Vector2i.ZERO).get_rows()
		layer.set(property.name, other_value(layer, property))
		check(layer.get(property.name) != before, "%s accepts a new value" % property.name)
		var counts := layer.affects_placement(property.name)
		placement += int(counts)
		check_equal(layer_part(scatter) != digest, counts, "the digest and %s" % property.name)
		if not counts:
			check(scatter.build_tile(scatter.layers[0], Vector2i.ZERO).get_rows() == rows, "%s moves nothing" % property.name)
		layer.set(property.name, before)
		errors.take()
	check(placement > 40 and properties.size() - placement > 20, "%d of %d properties" % [placement, properties.size()])
	check(not layer.affects_placement(&"regrowth_time") and layer.affects_placement(&"tile_size"), "examples of both")
	check(layer.affects_placement(&"of_a_script"), "unknown properties affect placement")


## Geometry properties have counterparts in the engine with the same type and default, and only affect drawing.
func test_geometry_properties_match_the_engine() -> void:
	var layer := make_layer()
	var instance := MultiMeshInstance3D.new()
	var types := {}
	for property: Dictionary in layer.get_property_list() + instance.get_property_list():
		types.get_or_add(property.name, []).append(property.type)
	var properties := layer.get_geometry_properties()
	for own: StringName in properties:
		check(types.has(String(own)) and types.has(String(properties[own])), "%s and %s exist" % [own, properties[own]])
		check_equal(types[String(own)][0], types[String(properties[own])][-1], "the type of %s" % own)
		check(not layer.affects_placement(own), "%s only affects drawing" % own)
		check(layer.get(own) == instance.get(properties[own]), "%s has the engine's default" % own)
	check_equal(properties.get(&"render_layers"), &"layers", "a property with a different name")
	instance.free()
