extends RefCounted
## A saguaro, 4 to 6 m high: a ribbed column with lifted arms.

const Builder := preload("res://meshes/mesh_builder.gd")
const LOW := Color(0.15, 0.2, 0.09)
const HIGH := Color(0.35, 0.41, 0.23)


## Builds the cactus. The number [param variant] is also the number of its arms.
static func build(variant: int) -> Builder:
	var builder := Builder.new()
	for level in 3:
		var rng := RandomNumberGenerator.new()
		rng.seed = 3100 + variant
		var ribs: int = [11, 7, 3][level]
		builder.begin_level()
		_column(builder, [Vector3(0.0, -0.3, 0.0), Vector3(0.0, 2.0, 0.0), Vector3(0.0, 4.3 + 0.4 * variant, 0.0)], 0.3, ribs)
		for arm in variant:
			var angle := arm * 2.6 + variant
			var radial := Vector3(cos(angle), 0.0, sin(angle))
			var root := Vector3.UP * rng.randf_range(1.5, 2.4)
			var elbow := root + radial * rng.randf_range(0.6, 0.8) + Vector3.UP * 0.2
			_column(builder, [root, elbow, elbow + radial * 0.1 + Vector3.UP * rng.randf_range(1.0, 1.9)], 0.19, ribs)
	builder.end(PackedFloat32Array([30.0, 110.0]))
	return builder


## Adds a column with a round end along three points. Every second line along the column is a groove.
static func _column(builder: Builder, points: Array[Vector3], radius: float, ribs: int) -> void:
	var rows: Array[PackedInt32Array] = []
	var path: Array[Vector3] = [points[0], points[1], points[2]]
	var radii := [radius * 0.85, radius, radius * 0.92]
	var top := (points[2] - points[1]).normalized()
	for cap: Vector2 in [Vector2(0.55, 0.75), Vector2(0.85, 0.4)]:
		path.append(points[2] + top * radius * cap.x)
		radii.append(radius * cap.y)
	var sides := ribs * 2 if ribs > 4 else ribs
	for i in path.size():
		var axis := (path[mini(i + 1, path.size() - 1)] - path[maxi(i - 1, 0)]).normalized()
		var right := axis.cross(Vector3.FORWARD if absf(axis.z) < 0.9 else Vector3.RIGHT).normalized()
		var forward := right.cross(axis)
		var row := PackedInt32Array()
		for k in sides + 1:
			var angle := TAU * k / sides
			var radial := right * cos(angle) + forward * sin(angle)
			var is_groove := k % 2 == 1 and ribs > 4
			var color := LOW.lerp(HIGH, (0.25 if is_groove else 0.8) * (0.6 + 0.1 * i))
			row.append(builder.vertex(path[i] + radial * float(radii[i]) * (0.8 if is_groove else 1.0), radial + axis * (0.5 if i > 2 else 0.0), color, Builder.OPAQUE_UV))
		rows.append(row)
	var tip := builder.vertex(points[2] + top * radius, top, HIGH, Builder.OPAQUE_UV)
	for i in rows.size() - 1:
		for k in sides:
			builder.quad(rows[i][k], rows[i + 1][k], rows[i + 1][k + 1], rows[i][k + 1])
	var last_row := rows[rows.size() - 1]
	for k in sides:
		builder.triangle(last_row[k], tip, last_row[k + 1])
