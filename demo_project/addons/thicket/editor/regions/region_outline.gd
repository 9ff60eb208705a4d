@tool
extends RefCounted
## Computes the lines of the gizmo of a [ScatterRegion3D]: its shape and its border on the ground.

const SIDES := 48


## Returns the edges of a box, sphere or cylinder, as pairs of end points in the node's local space, or an empty array for polygons
## and paths.
static func body(region: ScatterRegion3D) -> PackedVector3Array:
	var lines := PackedVector3Array()
	var radius := region.radius
	match region.shape:
		ScatterRegion3D.SHAPE_BOX:
			var half_size := 0.5 * region.size
			for axis in 3:
				for corner in 4:
					var from := half_size
					from[(axis + 1) % 3] *= 1.0 if corner & 1 else -1.0
					from[(axis + 2) % 3] *= 1.0 if corner & 2 else -1.0
					var to := from
					to[axis] = -from[axis]
					lines.append_array([from, to])
		ScatterRegion3D.SHAPE_SPHERE:
			_circle(lines, Vector3.ZERO, Vector3.RIGHT * radius, Vector3.BACK * radius)
			_circle(lines, Vector3.ZERO, Vector3.RIGHT * radius, Vector3.UP * radius)
			_circle(lines, Vector3.ZERO, Vector3.BACK * radius, Vector3.UP * radius)
		ScatterRegion3D.SHAPE_CYLINDER:
			var up: Vector3 = Vector3.UP * 0.5 * region.height
			_circle(lines, up, Vector3.RIGHT * radius, Vector3.BACK * radius)
			_circle(lines, -up, Vector3.RIGHT * radius, Vector3.BACK * radius)
			for side: Vector3 in [Vector3.RIGHT, Vector3.BACK, Vector3.LEFT, Vector3.FORWARD]:
				lines.append_array([side * radius - up, side * radius + up])
	return lines


## Returns the region's borders as seen from above, moved inward by [param distance] meters, as closed lines of world x and z.
static func borders(region: ScatterRegion3D, distance: float) -> Array[PackedVector2Array]:
	match region.shape:
		ScatterRegion3D.SHAPE_PATH:
			return strip(_flat(path_positions(region)), 0.5 * region.width - distance)
		ScatterRegion3D.SHAPE_POLYGON:
			return inset(_flat(corners(region)), distance)
		_:
			return inset(hull(_flat(region.global_transform * body(region))), distance)


## Returns the outlines of a strip along a line, or an empty array if there is no line or no width.
static func strip(points: PackedVector2Array, half_width: float) -> Array[PackedVector2Array]:
	if half_width > 0.0 and points.size() > 1:
		return Geometry2D.offset_polyline(points, half_width, Geometry2D.JOIN_ROUND, Geometry2D.END_ROUND)
	return []


## Returns an outline, moved inward, or an empty array if nothing of it is left.
static func inset(outline: PackedVector2Array, distance: float) -> Array[PackedVector2Array]:
	if outline.size() < 3:
		return []
	if distance <= 0.0:
		return [outline]
	if Geometry2D.is_polygon_clockwise(outline):
		outline.reverse()
	return Geometry2D.offset_polygon(outline, -distance, Geometry2D.JOIN_MITER)


## Returns the corners of the convex hull of points.
static func hull(points: PackedVector2Array) -> PackedVector2Array:
	var outline := Geometry2D.convex_hull(points)
	# The hull ends with a copy of its first point.
	outline.resize(maxi(0, outline.size() - 1))
	return outline


## Returns the world positions of the corners of a polygon.
static func corners(region: ScatterRegion3D) -> PackedVector3Array:
	var positions := PackedVector3Array()
	for corner in region.polygon:
		positions.append(region.global_transform * Vector3(corner.x, 0.0, corner.y))
	return positions


## Returns the world positions of the points of the region's path, or an empty array if there is no path.
static func path_positions(region: ScatterRegion3D) -> PackedVector3Array:
	var path := path_node(region)
	if path == null or path.curve == null:
		return PackedVector3Array()
	return path.global_transform * path.curve.tessellate(4, 3.0)


## Returns the region's path, or null if there is none.
static func path_node(region: ScatterRegion3D) -> Path3D:
	return (region.get_parent() if region.path.is_empty() else region.get_node_or_null(region.path)) as Path3D


## Returns the x and z of positions.
static func _flat(positions: PackedVector3Array) -> PackedVector2Array:
	var points := PackedVector2Array()
	for position in positions:
		points.append(Vector2(position.x, position.z))
	return points


static func _circle(lines: PackedVector3Array, center: Vector3, right: Vector3, forward: Vector3) -> void:
	for side in SIDES:
		for step in 2:
			var angle := TAU * (side + step) / SIDES
			lines.append(center + right * cos(angle) + forward * sin(angle))
