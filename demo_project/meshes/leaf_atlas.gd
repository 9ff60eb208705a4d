extends RefCounted
## Draws the leaves of all plants into one small texture, once a run: our own work, made of ellipses and strokes.
##
## Five regions: broad leaves, a conifer's twig (stem on the left, tip on the right), a fern's frond (the same way),
## bark (up is up), and opaque white. The color is a brightness that the vertex color tints; alpha is for scissoring.

const SIZE := 512
const BROADLEAF := Rect2(0.0, 0.0, 0.5, 0.5)
const TWIG := Rect2(0.5, 0.0, 0.5, 0.5)
const FROND := Rect2(0.0, 0.5, 0.5, 0.5)
const BARK := Rect2(0.5625, 0.5625, 0.21875, 0.40625)
## A texel that is opaque and white, for what has no texture.
const OPAQUE_UV := Vector2(0.890625, 0.890625)

static var _texture: ImageTexture


## The atlas, made on the first call.
static func texture() -> ImageTexture:
	if _texture == null:
		var image := _draw()
		image.generate_mipmaps()
		_texture = ImageTexture.create_from_image(image)
	return _texture


static func _draw() -> Image:
	var image := Image.create_empty(SIZE, SIZE, false, Image.FORMAT_RGBA8)
	image.fill(Color(0.72, 0.72, 0.72, 0.0))
	# Margins around what is opaque keep mipmaps from carrying it into the regions beside it.
	image.fill_rect(Rect2i(OPAQUE_UV * SIZE - Vector2(16.0, 16.0), Vector2(32.0, 32.0)), Color.WHITE)
	_draw_bark(image)
	var rng := RandomNumberGenerator.new()
	rng.seed = 11
	_draw_broadleaf(image, rng)
	_draw_twig(image, rng)
	_draw_frond(image, rng)
	return image


## Furrows along the trunk.
static func _draw_bark(image: Image) -> void:
	var noise := FastNoiseLite.new()
	noise.seed = 5
	noise.noise_type = FastNoiseLite.TYPE_SIMPLEX_SMOOTH
	noise.fractal_octaves = 3
	noise.frequency = 1.0
	var area := Rect2i(BARK.position * SIZE, BARK.size * SIZE)
	for y in area.size.y:
		for x in area.size.x:
			# Left and right borders meet around the trunk.
			var around := TAU * x / area.size.x
			var furrow := noise.get_noise_3d(cos(around) * 2.2, sin(around) * 2.2, y * 0.012)
			var grain := noise.get_noise_3d(cos(around) * 7.0, sin(around) * 7.0, y * 0.08 + 9.0)
			var value := clampf(0.78 + 0.45 * furrow + 0.25 * grain, 0.3, 1.0)
			image.set_pixel(area.position.x + x, area.position.y + y, Color(value, value, value, 1.0))


## A roundish spray of pointed leaves, dark ones first, so that it has depth.
static func _draw_broadleaf(image: Image, rng: RandomNumberGenerator) -> void:
	var bounds := Rect2i(0, 0, SIZE / 2, SIZE / 2)
	var center := Vector2(SIZE, SIZE) * 0.25
	var count := 120
	for i in count:
		var depth := float(i) / count
		var angle := rng.randf() * TAU
		var distance := sqrt(rng.randf()) * SIZE * 0.2
		var root := center + Vector2.from_angle(angle) * distance
		var direction := Vector2.from_angle(angle + rng.randf_range(-0.9, 0.9))
		var length := SIZE * rng.randf_range(0.055, 0.085)
		var shade := lerpf(0.5, 1.0, depth) * rng.randf_range(0.85, 1.0)
		_stroke(image, bounds, root - direction * length * 0.5, root + direction * length * 0.5, length * 0.24, shade,
				true)


## A drooping conifer twig: side shoots along a stem, needles along the shoots.
static func _draw_twig(image: Image, rng: RandomNumberGenerator) -> void:
	var bounds := Rect2i(SIZE / 2, 0, SIZE / 2, SIZE / 2)
	var half := SIZE * 0.5
	var root := Vector2(half * 1.01, half * 0.5)
	var tip := Vector2(half * 1.9, half * 0.5)
	_stroke(image, bounds, root, root.lerp(tip, 0.9), 3.0, 0.35, false)
	for i in 17:
		var along := (i + 0.5) / 17.0
		var base := root.lerp(tip, along)
		for side: float in [-1.0, 1.0]:
			var reach := half * 0.45 * (1.0 - pow(along, 2.2)) * rng.randf_range(0.75, 1.0) + half * 0.05
			var end := base + Vector2(0.62, side).normalized() * reach
			end.x = minf(end.x, half * 1.96)
			_needles(image, bounds, base, end, rng)
	_needles(image, bounds, root.lerp(tip, 0.5), tip, rng)


static func _needles(image: Image, bounds: Rect2i, from: Vector2, to: Vector2, rng: RandomNumberGenerator) -> void:
	var axis := to - from
	var count := maxi(4, int(axis.length() / 2.6))
	var forward := axis.normalized()
	_stroke(image, bounds, from, to, 2.4, 0.5, false)
	for i in count:
		var base := from.lerp(to, float(i) / count)
		var side := forward.orthogonal() * (1.0 if i % 2 == 0 else -1.0)
		var direction := (forward + side * rng.randf_range(0.6, 1.0)).normalized()
		_stroke(image, bounds, base, base + direction * rng.randf_range(9.0, 14.0), 1.7, rng.randf_range(0.6, 1.0),
				false)


## A fern's frond: leaflets in pairs, longest in the lower third.
static func _draw_frond(image: Image, rng: RandomNumberGenerator) -> void:
	var bounds := Rect2i(0, SIZE / 2, SIZE / 2, SIZE / 2)
	var half := SIZE * 0.5
	var root := Vector2(half * 0.01, half * 1.5)
	var tip := Vector2(half * 0.97, half * 1.5)
	_stroke(image, bounds, root, tip, 2.6, 0.55, false)
	for i in 20:
		var along := 0.06 + 0.92 * i / 20.0
		var base := root.lerp(tip, along)
		var reach := half * 0.4 * sin(PI * pow(along, 0.62)) + half * 0.02
		for side: float in [-1.0, 1.0]:
			var end := base + Vector2(0.45, side).normalized() * reach
			_stroke(image, bounds, base, end, 5.4, rng.randf_range(0.75, 1.0), true)


## Paints a leaf (pointed at both ends, with a lighter rib) or a needle of half-width [param width] pixels.
static func _stroke(image: Image, bounds: Rect2i, from: Vector2, to: Vector2, width: float, shade: float,
		leaf: bool) -> void:
	var axis := to - from
	var length := axis.length()
	var forward := axis / length
	var box := Rect2i(Rect2(from, Vector2.ZERO).expand(to).grow(width + 1.0)).intersection(bounds)
	for y in range(box.position.y, box.end.y):
		for x in range(box.position.x, box.end.x):
			var offset := Vector2(x + 0.5, y + 0.5) - from
			var along := offset.dot(forward) / length
			if along < 0.0 or along > 1.0:
				continue
			var across := absf(offset.cross(forward))
			var reach := width * (pow(sin(PI * along), 0.75) if leaf else 1.0 - 0.6 * along)
			if across > reach:
				continue
			var value := shade
			if leaf:
				value *= 1.0 + 0.12 * maxf(0.0, 1.0 - across) - 0.14 * across / width
			image.set_pixel(x, y, Color(value, value, value, 1.0))
