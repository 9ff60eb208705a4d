extends RefCounted
## A birch of about 15 m: a slender white trunk, thin branches, and a light, narrow crown.

const Builder := preload("res://meshes/mesh_builder.gd")
const Atlas := preload("res://meshes/leaf_atlas.gd")
const Crown := preload("res://meshes/leaf_crown.gd")
const BARK := Color(0.62, 0.6, 0.56)
const TWIGS := Color(0.22, 0.17, 0.14)
const LOW := Color(0.19, 0.25, 0.065)
const HIGH := Color(0.43, 0.48, 0.15)
const BARK_KIND := 2


## Builds the tree. The number [param variant] determines its individual shape.
static func build(variant: int) -> Builder:
	var rng := RandomNumberGenerator.new()
	rng.seed = 1900 + variant
	var clumps := _clumps(rng, variant)
	var leaves := Crown.new()
	leaves.region = Atlas.BROADLEAF
	leaves.low = LOW
	leaves.high = HIGH
	leaves.center = Vector3(0.0, 8.4, 0.0)
	leaves.radius = 4.4
	leaves.heights = Vector2(4.0, 15.0)
	leaves.flatness = 1.5
	leaves.random = rng
	var builder := Builder.new()
	builder.begin_level()
	_trunk(builder, clumps, 7)
	leaves.add(builder, clumps, 11, 0.58)
	builder.begin_level()
	_trunk(builder, clumps.slice(0, 5), 4)
	leaves.add(builder, clumps, 5, 0.88)
	builder.begin_level()
	_trunk(builder, [], 3)
	leaves.add(builder, clumps, 2, 1.35)
	builder.begin_level()
	_trunk(builder, [], 3)
	builder.crossed(Vector3(0.0, 3.4, 0.0), 3.2, 11.9, Atlas.CROWN, LOW.lerp(HIGH, 0.3), LOW.lerp(HIGH, 0.85), 3)
	builder.card(Vector3.UP * 8.6, Vector3.RIGHT * 2.3, Vector3.FORWARD * 2.3, Vector3.UP, Atlas.CROWN, LOW.lerp(HIGH, 0.8), 0.7)
	builder.end(PackedFloat32Array([35.0, 90.0, 200.0]))
	return builder


## Returns the center and radius of the crown's clumps, as Vector4(x, y, z, radius).
static func _clumps(rng: RandomNumberGenerator, variant: int) -> Array[Vector4]:
	var result: Array[Vector4] = []
	var count := 21
	for i in count:
		var fraction := (i + 0.5) / count
		var angle := i * 2.39996 + 1.7 * variant
		var distance := 2.5 * sin(PI * clampf(fraction * 0.82 + 0.2, 0.0, 1.0)) * rng.randf_range(0.7, 1.15)
		result.append(Vector4(cos(angle) * distance, 4.4 + 9.4 * fraction - 0.25 * distance, sin(angle) * distance, rng.randf_range(0.65, 1.05)))
	result.append(Vector4(0.0, 14.0, 0.0, 0.8))
	return result


## Adds the trunk, and branches to the clumps.
static func _trunk(builder: Builder, clumps: Array[Vector4], sides: int) -> void:
	var bend := Vector3(0.25, 6.0, 0.1)
	builder.tube(Vector3(0.0, -0.6, 0.0), Vector3(0.0, 0.35, 0.0), 0.34, 0.21, sides, BARK * 0.6, BARK_KIND)
	builder.tube(Vector3(0.0, 0.35, 0.0), bend, 0.21, 0.15, sides, BARK, BARK_KIND)
	builder.tube(bend, Vector3(0.0, 13.6, 0.0), 0.15, 0.03, maxi(3, sides - 2), BARK * 0.9, BARK_KIND)
	for clump in clumps:
		var end := Vector3(clump.x, clump.y + 0.4, clump.z)
		var start := Vector3(0.12, clump.y - 0.9 - 0.3 * Vector2(clump.x, clump.z).length(), 0.05)
		builder.tube(start, end, 0.055, 0.02, 3, TWIGS, BARK_KIND)
