extends RefCounted
## A Scots pine of about 19 m, with a bare trunk that is orange above, and flat clumps of needles.

const Builder := preload("res://meshes/mesh_builder.gd")
const Atlas := preload("res://meshes/leaf_atlas.gd")
const Crown := preload("res://meshes/leaf_crown.gd")
const BARK := Color(0.36, 0.27, 0.21)
const UPPER_BARK := Color(0.62, 0.36, 0.2)
const LOW := Color(0.12, 0.18, 0.095)
const HIGH := Color(0.36, 0.45, 0.22)
const BARK_KIND := 1


## Builds the tree. The number [param variant] determines its individual shape.
static func build(variant: int) -> Builder:
	var rng := RandomNumberGenerator.new()
	rng.seed = 2100 + variant
	var lean := Vector3(rng.randf_range(-0.6, 0.6), 0.0, rng.randf_range(-0.6, 0.6))
	var clumps := _clumps(rng, variant, lean)
	var leaves := Crown.new()
	leaves.region = Atlas.TUFT
	leaves.low = LOW
	leaves.high = HIGH
	leaves.center = Vector3(0.0, 14.0, 0.0) + lean
	leaves.radius = 5.2
	leaves.heights = Vector2(10.5, 19.5)
	leaves.flatness = 0.55
	leaves.random = rng
	var builder := Builder.new()
	builder.begin_level()
	_trunk(builder, clumps, lean, 7)
	leaves.add(builder, clumps, 26, 0.62)
	builder.begin_level()
	_trunk(builder, clumps.slice(0, 6), lean, 4)
	leaves.add(builder, clumps, 7, 1.1)
	builder.begin_level()
	_trunk(builder, [], lean, 3)
	leaves.add(builder, clumps, 3, 1.7)
	builder.begin_level()
	_trunk(builder, [], lean, 3)
	builder.crossed(Vector3(0.0, 10.4, 0.0) + lean, 3.9, 8.6, Atlas.CROWN, LOW.lerp(HIGH, 0.25), LOW.lerp(HIGH, 0.8), 3)
	builder.card(Vector3.UP * 14.8 + lean, Vector3.RIGHT * 3.0, Vector3.FORWARD * 3.0, Vector3.UP, Atlas.CROWN, LOW.lerp(HIGH, 0.75), 0.7)
	builder.end(PackedFloat32Array([40.0, 100.0, 220.0]))
	return builder


## Returns the center and radius of the crown's clumps, as Vector4(x, y, z, radius).
static func _clumps(rng: RandomNumberGenerator, variant: int, lean: Vector3) -> Array[Vector4]:
	var result: Array[Vector4] = []
	var count := 11
	for i in count:
		var fraction := (i + 0.5) / count
		var angle := i * 2.39996 + 2.1 * variant
		var distance := lerpf(3.5, 1.0, fraction * fraction) * rng.randf_range(0.65, 1.1)
		var position := Vector3(cos(angle) * distance, 11.3 + 6.9 * fraction + rng.randf_range(-0.4, 0.4), sin(angle) * distance) + lean
		result.append(Vector4(position.x, position.y, position.z, rng.randf_range(1.15, 1.75)))
	result.append(Vector4(lean.x, 18.5, lean.z, 1.2))
	return result


## Adds the trunk, and branches to the clumps.
static func _trunk(builder: Builder, clumps: Array[Vector4], lean: Vector3, sides: int) -> void:
	var middle := Vector3(0.0, 8.0, 0.0) + lean * 0.3
	builder.tube(Vector3(0.0, -0.8, 0.0), Vector3(0.0, 0.4, 0.0), 0.52, 0.35, sides, BARK * 0.85, BARK_KIND)
	builder.tube(Vector3(0.0, 0.4, 0.0), middle, 0.35, 0.27, sides, BARK, BARK_KIND)
	builder.tube(middle, Vector3(0.0, 18.0, 0.0) + lean, 0.27, 0.06, maxi(3, sides - 1), UPPER_BARK, BARK_KIND)
	for i in clumps.size():
		var clump := clumps[i]
		var end := Vector3(clump.x, clump.y - 0.1, clump.z)
		var height := clump.y - 0.8
		var start := middle.lerp(Vector3(0.0, 18.0, 0.0) + lean, (height - 8.0) / 10.0)
		builder.tube(start, end, 0.1, 0.03, 3, UPPER_BARK * 0.8, BARK_KIND)
	# Dead stubs on the bare trunk.
	for i in (4 if sides > 6 else 0):
		var start := Vector3(0.0, 5.5 + 1.3 * i, 0.0) + lean * 0.3
		var direction := Vector3(cos(i * 2.4), 0.15, sin(i * 2.4))
		builder.tube(start, start + direction * (0.7 + 0.2 * i), 0.05, 0.015, 3, BARK * 0.7, BARK_KIND)
