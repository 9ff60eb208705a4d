@tool
extends "res://addons/thicket/editor/brush/painted_overlay.gd"
## Shows the biomes in their colors on the ground while the biome brush is on.

const OPACITY := 0.4


func _color_at(world_xz: Vector2) -> Color:
	return _color_of((_painted as ScatterBiomeMap).get_biome_at(world_xz))


func _color_on_planet(from_center: Vector3) -> Color:
	return _color_of((_painted as ScatterBiomeMap).get_biome_on_planet(planet_radius, from_center))


static func _color_of(biome: ScatterBiome) -> Color:
	return Color(biome.color, OPACITY) if biome != null else Color.TRANSPARENT
