extends RefCounted
## A fallen trunk, 3.5 m long, half sunk into the ground. Driftwood is paler.

const Builder := preload("res://meshes/mesh_builder.gd")
const BARKS: Array[Color] = [Color(0.3, 0.23, 0.165), Color(0.58, 0.54, 0.48)]
const WOODS: Array[Color] = [Color(0.52, 0.4, 0.26), Color(0.54, 0.49, 0.41)]


## Builds the trunk. The number [param variant] determines its individual shape. Odd variants are driftwood.
static func build(variant: int) -> Builder:
	var bark := BARKS[variant % 2]
	var builder := Builder.new()
	for level in 3:
		var rng := RandomNumberGenerator.new()
		rng.seed = 3500 + variant
		var sides: int = [10, 6, 4][level]
		builder.begin_level()
		var start_point := Vector3(-1.7, 0.14, 0.05)
		var end_point := Vector3(1.8, 0.1, -0.1)
		builder.tube(start_point, Vector3(0.1, 0.16, 0.0), 0.27, 0.24, sides, bark, 0)
		builder.tube(Vector3(0.1, 0.16, 0.0), end_point, 0.24, 0.17, sides, bark, 0)
		_end(builder, start_point, Vector3.LEFT, 0.27, sides, WOODS[variant % 2])
		_end(builder, end_point, Vector3.RIGHT, 0.17, sides, WOODS[variant % 2])
		for branch: int in [4, 2, 0][level]:
			var start := Vector3(-1.0 + 0.75 * branch, 0.25, 0.0)
			var direction := Vector3(1.0, rng.randf_range(0.3, 0.7), rng.randf_range(-1.3, 1.3)).normalized()
			builder.tube(start, start + direction * rng.randf_range(0.25, 0.5), 0.06, 0.025, 3, bark * 0.85, 0)
	builder.end(PackedFloat32Array([20.0, 60.0]))
	return builder


static func _end(builder: Builder, center: Vector3, normal: Vector3, radius: float, sides: int, wood: Color) -> void:
	var middle_vertex := builder.vertex(center + normal * 0.03, normal, wood, Builder.OPAQUE_UV)
	var ring: Array[int] = []
	for i in sides + 1:
		var angle := TAU * i / sides
		ring.append(builder.vertex(center + Vector3(0.0, sin(angle), cos(angle)) * radius, normal, wood * 0.75, Builder.OPAQUE_UV))
	for i in sides:
		if normal.x > 0.0:
			builder.triangle(middle_vertex, ring[i], ring[i + 1])
		else:
			builder.triangle(middle_vertex, ring[i + 1], ring[i])
