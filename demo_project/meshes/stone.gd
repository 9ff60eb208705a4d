extends RefCounted
## A weathered rock of about 1 m with flat faces and worn edges. The variants are boulders, slabs and blocks.

const Builder := preload("res://meshes/mesh_builder.gd")
const LOW := Color(0.17, 0.165, 0.155, 0.6)
const HIGH := Color(0.44, 0.42, 0.385, 1.0)
## Half the width, height and depth of each shape before it is cut, in meters.
const SHAPES: Array[Vector3] = [
	Vector3(0.95, 0.72, 0.82), Vector3(1.15, 0.42, 0.9), Vector3(0.75, 0.95, 0.68), Vector3(1.05, 0.6, 0.7),
]


## Builds the stone. The number [param variant] determines its individual shape.
static func build(variant: int) -> Builder:
	return build_of(1300 + variant, SHAPES[variant % SHAPES.size()], LOW, HIGH, 3)


## Builds a stone with this size and these colors. [param finest] is the number of subdivisions of its finest LOD. Small
## stones need fewer subdivisions and get coarser LODs at shorter distances.
static func build_of(seed: int, stretch: Vector3, low: Color, high: Color, finest: int) -> Builder:
	var builder := Builder.new()
	for level in 3:
		builder.begin_level()
		rock(builder, maxi(finest - level, 0), seed, stretch, Vector3.UP * 0.12 * stretch.y, low, high)
	builder.end(PackedFloat32Array([25.0, 70.0]) if finest > 2 else PackedFloat32Array([12.0, 35.0]))
	return builder


## Adds an icosphere that is cut by random planes, which become the stone's faces. Most planes are nearly vertical or horizontal, as in layered rock.
static func rock(builder: Builder, subdivisions: int, seed: int, stretch: Vector3, center: Vector3, low: Color, high: Color) -> void:
	var rng := RandomNumberGenerator.new()
	rng.seed = seed
	var cuts: Array[Plane] = []
	for i in 14:
		var normal := Vector3(rng.randfn(), rng.randfn() * (0.3 if i % 3 > 0 else 2.2), rng.randfn()).normalized()
		cuts.append(Plane(normal, rng.randf_range(0.42, 0.78)))
	var shape := Builder.icosphere(subdivisions)
	var points: PackedVector3Array = shape[0]
	var faces: PackedInt32Array = shape[1]
	var first := -1
	for point in points:
		var position := point
		var normal := point
		for plane in cuts:
			var excess := plane.distance_to(position)
			if excess > 0.0:
				position -= plane.normal * excess
				normal = normal.lerp(plane.normal, 0.9)
		# Roughens the faces, so that the stone looks weathered.
		position *= 1.0 + 0.03 * sin(point.x * 17.0 + seed) * sin(point.y * 13.0) * sin(point.z * 19.0)
		var shade := low.lerp(high, clampf(position.y * 0.6 + 0.6 + 0.14 * sin(point.x * 23.0 + point.y * 31.0 + seed), 0.0, 1.0))
		var index := builder.vertex(position * stretch + center, normal / stretch, shade, Builder.OPAQUE_UV)
		if first < 0:
			first = index
	for i in range(0, faces.size(), 3):
		builder.triangle(first + faces[i], first + faces[i + 1], first + faces[i + 2])
