@tool
extends RefCounted
## The ring that shows where the brush would paint, on the ground below the mouse.

const Brush := preload("res://addons/thicket/editor/brush.gd")
const GroundRay := preload("res://addons/thicket/editor/ground_ray.gd")

const COLORS: Array[Color] = [Color(0.5, 1.0, 0.45), Color(1.0, 0.45, 0.35), Color(0.45, 0.75, 1.0)]
const SIDES := 64

## Where the mouse points at the ground, in world meters; [constant Vector3.INF] where there is none.
var on_ground := Vector3.INF
## Why there was no stroke, shown at the mouse; empty for nothing.
var problem := ""

var _camera: Camera3D
var _mouse := Vector2.ZERO


## Points at the ground below a position in the camera's viewport; at nothing without a terrain.
func aim(camera: Camera3D, position: Vector2, terrain: Resource) -> void:
	_camera = camera
	_mouse = position
	on_ground = Vector3.INF
	if terrain == null:
		return
	position /= _shrink(camera)
	on_ground = GroundRay.hit(terrain, camera.project_ray_origin(position), camera.project_ray_normal(position))


## Meters from a camera to the ground that it looks at, at most 1000.
static func distance_to_ground(camera: Camera3D, terrain: Resource) -> float:
	var hit := GroundRay.hit(terrain, camera.global_position, -camera.global_basis.z)
	return minf(hit.distance_to(camera.global_position), 1000.0) if hit.is_finite() else 100.0


## Shows nothing until the next [method aim].
func hide() -> void:
	on_ground = Vector3.INF
	problem = ""


## Draws the ring on an overlay of a viewport, if the mouse was there last: the radius, the part that is painted in
## full, and a dot in the middle. And what stood in the way.
func draw(overlay: Control, brush: Brush, terrain: Resource) -> void:
	if not is_instance_valid(_camera) or not _is_over(overlay):
		return
	if not problem.is_empty():
		_say(overlay)
	if not on_ground.is_finite() or terrain == null:
		return
	var color := COLORS[brush.mode]
	_ring(overlay, terrain, brush.radius, color, 2.0)
	if brush.hardness > 0.0:
		_ring(overlay, terrain, brush.radius * brush.hardness, Color(color, 0.45), 1.0)
	overlay.draw_circle(_camera.unproject_position(on_ground) * _shrink(_camera), 2.5, color)


func _say(overlay: Control) -> void:
	var font := ThemeDB.fallback_font
	var size := ThemeDB.fallback_font_size
	var extent := font.get_string_size(problem, HORIZONTAL_ALIGNMENT_LEFT, -1.0, size)
	var at := (_mouse + Vector2(18.0, 24.0)).min(overlay.size - extent - Vector2(8.0, 0.0)).max(Vector2(8.0, extent.y))
	overlay.draw_rect(Rect2(at - Vector2(6.0, extent.y), extent + Vector2(12.0, 8.0)), Color(0.0, 0.0, 0.0, 0.75))
	overlay.draw_string(font, at, problem, HORIZONTAL_ALIGNMENT_LEFT, -1.0, size, Color(1.0, 0.85, 0.5))


func _ring(overlay: Control, terrain: Resource, radius: float, color: Color, width: float) -> void:
	var line := PackedVector2Array()
	for side in SIDES + 1:
		var angle := TAU * side / SIDES
		var at := on_ground + Vector3(cos(angle), 0.0, sin(angle)) * radius
		var height: float = terrain.call(&"get_height", at)
		if not is_nan(height):
			at.y = height
		if _camera.is_position_behind(at):
			_line(overlay, line, color, width)
			line = PackedVector2Array()
		else:
			line.append(_camera.unproject_position(at) * _shrink(_camera))
	_line(overlay, line, color, width)


func _line(overlay: Control, line: PackedVector2Array, color: Color, width: float) -> void:
	if line.size() > 1:
		overlay.draw_polyline(line, Color(0.0, 0.0, 0.0, 0.5 * color.a), width + 2.0, true)
		overlay.draw_polyline(line, color, width, true)


## Overlays lie beside the container of their viewport.
func _is_over(overlay: Control) -> bool:
	var container := _camera.get_viewport().get_parent()
	return container != null and container.get_parent() != null and container.get_parent().is_ancestor_of(overlay)


## At half resolution a viewport has fewer pixels than its overlay.
static func _shrink(camera: Camera3D) -> float:
	var container := camera.get_viewport().get_parent() as SubViewportContainer
	return float(container.stretch_shrink) if container != null and container.stretch else 1.0
