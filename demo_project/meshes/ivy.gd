extends RefCounted
## Ivy. Even variants are a mat of leaves, 1.2 m wide, that lies on the surface below it; the y axis points away from the surface. Odd variants are shoots that
## hang straight down for up to 2 m.

const Builder := preload("res://meshes/mesh_builder.gd")
const Atlas := preload("res://meshes/leaf_atlas.gd")
const STEM := Color(0.2, 0.16, 0.09)
const LOW := Color(0.1, 0.17, 0.045, 0.7)
const HIGH := Color(0.29, 0.4, 0.13)


## Builds the ivy. The number [param variant] determines its individual shape.
static func build(variant: int) -> Builder:
	var builder := Builder.new()
	for level in 3:
		var rng := RandomNumberGenerator.new()
		rng.seed = 4300 + variant
		builder.begin_level()
		if variant % 2 == 0:
			_mat(builder, [24, 11, 5][level], [0.19, 0.27, 0.4][level], rng)
		else:
			_shoots(builder, [7, 5, 3][level], [9, 5, 3][level], [0.13, 0.18, 0.27][level], rng)
	builder.end(PackedFloat32Array([14.0, 38.0]))
	return builder


static func _mat(builder: Builder, count: int, size: float, rng: RandomNumberGenerator) -> void:
	for i in count:
		var fraction := (i + 0.5) / count
		var angle := i * 2.39996
		var position := Vector3(cos(angle), 0.0, sin(angle)) * 0.6 * sqrt(fraction) + Vector3.UP * (0.04 + 0.16 * (1.0 - fraction) * rng.randf())
		_leaf(builder, position, Vector3.UP + Vector3(rng.randf_range(-0.6, 0.6), 0.0, rng.randf_range(-0.6, 0.6)), size, rng)


static func _shoots(builder: Builder, count: int, leaves: int, size: float, rng: RandomNumberGenerator) -> void:
	for i in count:
		var angle := i * 2.39996
		var root := Vector3(cos(angle), 0.0, sin(angle)) * 0.45 * sqrt((i + 0.5) / count) + Vector3.UP * 0.25
		var tip := root + Vector3(rng.randf_range(-0.12, 0.12), -rng.randf_range(0.8, 2.2), rng.randf_range(-0.12, 0.12))
		builder.tube(root, tip, 0.012, 0.004, 3, STEM, 0)
		for leaf in leaves:
			var position := root.lerp(tip, (leaf + rng.randf_range(0.3, 0.9)) / leaves)
			var normal := Vector3(rng.randf_range(-1.0, 1.0), 0.35, rng.randf_range(-1.0, 1.0))
			_leaf(builder, position + normal * 0.06, normal, size * (1.25 - 0.6 * leaf / leaves), rng)


static func _leaf(builder: Builder, position: Vector3, normal: Vector3, size: float, rng: RandomNumberGenerator) -> void:
	var face := normal.normalized()
	var right := face.cross(Vector3(rng.randf_range(-1.0, 1.0), 0.2, rng.randf_range(-1.0, 1.0))).normalized()
	builder.card(position, right * size, right.cross(face) * size, face, Atlas.BROADLEAF, LOW.lerp(HIGH, rng.randf()), 0.4)
