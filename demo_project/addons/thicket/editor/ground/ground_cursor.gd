@tool
extends RefCounted
## Finds the position on the ground below the mouse and draws the shapes of tools over the view.

const SurfacePlace := preload("res://addons/thicket/editor/ground/surface_place.gd")

const SIDES := 64
const PIECES := 24
## The largest width of a message next to the mouse, in pixels.
const WIDTH := 560.0
## The ground is a wall if the y component of its normal is between minus and plus this number.
const WALL := 0.26

## The position on the ground below the mouse, in meters, or [constant Vector3.INF] if there is none.
var on_ground := Vector3.INF
## The normal of the ground there. It is not finite if the ground does not know it.
var normal := Vector3.UP
## The ray from the camera through the mouse: its start in meters, and its direction with a length of 1.
var from := Vector3.ZERO
var direction := Vector3.FORWARD

var _camera: Camera3D
var _scatter: TerrainScatter3D
var _mouse := Vector2.ZERO


## Sets [member on_ground] to the ground of a scatter below a position in the camera's viewport, in pixels. It may be on a wall, on a ceiling or on
## any side of a planet.
func aim(camera: Camera3D, position: Vector2, scatter: TerrainScatter3D) -> void:
	_camera = camera
	_scatter = scatter
	_mouse = position
	position /= _pixel_ratio(camera)
	from = camera.project_ray_origin(position)
	direction = camera.project_ray_normal(position)
	var hit := SurfacePlace.on_ray(scatter, from, direction) if scatter.ground != null else PackedVector3Array()
	on_ground = hit[0] if not hit.is_empty() else Vector3.INF
	normal = hit[1] if not hit.is_empty() else Vector3.UP


## Clears [member on_ground] until the next call to [method aim].
func clear() -> void:
	on_ground = Vector3.INF
	_camera = null
	_scatter = null


## Returns true if the mouse was last over the viewport of this overlay. The overlay is a sibling of the viewport's
## container, or a descendant of such a sibling.
func is_over(overlay: Control) -> bool:
	if not is_instance_valid(_camera):
		return false
	var container := _camera.get_viewport().get_parent()
	return container != null and container.get_parent() != null and container.get_parent().is_ancestor_of(overlay)


## Returns the position of the mouse over the viewport, in pixels.
func mouse() -> Vector2:
	return _mouse


## Draws a message next to the mouse.
func draw_message(overlay: Control, message: String) -> void:
	_write(overlay, message, WIDTH, _mouse + Vector2(18.0, 24.0), Color(1.0, 0.85, 0.5))


## Draws a hint about keys and clicks at the lower edge of the view.
func draw_hint(overlay: Control, message: String) -> void:
	_write(overlay, message, INF, Vector2(12.0, overlay.size.y - 14.0), Color(0.9, 0.95, 1.0))


func _write(overlay: Control, text: String, max_width: float, position: Vector2, color: Color) -> void:
	var font := ThemeDB.fallback_font
	var size := ThemeDB.fallback_font_size
	var width := minf(max_width, overlay.size.x - 20.0)
	var extent := font.get_multiline_string_size(text, HORIZONTAL_ALIGNMENT_LEFT, width, size)
	# The position is the left end of the first line. The last line of a message must also be in the view.
	var line_height := font.get_height(size)
	position = position.min(overlay.size - extent + Vector2(-8.0, line_height - 8.0)).max(Vector2(8.0, line_height))
	overlay.draw_rect(Rect2(position - Vector2(6.0, line_height), extent + Vector2(12.0, 8.0)), Color(0.0, 0.0, 0.0, 0.75))
	overlay.draw_multiline_string(font, position, text, HORIZONTAL_ALIGNMENT_LEFT, width, size, -1, color)


## Draws a dot at the position below the mouse.
func draw_dot(overlay: Control, color: Color) -> void:
	overlay.draw_circle(to_overlay(on_ground), 2.5, color)


## Draws a handle at a world position that is in front of the camera.
func draw_knob(overlay: Control, position: Vector3, color: Color) -> void:
	if not _camera.is_position_behind(position):
		overlay.draw_circle(to_overlay(position), 6.0, Color(0.0, 0.0, 0.0, 0.6))
		overlay.draw_circle(to_overlay(position), 4.5, color)


## Draws a circle around the position below the mouse, with a radius in meters along x and z or, on a planet, across up. It follows the level of the
## ground there, which may be a ceiling.
func draw_ring(overlay: Control, radius: float, color: Color, width: float) -> void:
	var line := PackedVector3Array()
	var upright := SurfacePlace.upright(SurfacePlace.up_at(_scatter, on_ground))
	var level_direction := -upright.y if normal.dot(upright.y) < 0.0 else upright.y
	for side in SIDES + 1:
		var angle := TAU * side / SIDES
		var position := on_ground + upright * Vector3(cos(angle), 0.0, sin(angle)) * radius
		# On a wall, the ring stays at the height of the mouse.
		var level := SurfacePlace.level(_scatter, position, level_direction, maxf(2.0 * radius, 1.0)) if not is_on_wall() else PackedVector3Array()
		line.append(level[0] if not level.is_empty() else position)
	draw_path(overlay, line, color, width)


## Returns true if the ground below the mouse is nearly vertical.
func is_on_wall() -> bool:
	return absf(normal.dot(SurfacePlace.up_at(_scatter, on_ground))) < WALL


## Returns true if there is other ground above or below the position below the mouse, or if that position is on a wall or a ceiling. What is
## projected along the y axis then applies to more ground than the mouse points at.
func is_among_levels() -> bool:
	if not on_ground.is_finite() or not SurfacePlace.has_levels(_scatter.ground):
		return false
	return normal.y < WALL or _scatter.ground.get_height(on_ground) > on_ground.y + 0.5


## Returns the position on the overlay, in pixels, of a world position. The world position must not be behind the camera.
func to_overlay(position: Vector3) -> Vector2:
	return _camera.unproject_position(position) * _pixel_ratio(_camera)


## Returns a line between two positions that follows the ground and is straight where there is no ground. On a planet, the ground is searched along
## up or, if [param from_above] is true, along the y axis.
func along_ground(from: Vector3, to: Vector3, from_above := false) -> PackedVector3Array:
	var line := PackedVector3Array()
	for piece in PIECES + 1:
		var position := from.lerp(to, piece / float(PIECES))
		var level := SurfacePlace.level(_scatter, position, Vector3.UP if from_above else SurfacePlace.up_at(_scatter, position))
		line.append(level[0] if not level.is_empty() else position)
	return line


## Draws a line through world positions, except those behind the camera.
func draw_path(overlay: Control, positions: PackedVector3Array, color: Color, width: float) -> void:
	var line := PackedVector2Array()
	for position in positions:
		if _camera.is_position_behind(position):
			_draw_line(overlay, line, color, width)
			line = PackedVector2Array()
		else:
			line.append(to_overlay(position))
	_draw_line(overlay, line, color, width)


func _draw_line(overlay: Control, line: PackedVector2Array, color: Color, width: float) -> void:
	if line.size() > 1:
		overlay.draw_polyline(line, Color(0.0, 0.0, 0.0, 0.5 * color.a), width + 2.0, true)
		overlay.draw_polyline(line, color, width, true)


## Returns the number of overlay pixels per viewport pixel, which is above 1 if the view has half resolution.
static func _pixel_ratio(camera: Camera3D) -> float:
	var container := camera.get_viewport().get_parent() as SubViewportContainer
	return float(container.stretch_shrink) if container != null and container.stretch else 1.0
