extends RefCounted
## A group of moss cushions, 0.6 m wide. The y axis points away from the surface below it.

const Builder := preload("res://meshes/mesh_builder.gd")
const LOW := Color(0.17, 0.21, 0.05, 0.8)
const HIGH := Color(0.29, 0.35, 0.1)


## Builds the moss. The number [param variant] determines its individual shape.
static func build(variant: int) -> Builder:
	var builder := Builder.new()
	for level in 3:
		var rng := RandomNumberGenerator.new()
		rng.seed = 4100 + variant
		builder.begin_level()
		for i: int in [7, 4, 2][level]:
			var angle := i * 2.39996 + variant
			var distance := 0.2 * sqrt(i)
			var size: float = rng.randf_range(0.09, 0.15) * (1.0 - 0.05 * i) * [1.0, 1.15, 1.5][level]
			var lean := Vector3(rng.randf_range(-0.2, 0.2), 1.0, rng.randf_range(-0.2, 0.2)).normalized()
			_cushion(builder, Vector3(cos(angle) * distance * 0.6, -0.02, sin(angle) * distance * 0.6), lean, size, [7, 6, 5][level], level)
			if level == 0:
				_leaves(builder, Vector3(cos(angle) * distance * 0.6, -0.02, sin(angle) * distance * 0.6), size, rng)
	builder.end(PackedFloat32Array([6.0, 15.0]))
	return builder


static func _cushion(builder: Builder, base: Vector3, axis: Vector3, size: float, sides: int, level: int) -> void:
	var middle := LOW.lerp(HIGH, 0.45)
	var profile := PackedVector2Array([Vector2(size, 0.0), Vector2(size * 0.8, size * 0.26), Vector2(size * 0.42, size * 0.4), Vector2(0.0, size * 0.44)])
	var colors := PackedColorArray([LOW, middle, HIGH, HIGH])
	if level > 0:
		profile.remove_at(2)
		colors.remove_at(2)
	builder.revolve(base, axis, profile, colors, sides)


## Adds short leaves, so that the outline of the cushion is soft.
static func _leaves(builder: Builder, base: Vector3, size: float, rng: RandomNumberGenerator) -> void:
	for i in 9:
		var angle := i * 2.39996
		var elevation := rng.randf_range(0.3, 1.5)
		var direction := Vector3(cos(angle) * cos(elevation), sin(elevation), sin(angle) * cos(elevation))
		var side := Vector3(-sin(angle), 0.0, cos(angle)) * 0.012
		var root := base + direction * size * Vector3(0.85, 0.4, 0.85)
		var color := LOW.lerp(HIGH, rng.randf_range(0.5, 1.2))
		builder.triangle(builder.vertex(root - side, direction, color * 0.8, Builder.OPAQUE_UV), builder.vertex(root + direction * 0.04, direction, color, Builder.OPAQUE_UV),
				builder.vertex(root + side, direction, color * 0.8, Builder.OPAQUE_UV))
