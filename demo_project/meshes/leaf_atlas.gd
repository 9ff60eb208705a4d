extends RefCounted
## Draws the leaves and the bark of all plants into one small texture, once per run: original artwork from ellipses, strokes and
## noise.
##
## The atlas has broad leaves, a conifer's twig (stem on the left, tip on the right), a fern's frond (in the same direction), and
## opaque white. It also has columns of bark, which repeat from top to bottom, so that the bark has the same size on a trunk of any
## length. The color is a brightness, which the vertex color tints. Alpha is for the alpha scissor.

const SIZE := Vector2i(1248, 512)
## The side of a leaf's square in texels.
const CELL := 256
const BROADLEAF := Rect2(0.0, 0.0, 256.0 / 1248.0, 0.5)
const TWIG := Rect2(256.0 / 1248.0, 0.0, 256.0 / 1248.0, 0.5)
const FROND := Rect2(0.0, 0.5, 256.0 / 1248.0, 0.5)
## An opaque white texel, for surfaces without a texture.
const OPAQUE_UV := Vector2(384.0 / 1248.0, 0.75)
## Columns that go around a trunk: furrows like an oak's, scales like a spruce's.
const BARKS: Array[Rect2] = [Rect2(560.0 / 1248.0, 0.0, 288.0 / 1248.0, 1.0), Rect2(912.0 / 1248.0, 0.0, 288.0 / 1248.0, 1.0)]
## The length of a column, as a multiple of the trunk's circumference.
const BARK_LENGTH := 512.0 / 288.0
## Texels by which a column continues at its sides, followed by as many transparent ones, so that mipmaps mix in nothing else.
const MARGIN := 16

static var _texture: ImageTexture


## The atlas, drawn on the first call.
static func texture() -> ImageTexture:
	if _texture == null:
		var image := _draw()
		image.generate_mipmaps()
		_texture = ImageTexture.create_from_image(image)
	return _texture


static func _draw() -> Image:
	var image := Image.create_empty(SIZE.x, SIZE.y, false, Image.FORMAT_RGBA8)
	image.fill(Color(0.72, 0.72, 0.72, 0.0))
	var white := Vector2i(OPAQUE_UV * Vector2(SIZE))
	image.fill_rect(Rect2i(white - Vector2i(16, 16), Vector2i(32, 32)), Color.WHITE)
	_draw_barks(image)
	var rng := RandomNumberGenerator.new()
	rng.seed = 11
	_draw_broadleaf(image, rng)
	_draw_twig(image, rng)
	_draw_frond(image, rng)
	return image


## Draws cracks between plates, long on an oak and round on a spruce, lit from one side to look deep.
static func _draw_barks(image: Image) -> void:
	var furrows := FastNoiseLite.new()
	furrows.seed = 5
	furrows.noise_type = FastNoiseLite.TYPE_SIMPLEX_SMOOTH
	furrows.fractal_type = FastNoiseLite.FRACTAL_RIDGED
	furrows.fractal_octaves = 3
	furrows.frequency = 0.034
	_draw_bark(image, BARKS[0], furrows, 144, 1.0)
	var scales := FastNoiseLite.new()
	scales.seed = 6
	scales.noise_type = FastNoiseLite.TYPE_CELLULAR
	scales.cellular_return_type = FastNoiseLite.RETURN_DISTANCE2_SUB
	scales.fractal_type = FastNoiseLite.FRACTAL_NONE
	scales.frequency = 0.06
	_draw_bark(image, BARKS[1], scales, 256, -1.0)


## Draws one bark. Cracks are at high values of [param cracks] if [param sign] is 1, and at low values if it is -1. The noise is
## stretched along the trunk from [param rows] rows.
static func _draw_bark(image: Image, column: Rect2, cracks: FastNoiseLite, rows: int, sign: float) -> void:
	var wide := int(column.size.x * SIZE.x)
	var plates := cracks.get_seamless_image(wide, rows)
	plates.resize(wide, SIZE.y, Image.INTERPOLATE_BILINEAR)
	var deep := plates.get_data()
	var fine := FastNoiseLite.new()
	fine.seed = 9
	fine.frequency = 0.12
	var grain := fine.get_seamless_image(wide, SIZE.y).get_data()
	var bytes := PackedByteArray()
	bytes.resize(wide * SIZE.y * 4)
	bytes.fill(255)
	for y in SIZE.y:
		var row := y * wide
		for x in wide:
			var here := deep[row + x] * sign
			var slant := deep[row + (x + 2) % wide] * sign - here
			var value := 0.86 - 0.0021 * (here + (255.0 if sign < 0.0 else 0.0)) + 0.005 * slant + 0.0014 * (grain[row + x] - 128.0)
			var byte := clampi(int(value * 255.0), 40, 255)
			var at := 4 * (row + x)
			bytes[at] = byte
			bytes[at + 1] = byte
			bytes[at + 2] = byte
	var drawn := Image.create_from_data(wide, SIZE.y, false, Image.FORMAT_RGBA8, bytes)
	var left := int(column.position.x * SIZE.x)
	image.blit_rect(drawn, Rect2i(0, 0, wide, SIZE.y), Vector2i(left, 0))
	image.blit_rect(drawn, Rect2i(wide - MARGIN, 0, MARGIN, SIZE.y), Vector2i(left - MARGIN, 0))
	image.blit_rect(drawn, Rect2i(0, 0, MARGIN, SIZE.y), Vector2i(left + wide, 0))


## Draws a roundish spray of pointed leaves, dark ones first, which makes it look deep.
static func _draw_broadleaf(image: Image, rng: RandomNumberGenerator) -> void:
	var bounds := Rect2i(0, 0, CELL, CELL)
	var center := Vector2(CELL, CELL) * 0.5
	var count := 120
	for i in count:
		var depth := float(i) / count
		var angle := rng.randf() * TAU
		var distance := sqrt(rng.randf()) * CELL * 0.4
		var root := center + Vector2.from_angle(angle) * distance
		var direction := Vector2.from_angle(angle + rng.randf_range(-0.9, 0.9))
		var length := CELL * rng.randf_range(0.11, 0.17)
		var shade := lerpf(0.5, 1.0, depth) * rng.randf_range(0.85, 1.0)
		_stroke(image, bounds, root - direction * length * 0.5, root + direction * length * 0.5, length * 0.24, shade,
				true)


## Draws a drooping conifer twig: side shoots along a stem, needles along the shoots.
static func _draw_twig(image: Image, rng: RandomNumberGenerator) -> void:
	var bounds := Rect2i(CELL, 0, CELL, CELL)
	var half := float(CELL)
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


## Draws a fern's frond: leaflets in pairs, longest in the lower third.
static func _draw_frond(image: Image, rng: RandomNumberGenerator) -> void:
	var bounds := Rect2i(0, CELL, CELL, CELL)
	var half := float(CELL)
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


## Draws a leaf (pointed at both ends, with a lighter rib) or a needle with a half-width of [param width] pixels.
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
