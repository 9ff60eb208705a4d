extends RefCounted
## A broadleaf tree of about 16 m, with a forked trunk and a crown of leaf sprays that is round, wide or tall.

const Builder := preload("res://meshes/mesh_builder.gd")
const Atlas := preload("res://meshes/leaf_atlas.gd")
const Crown := preload("res://meshes/leaf_crown.gd")
const BARK := Color(0.37, 0.3, 0.225)
const LOW := Color(0.155, 0.24, 0.06)
const HIGH := Color(0.31, 0.395, 0.115)
## The shapes of the crown, as factors for its width and height.
const SHAPES: Array[Vector2] = [Vector2(1.0, 1.0), Vector2(1.22, 0.86), Vector2(0.84, 1.14)]
const HEART := Vector3(0.0, 8.6, 0.0)


## Builds the tree. The number [param variant] determines its individual shape.
static func build(variant: int) -> Builder:
	var rng := RandomNumberGenerator.new()
	rng.seed = 100 + variant
	var shape := SHAPES[variant % SHAPES.size()]
	var clumps := clumps_of(rng, variant)
	var inner_clumps: Array[Vector4] = [Vector4(0.0, 9.2 * shape.y, 0.0, 3.6 * shape.x)]
	var builder := Builder.new()
	builder.begin_level()
	trunk(builder, clumps, 7)
	var leaves := crown(shape, rng)
	leaves.add(builder, inner_clumps, 22, 1.3)
	leaves.add(builder, clumps, 22, 1.0)
	builder.begin_level()
	trunk(builder, clumps.slice(0, 4), 4)
	leaves.add(builder, inner_clumps, 10, 1.8)
	leaves.add(builder, clumps, 7, 1.6)
	builder.begin_level()
	_stem(builder)
	leaves.add(builder, inner_clumps, 5, 2.5)
	leaves.add(builder, clumps, 3, 2.3)
	builder.begin_level()
	_stem(builder)
	_far_crown(builder, shape)
	builder.end(PackedFloat32Array([32.0, 90.0, 220.0]))
	return builder


## Returns the center and radius of the crown's clumps, as Vector4(x, y, z, radius).
static func clumps_of(rng: RandomNumberGenerator, variant: int) -> Array[Vector4]:
	var result: Array[Vector4] = []
	var count := 11
	var shape := SHAPES[variant % SHAPES.size()]
	for i in count:
		# A golden-angle spiral from the crown's shoulder to its top keeps the clumps apart.
		var fraction := (i + 0.5) / count
		var angle := i * 2.39996 + variant
		var distance := 3.8 * shape.x * sqrt(1.0 - pow(fraction * 1.04 - 0.12, 2.0)) * (0.6 if i > count - 4 else 1.0)
		var height := (6.4 + 7.4 * fraction) * shape.y + rng.randf_range(-0.6, 0.6)
		var radius := rng.randf_range(1.8, 2.5)
		result.append(Vector4(cos(angle) * distance, height, sin(angle) * distance, radius))
	result.append(Vector4(0.3, 13.2 * shape.y, -0.2, 2.2))
	return result


## Returns the settings of the crown's leaves.
static func crown(shape: Vector2, rng: RandomNumberGenerator) -> Crown:
	var foliage := Crown.new()
	foliage.region = Atlas.BROADLEAF
	foliage.low = LOW
	foliage.high = HIGH
	foliage.center = HEART * shape.y
	foliage.radius = 5.9 * shape.x
	foliage.heights = Vector2(4.8, 15.0) * shape.y
	foliage.random = rng
	return foliage


## Adds the trunk, and branches to the first clumps.
static func trunk(builder: Builder, clumps: Array[Vector4], sides: int) -> void:
	var fork := Vector3(0.12, 5.0, -0.1)
	builder.tube(Vector3(0.0, -0.8, 0.0), Vector3(0.0, 0.5, 0.0), 0.72, 0.46, sides, BARK * 0.85, 0)
	builder.tube(Vector3(0.0, 0.5, 0.0), fork, 0.46, 0.34, sides, BARK, 0)
	builder.tube(fork, Vector3(0.1, 11.0, 0.0), 0.32, 0.08, maxi(3, sides - 2), BARK * 0.8, 0)
	for i in mini(clumps.size(), 7):
		var clump := clumps[i]
		var end := Vector3(clump.x, clump.y, clump.z)
		var start := fork + Vector3.UP * (0.35 * i - 0.4)
		# A branch leaves the trunk steeply and then bends outward.
		var knee := start.lerp(end, 0.45) + Vector3.UP * 0.5
		builder.tube(start, knee, 0.19, 0.12, maxi(3, sides - 3), BARK * 0.8, 0)
		builder.tube(knee, start.lerp(end, 0.9), 0.12, 0.04, 3, BARK * 0.75, 0)


## Adds the trunk of distant LODs.
static func _stem(builder: Builder) -> void:
	builder.tube(Vector3(0.0, -0.8, 0.0), Vector3(0.0, 6.5, 0.0), 0.5, 0.3, 3, BARK, 0)


## Adds the crown of the farthest LOD: crossed images of a crown, and one image that is seen from above.
static func _far_crown(builder: Builder, shape: Vector2) -> void:
	var half_width := 5.9 * shape.x
	builder.crossed(Vector3(0.0, 4.2 * shape.y, 0.0), half_width, 11.2 * shape.y, Atlas.CROWN, LOW.lerp(HIGH, 0.52), LOW.lerp(HIGH, 1.1), 3)
	builder.card(Vector3(0.0, 9.6 * shape.y, 0.0), Vector3.RIGHT * half_width * 0.8, Vector3.FORWARD * half_width * 0.8, Vector3.UP, Atlas.CROWN,
			LOW.lerp(HIGH, 1.07), 0.7)
