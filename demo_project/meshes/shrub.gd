extends RefCounted
## A round shrub of about 1.7 m: three clumps of leaf sprays on the ground.

const Builder := preload("res://meshes/mesh_builder.gd")
const Atlas := preload("res://meshes/leaf_atlas.gd")
const CORE := Color(0.09, 0.15, 0.045, 0.55)
const LOW := Color(0.11, 0.2, 0.045)
const HIGH := Color(0.34, 0.41, 0.13)


## Builds the shrub with the number [param variant].
static func build(variant: int) -> Builder:
	var rng := RandomNumberGenerator.new()
	rng.seed = 500 + variant
	var clumps: Array[Vector4] = []
	for i in 3:
		var angle := i * 2.1 + variant
		var radius := rng.randf_range(0.55, 0.8)
		clumps.append(Vector4(cos(angle) * 0.55, radius * 0.85, sin(angle) * 0.55, radius))
	clumps.append(Vector4(0.0, 1.0, 0.0, 0.62))
	var builder := Builder.new()
	builder.begin_level()
	_leaves(builder, clumps, 15, 0.36, rng)
	_cores(builder, clumps, 0.72, CORE, CORE, rng)
	builder.begin_level()
	_leaves(builder, clumps, 5, 0.6, rng)
	_cores(builder, clumps, 0.8, CORE, LOW, rng)
	builder.begin_level()
	builder.blob(Vector3(0.0, 0.7, 0.0), Vector3(1.1, 0.85, 1.1), 0, 0.15, Color(LOW, 0.5), HIGH * 0.8, rng)
	builder.end(PackedFloat32Array([40.0, 110.0]))
	return builder


static func _leaves(builder: Builder, clumps: Array[Vector4], count: int, size: float,
		rng: RandomNumberGenerator) -> void:
	for clump in clumps:
		for i in count:
			var y := 1.0 - 1.5 * (i + 0.5) / count
			var angle := i * 2.39996 + rng.randf()
			var ring := sqrt(maxf(0.0, 1.0 - y * y))
			var out := Vector3(cos(angle) * ring, y, sin(angle) * ring)
			var position := Vector3(clump.x, clump.y, clump.z) + out * clump.w * rng.randf_range(0.65, 1.0)
			var face := (out + Vector3(rng.randf_range(-0.6, 0.6), rng.randf_range(-0.2, 0.6),
					rng.randf_range(-0.6, 0.6))).normalized()
			var right := face.cross(Vector3.UP + Vector3(0.01, 0.0, 0.0)).normalized().rotated(face, rng.randf() * TAU)
			var height := clampf(position.y / 1.6, 0.0, 1.0)
			var color := LOW.lerp(HIGH, clampf(height * 0.8 + rng.randf_range(-0.1, 0.25), 0.0, 1.0))
			color.a = clampf(0.3 + 0.75 * height, 0.0, 1.0)
			var normal := position * Vector3(1.0, 0.8, 1.0) + Vector3.UP * 0.4 + out * 0.3
			var extent := size * rng.randf_range(0.85, 1.25)
			builder.card(position, right * extent, right.cross(face) * extent, normal, Atlas.BROADLEAF, color)


static func _cores(builder: Builder, clumps: Array[Vector4], size: float, low: Color, high: Color,
		rng: RandomNumberGenerator) -> void:
	for clump in clumps:
		var radii := Vector3(clump.w, clump.w * 0.9, clump.w) * size
		builder.blob(Vector3(clump.x, clump.y, clump.z), radii, 0, 0.12, low, high, rng)
