extends RefCounted
## A thorny shrub of dry lands, 0.9 m high: a few gray leaves on bare twigs.

const Builder := preload("res://meshes/mesh_builder.gd")
const Atlas := preload("res://meshes/leaf_atlas.gd")
const TWIGS := Color(0.42, 0.34, 0.25)
const LOW := Color(0.36, 0.33, 0.21)
const HIGH := Color(0.62, 0.57, 0.4)


## Builds the shrub. The number [param variant] determines its individual shape.
static func build(variant: int) -> Builder:
	var builder := Builder.new()
	for level in 3:
		var rng := RandomNumberGenerator.new()
		rng.seed = 2500 + variant
		builder.begin_level()
		for twig: int in [16, 9, 5][level]:
			_twig(builder, twig, level, rng)
	builder.end(PackedFloat32Array([22.0, 55.0]))
	return builder


static func _twig(builder: Builder, index: int, level: int, rng: RandomNumberGenerator) -> void:
	var angle := index * 2.39996
	var radial := Vector3(cos(angle), 0.0, sin(angle)) * rng.randf_range(0.35, 0.75)
	var tip := radial + Vector3.UP * rng.randf_range(0.5, 0.95)
	var middle := radial * 0.4 + Vector3.UP * 0.42
	if level < 2:
		builder.tube(Vector3.DOWN * 0.05, middle, 0.02, 0.012, 3, TWIGS * 0.8, 0)
		builder.tube(middle, tip, 0.012, 0.004, 3, TWIGS, 0)
	var size: float = [0.2, 0.28, 0.42][level]
	for leaf in (2 if level == 0 else 1):
		var position := middle.lerp(tip, 0.95 - 0.5 * leaf)
		var face := Vector3(rng.randf_range(-1.0, 1.0), rng.randf_range(0.2, 1.0), rng.randf_range(-1.0, 1.0)).normalized()
		var right := face.cross(radial).normalized()
		var color := LOW.lerp(HIGH, rng.randf())
		builder.card(position, right * size, right.cross(face) * size, radial + Vector3.UP, Atlas.TUFT, color, 0.5)
