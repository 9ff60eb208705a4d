extends RefCounted
## A few meadow flowers, 0.3 to 0.6 m high. The variant selects white, yellow or violet.

const Builder := preload("res://meshes/mesh_builder.gd")
const STEM := Color(0.2, 0.3, 0.06, 0.7)
const PETALS: Array[Color] = [Color(0.85, 0.83, 0.76), Color(0.86, 0.6, 0.06), Color(0.36, 0.2, 0.62)]
const HEART := Color(0.7, 0.42, 0.03)


## Builds the flowers. The number [param variant] determines their individual shapes.
static func build(variant: int) -> Builder:
	var rng := RandomNumberGenerator.new()
	rng.seed = 1100 + variant
	var color := PETALS[variant % PETALS.size()]
	var builder := Builder.new()
	builder.begin_level()
	_flowers(builder, 9, 6, 0.05, color, rng)
	builder.begin_level()
	_flowers(builder, 5, 4, 0.075, color, rng)
	builder.end(PackedFloat32Array([16.0]))
	return builder


static func _flowers(builder: Builder, count: int, petals: int, size: float, color: Color,
		rng: RandomNumberGenerator) -> void:
	for i in count:
		var angle := i * 2.39996 + rng.randf()
		var root := Vector3(cos(angle), 0.0, sin(angle)) * 0.42 * sqrt((i + 0.5) / count)
		var lean := Vector3(rng.randf_range(-0.12, 0.12), 0.0, rng.randf_range(-0.12, 0.12))
		var head := root + Vector3.UP * rng.randf_range(0.32, 0.6) + lean
		var side := Vector3(cos(angle * 3.0), 0.0, sin(angle * 3.0)) * 0.008
		var a := builder.vertex(root - side, Vector3.UP, STEM * 0.6, Builder.OPAQUE_UV)
		var b := builder.vertex(root + side, Vector3.UP, STEM * 0.6, Builder.OPAQUE_UV)
		var c := builder.vertex(head, Vector3.UP, STEM, Builder.OPAQUE_UV)
		builder.triangle(a, c, b)
		_head(builder, head, (Vector3.UP + lean * 5.0).normalized(), petals, size * rng.randf_range(0.8, 1.2), color)


static func _head(builder: Builder, head: Vector3, axis: Vector3, petals: int, size: float, color: Color) -> void:
	var right := axis.cross(Vector3.FORWARD).normalized()
	var forward := right.cross(axis)
	for i in petals:
		var angle := TAU * i / petals
		var radial := right * cos(angle) + forward * sin(angle)
		var tangent := right * cos(angle + 1.57) + forward * sin(angle + 1.57)
		var root := builder.vertex(head, Vector3.UP, HEART, Builder.OPAQUE_UV)
		var left_edge := builder.vertex(head + (radial * 0.75 + tangent * 0.45) * size, Vector3.UP + radial * 0.3, color,
				Builder.OPAQUE_UV)
		var tip := builder.vertex(head + radial * size + axis * size * 0.25, Vector3.UP + radial * 0.3, color,
				Builder.OPAQUE_UV)
		var right_edge := builder.vertex(head + (radial * 0.75 - tangent * 0.45) * size, Vector3.UP + radial * 0.3, color,
				Builder.OPAQUE_UV)
		builder.quad(root, left_edge, tip, right_edge)
