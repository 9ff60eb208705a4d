@tool
extends EditorNode3DGizmoPlugin
## Draws a [ScatterRegion3D]: its shape, its border on the ground, a second line where the falloff ends, and handles for
## its size. On a planet, the border is drawn along the planet's up. Handles snap like the editor's gizmos. Dragging a face keeps the opposite face in
## place unless Alt is held.

const EditorSnap := preload("res://addons/thicket/editor/editor_snap.gd")
const GroundLines := preload("res://addons/thicket/editor/ground/ground_lines.gd")
const Outline := preload("res://addons/thicket/editor/regions/region_outline.gd")
const PlanetOutline := preload("res://addons/thicket/editor/regions/planet_outline.gd")
const SurfacePlace := preload("res://addons/thicket/editor/ground/surface_place.gd")

const INCLUDE := Color(0.45, 0.9, 0.4)
const EXCLUDE := Color(1.0, 0.42, 0.3)
## The distance between two ground heights along the border of a small region, in meters. The border of a larger region is divided into
## [constant PIECES] parts.
const PIECE := 0.5
const PIECES := 400.0
const AXES: Array[Vector3] = [Vector3.RIGHT, Vector3.UP, Vector3.BACK]

var undo_redo: EditorUndoRedoManager

# The transform and size of the region when its handle was grabbed.
var _start_transform := Transform3D.IDENTITY
var _start_size := Vector3.ONE

# Materials for regions that include, and for regions that exclude.
var _borders: Array[Material] = []
var _bodies: Array[Material] = []
var _falloffs: Array[Material] = []


func _init() -> void:
	for color: Color in [INCLUDE, EXCLUDE]:
		_borders.append(GroundLines.material(color))
		_bodies.append(GroundLines.material(Color(color, 0.35)))
		_falloffs.append(GroundLines.material(Color(color, 0.5)))
	create_handle_material("handles")


func _get_gizmo_name() -> String:
	return "ScatterRegion3D"


func _has_gizmo(node: Node3D) -> bool:
	return node is ScatterRegion3D


func _redraw(gizmo: EditorNode3DGizmo) -> void:
	gizmo.clear()
	var region := gizmo.get_node_3d() as ScatterRegion3D
	var material_index := int(region.exclude)
	var body := Outline.body(region)
	if not body.is_empty():
		gizmo.add_lines(body, _bodies[material_index])
	var border := _on_ground(region, 0.0)
	if not border.is_empty():
		gizmo.add_lines(border, _borders[material_index])
	if region.falloff > 0.0:
		var falloff_border := _on_ground(region, region.falloff)
		if not falloff_border.is_empty():
			gizmo.add_lines(falloff_border, _falloffs[material_index])
	gizmo.add_collision_segments(border + body)
	var handles := _handles(region)
	if not handles.is_empty():
		gizmo.add_handles(handles, get_material("handles", gizmo), [])


func _get_handle_name(gizmo: EditorNode3DGizmo, id: int, _secondary: bool) -> String:
	return {
		ScatterRegion3D.SHAPE_BOX: "Size", ScatterRegion3D.SHAPE_SPHERE: "Radius",
		ScatterRegion3D.SHAPE_CYLINDER: ["Radius", "Height"][mini(id, 1)],
		ScatterRegion3D.SHAPE_POLYGON: "Corner %d" % id, ScatterRegion3D.SHAPE_PATH: "Width",
	}[(gizmo.get_node_3d() as ScatterRegion3D).shape]


func _get_handle_value(gizmo: EditorNode3DGizmo, id: int, _secondary: bool) -> Variant:
	var region := gizmo.get_node_3d() as ScatterRegion3D
	return region.get(_property(region, id))


func _begin_handle_action(gizmo: EditorNode3DGizmo, _id: int, _secondary: bool) -> void:
	var region := gizmo.get_node_3d() as ScatterRegion3D
	_start_transform = region.transform
	_start_size = region.size
	if region.shape == ScatterRegion3D.SHAPE_CYLINDER:
		_start_size = Vector3.ONE * region.height


