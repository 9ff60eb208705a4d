extends RefCounted
## The stump of a felled tree: half a meter of trunk with roots, and pale wood on top. Variant 0 is an oak stump, and
## variant 1 is a spruce stump.

const Builder := preload("res://meshes/mesh_builder.gd")
## The height of the cut above the ground in meters.
const HEIGHT := 0.5
const BARKS: Array[Color] = [Color(0.37, 0.3, 0.225), Color(0.39, 0.27, 0.195)]
## The radii of the trunks at the cut, in meters.
const RADII: Array[float] = [0.46, 0.34]
const WOOD := Color(0.56, 0.4, 0.22)
const RING := Color(0.38, 0.25, 0.13)


## Builds the stump. The number [param variant] determines its individual shape.
static func build(variant: int) -> Builder:
	var kind := variant % RADII.size()
	var builder := Builder.new()
	for sides: int in [12, 7, 4]:
		builder.begin_level()
		builder.tube(Vector3(0.0, -0.8, 0.0), Vector3(0.0, 0.12, 0.0), RADII[kind] * 1.9, RADII[kind] * 1.15, sides,
				BARKS[kind] * 0.8, kind)
		builder.tube(Vector3(0.0, 0.12, 0.0), Vector3(0.0, HEIGHT, 0.0), RADII[kind] * 1.15, RADII[kind], sides,
				BARKS[kind], kind)
		_top(builder, RADII[kind], sides)
	builder.end(PackedFloat32Array([18.0, 60.0]))
	return builder


## Adds the cut surface, with a few annual rings.
static func _top(builder: Builder, radius: float, sides: int) -> void:
	var rings := 5 if sides > 8 else 1
	var inner_ring: Array[int] = []
	for ring in rings + 1:
		var color := WOOD if ring % 2 == 0 else RING
		var outer_ring: Array[int] = []
		for i in sides + 1:
			var angle := TAU * i / sides
			var position := Vector3(cos(angle), 0.0, sin(angle)) * radius * (ring + 0.001) / rings
			outer_ring.append(builder.vertex(position + Vector3.UP * HEIGHT, Vector3.UP, color, Builder.OPAQUE_UV))
		for i in (sides if ring > 0 else 0):
			builder.quad(inner_ring[i], outer_ring[i], outer_ring[i + 1], inner_ring[i + 1])
		inner_ring = outer_ring
