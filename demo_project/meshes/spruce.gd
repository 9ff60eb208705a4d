extends RefCounted
## A spruce of about 21 m, with boughs in a spiral around a straight trunk. Boughs hang with lifted tips, and are longer at the bottom.

const Builder := preload("res://meshes/mesh_builder.gd")
const Atlas := preload("res://meshes/leaf_atlas.gd")
const BARK := Color(0.39, 0.27, 0.195)
const DARK := Color(0.09, 0.15, 0.08, 0.6)
const LOW := Color(0.1, 0.17, 0.09)
const HIGH := Color(0.26, 0.37, 0.18)
const HEIGHT := 21.0
const BARK_KIND := 1


## Builds the tree. The number [param variant] determines its individual shape.
static func build(variant: int) -> Builder:
	var rng := RandomNumberGenerator.new()
	rng.seed = 300 + variant
	var builder := Builder.new()
	var width_factor := 1.0 - 0.13 * (variant % 3)
	builder.begin_level()
	_trunk(builder, 7)
	_boughs(builder, 130, width_factor, true, rng)
	_core(builder, 6, width_factor * 0.3, 0.82)
	builder.begin_level()
	_trunk(builder, 4)
	_boughs(builder, 64, width_factor * 1.02, false, rng)
	_core(builder, 5, width_factor * 0.3, 0.82)
	builder.begin_level()
	_stem(builder)
	_boughs(builder, 28, width_factor * 1.06, false, rng)
	_core(builder, 4, width_factor * 0.24, 0.84)
	builder.begin_level()
	_far_tree(builder, width_factor)
	builder.end(PackedFloat32Array([32.0, 90.0, 220.0]))
	return builder


## Returns the radius of the crown, in meters, at a height that is given as a fraction of the tree's height.
static func _radius(height: float) -> float:
	return 4.7 * pow(1.0 - height, 0.92) * (0.6 + 0.4 * minf(1.0, height / 0.16)) + 0.3


static func _trunk(builder: Builder, sides: int) -> void:
	builder.tube(Vector3(0.0, -0.8, 0.0), Vector3(0.0, 0.4, 0.0), 0.5, 0.34, sides, BARK * 0.85, BARK_KIND)
	builder.tube(Vector3(0.0, 0.4, 0.0), Vector3(0.0, HEIGHT * 0.9, 0.0), 0.34, 0.05, sides, BARK, BARK_KIND)


## Adds the trunk of a distant LOD.
static func _stem(builder: Builder) -> void:
	builder.tube(Vector3(0.0, -0.8, 0.0), Vector3(0.0, HEIGHT * 0.3, 0.0), 0.4, 0.25, 3, BARK, BARK_KIND)


## Adds boughs in a golden-angle spiral. Toward the top, where boughs are small, they are closer together. Boughs at equal heights would look like
## bands.
static func _boughs(builder: Builder, count: int, width_factor: float, is_bent: bool, rng: RandomNumberGenerator) -> void:
	var scale := 13.0 / sqrt(count)
	for i in count:
		var fraction := 1.0 - pow(1.0 - (i + 0.5) / count, 0.72)
		var height := lerpf(0.09, 0.975, pow(fraction, 0.95))
		var angle := i * 2.39996 + rng.randf_range(-0.3, 0.3)
		var radial := Vector3(cos(angle), 0.0, sin(angle))
		var length := _radius(height) * width_factor * rng.randf_range(0.75, 1.12)
		var start := Vector3.UP * HEIGHT * (height + rng.randf_range(-0.012, 0.012))
		_bough(builder, start, radial, length, fraction, scale, is_bent, rng)
	# The leader: two crossed upright twigs at the top.
	for turn: float in [0.0, PI * 0.5]:
		var side := Vector3(cos(turn), 0.0, sin(turn))
		builder.card(Vector3.UP * HEIGHT * 0.955, Vector3.UP * 0.85, side * 0.35, Vector3.UP, Atlas.TWIG, LOW.lerp(HIGH, 0.3), 0.3)


## Adds one bough as one or two pairs of quads. They form a roof with hanging sides, which is visible from the side and from above. A young
## bough grows upward, and an old one hangs with a lifted tip. [param scale] is the width of the bough relative to a bough of the finest LOD.
static func _bough(builder: Builder, start: Vector3, radial: Vector3, length: float, fraction: float, scale: float, is_bent: bool,
		rng: RandomNumberGenerator) -> void:
	var side := radial.cross(Vector3.UP).rotated(radial, rng.randf_range(-0.35, 0.35))
	var width := (length * 0.2 + 0.32) * scale * rng.randf_range(0.8, 1.15)
	var sag := lerpf(-0.4, 0.5, fraction) * length * rng.randf_range(0.6, 1.3)
	var hang := rng.randf_range(0.3, 0.7)
	var stations: Array[Vector3] = [start, start + radial * length + Vector3.UP * (sag + 0.1 * length)]
	if is_bent:
		stations.insert(1, start + radial * length * 0.6 + Vector3.UP * (sag * 0.78 + 0.04 * length * fraction))
	var tint := rng.randf_range(-0.14, 0.14)
	var previous: Array[int] = []
	for i in stations.size():
		var t := float(i) / (stations.size() - 1)
		var color := LOW.lerp(HIGH, clampf(0.08 + 0.5 * t * (0.6 + 0.4 * fraction) + tint, 0.0, 1.0))
		color.a = clampf(0.15 + 0.6 * t + 0.28 * fraction, 0.0, 1.0)
		var normal := radial * (0.45 + 0.5 * t) + Vector3.UP * 0.7
		var row: Array[int] = []
		for k: float in [-1.0, 0.0, 1.0]:
			var position := stations[i] + side * width * k + Vector3.DOWN * width * hang * absf(k)
			var uv := Atlas.TWIG.position + Atlas.TWIG.size * Vector2(t, 0.5 + 0.5 * k)
			row.append(builder.vertex(position, normal + side * 0.5 * k, color, uv))
		for k in (2 if i > 0 else 0):
			builder.quad(previous[k], row[k], row[k + 1], previous[k + 1])
		previous = row


## Adds a dark cone inside the boughs, which hides the far side of the crown. [param height] is a fraction of the tree's height.
static func _core(builder: Builder, sides: int, width_factor: float, height: float) -> void:
	builder.cone(Vector3.UP * HEIGHT * 0.12, _radius(0.12) * width_factor, HEIGHT * height, sides, DARK)


## Adds the farthest LOD: crossed images of the tree, and two cards that are seen from above.
static func _far_tree(builder: Builder, width_factor: float) -> void:
	var half_width := 4.9 * width_factor
	builder.crossed(Vector3.ZERO, half_width, HEIGHT * 1.02, Atlas.CONIFER, LOW.lerp(HIGH, 0.05), LOW.lerp(HIGH, 0.42), 3)
	for piece: Vector2 in [Vector2(0.25, 0.8), Vector2(0.55, 0.5)]:
		var half_size := half_width * piece.y
		builder.card(Vector3.UP * HEIGHT * piece.x, Vector3.RIGHT * half_size, Vector3.FORWARD * half_size, Vector3.UP, Atlas.TUFT, LOW.lerp(HIGH, 0.25), 0.8)
