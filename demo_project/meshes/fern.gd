extends RefCounted
## A fern of the forest floor, 0.5 m high and 1.2 m wide: a rosette of arched fronds.

const Builder := preload("res://meshes/mesh_builder.gd")
const Atlas := preload("res://meshes/leaf_atlas.gd")
const LOW := Color(0.08, 0.15, 0.035, 0.5)
const HIGH := Color(0.25, 0.37, 0.09, 1.0)


## Builds the fern. The number [param variant] determines its individual shape.
static func build(variant: int) -> Builder:
	var rng := RandomNumberGenerator.new()
	rng.seed = 900 + variant
	var builder := Builder.new()
	builder.begin_level()
	_fronds(builder, 9, 4, rng)
	builder.begin_level()
	_fronds(builder, 6, 2, rng)
	builder.end(PackedFloat32Array([22.0]))
	return builder


static func _fronds(builder: Builder, count: int, segments: int, rng: RandomNumberGenerator) -> void:
	for i in count:
		var angle := TAU * i / count + rng.randf_range(-0.3, 0.3)
		var radial := Vector3(cos(angle), 0.0, sin(angle))
		var side := radial.cross(Vector3.UP)
		var length := rng.randf_range(0.6, 0.85)
		var rise := rng.randf_range(0.45, 0.75)
		var previous := Vector2i(-1, -1)
		for k in segments + 1:
			var t := float(k) / segments
			var position := radial * length * t + Vector3.UP * (rise * sin(t * 2.3) * 0.85)
			var color := LOW.lerp(HIGH, 0.2 + 0.8 * t)
			var u := Atlas.FROND.position.x + Atlas.FROND.size.x * t
			var normal := Vector3.UP + radial * (t - 0.2)
			var a := builder.vertex(position + side * 0.2, normal + side * 0.3, color,
					Vector2(u, Atlas.FROND.position.y))
			var b := builder.vertex(position - side * 0.2, normal - side * 0.3, color, Vector2(u, Atlas.FROND.end.y))
			if previous.x >= 0:
				builder.quad(previous.x, a, b, previous.y)
			previous = Vector2i(a, b)
