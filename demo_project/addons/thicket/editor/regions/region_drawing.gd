@tool
extends "res://addons/thicket/editor/ground/ground_tool.gd"
## The tool that draws a region. The user clicks the corners of its polygon, or the points of its path, on the ground.

const EditorSnap := preload("res://addons/thicket/editor/editor_snap.gd")
const PlanetOutline := preload("res://addons/thicket/editor/regions/planet_outline.gd")
const RegionGizmos := preload("res://addons/thicket/editor/regions/region_gizmos.gd")
const RegionMenu := preload("res://addons/thicket/editor/regions/region_menu.gd")

## Emitted when the shape is finished. [param region] is not in the scene yet, and [param point] is its world position.
signal drawn(region: ScatterRegion3D, point: Vector3)

const HINT_FIRST := "Click along the %s   Enter or double click ends it   Backspace removes the last one   Esc cancels"
const HINT_NEXT := "%d points   Enter or double click ends it   Backspace removes the last one   Esc cancels"
## The distance in pixels from the first corner within which a click closes the polygon.
const GRAB := 10.0
## The minimum area of a polygon in square meters.
const MIN_AREA := 1e-4

## The width of a new path in meters.
const WIDTH := 3.0
## The length of the curve handles of a path's points, as a fraction of the distance from the previous to the next point.
const BEND := 1.0 / 6.0

## The shape to draw: a polygon or a path.
var shape := ScatterRegion3D.SHAPE_POLYGON
## True if the new region excludes layers.
var exclude := true
## The world positions of the corners, or of the points of the path.
var corners := PackedVector3Array()


func _init() -> void:
	needs_layer = false
	_setup("Region", &"ToolAddNode", "Region: click its corners on the ground.")
	# Only the region menu turns the tool on.
	button.visible = false


func _on_button(click: InputEventMouseButton) -> void:
	if not click.pressed:
		return
	problem = ""
	var closes_polygon := shape == ScatterRegion3D.SHAPE_POLYGON and corners.size() >= 3 and _cursor.to_overlay(corners[0]).distance_to(_cursor.mouse()) <= GRAB
	if click.double_click or closes_polygon:
		close()
	else:
		_add_corner()


func _draw_view(overlay: Control) -> void:
	var color := RegionGizmos.EXCLUDE if exclude else RegionGizmos.INCLUDE
	var line := PackedVector3Array()
	for corner in corners + (PackedVector3Array([_corner()]) if _cursor.on_ground.is_finite() else PackedVector3Array()):
		if not line.is_empty():
			_cursor.draw_path(overlay, _cursor.along_ground(line[-1], corner), color, 2.0)
		line.append(corner)
	if line.size() > 2 and shape == ScatterRegion3D.SHAPE_POLYGON:
		_cursor.draw_path(overlay, _cursor.along_ground(line[-1], line[0]), Color(color, 0.4), 1.0)
	for corner in corners:
		_cursor.draw_knob(overlay, corner, color)
	var outline := "path" if shape == ScatterRegion3D.SHAPE_PATH else "outline"
	_cursor.draw_hint(overlay, HINT_FIRST % outline if corners.is_empty() else HINT_NEXT % corners.size())


func finish() -> void:
	corners.clear()
	problem = ""


func _on_toggled() -> void:
	super()
	finish()


## Creates a region from the corners and turns the tool off. If there are too few corners, or if those of a polygon are
## in a line, sets [member problem] instead.
func close() -> void:
	var middle := Vector3.ZERO
	for corner in corners:
		middle += corner / corners.size()
	if SurfacePlace.is_planet(scatter):
		var level := SurfacePlace.level(scatter, middle, SurfacePlace.up_at(scatter, middle))
		middle = level[0] if not level.is_empty() else middle
	var frame := RegionMenu.frame_at(scatter, middle)
	var region := _polygon(frame) if shape == ScatterRegion3D.SHAPE_POLYGON else _path(frame)
	if region == null:
		redraw_requested.emit()
		return
	set_on(false)
	drawn.emit(region, middle)


func _polygon(frame: Transform3D) -> ScatterRegion3D:
	var polygon := PackedVector2Array()
	var area := 0.0
	for corner in corners:
		polygon.append(_in_frame(corner, frame))
		if not polygon[-1].is_finite():
			problem = "A corner is more than %d° around the planet from the middle of the outline. Draw several smaller regions." % PlanetOutline.MAX_DEGREES
			return null
	for index in polygon.size():
		area += 0.5 * polygon[index].cross(polygon[index - 1])
	if polygon.size() < 3 or absf(area) < MIN_AREA:
		problem = "A region needs at least three corners that are not in a line, got %d. Click more corners." % corners.size()
		return null
	var region := RegionMenu.make(shape, exclude)
	region.polygon = polygon
	return region


## Returns a corner in the local coordinates of a region with this transform, or [constant Vector2.INF] if the region cannot have this corner.
func _in_frame(corner: Vector3, frame: Transform3D) -> Vector2:
	if SurfacePlace.is_planet(scatter):
		return PlanetOutline.corner_toward(corner, SurfacePlace.planet_center(scatter), frame)
	return Vector2(corner.x - frame.origin.x, corner.z - frame.origin.z)


## Returns a region along a smooth path through the points, with a Path3D below it. Returns null and sets [member problem] on failure.
func _path(frame: Transform3D) -> ScatterRegion3D:
	if corners.size() < 2:
		problem = "A path needs at least two points, got %d. Click more points." % corners.size()
		return null
	var region := RegionMenu.make(shape, exclude)
	var path := Path3D.new()
	path.name = "Path3D"
	path.curve = Curve3D.new()
	for index in corners.size():
		var tangent := frame.basis.inverse() * (corners[mini(index + 1, corners.size() - 1)] - corners[maxi(index - 1, 0)]) * BEND
		path.curve.add_point(frame.affine_inverse() * corners[index], -tangent, tangent)
	region.add_child(path)
	region.path = NodePath("Path3D")
	region.width = WIDTH
	return region


func _on_key(key: InputEventKey) -> int:
	if not key.pressed or key.ctrl_pressed or key.alt_pressed or key.meta_pressed:
		return NOT_MINE
	match key.keycode:
		KEY_ENTER, KEY_KP_ENTER:
			close()
		KEY_BACKSPACE:
			if not corners.is_empty():
				corners.resize(corners.size() - 1)
		KEY_ESCAPE:
			set_on(false)
		KEY_DELETE:
			pass # Consumes the key, because the editor would delete the scatter.
		_:
			return NOT_MINE
	_take_key()
	return MINE


func _add_corner() -> void:
	if ground() == null:
		problem = _ground_problem("draw on")
	elif not _cursor.on_ground.is_finite():
		problem = NO_GROUND_BELOW
	elif corners.is_empty() or corners[-1].distance_to(_corner()) > 0.01:
		corners.append(_corner())


## Returns the position of the next corner, snapped like the editor's gizmos, except on a planet.
func _corner() -> Vector3:
	var point := _cursor.on_ground
	if EditorSnap.is_on() and not SurfacePlace.is_planet(scatter):
		var step := maxf(0.01, EditorSnap.meters())
		point = Vector3(snappedf(point.x, step), point.y, snappedf(point.z, step))
		var level := SurfacePlace.level(scatter, point, Vector3.UP)
		point = level[0] if not level.is_empty() else point
	return point
