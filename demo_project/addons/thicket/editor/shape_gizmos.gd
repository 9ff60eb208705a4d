@tool
extends EditorNode3DGizmoPlugin
## Draws a [code]ScatterShape3D[/code]: its body, its border on the ground, a second line where the falloff ends, and
## handles for its sizes.

const GroundLines := preload("res://addons/thicket/editor/ground_lines.gd")
const Outline := preload("res://addons/thicket/editor/shape_outline.gd")

const INCLUDE := Color(0.45, 0.9, 0.4)
const EXCLUDE := Color(1.0, 0.42, 0.3)
## Meters from one height that is asked to the next, for small shapes; larger ones use some hundred pieces.
const PIECE := 0.5
const PIECES := 400.0
const AXES: Array[Vector3] = [Vector3.RIGHT, Vector3.UP, Vector3.BACK]

var undo_redo: EditorUndoRedoManager

# Of shapes that include, and of those that exclude.
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
	return "ScatterShape3D"


func _has_gizmo(node: Node3D) -> bool:
	return node.is_class("ScatterShape3D")


func _redraw(gizmo: EditorNode3DGizmo) -> void:
	gizmo.clear()
	var shape := gizmo.get_node_3d()
	var rule := int(shape.get(&"exclude"))
	var body := Outline.body(shape)
	if not body.is_empty():
		gizmo.add_lines(body, _bodies[rule])
	var border := _on_ground(shape, 0.0)
	if not border.is_empty():
		gizmo.add_lines(border, _borders[rule])
	var falloff: float = shape.get(&"falloff")
	if falloff > 0.0:
		var full := _on_ground(shape, falloff)
		if not full.is_empty():
			gizmo.add_lines(full, _falloffs[rule])
	gizmo.add_collision_segments(border + body)
	var handles := _handles(shape)
	if not handles.is_empty():
		gizmo.add_handles(handles, get_material("handles", gizmo), [])


func _get_handle_name(gizmo: EditorNode3DGizmo, id: int, _secondary: bool) -> String:
	return {
		Outline.Kind.BOX: "Size", Outline.Kind.SPHERE: "Radius", Outline.Kind.CYLINDER: ["Radius", "Height"][mini(id, 1)],
		Outline.Kind.POLYGON: "Corner %d" % id, Outline.Kind.PATH: "Width",
	}[gizmo.get_node_3d().get(&"kind")]


func _get_handle_value(gizmo: EditorNode3DGizmo, id: int, _secondary: bool) -> Variant:
	return gizmo.get_node_3d().get(_property(gizmo.get_node_3d(), id))


func _set_handle(gizmo: EditorNode3DGizmo, id: int, _secondary: bool, camera: Camera3D, point: Vector2) -> void:
	var shape := gizmo.get_node_3d()
	var to_node := shape.global_transform.affine_inverse()
	var from := to_node * camera.project_ray_origin(point)
	var to := to_node * (camera.project_ray_origin(point) + camera.project_ray_normal(point) * camera.far)
	match shape.get(&"kind"):
		Outline.Kind.BOX:
			var size: Vector3 = shape.get(&"size")
			size[id] = _length(2.0 * _along(AXES[id], from, to))
			shape.set(&"size", size)
		Outline.Kind.SPHERE:
			shape.set(&"radius", _length(_along(Vector3.RIGHT, from, to)))
		Outline.Kind.CYLINDER:
			if id == 0:
				shape.set(&"radius", _length(_along(Vector3.RIGHT, from, to)))
			else:
				shape.set(&"height", _length(2.0 * _along(Vector3.UP, from, to)))
		Outline.Kind.POLYGON:
			var place: Variant = Plane(Vector3.UP, 0.0).intersects_segment(from, to)
			if place is Vector3:
				var polygon: PackedVector2Array = shape.get(&"polygon")
				polygon[id] = Vector2(place.x, place.z)
				shape.set(&"polygon", polygon)
		Outline.Kind.PATH:
			_drag_width(shape, shape.global_transform * from, shape.global_transform * to)


func _commit_handle(gizmo: EditorNode3DGizmo, id: int, secondary: bool, restore: Variant, cancel: bool) -> void:
	var shape := gizmo.get_node_3d()
	var property := _property(shape, id)
	if cancel:
		shape.set(property, restore)
		return
	undo_redo.create_action("Set %s of %s" % [_get_handle_name(gizmo, id, secondary), shape.name])
	undo_redo.add_do_property(shape, property, shape.get(property))
	undo_redo.add_undo_property(shape, property, restore)
	undo_redo.commit_action(false)


static func _property(shape: Node3D, id: int) -> StringName:
	return [&"size", &"radius", [&"radius", &"height"][mini(id, 1)], &"polygon", &"width"][int(shape.get(&"kind"))]


static func _on_ground(shape: Node3D, inwards: float) -> PackedVector3Array:
	var lines := GroundLines.new(shape)
	for border in Outline.borders(shape, inwards):
		var length := 0.0
		for index in border.size():
			length += border[index].distance_to(border[(index + 1) % border.size()])
		lines.add(border, true, maxf(PIECE, length / PIECES))
	return lines.segments


## The handles in the node's own space, in the order of their ids.
func _handles(shape: Node3D) -> PackedVector3Array:
	var places := PackedVector3Array()
	match shape.get(&"kind"):
		Outline.Kind.BOX:
			for axis in 3:
				places.append(AXES[axis] * 0.5 * shape.get(&"size")[axis])
		Outline.Kind.SPHERE:
			places.append(Vector3.RIGHT * shape.get(&"radius"))
		Outline.Kind.CYLINDER:
			places.append(Vector3.RIGHT * shape.get(&"radius"))
			places.append(Vector3.UP * 0.5 * shape.get(&"height"))
		Outline.Kind.POLYGON:
			for corner: Vector2 in shape.get(&"polygon"):
				places.append(Vector3(corner.x, 0.0, corner.y))
		Outline.Kind.PATH:
			var start := _path_start(shape)
			if not start.is_empty():
				var place: Vector3 = start[0] + start[1] * 0.5 * float(shape.get(&"width"))
				places.append(shape.global_transform.affine_inverse() * place)
	return places


## Where a path begins in the world, and the direction across it; empty if there is no path.
static func _path_start(shape: Node3D) -> PackedVector3Array:
	var path := Outline.path_node(shape)
	if path == null or path.curve == null or path.curve.point_count < 2:
		return PackedVector3Array()
	var points := path.curve.tessellate(4, 3.0)
	var from := path.global_transform * points[0]
	var ahead := path.global_transform * points[1] - from
	var across := Vector3(-ahead.z, 0.0, ahead.x).normalized()
	return PackedVector3Array([from, across] if across != Vector3.ZERO else [])


static func _drag_width(shape: Node3D, from: Vector3, to: Vector3) -> void:
	var start := _path_start(shape)
	if start.is_empty():
		return
	var reach := start[1] * 1e5
	var nearest := Geometry3D.get_closest_points_between_segments(start[0] - reach, start[0] + reach, from, to)
	shape.set(&"width", _length(2.0 * nearest[0].distance_to(start[0])))


## How far along an axis through the node's origin a ray comes nearest to it.
static func _along(axis: Vector3, from: Vector3, to: Vector3) -> float:
	return Geometry3D.get_closest_points_between_segments(Vector3.ZERO, axis * 1e5, from, to)[0].length()


## A length that a shape takes, in steps of a centimeter.
static func _length(length: float) -> float:
	return clampf(snappedf(length, 0.01), 0.01, 1e6)
