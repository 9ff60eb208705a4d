extends RefCounted
## A weathered boulder of about 1 m, mossy on top, with facets softened by shared normals.

const Builder := preload("res://meshes/mesh_builder.gd")
const ROCK_LOW := Color(0.16, 0.155, 0.145, 0.6)
const ROCK_HIGH := Color(0.44, 0.42, 0.385, 1.0)


## Builds the stone with the number [param variant].
static func build(variant: int) -> Builder:
	var builder := Builder.new()
	for level in 3:
		builder.begin_level()
		_rock(builder, 2 - level, variant)
	builder.end(PackedFloat32Array([25.0, 70.0]))
	return builder


## Adds an icosphere cut by a few random planes, which are the stone's faces.
static func _rock(builder: Builder, subdivisions: int, variant: int) -> void:
	var rng := RandomNumberGenerator.new()
	rng.seed = 1300 + variant
	var cuts: Array[Plane] = []
	for i in 9:
		var normal := Vector3(rng.randfn(), rng.randfn() * 0.8, rng.randfn()).normalized()
		cuts.append(Plane(normal, rng.randf_range(0.5, 0.82)))
	var stretch := Vector3(rng.randf_range(0.7, 0.95), rng.randf_range(0.45, 0.62), rng.randf_range(0.6, 0.75))
	var shape := Builder._icosphere(subdivisions)
	var points: PackedVector3Array = shape[0]
	var faces: PackedInt32Array = shape[1]
	var first := -1
	for point in points:
		var cut := point
		var normal := point
		for plane in cuts:
			var over := plane.distance_to(cut)
			if over > 0.0:
				cut -= plane.normal * over
				normal = plane.normal
		var shade := ROCK_LOW.lerp(ROCK_HIGH, clampf(cut.y * 0.6 + 0.55 + rng.randf_range(-0.12, 0.12), 0.0, 1.0))
		var index := builder.vertex(cut * stretch + Vector3.UP * 0.12, normal.lerp(point, 0.3) / stretch, shade,
				Builder.OPAQUE_UV)
		if first < 0:
			first = index
	for i in range(0, faces.size(), 3):
		builder.triangle(first + faces[i], first + faces[i + 1], first + faces[i + 2])
