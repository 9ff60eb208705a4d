extends RefCounted
## A tuft of grass, 0.35 to 0.75 m high: bent blades without a texture, lit like the ground below them.

const Builder := preload("res://meshes/mesh_builder.gd")
const LOW := Color(0.1, 0.16, 0.04, 0.6)
const HIGH := Color(0.3, 0.4, 0.1, 1.0)
const DRY := Color(0.5, 0.44, 0.2, 1.0)


## Builds the tuft. The number [param variant] determines its individual shape. Odd variants are lower and denser, and have no dry stalks.
static func build(variant: int) -> Builder:
	var rng := RandomNumberGenerator.new()
	rng.seed = 700 + variant
	var is_lush := variant % 2 == 1
	var builder := Builder.new()
	builder.begin_level()
	_blades(builder, 36 if is_lush else 30, 0.42 if is_lush else 0.66, 0.013, true, 0 if is_lush else 3, rng)
	builder.begin_level()
	_blades(builder, 14, 0.4 if is_lush else 0.6, 0.026, false, 0, rng)
	builder.begin_level()
	_blades(builder, 6, 0.38 if is_lush else 0.55, 0.05, false, 0, rng)
	builder.end(PackedFloat32Array([18.0, 40.0]))
	return builder


static func _blades(builder: Builder, count: int, height: float, width: float, is_bent: bool, stalks: int,
		rng: RandomNumberGenerator) -> void:
	for i in count:
		var angle := i * 2.39996 + rng.randf() * 0.6
		var root := Vector3(cos(angle), 0.0, sin(angle)) * 0.36 * sqrt((i + 0.5) / count)
		var heading := angle + rng.randf_range(-0.9, 0.9)
		var lean := Vector3(cos(heading), 0.0, sin(heading)) * rng.randf_range(0.15, 0.75)
		var blade_height := height * rng.randf_range(0.6, 1.1)
		var tip_color := HIGH.lerp(DRY, rng.randf() * 0.3)
		if i < stalks:
			blade_height *= 1.35
			lean *= 0.35
			tip_color = DRY
		_blade(builder, root, lean, blade_height, width * rng.randf_range(0.8, 1.25), tip_color, is_bent)


static func _blade(builder: Builder, root: Vector3, lean: Vector3, height: float, width: float, tip_color: Color,
		is_bent: bool) -> void:
	var side := lean.cross(Vector3.UP).normalized() * width
	var normal := Vector3.UP + lean * 0.35
	var base := root + Vector3.DOWN * 0.06
	var tip := root + Vector3.UP * height * (1.0 - 0.35 * lean.length()) + lean * height
	var a := builder.vertex(base - side, normal, LOW, Builder.OPAQUE_UV)
	var b := builder.vertex(base + side, normal, LOW, Builder.OPAQUE_UV)
	var c := builder.vertex(tip, normal, tip_color, Builder.OPAQUE_UV)
	if not is_bent:
		builder.triangle(a, c, b)
		return
	var middle := root + Vector3.UP * height * 0.58 + lean * height * 0.3
	var color := LOW.lerp(tip_color, 0.5)
	var d := builder.vertex(middle - side * 0.8, normal, color, Builder.OPAQUE_UV)
	var e := builder.vertex(middle + side * 0.8, normal, color, Builder.OPAQUE_UV)
	builder.quad(a, d, e, b)
	builder.triangle(d, c, e)
