extends RefCounted
## An agave, 0.7 m high: a rosette of stiff, pointed leaves.

const Builder := preload("res://meshes/mesh_builder.gd")
const LOW := Color(0.16, 0.22, 0.16, 0.6)
const HIGH := Color(0.4, 0.48, 0.36)
const TIP := Color(0.45, 0.36, 0.2)


## Builds the agave. The number [param variant] determines its individual shape.
static func build(variant: int) -> Builder:
	var builder := Builder.new()
	for level in 3:
		var rng := RandomNumberGenerator.new()
		rng.seed = 3300 + variant
		builder.begin_level()
		var count: int = [26, 14, 7][level]
		for i in count:
			_leaf(builder, i * 2.39996 + rng.randf_range(-0.1, 0.1), float(i) / count, [0.07, 0.1, 0.15][level], level == 0)
	builder.end(PackedFloat32Array([20.0, 60.0]))
	return builder


## Adds a leaf with a V-shaped cross section. [param inner_fraction] is 0 for the outermost leaf and 1 for the innermost.
static func _leaf(builder: Builder, angle: float, inner_fraction: float, width: float, is_bent: bool) -> void:
	var radial := Vector3(cos(angle), 0.0, sin(angle))
	var side := radial.cross(Vector3.UP)
	var length := lerpf(0.75, 0.55, inner_fraction)
	var elevation := lerpf(0.3, 1.35, inner_fraction)
	var direction := (radial * cos(elevation) + Vector3.UP * sin(elevation)).normalized()
	var up := side.cross(direction)
	var previous: Array[int] = []
	for station in (4 if is_bent else 3):
		var t := station / (3.0 if is_bent else 2.0)
		var position := Vector3.DOWN * 0.03 + radial * 0.05 + direction * length * t + radial * 0.12 * t * t
		var half_width := width * (0.75 + 0.9 * t) * (1.0 - pow(t, 2.5)) * 1.1
		var color := LOW.lerp(HIGH, 0.25 + 0.75 * t) if t < 0.99 else TIP
		var row: Array[int] = []
		for k: float in [-1.0, 0.0, 1.0]:
			row.append(builder.vertex(position + side * half_width * k - up * half_width * 0.35 * (1.0 - absf(k)), up - side * k * 0.5, color, Builder.OPAQUE_UV))
		for k in (2 if station > 0 else 0):
			builder.quad(previous[k], row[k], row[k + 1], previous[k + 1])
		previous = row
