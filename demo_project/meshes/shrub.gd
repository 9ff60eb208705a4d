extends RefCounted
## A shrub of about 1.6 m, with round clumps of leaf sprays.

const Builder := preload("res://meshes/mesh_builder.gd")
const Atlas := preload("res://meshes/leaf_atlas.gd")
const Crown := preload("res://meshes/leaf_crown.gd")
const LOW := Color(0.15, 0.235, 0.06)
const HIGH := Color(0.34, 0.42, 0.13)


## Builds the shrub. The number [param variant] determines its individual shape.
static func build(variant: int) -> Builder:
	return build_of(500 + variant, LOW, HIGH, Vector2(1.0, 1.0), variant)


## Builds a shrub with these colors. [param shape] is its width and height, relative to 2.4 m and 1.6 m. Small shrubs
## have fewer leaves and get coarser LODs at shorter distances.
static func build_of(seed: int, low: Color, high: Color, shape: Vector2, turn: int) -> Builder:
	var leaves := Crown.new()
	leaves.random.seed = seed
	var clumps: Array[Vector4] = []
	for i in 4:
		var angle := i * 1.6 + turn
		var radius := leaves.random.randf_range(0.5, 0.72)
		var distance := leaves.random.randf_range(0.35, 0.62) * shape.x
		clumps.append(Vector4(cos(angle) * distance, radius * 0.85 * shape.y, sin(angle) * distance, radius * shape.x))
	clumps.append(Vector4(0.05, 1.0 * shape.y, 0.0, 0.55 * shape.x))
	leaves.region = Atlas.BROADLEAF
	leaves.low = low
	leaves.high = high
	leaves.center = Vector3(0.0, 0.35 * shape.y, 0.0)
	leaves.radius = 1.25 * shape.x
	leaves.heights = Vector2(0.0, 1.6) * shape.y
	leaves.flatness = 0.9 * shape.y / shape.x
	var inner_clumps: Array[Vector4] = [Vector4(0.0, 0.55 * shape.y, 0.0, 0.6 * shape.x)]
	var builder := Builder.new()
	builder.begin_level()
	var count_factor := sqrt(shape.x)
	leaves.add(builder, inner_clumps, roundi(12 * count_factor), 0.42 * shape.x / count_factor)
	leaves.add(builder, clumps, roundi(18 * count_factor), 0.34 * shape.x / count_factor)
	builder.begin_level()
	leaves.add(builder, inner_clumps, roundi(6 * shape.x), 0.6 * sqrt(shape.x))
	leaves.add(builder, clumps, roundi(6 * shape.x), 0.55 * sqrt(shape.x))
	builder.begin_level()
	builder.crossed(Vector3.DOWN * 0.1, 1.15 * shape.x, 1.65 * shape.y, Atlas.CROWN, low.lerp(high, 0.25), low.lerp(high, 0.75), 3)
	builder.card(Vector3.UP * 0.8 * shape.y, Vector3.RIGHT * 0.8 * shape.x, Vector3.FORWARD * 0.8 * shape.x, Vector3.UP, Atlas.CROWN, low.lerp(high, 0.7), 0.7)
	builder.end(PackedFloat32Array([35.0 * shape.x, 90.0 * shape.x]))
	return builder