func _set_handle(gizmo: EditorNode3DGizmo, id: int, _secondary: bool, camera: Camera3D, point: Vector2) -> void:
	var region := gizmo.get_node_3d() as ScatterRegion3D
	var to_node := (_parent_transform(region) * _start_transform).affine_inverse()
	var from := to_node * camera.project_ray_origin(point)
	var to := to_node * (camera.project_ray_origin(point) + camera.project_ray_normal(point) * camera.far)
	match region.shape:
		ScatterRegion3D.SHAPE_BOX:
			var size := _start_size
			size[id / 2] = _drag_face(region, id / 2, 1.0 - 2.0 * (id % 2), from, to)
			region.size = size
		ScatterRegion3D.SHAPE_SPHERE:
			region.radius = _length(absf(_along(Vector3.RIGHT, from, to)))
		ScatterRegion3D.SHAPE_CYLINDER:
			if id == 0:
				region.radius = _length(absf(_along(Vector3.RIGHT, from, to)))
			else:
				region.height = _drag_face(region, Vector3.AXIS_Y, 1.0 if id == 1 else -1.0, from, to)
		ScatterRegion3D.SHAPE_POLYGON:
			var corner := _dragged_corner(region, from, to)
			if corner.is_finite():
				var polygon := region.polygon
				polygon[id] = corner.snapped(Vector2.ONE * EditorSnap.meters()) if EditorSnap.is_on() else corner
				region.polygon = polygon
		ScatterRegion3D.SHAPE_PATH:
			_drag_width(region, region.global_transform * from, region.global_transform * to)


func _commit_handle(gizmo: EditorNode3DGizmo, id: int, secondary: bool, restore: Variant, cancel: bool) -> void:
	var region := gizmo.get_node_3d() as ScatterRegion3D
	var property := _property(region, id)
	if cancel:
		region.set(property, restore)
		region.transform = _start_transform
		return
	undo_redo.create_action("Set %s of %s" % [_get_handle_name(gizmo, id, secondary), region.name])
	undo_redo.add_do_property(region, property, region.get(property))
	undo_redo.add_undo_property(region, property, restore)
	if region.transform != _start_transform:
		undo_redo.add_do_property(region, &"transform", region.transform)
		undo_redo.add_undo_property(region, &"transform", _start_transform)
	undo_redo.commit_action(false)


## Drags the face of a box or a cylinder on one side of an axis. The opposite face stays in place or, with Alt, moves symmetrically. Returns
## the new length along the axis.
func _drag_face(region: ScatterRegion3D, axis: int, side: float, from: Vector3, to: Vector3) -> float:
	var outward := AXES[axis] * side
	var is_symmetric := Input.is_key_pressed(KEY_ALT)
	var face := _along(outward, from, to)
	var length := _length(2.0 * face if is_symmetric else face + 0.5 * _start_size[axis])
	var shift := 0.0 if is_symmetric else 0.5 * (length - _start_size[axis])
	region.transform = _start_transform.translated_local(outward * shift) if shift != 0.0 else _start_transform
	return length


## Returns the corner of a polygon below the mouse, [constant Vector2.INF] if there is none. The ray of the mouse is in the region's local space. On
## a planet, the corner is on the ground.
static func _dragged_corner(region: ScatterRegion3D, from: Vector3, to: Vector3) -> Vector2:
	var scatter := _scatter_on_planet(region)
	if scatter == null:
		var hit: Variant = Plane(Vector3.UP, 0.0).intersects_segment(from, to)
		return Vector2((hit as Vector3).x, (hit as Vector3).z) if hit is Vector3 else Vector2.INF
	var start := region.global_transform * from
	var hit_on_ground := SurfacePlace.on_ray(scatter, start, start.direction_to(region.global_transform * to))
	if hit_on_ground.is_empty():
		return Vector2.INF
	return PlanetOutline.corner_toward(hit_on_ground[0], SurfacePlace.planet_center(scatter), region.global_transform)


## Returns the scatter above a region if its ground forms a planet, otherwise null.
static func _scatter_on_planet(region: ScatterRegion3D) -> TerrainScatter3D:
	var scatter := GroundLines.scatter_of(region)
	return scatter if scatter != null and SurfacePlace.is_planet(scatter) else null


