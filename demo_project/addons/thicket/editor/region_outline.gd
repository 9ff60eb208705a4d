@tool
extends RefCounted
## What the gizmo of a [code]ScatterRegion3D[/code] draws: its body, and its border on the ground.

## As [code]ScatterRegion3D.Shape[/code].
enum Shape { BOX, SPHERE, CYLINDER, POLYGON, PATH }

const SIDES := 48


## The edges of a box, sphere or cylinder, as pairs of ends in the node's own space. Empty for flat regions.
static func body(region: Node3D) -> PackedVector3Array:
	var lines := PackedVector3Array()
	var radius: float = region.get(&"radius")
	match region.get(&"shape"):
		Shape.BOX:
			var half: Vector3 = 0.5 * region.get(&"size")
			for axis in 3:
				for corner in 4:
					var from := half
					from[(axis + 1) % 3] *= 1.0 if corner & 1 else -1.0
					from[(axis + 2) % 3] *= 1.0 if corner & 2 else -1.0
					var to := from
					to[axis] = -from[axis]
					lines.append_array([from, to])
		Shape.SPHERE:
			_circle(lines, Vector3.ZERO, Vector3.RIGHT * radius, Vector3.BACK * radius)
			_circle(lines, Vector3.ZERO, Vector3.RIGHT * radius, Vector3.UP * radius)
			_circle(lines, Vector3.ZERO, Vector3.BACK * radius, Vector3.UP * radius)
		Shape.CYLINDER:
			var up: Vector3 = Vector3.UP * 0.5 * region.get(&"height")
			_circle(lines, up, Vector3.RIGHT * radius, Vector3.BACK * radius)
			_circle(lines, -up, Vector3.RIGHT * radius, Vector3.BACK * radius)
			for side: Vector3 in [Vector3.RIGHT, Vector3.BACK, Vector3.LEFT, Vector3.FORWARD]:
				lines.append_array([side * radius - up, side * radius + up])
	return lines


## The region's borders seen from above, [param inwards] meters within it: closed lines of world x and z.
static func borders(region: Node3D, inwards: float) -> Array[PackedVector2Array]:
	var result: Array[PackedVector2Array] = []
	var shape: int = region.get(&"shape")
	if shape == Shape.PATH:
		var strip := 0.5 * float(region.get(&"width")) - inwards
		var points := path_points(region)
		if strip > 0.0 and points.size() > 1:
			result = Geometry2D.offset_polyline(points, strip, Geometry2D.JOIN_ROUND, Geometry2D.END_ROUND)
		return result
	var outline := PackedVector2Array()
	if shape == Shape.POLYGON:
		for corner: Vector2 in region.get(&"polygon"):
			outline.append(_flat(region.global_transform * Vector3(corner.x, 0.0, corner.y)))
	else:
		for corner in body(region):
			outline.append(_flat(region.global_transform * corner))
		outline = Geometry2D.convex_hull(outline)
		# The hull repeats its first point.
		outline.resize(maxi(0, outline.size() - 1))
	if outline.size() < 3:
		return result
	if inwards <= 0.0:
		result.append(outline)
	else:
		if Geometry2D.is_polygon_clockwise(outline):
			outline.reverse()
		result = Geometry2D.offset_polygon(outline, -inwards, Geometry2D.JOIN_MITER)
	return result


## The path that the region follows, as world x and z; empty if there is none.
static func path_points(region: Node3D) -> PackedVector2Array:
	var points := PackedVector2Array()
	var path := path_node(region)
	if path != null and path.curve != null:
		for position in path.curve.tessellate(4, 3.0):
			points.append(_flat(path.global_transform * position))
	return points


## The path that the region follows; null if there is none.
static func path_node(region: Node3D) -> Path3D:
	var path: NodePath = region.get(&"path")
	return (region.get_parent() if path.is_empty() else region.get_node_or_null(path)) as Path3D


static func _flat(position: Vector3) -> Vector2:
	return Vector2(position.x, position.z)


static func _circle(lines: PackedVector3Array, center: Vector3, right: Vector3, forward: Vector3) -> void:
	for side in SIDES:
		for step in 2:
			var angle := TAU * (side + step) / SIDES
			lines.append(center + right * cos(angle) + forward * sin(angle))
