@tool
extends "res://addons/thicket/editor/brush/painted_overlay.gd"
## Shows the biomes in their colors on the ground while the biome brush is on.

const OPACITY := 0.4


func _color_at(at: Vector2) -> Color:
	var biome := (_painted as ScatterBiomeMap).get_biome_at(at)
	return Color(biome.color, OPACITY) if biome != null else Color.TRANSPARENT
