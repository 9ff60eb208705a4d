extends RefCounted
## A spruce of about 21 m: whorls of boughs around a straight trunk. Boughs hang and lift their tips, and are longer at the bottom.

const Builder := preload("res://meshes/mesh_builder.gd")
const Atlas := preload("res://meshes/leaf_atlas.gd")
const BARK := Color(0.39, 0.27, 0.195)
const DARK := Color(0.075, 0.13, 0.065, 0.45)
const LOW := Color(0.11, 0.185, 0.1)
const HIGH := Color(0.26, 0.37, 0.18)
const HEIGHT := 21.0
const BARK_KIND := 1


## Builds the tree with the number [param variant].
static func build(variant: int) -> Builder:
	var rng := RandomNumberGenerator.new()
	rng.seed = 300 + variant
	var builder := Builder.new()
	var slim := 1.0 - 0.13 * (variant % 3)
	builder.begin_level()
	_trunk(builder, 6)
	_boughs(builder, 21, 9, slim, true, rng)
	_tiers(builder, 6, 7, slim * 0.4, DARK, DARK, rng)
	builder.begin_level()
	_trunk(builder, 4)
	_boughs(builder, 14, 6, slim * 1.04, false, rng)
	_tiers(builder, 5, 6, slim * 0.58, DARK, DARK, rng)
	builder.begin_level()
	_stem(builder)
	_boughs(builder, 7, 5, slim * 1.08, false, rng)
	_tiers(builder, 5, 6, slim * 0.74, LOW * 0.7, LOW.lerp(HIGH, 0.3), rng)
	builder.begin_level()
	_tiers(builder, 3, 6, slim * 0.9, LOW * 0.75, HIGH * 0.7, rng)
	builder.end(PackedFloat32Array([80.0, 220.0, 500.0]))
	return builder


## The crown's radius in meters at a height of 0..1 of the tree.
static func _radius(height: float) -> float:
	return 4.7 * pow(1.0 - height, 0.92) * (0.6 + 0.4 * minf(1.0, height / 0.16)) + 0.15


static func _trunk(builder: Builder, sides: int) -> void:
	builder.tube(Vector3(0.0, -0.8, 0.0), Vector3(0.0, 0.4, 0.0), 0.5, 0.34, sides, BARK * 0.85, BARK_KIND)
	builder.tube(Vector3(0.0, 0.4, 0.0), Vector3(0.0, HEIGHT * 0.9, 0.0), 0.34, 0.05, sides, BARK, BARK_KIND)


## The trunk for far away.
static func _stem(builder: Builder) -> void:
	builder.tube(Vector3(0.0, -0.8, 0.0), Vector3(0.0, HEIGHT * 0.3, 0.0), 0.4, 0.25, 3, BARK, BARK_KIND)


static func _boughs(builder: Builder, whorls: int, count: int, slim: float, bent: bool,
		rng: RandomNumberGenerator) -> void:
	for whorl in whorls:
		var along := float(whorl) / (whorls - 1)
		var height := lerpf(0.11, 0.965, pow(along, 0.95))
		var number := maxi(4, roundi(count * (1.0 - 0.45 * along)))
		for i in number:
			var angle := TAU * (i + 0.5 * (whorl % 2)) / number + rng.randf_range(-0.22, 0.22)
			var out := Vector3(cos(angle), 0.0, sin(angle))
			var reach := _radius(height) * slim * rng.randf_range(0.82, 1.12)
			var start := Vector3.UP * HEIGHT * (height + rng.randf_range(-0.016, 0.016))
			_bough(builder, start, out, reach, along, TAU / number, bent, rng)
	# The leader: two crossed upright twigs at the top.
	for turn: float in [0.0, PI * 0.5]:
		var side := Vector3(cos(turn), 0.0, sin(turn))
		builder.card(Vector3.UP * HEIGHT * 0.965, Vector3.UP * 1.1, side * 0.4, Vector3.UP, Atlas.TWIG, LOW.lerp(HIGH, 0.7), 0.3)


## Adds one bough, which fills the angle [param share]: a roof of one or two pairs of quads with hanging sides, visible from the
## side as well as from above. A young bough leaves the trunk upwards, and an old one hangs with a lifted tip.
static func _bough(builder: Builder, start: Vector3, out: Vector3, reach: float, along: float, share: float, bent: bool,
		rng: RandomNumberGenerator) -> void:
	var side := out.cross(Vector3.UP).rotated(out, rng.randf_range(-0.25, 0.25))
	var width := reach * minf(0.55 * share, 0.5) + 0.26
	var sag := lerpf(-0.36, 0.5, along) * reach
	var stations: Array[Vector3] = [start, start + out * reach + Vector3.UP * (sag + 0.1 * reach)]
	if bent:
		stations.insert(1, start + out * reach * 0.6 + Vector3.UP * (sag * 0.78 + 0.04 * reach * along))
	var tint := rng.randf_range(-0.12, 0.12)
	var previous: Array[int] = []
	for i in stations.size():
		var t := float(i) / (stations.size() - 1)
		var color := LOW.lerp(HIGH, clampf(0.08 + 0.5 * t * (0.6 + 0.4 * along) + tint, 0.0, 1.0))
		color.a = clampf(0.12 + 0.6 * t + 0.28 * along, 0.0, 1.0)
		var normal := out * (0.45 + 0.5 * t) + Vector3.UP * 0.7
		var row: Array[int] = []
		for k: float in [-1.0, 0.0, 1.0]:
			var position := stations[i] + side * width * k + Vector3.DOWN * width * 0.62 * absf(k)
			var uv := Atlas.TWIG.position + Atlas.TWIG.size * Vector2(t, 0.5 + 0.5 * k)
			row.append(builder.vertex(position, normal + side * 0.5 * k, color, uv))
		for k in (2 if i > 0 else 0):
			builder.quad(previous[k], row[k], row[k + 1], previous[k + 1])
		previous = row


static func _tiers(builder: Builder, tiers: int, sides: int, slim: float, low: Color, high: Color,
		rng: RandomNumberGenerator) -> void:
	for tier in tiers:
		var from := float(tier) / tiers
		var height := lerpf(0.1, 0.93, from)
		var rise := 1.55 * 0.9 / tiers * HEIGHT
		var radius := _radius(height) * slim * 1.06
		rise = minf(rise, HEIGHT * (1.0 - height))
		var shade := low.lerp(high, 0.25 + 0.5 * from)
		builder.cone(Vector3.UP * HEIGHT * height, radius, rise, sides, 0.22, radius * 0.16,
				Color(low.lerp(shade, 0.7), 0.85), Color(shade.lerp(high, 0.3), 0.6),
				rng.randf() * TAU)
