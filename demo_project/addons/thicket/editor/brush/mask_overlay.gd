@tool
extends "res://addons/thicket/editor/ground/ground_overlay.gd"
## Shows the mask of a layer while the brush is on: green where the layer may grow, and red where it may not.

const STANDS := Color(0.35, 0.95, 0.3, 0.2)
const GONE := Color(1.0, 0.25, 0.2, 0.4)

var _mask: ScatterMask
var _version := 0 ## Increases with each change of the mask.


## Sets the mask to show; null for none.
func watch(mask: ScatterMask) -> void:
	if mask == _mask:
		return
	if _mask != null:
		_mask.area_changed.disconnect(_on_changed)
	_mask = mask
	if _mask != null:
		_mask.area_changed.connect(_on_changed)


## Draws the mask on the ground around a position, seen from [param away] meters. Does nothing if nothing has changed.
func show(scatter: TerrainScatter3D, around: Vector3, away: float) -> void:
	cover(scatter, around, away, [_mask, _version], _sample)
	while not is_complete(): # A stroke must be visible immediately.
		work(100000)


func _sample(rect: Rect2, size: Vector2i) -> PackedColorArray:
	var colors := PackedColorArray()
	for z in size.y:
		for x in size.x:
			var at := rect.position + rect.size * (Vector2(x, z) + Vector2(0.5, 0.5)) / Vector2(size)
			colors.append(GONE.lerp(STANDS, _mask.sample(at)))
	return colors


func _on_changed(_rect: Rect2) -> void:
	_version += 1
