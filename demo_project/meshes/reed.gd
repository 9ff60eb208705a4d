extends RefCounted
## A clump of reeds, 1.3 to 2.1 m high, with upright blades, and stalks with brown heads.

const Builder := preload("res://meshes/mesh_builder.gd")
const LOW := Color(0.16, 0.17, 0.06, 0.6)
const HIGH := Color(0.36, 0.42, 0.13, 1.0)
const HEAD := Color(0.2, 0.1, 0.045, 1.0)


## Builds the clump. The number [param variant] determines its individual shape.
static func build(variant: int) -> Builder:
	var rng := RandomNumberGenerator.new()
	rng.seed = 1500 + variant
	var builder := Builder.new()
	builder.begin_level()
	_blades(builder, 16, 0.016, rng)
	_heads(builder, 3, rng)
	builder.begin_level()
	_blades(builder, 8, 0.03, rng)
	_heads(builder, 2, rng)
	builder.begin_level()
	_blades(builder, 5, 0.055, rng)
	builder.end(PackedFloat32Array([25.0, 60.0]))
	return builder


static func _blades(builder: Builder, count: int, width: float, rng: RandomNumberGenerator) -> void:
	for i in count:
		var angle := i * 2.39996 + rng.randf() * 0.6
		var root := Vector3(cos(angle), 0.0, sin(angle)) * 0.3 * sqrt((i + 0.5) / count)
		var heading := rng.randf() * TAU
		var lean := Vector3(cos(heading), 0.0, sin(heading)) * rng.randf_range(0.05, 0.3)
		var side := Vector3(-sin(heading + 1.0), 0.0, cos(heading + 1.0)) * width * rng.randf_range(0.8, 1.2)
		var height := rng.randf_range(1.3, 2.0)
		var normal := Vector3.UP * 0.6 + lean + side.cross(Vector3.UP).normalized() * 0.4
		var middle := root + Vector3.UP * height * 0.6 + lean * 0.3
		var color := LOW.lerp(HIGH, rng.randf_range(0.4, 0.7))
		var a := builder.vertex(root + Vector3.DOWN * 0.5 - side, normal, LOW, Builder.OPAQUE_UV)
		var b := builder.vertex(root + Vector3.DOWN * 0.5 + side, normal, LOW, Builder.OPAQUE_UV)
		var c := builder.vertex(middle + side, normal, color, Builder.OPAQUE_UV)
		var d := builder.vertex(middle - side, normal, color, Builder.OPAQUE_UV)
		var tip := builder.vertex(root + Vector3.UP * height + lean, normal, HIGH, Builder.OPAQUE_UV)
		builder.quad(a, d, c, b)
		builder.triangle(d, tip, c)


## Adds the heads on their stalks, as two crossed strips each.
static func _heads(builder: Builder, count: int, rng: RandomNumberGenerator) -> void:
	for i in count:
		var angle := rng.randf() * TAU
		var root := Vector3(cos(angle), 0.0, sin(angle)) * rng.randf_range(0.05, 0.25)
		var top := root * 1.4 + Vector3.UP * rng.randf_range(1.7, 2.1)
		for turn: float in [0.0, PI * 0.5]:
			var side := Vector3(cos(angle + turn), 0.0, sin(angle + turn))
			_slat(builder, root, top + Vector3.DOWN * 0.3, side * 0.006, LOW, HIGH)
			_slat(builder, top + Vector3.DOWN * 0.3, top, side * 0.022, HEAD, HEAD)


static func _slat(builder: Builder, from: Vector3, to: Vector3, side: Vector3, low: Color, high: Color) -> void:
	var normal := side.cross(Vector3.UP).normalized() + Vector3.UP * 0.5
	var a := builder.vertex(from - side, normal, low, Builder.OPAQUE_UV)
	var b := builder.vertex(to - side, normal, high, Builder.OPAQUE_UV)
	var c := builder.vertex(to + side, normal, high, Builder.OPAQUE_UV)
	var d := builder.vertex(from + side, normal, low, Builder.OPAQUE_UV)
	builder.quad(a, b, c, d)
