@tool
extends "res://addons/thicket/editor/brush/painted_overlay.gd"
## Shows the mask of a layer on the ground while the brush is on: green where the layer may grow, and red where it may not.

const FULL_COLOR := Color(0.35, 0.95, 0.3, 0.2)
const EMPTY_COLOR := Color(1.0, 0.25, 0.2, 0.4)


func _change() -> StringName:
	return &"area_changed"


func _color_at(world_xz: Vector2) -> Color:
	return EMPTY_COLOR.lerp(FULL_COLOR, (_painted as ScatterMask).sample(world_xz))


func _color_on_planet(from_center: Vector3) -> Color:
	return EMPTY_COLOR.lerp(FULL_COLOR, (_painted as ScatterMask).sample_on_planet(planet_radius, from_center))