static func _property(region: ScatterRegion3D, id: int) -> StringName:
	return [&"size", &"radius", [&"radius", &"height"][mini(id, 1)], &"polygon", &"width"][region.shape]


static func _on_ground(region: ScatterRegion3D, inset: float) -> PackedVector3Array:
	var lines := GroundLines.new(region)
	var scatter := _scatter_on_planet(region)
	var planet_outline := PlanetOutline.new(region, scatter) if scatter != null else null
	if planet_outline != null:
		lines.to_ground = planet_outline.to_ground.bind(GroundLines.LIFT)
	for border in planet_outline.borders(inset) if planet_outline != null else Outline.borders(region, inset):
		var length := 0.0
		for index in border.size():
			length += border[index].distance_to(border[(index + 1) % border.size()])
		lines.add(border, true, maxf(PIECE, length / PIECES))
	return lines.segments


## Returns the positions of the handles in the node's local space, in the order of their IDs.
func _handles(region: ScatterRegion3D) -> PackedVector3Array:
	var positions := PackedVector3Array()
	match region.shape:
		ScatterRegion3D.SHAPE_BOX:
			for axis in 3:
				for side: float in [0.5, -0.5]:
					positions.append(AXES[axis] * side * region.size[axis])
		ScatterRegion3D.SHAPE_SPHERE:
			positions.append(Vector3.RIGHT * region.radius)
		ScatterRegion3D.SHAPE_CYLINDER:
			positions.append(Vector3.RIGHT * region.radius)
			for side: float in [0.5, -0.5]:
				positions.append(Vector3.UP * side * region.height)
		ScatterRegion3D.SHAPE_POLYGON:
			var scatter := _scatter_on_planet(region)
			var planet_outline := PlanetOutline.new(region, scatter) if scatter != null else null
			for corner in Outline.corners(region):
				var position := planet_outline.on_ground(corner, GroundLines.LIFT) if planet_outline != null else corner
				positions.append(region.global_transform.affine_inverse() * position)
		ScatterRegion3D.SHAPE_PATH:
			var start := _path_start(region)
			if not start.is_empty():
				var position: Vector3 = start[0] + start[1] * 0.5 * region.width
				positions.append(region.global_transform.affine_inverse() * position)
	return positions


## Returns the world position where a path begins, and the direction across it, or an empty array if there is no path.
static func _path_start(region: ScatterRegion3D) -> PackedVector3Array:
	var points := Outline.path_positions(region)
	if points.size() < 2:
		return PackedVector3Array()
	var scatter := _scatter_on_planet(region)
	var up := SurfacePlace.up_at(scatter, points[0]) if scatter != null else Vector3.UP
	var across := (points[1] - points[0]).cross(up).normalized()
	return PackedVector3Array([points[0], across] if across != Vector3.ZERO else [])


static func _drag_width(region: ScatterRegion3D, from: Vector3, to: Vector3) -> void:
	var start := _path_start(region)
	if start.is_empty():
		return
	var half_line := start[1] * 1e5
	var nearest := Geometry3D.get_closest_points_between_segments(start[0] - half_line, start[0] + half_line, from, to)
	region.width = _length(2.0 * nearest[0].distance_to(start[0]))


## Returns the position along an axis through the node's origin at which a ray is nearest to the axis. It is negative on the other side of the origin.
static func _along(axis: Vector3, from: Vector3, to: Vector3) -> float:
	# Geometry3D's function for segments is not used: with distant end points, its 32-bit floats are off by centimeters.
	var direction := (to - from).normalized()
	var cosine := axis.dot(direction)
	return (axis.dot(from) - cosine * direction.dot(from)) / maxf(1.0 - cosine * cosine, 1e-6)


static func _parent_transform(region: ScatterRegion3D) -> Transform3D:
	var parent := region.get_parent_node_3d()
	return parent.global_transform if parent != null and not region.top_level else Transform3D.IDENTITY


## Returns a valid length for a region, rounded to centimeters, or to the editor's snap step if snapping is on.
static func _length(length: float) -> float:
	return clampf(snappedf(length, maxf(0.01, EditorSnap.meters()) if EditorSnap.is_on() else 0.01), 0.01, 1e6)
