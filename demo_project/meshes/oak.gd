extends RefCounted
## A broadleaf tree of about 16 m: a forked trunk and a round crown of leaf sprays around dark cores.

const Builder := preload("res://meshes/mesh_builder.gd")
const Atlas := preload("res://meshes/leaf_atlas.gd")
const BARK := Color(0.37, 0.3, 0.225)
const CORE := Color(0.1, 0.165, 0.045, 0.5)
const LOW := Color(0.1, 0.175, 0.04)
const HIGH := Color(0.29, 0.375, 0.11)


## Builds the tree with the number [param variant].
static func build(variant: int) -> Builder:
	var rng := RandomNumberGenerator.new()
	rng.seed = 100 + variant
	var clumps := _clumps(rng, variant)
	var builder := Builder.new()
	var heart: Array[Vector4] = [Vector4(0.0, 9.4, 0.0, 3.7)]
	builder.begin_level()
	_trunk(builder, clumps, 6)
	_crown(builder, clumps, 15, 1.0, rng)
	_crown(builder, heart, 16, 1.1, rng)
	_cores(builder, clumps.slice(3, 9) + heart, 0.42, CORE, CORE, rng)
	builder.begin_level()
	_trunk(builder, [], 4)
	_crown(builder, clumps, 5, 1.6, rng)
	_cores(builder, clumps.slice(0, 3) + heart, 0.9, CORE, CORE, rng)
	builder.begin_level()
	_stem(builder)
	_crown(builder, clumps, 2, 2.05, rng)
	_cores(builder, heart, 1.08, LOW * 0.7, LOW.lerp(HIGH, 0.35), rng)
	builder.begin_level()
	_stem(builder)
	_crown(builder, clumps.slice(2), 1, 2.3, rng)
	_far_crown(builder, 1.05, rng)
	builder.end(PackedFloat32Array([80.0, 220.0, 500.0]))
	return builder


## The center and radius of the crown's clumps, as Vector4(x, y, z, radius).
static func _clumps(rng: RandomNumberGenerator, variant: int) -> Array[Vector4]:
	var result: Array[Vector4] = []
	var count := 11
	var wide := 1.0 + 0.14 * (variant % 3)
	for i in count:
		# A golden-angle spiral from the crown's shoulder to its top keeps the clumps apart.
		var along := (i + 0.5) / count
		var angle := i * 2.39996 + variant
		var reach := 3.7 * wide * sqrt(1.0 - pow(along * 1.04 - 0.12, 2.0)) * (0.6 if i > count - 4 else 1.0)
		var height := 6.6 + 7.4 * along + rng.randf_range(-0.5, 0.5)
		var radius := rng.randf_range(1.9, 2.5)
		result.append(Vector4(cos(angle) * reach, height, sin(angle) * reach, radius))
	result.append(Vector4(0.3, 13.0, -0.2, 2.3))
	return result


static func _trunk(builder: Builder, clumps: Array[Vector4], sides: int) -> void:
	var fork := Vector3(0.12, 5.2, -0.1)
	builder.tube(Vector3(0.0, -0.8, 0.0), Vector3(0.0, 0.5, 0.0), 0.72, 0.46, sides, BARK * 0.85, 0)
	builder.tube(Vector3(0.0, 0.5, 0.0), fork, 0.46, 0.32, sides, BARK, 0)
	builder.tube(fork, Vector3(0.0, 11.0, 0.0), 0.3, 0.1, maxi(3, sides - 2), BARK * 0.8, 0)
	for i in mini(clumps.size(), 6):
		var clump := clumps[i]
		var end := Vector3(clump.x, clump.y, clump.z)
		var start := fork + Vector3.UP * (0.3 * i - 0.5)
		builder.tube(start, start.lerp(end, 0.85), 0.2, 0.06, maxi(3, sides - 3), BARK * 0.8, 0)


## The trunk for far away.
static func _stem(builder: Builder) -> void:
	builder.tube(Vector3(0.0, -0.8, 0.0), Vector3(0.0, 6.5, 0.0), 0.5, 0.3, 3, BARK, 0)


## A crown of twenty faces.
static func _far_crown(builder: Builder, size: float, rng: RandomNumberGenerator) -> void:
	builder.blob(Vector3(0.0, 9.2, 0.0), Vector3(3.9, 4.4, 3.9) * size, 0, 0.16, Color(LOW * 0.75, 0.5),
			LOW.lerp(HIGH, 0.62), rng)


## Adds leaf sprays around each clump on its visible sides, not towards the crown's center.
static func _crown(builder: Builder, clumps: Array[Vector4], cards: int, size: float,
		rng: RandomNumberGenerator) -> void:
	var heart := Vector3(0.0, 8.4, 0.0)
	for clump in clumps:
		var center := Vector3(clump.x, clump.y, clump.z)
		var outward := (center - heart).normalized()
		for i in cards:
			var out := _direction(i, cards, rng)
			if out.dot(outward) < -0.35:
				out = (out - outward * 2.0 * out.dot(outward)).normalized()
			var position := center + out * clump.w * (rng.randf_range(0.6, 0.85) if cards > 2 else 0.35)
			var from_heart := position - heart
			var normal := from_heart.normalized() * 0.8 + out * 0.4 + Vector3.UP * 0.25
			var face := (out + outward * 0.4 + Vector3(rng.randf_range(-0.4, 0.4), rng.randf_range(-0.2, 0.5),
					rng.randf_range(-0.4, 0.4))).normalized()
			var right := face.cross(Vector3.UP + Vector3(0.01, 0.0, 0.0)).normalized().rotated(face, rng.randf() * TAU)
			var extent := size * rng.randf_range(1.0, 1.35)
			var height := clampf((position.y - 5.0) / 9.5, 0.0, 1.0)
			var depth := clampf(from_heart.length() / 5.6, 0.0, 1.0)
			var color := LOW.lerp(HIGH, clampf(0.12 + 0.95 * height * depth + rng.randf_range(-0.1, 0.18), 0.0, 1.0))
			color.a = clampf(0.2 + 0.5 * depth + 0.35 * height, 0.0, 1.0)
			builder.card(position, right * extent, right.cross(face) * extent, normal, Atlas.BROADLEAF, color)


## Adds dark round bodies that fill the crown behind the leaves.
static func _cores(builder: Builder, clumps: Array[Vector4], size: float, low: Color, high: Color,
		rng: RandomNumberGenerator) -> void:
	for clump in clumps:
		var radius := clump.w * size
		var radii := Vector3(radius, radius * 0.9, radius)
		builder.blob(Vector3(clump.x * 0.85, clump.y, clump.z * 0.85), radii, 0, 0.15, low, high, rng)


## The i-th of n directions spread over the sphere.
static func _direction(i: int, n: int, rng: RandomNumberGenerator) -> Vector3:
	var y := 1.0 - 2.0 * (i + 0.5) / n
	var angle := i * 2.39996 + rng.randf() * 0.8
	var ring := sqrt(1.0 - y * y)
	return Vector3(cos(angle) * ring, y, sin(angle) * ring)
