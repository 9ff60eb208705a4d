extends RefCounted
## A group of mushrooms, up to 0.4 m high. Even variants are ocher and grow in clusters; odd ones are pale and slender.

const Builder := preload("res://meshes/mesh_builder.gd")
const CAPS: Array[Color] = [Color(0.66, 0.33, 0.12), Color(0.6, 0.5, 0.37)]
const STEM := Color(0.6, 0.53, 0.42)
const GILLS := Color(0.62, 0.5, 0.36, 0.4)


## Builds the mushrooms. The number [param variant] determines their individual shapes.
static func build(variant: int) -> Builder:
	var is_slender := variant % 2 == 1
	var builder := Builder.new()
	for level in 3:
		var rng := RandomNumberGenerator.new()
		rng.seed = 4500 + variant
		builder.begin_level()
		for i: int in [9, 6, 4][level]:
			var angle := i * 2.39996 + variant
			var radial := Vector3(cos(angle), 0.0, sin(angle))
			var height := rng.randf_range(0.12, 0.3) * (1.25 if is_slender else 1.0) * (1.0 - 0.05 * i)
			var width := height * (0.34 if is_slender else 0.55) * rng.randf_range(0.8, 1.2)
			var color := CAPS[variant % 2] * rng.randf_range(0.8, 1.1)
			color.a = 1.0
			_mushroom(builder, radial * 0.16 * sqrt(i), (Vector3.UP + radial * rng.randf_range(0.05, 0.35)).normalized(), height, width, color, [10, 6, 4][level], level)
	builder.end(PackedFloat32Array([7.0, 18.0]))
	return builder


static func _mushroom(builder: Builder, base: Vector3, axis: Vector3, height: float, width: float, color: Color, sides: int, level: int) -> void:
	var foot := Color(STEM.r * 0.7, STEM.g * 0.66, STEM.b * 0.6, 0.7)
	var stem := PackedVector2Array([Vector2(width * 0.3, -0.05), Vector2(width * 0.17, height)])
	builder.revolve(base, axis, stem, PackedColorArray([foot, STEM]), maxi(3, sides / 2))
	var rim := color.lerp(STEM, 0.45)
	var profile := PackedVector2Array([
		Vector2(width * 0.15, height * 0.93), Vector2(width, height * 0.86), Vector2(width * 1.02, height * 0.92), Vector2(width * 0.8, height + width * 0.3),
		Vector2(width * 0.42, height + width * 0.52), Vector2(0.0, height + width * 0.58),
	])
	var colors := PackedColorArray([GILLS, GILLS.lerp(STEM, 0.5), rim, color, color, color * 0.9])
	if level > 0:
		for point: int in [4, 1]:
			profile.remove_at(point)
			colors.remove_at(point)
	builder.revolve(base, axis, profile, colors, sides)
