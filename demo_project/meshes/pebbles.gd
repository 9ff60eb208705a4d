extends RefCounted
## A handful of small stones, 0.5 m wide.

const Builder := preload("res://meshes/mesh_builder.gd")
const Stone := preload("res://meshes/stone.gd")


## Builds the stones. The number [param variant] determines their individual shapes.
static func build(variant: int) -> Builder:
	var builder := Builder.new()
	for level in 2:
		builder.begin_level()
		var rng := RandomNumberGenerator.new()
		rng.seed = 2900 + variant
		for i in 4:
			var angle := i * 2.39996
			var size := rng.randf_range(0.05, 0.13)
			var position := Vector3(cos(angle), 0.0, sin(angle)) * 0.22 * sqrt(i + 0.5) * rng.randf_range(0.7, 1.0)
			var stretch := Vector3(size, size * rng.randf_range(0.45, 0.7), size * rng.randf_range(0.7, 1.0))
			Stone.rock(builder, 1 - level, 2900 + 10 * variant + i, stretch, position + Vector3.UP * stretch.y * 0.3, Stone.LOW, Stone.HIGH)
	builder.end(PackedFloat32Array([10.0]))
	return builder
