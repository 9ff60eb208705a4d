@tool
extends "res://addons/thicket/editor/ground/ground_overlay.gd"
## Shows what is painted on a layer while the brush is on: green where the layer may stand and red where it may not.

const STANDS := Color(0.35, 0.95, 0.3, 0.2)
const GONE := Color(1.0, 0.25, 0.2, 0.4)

var _mask: ScatterMask
var _version := 0 ## One state of the mask from another.


## Takes a mask to show; null for none.
func watch(mask: ScatterMask) -> void:
	if mask == _mask:
		return
	if _mask != null:
		_mask.area_changed.disconnect(_on_changed)
	_mask = mask
	if _mask != null:
		_mask.area_changed.connect(_on_changed)


## Draws the mask over the ground around a place of it, seen from [param away] meters; while nothing has changed, it does nothing.
func show(scatter: TerrainScatter3D, around: Vector3, away: float) -> void:
	cover(scatter, around, away, [_mask, _version], _sample)
	while not is_complete(): # A stroke is seen at once.
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
