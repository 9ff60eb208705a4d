extends RefCounted
## A broadleaf tree of about 16 m: a forked trunk and a round crown of leaf sprays around dark cores.

const Builder := preload("res://meshes/mesh_builder.gd")
const Atlas := preload("res://meshes/leaf_atlas.gd")
const BARK := Color(0.26, 0.2, 0.15)
const CORE := Color(0.06, 0.11, 0.028, 0.4)
const LOW := Color(0.11, 0.2, 0.035)
const HIGH := Color(0.4, 0.5, 0.1)


## Fills [param mesh] with the tree that [param variant] names.
static func build(mesh: ArrayMesh, variant: int, material: Material) -> void:
	var rng := RandomNumberGenerator.new()
	rng.seed = 100 + variant
	var clumps := _clumps(rng, variant)
	var builder := Builder.new()
	builder.begin_level()
	_trunk(builder, clumps, 7)
	_crown(builder, clumps, 13, 1.0, rng)
	_cores(builder, clumps, 0, 0.72, CORE, CORE.lightened(0.02), rng)
	builder.begin_level()
	_trunk(builder, clumps.slice(0, 3), 4)
	_crown(builder, clumps, 5, 1.55, rng)
	_cores(builder, clumps, 0, 0.8, CORE, CORE.lightened(0.02), rng)
	builder.begin_level()
	_trunk(builder, [], 3)
	_crown(builder, clumps, 2, 1.5, rng)
	_cores(builder, clumps.slice(0, 6), 0, 0.95, LOW * 0.8, LOW.lerp(HIGH, 0.5), rng)
	builder.begin_level()
	_trunk(builder, [], 3)
	builder.blob(Vector3(0.0, 10.0, 0.0), Vector3(4.9, 5.2, 4.9), 0, 0.14, Color(LOW, 0.55), Color(LOW.lerp(HIGH, 0.72), 1.0), Vector2(0.3, 0.5), rng)
	builder.commit(mesh, PackedFloat32Array([70.0, 190.0, 520.0]), material)


## Centre and radius of the crown's clumps, as Vector4(x, y, z, radius).
static func _clumps(rng: RandomNumberGenerator, variant: int) -> Array[Vector4]:
	var result: Array[Vector4] = []
	var count := 11
	var wide := 1.0 + 0.14 * (variant % 3)
	for i in count:
		# A golden-angle spiral from the crown's shoulder to its top keeps the clumps apart.
		var along := (i + 0.5) / count
		var angle := i * 2.39996 + variant
		var reach := 3.7 * wide * sqrt(1.0 - pow(along * 1.04 - 0.12, 2.0)) * (0.55 if i > count - 4 else 1.0)
		var height := 6.6 + 7.4 * along + rng.randf_range(-0.5, 0.5)
		var radius := rng.randf_range(1.9, 2.5)
		result.append(Vector4(cos(angle) * reach, height, sin(angle) * reach, radius))
	result.append(Vector4(0.0, 10.0, 0.0, 3.2))
	return result


static func _trunk(builder: Builder, clumps: Array[Vector4], sides: int) -> void:
	var fork := Vector3(0.12, 5.2, -0.1)
	builder.tube(Vector3(0.0, -0.8, 0.0), Vector3(0.0, 0.5, 0.0), 0.72, 0.46, sides, BARK * 0.85, 0.0, 0.0)
	builder.tube(Vector3(0.0, 0.5, 0.0), fork, 0.46, 0.32, sides, BARK, 0.0, 0.04)
	builder.tube(fork, Vector3(0.0, 11.0, 0.0), 0.3, 0.1, maxi(3, sides - 2), BARK * 0.8, 0.04, 0.2)
	for i in mini(clumps.size(), 6):
		var clump := clumps[i]
		var end := Vector3(clump.x, clump.y, clump.z)
		var start := fork + Vector3.UP * (0.3 * i - 0.5)
		builder.tube(start, start.lerp(end, 0.85), 0.2, 0.06, maxi(3, sides - 3), BARK * 0.8, 0.04, 0.25)


static func _crown(builder: Builder, clumps: Array[Vector4], cards: int, size: float, rng: RandomNumberGenerator) -> void:
	var heart := Vector3(0.0, 8.6, 0.0)
	for clump in clumps:
		var center := Vector3(clump.x, clump.y, clump.z)
		for i in cards:
			var out := _direction(i, cards, rng)
			# Few leaves where nobody looks: inside, and below.
			if out.dot(center - heart) < -1.2 and out.y < 0.5:
				continue
			var position := center + out * clump.w * rng.randf_range(0.55, 0.95)
			var normal := (position - heart).normalized() * 0.75 + out * 0.45 + Vector3.UP * 0.2
			var face := (out + Vector3(rng.randf_range(-0.7, 0.7), rng.randf_range(-0.3, 0.7), rng.randf_range(-0.7, 0.7))).normalized()
			var right := face.cross(Vector3.UP + Vector3(0.01, 0.0, 0.0)).normalized().rotated(face, rng.randf() * TAU)
			var up := right.cross(face)
			var extent := size * rng.randf_range(1.0, 1.4)
			var height := clampf((position.y - 5.0) / 10.5, 0.0, 1.0)
			var depth := clampf((position - heart).length() / 6.2, 0.0, 1.0)
			var color := LOW.lerp(HIGH, clampf(0.15 + 0.75 * height * depth + rng.randf_range(-0.12, 0.2), 0.0, 1.0))
			color.a = clampf(0.25 + 0.5 * depth + 0.35 * height, 0.0, 1.0)
			builder.card(position, right * extent, up * extent, normal, Atlas.BROADLEAF, color, Vector2(0.3 + 0.4 * depth, rng.randf()))


static func _cores(builder: Builder, clumps: Array[Vector4], subdivisions: int, size: float, low: Color, high: Color, rng: RandomNumberGenerator) -> void:
	for clump in clumps:
		var radius := clump.w * size
		builder.blob(Vector3(clump.x, clump.y, clump.z) * Vector3(0.92, 1.0, 0.92), Vector3(radius, radius * 0.85, radius), subdivisions, 0.12, low, high, Vector2(0.25, 0.5), rng)


## The i-th of n directions spread over the sphere.
static func _direction(i: int, n: int, rng: RandomNumberGenerator) -> Vector3:
	var y := 1.0 - 2.0 * (i + 0.5) / n
	var angle := i * 2.39996 + rng.randf() * 0.8
	var ring := sqrt(1.0 - y * y)
	return Vector3(cos(angle) * ring, y, sin(angle) * ring)
