extends RefCounted
## A group of stalagmites or stalactites, up to 1.6 m long. Variants 0, 1, 4, 5 and so on stand on the ground, and all others hang from a ceiling. Odd
## variants are thicker.

const Builder := preload("res://meshes/mesh_builder.gd")
const LOW := Color(0.3, 0.25, 0.2, 0.7)
const HIGH := Color(0.55, 0.48, 0.39)


## Builds the group. The number [param variant] determines its individual shape.
static func build(variant: int) -> Builder:
	var axis := Vector3.UP if variant % 4 < 2 else Vector3.DOWN
	var thickness := 1.5 if variant % 2 == 1 else 1.0
	var builder := Builder.new()
	for level in 3:
		var rng := RandomNumberGenerator.new()
		rng.seed = 4700 + variant
		builder.begin_level()
		for i: int in [6, 4, 3][level]:
			var angle := i * 2.39996 + variant
			var length := rng.randf_range(0.7, 1.6) * (1.0 - 0.13 * i) / sqrt(thickness)
			var base := Vector3(cos(angle), 0.0, sin(angle)) * 0.15 * sqrt(i) * thickness
			_cone(builder, base, axis, length, length * 0.11 * thickness + 0.04, [9, 6, 4][level], [9, 5, 2][level], rng.randf() * 9.0)
	builder.end(PackedFloat32Array([14.0, 35.0]))
	return builder


## Adds a cone with rings of sinter and a broad foot.
static func _cone(builder: Builder, base: Vector3, axis: Vector3, length: float, radius: float, sides: int, rings: int, phase: float) -> void:
	var profile := PackedVector2Array()
	var colors := PackedColorArray()
	for ring in rings + 1:
		var height := float(ring) / rings
		var bulge := 1.0 + 0.13 * sin(height * 17.0 + phase) + 0.7 * (1.0 - height) ** 6
		profile.append(Vector2(radius * (1.0 - height) ** 0.8 * bulge, lerpf(-1.0, length, height)))
		colors.append(LOW.lerp(HIGH, 0.25 + 0.6 * height + 0.15 * sin(height * 23.0 + phase)))
	builder.revolve(base, axis, profile, colors, sides)
