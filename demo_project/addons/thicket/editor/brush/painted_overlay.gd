@tool
extends "res://addons/thicket/editor/ground/ground_overlay.gd"
## The base class of overlays that show a painted resource while its brush is on.

## The radius of the planet that the resource covers, in meters; 0 if it is projected along the y axis.
var planet_radius := 0.0

var _painted: Resource
var _version := 0 ## Increases with each change to the resource.


## Sets the resource to show, or null for none.
func watch(painted: Resource) -> void:
	if painted == _painted:
		return
	if _painted != null:
		_painted.disconnect(_change(), _on_changed)
	_painted = painted
	if _painted != null:
		_painted.connect(_change(), _on_changed)


## Draws the resource on the ground around a position. The view is [param distance] meters from that position. Has no effect if nothing has changed.
func show(scatter: TerrainScatter3D, center: Vector3, distance: float) -> void:
	cover(scatter, center, distance, [_painted, _version, planet_radius], _sample.bind(scatter), INF, planet_radius > 0.0)
	while not is_complete(): # A stroke must be visible immediately.
		work(100000)


func _sample(rect: Rect2, size: Vector2i, positions: PackedVector3Array, scatter: TerrainScatter3D) -> PackedColorArray:
	var colors := PackedColorArray()
	if planet_radius > 0.0:
		for from_center in scatter._to_planet(positions):
			colors.append(_color_on_planet(from_center) if from_center.is_finite() else Color.TRANSPARENT)
		return colors
	for z in size.y:
		for x in size.x:
			colors.append(_color_at(rect.position + rect.size * (Vector2(x, z) + Vector2(0.5, 0.5)) / Vector2(size)))
	return colors


## Returns the signal with which the resource reports a change.
func _change() -> StringName:
	return &"changed"


## Returns the color at world x and z.
func _color_at(_world_xz: Vector2) -> Color:
	return Color.TRANSPARENT


## Returns the color at a position relative to the center of the planet.
func _color_on_planet(_from_center: Vector3) -> Color:
	return Color.TRANSPARENT


func _on_changed(_area := Rect2()) -> void:
	_version += 1
