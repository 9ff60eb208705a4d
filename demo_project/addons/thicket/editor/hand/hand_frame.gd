@tool
extends RefCounted
## The frame that the hand tool draws around an instance: a box, a ring with a handle to rotate the instance, and a handle to scale it.

const GroundCursor := preload("res://addons/thicket/editor/ground/ground_cursor.gd")

const SELECTED := Color(1.0, 0.75, 0.25)
const HOVERED := Color(1.0, 1.0, 1.0, 0.7)
const SIDES := 48
## The distance in pixels within which a handle is grabbed.
const GRAB := 10.0

enum Handle { NONE, TURN, SCALE }

## The transform of the instance, and the bounding box of its mesh in the instance's own space.
var transform := Transform3D.IDENTITY
var box := AABB()


## Returns the world position of a handle.
func handle_position(handle: Handle) -> Vector3:
	if handle == Handle.SCALE:
		return transform * Vector3(0.0, box.end.y * 1.08 + 0.1, 0.0)
	return transform.origin + _forward() * _radius()


## Returns the handle at a position on an overlay.
func handle_at(cursor: GroundCursor, mouse: Vector2) -> Handle:
	for handle: Handle in [Handle.TURN, Handle.SCALE]:
		if cursor.to_overlay(handle_position(handle)).distance_to(mouse) <= GRAB:
			return handle
	return Handle.NONE


## Returns the axis about which the instance rotates.
func up() -> Vector3:
	return transform.basis.y.normalized() if transform.basis.y != Vector3.ZERO else Vector3.UP


func draw_box(overlay: Control, cursor: GroundCursor, color: Color, width: float) -> void:
	for axis in 3:
		for corner in 4:
			var from := box.position
			from[(axis + 1) % 3] += box.size[(axis + 1) % 3] * float(corner & 1)
			from[(axis + 2) % 3] += box.size[(axis + 2) % 3] * float(corner >> 1)
			var to := from
			to[axis] += box.size[axis]
			cursor.draw_path(overlay, PackedVector3Array([transform * from, transform * to]), color, width)


func draw_handles(overlay: Control, cursor: GroundCursor) -> void:
	var ring := PackedVector3Array()
	for side in SIDES + 1:
		ring.append(transform.origin + _forward().rotated(up(), TAU * side / SIDES) * _radius())
	cursor.draw_path(overlay, ring, Color(SELECTED, 0.8), 1.5)
	cursor.draw_path(overlay, PackedVector3Array([transform.origin, handle_position(Handle.SCALE)]), Color(SELECTED, 0.5), 1.0)
	for handle: Handle in [Handle.TURN, Handle.SCALE]:
		cursor.draw_knob(overlay, handle_position(handle), SELECTED)


## Returns the direction from the instance to the handle that rotates it.
func _forward() -> Vector3:
	var axis := up()
	var forward := transform.basis.z - axis * transform.basis.z.dot(axis)
	return forward.normalized() if forward != Vector3.ZERO else axis.cross(Vector3.RIGHT).normalized()


func _radius() -> float:
	var scale := transform.basis.get_scale().abs()
	return 0.3 + 0.65 * maxf(box.size.x * scale.x, box.size.z * scale.z)
