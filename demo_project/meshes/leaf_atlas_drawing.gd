extends RefCounted
## Draws the leaves and the bark of all plants into one texture. The artwork is original and consists of ellipses, strokes and noise.
## [code]leaf_atlas.gd[/code] defines the regions.

const Atlas := preload("res://meshes/leaf_atlas.gd")
const CELL := Atlas.CELL
## The number of texels by which a column of bark continues beyond its edges. The same number of transparent texels follows, so that mipmaps do not
## mix in other regions.
const MARGIN := 16

var _image: Image
var _random := RandomNumberGenerator.new()
## The rectangle to which strokes are clipped, in texels.
var _bounds := Rect2i()


## Returns the texture's image with mipmaps.
func draw() -> Image:
	_image = Image.create_empty(Atlas.SIZE.x, Atlas.SIZE.y, false, Image.FORMAT_RGBA8)
	_image.fill(Color(0.72, 0.72, 0.72, 0.0))
	var white := Vector2i(Atlas.OPAQUE_UV * Vector2(Atlas.SIZE))
	_image.fill_rect(Rect2i(white - Vector2i(16, 16), Vector2i(32, 32)), Color.WHITE)
	_random.seed = 11
	_draw_barks()
	_draw_broadleaf()
	_draw_twig()
	_draw_frond()
	_draw_tuft()
	_draw_crown()
	_draw_conifer()
	_image.generate_mipmaps()
	return _image


## Draws bark with cracks between plates: long plates for an oak, round ones for a spruce. Also draws the dark marks of a birch. Cracks are lit from
## one side to look deep.
func _draw_barks() -> void:
	var furrows := FastNoiseLite.new()
	furrows.seed = 5
	furrows.noise_type = FastNoiseLite.TYPE_SIMPLEX_SMOOTH
	furrows.fractal_type = FastNoiseLite.FRACTAL_RIDGED
	furrows.fractal_octaves = 3
	furrows.frequency = 0.034
	_draw_bark(Atlas.BARKS[0], furrows, 288, 1.0)
	var scales := FastNoiseLite.new()
	scales.seed = 6
	scales.noise_type = FastNoiseLite.TYPE_CELLULAR
	scales.cellular_return_type = FastNoiseLite.RETURN_DISTANCE2_SUB
	scales.fractal_type = FastNoiseLite.FRACTAL_NONE
	scales.frequency = 0.06
	_draw_bark(Atlas.BARKS[1], scales, 512, -1.0)
	_draw_birch_bark(Atlas.BARKS[2])


## Draws one kind of bark. Cracks are where the noise [param cracks] has high values if [param sign] is 1, or low values if it is -1. The noise is
## computed with [param rows] rows and stretched along the trunk.
func _draw_bark(column: Rect2, cracks: FastNoiseLite, rows: int, sign: float) -> void:
	var width := int(column.size.x * Atlas.SIZE.x)
	var plates := cracks.get_seamless_image(width, rows)
	plates.resize(width, Atlas.SIZE.y, Image.INTERPOLATE_BILINEAR)
	var depths := plates.get_data()
	var grain := _grain(width)
	var bytes := PackedByteArray()
	bytes.resize(width * Atlas.SIZE.y)
	for y in Atlas.SIZE.y:
		var row := y * width
		for x in width:
			var depth := depths[row + x] * sign
			var slant := depths[row + (x + 2) % width] * sign - depth
			var value := 0.86 - 0.0021 * (depth + (255.0 if sign < 0.0 else 0.0)) + 0.005 * slant + 0.0014 * (grain[row + x] - 128.0)
			bytes[row + x] = clampi(int(value * 255.0), 40, 255)
	_put_column(column, bytes)


## Draws pale bark with dark horizontal marks.
func _draw_birch_bark(column: Rect2) -> void:
	var width := int(column.size.x * Atlas.SIZE.x)
	var grain := _grain(width)
	var bytes := PackedByteArray()
	bytes.resize(width * Atlas.SIZE.y)
	for index in bytes.size():
		bytes[index] = clampi(int(226.0 + 0.2 * (grain[index] - 128.0)), 0, 255)
	for mark in 170:
		var middle := Vector2i(_random.randi_range(0, width - 1), _random.randi_range(0, Atlas.SIZE.y - 1))
		var half_width := int(_random.randf_range(6.0, 34.0) * (2.0 if mark % 9 == 0 else 1.0))
		var half_height := _random.randf_range(1.5, 3.5) * (3.0 if mark % 9 == 0 else 1.0)
		var darkness := _random.randf_range(0.18, 0.5)
		for y in range(-int(half_height) - 1, int(half_height) + 2):
			for x in range(-half_width, half_width + 1):
				if absf(y) > half_height * sqrt(1.0 - pow(float(x) / (half_width + 1), 2.0)):
					continue
				var index := posmod(middle.y + y, Atlas.SIZE.y) * width + posmod(middle.x + x, width)
				bytes[index] = mini(bytes[index], int(255.0 * darkness) + grain[index] / 8)
	_put_column(column, bytes)


func _grain(width: int) -> PackedByteArray:
	var noise := FastNoiseLite.new()
	noise.seed = 9
	noise.frequency = 0.12
	return noise.get_seamless_image(width, Atlas.SIZE.y).get_data()


## Writes brightness values to a column and continues them at its edges.
func _put_column(column: Rect2, brightness: PackedByteArray) -> void:
	var width := int(column.size.x * Atlas.SIZE.x)
	var column_image := Image.create_from_data(width, Atlas.SIZE.y, false, Image.FORMAT_L8, brightness)
	column_image.convert(Image.FORMAT_RGBA8)
	var left := int(column.position.x * Atlas.SIZE.x)
	_image.blit_rect(column_image, Rect2i(0, 0, width, Atlas.SIZE.y), Vector2i(left, 0))
	_image.blit_rect(column_image, Rect2i(width - MARGIN, 0, MARGIN, Atlas.SIZE.y), Vector2i(left - MARGIN, 0))
	_image.blit_rect(column_image, Rect2i(0, 0, MARGIN, Atlas.SIZE.y), Vector2i(left + width, 0))


## Clips the following strokes to [param region] and returns its upper left corner in texels.
func _begin(region: Rect2) -> Vector2:
	_bounds = Rect2i(region.position * Vector2(Atlas.SIZE), region.size * Vector2(Atlas.SIZE))
	return Vector2(_bounds.position)


## Draws a roundish spray of pointed leaves. Dark leaves are drawn first, so that the spray looks deep.
func _draw_broadleaf() -> void:
	var center := _begin(Atlas.BROADLEAF) + Vector2(CELL, CELL) * 0.5
	var count := 210
	for i in count:
		var depth := float(i) / count
		var angle := _random.randf() * TAU
		var distance := sqrt(_random.randf()) * CELL * (0.42 - 0.05 * sin(3.0 * angle))
		var root := center + Vector2.from_angle(angle) * distance
		var direction := Vector2.from_angle(angle + _random.randf_range(-0.9, 0.9))
		var length := CELL * _random.randf_range(0.075, 0.12)
		var shade := lerpf(0.5, 1.0, depth) * _random.randf_range(0.85, 1.0)
		_stroke(root - direction * length * 0.5, root + direction * length * 0.5, length * 0.25, shade, true)


## Draws a conifer twig: side shoots along a stem, and needles along the shoots.
func _draw_twig() -> void:
	var corner := _begin(Atlas.TWIG)
	var root := corner + Vector2(CELL * 0.01, CELL * 0.5)
	var tip := corner + Vector2(CELL * 0.9, CELL * 0.5)
	_stroke(root, root.lerp(tip, 0.9), 6.0, 0.35, false)
	for i in 19:
		var fraction := (i + 0.5) / 19.0
		var base := root.lerp(tip, fraction)
		for side: float in [-1.0, 1.0]:
			var length := CELL * 0.45 * (1.0 - pow(fraction, 2.2)) * _random.randf_range(0.7, 1.0) + CELL * 0.05
			var end := base + Vector2(_random.randf_range(0.5, 0.8), side).normalized() * length
			end.x = minf(end.x, corner.x + CELL * 0.96)
			_needles(base, end, Vector2(18.0, 28.0), 3.2)
	_needles(root.lerp(tip, 0.5), tip, Vector2(18.0, 28.0), 3.2)


## Draws a shoot with needles. [param lengths] are the minimum and maximum length of a needle, in texels.
func _needles(from: Vector2, to: Vector2, lengths: Vector2, width: float) -> void:
	var axis := to - from
	var count := maxi(4, int(axis.length() / (1.6 * width)))
	var forward := axis.normalized()
	_stroke(from, to, width * 1.4, 0.5, false)
	for i in count:
		var base := from.lerp(to, float(i) / count)
		var side := forward.orthogonal() * (1.0 if i % 2 == 0 else -1.0)
		var direction := (forward + side * _random.randf_range(0.6, 1.0)).normalized()
		_stroke(base, base + direction * _random.randf_range(lengths.x, lengths.y), width, _random.randf_range(0.6, 1.0), false)


## Draws a fern's frond: pairs of leaflets, which are longest in the lower third.
func _draw_frond() -> void:
	var corner := _begin(Atlas.FROND)
	var root := corner + Vector2(CELL * 0.01, CELL * 0.5)
	var tip := corner + Vector2(CELL * 0.97, CELL * 0.5)
	_stroke(root, tip, 5.2, 0.55, false)
	for i in 24:
		var fraction := 0.05 + 0.93 * i / 24.0
		var base := root.lerp(tip, fraction)
		var length := CELL * 0.41 * sin(PI * pow(fraction, 0.62)) + CELL * 0.02
		for side: float in [-1.0, 1.0]:
			var end := base + Vector2(0.45, side).normalized() * length * _random.randf_range(0.92, 1.0)
			_stroke(base, end, 9.0, _random.randf_range(0.75, 1.0), true)


## Draws long needles that radiate from a few shoots.
func _draw_tuft() -> void:
	var center := _begin(Atlas.TUFT) + Vector2(CELL, CELL) * 0.5
	for i in 26:
		var depth := i / 26.0
		var angle := i * 2.39996
		var root := center + Vector2.from_angle(angle) * CELL * 0.3 * sqrt(1.0 - depth)
		for needle in 34:
			var direction := Vector2.from_angle(angle + _random.randf_range(-1.9, 1.9))
			var length := CELL * _random.randf_range(0.1, 0.17)
			_stroke(root, root + direction * length, 2.6, lerpf(0.45, 1.0, depth) * _random.randf_range(0.75, 1.0), false)


## Draws the crown of a broadleaf tree: clumps of leaves, which are drawn from the bottom up and darker inside.
func _draw_crown() -> void:
	var corner := _begin(Atlas.CROWN)
	var lumps: Array[Vector3] = []
	for i in 16:
		var position := Vector2.from_angle(i * 2.39996) * sqrt((i + 0.5) / 16.0) * 0.34
		lumps.append(Vector3(0.5 + position.x, 0.5 + position.y * 0.95, _random.randf_range(0.11, 0.16)))
	lumps.sort_custom(func(a: Vector3, b: Vector3) -> bool: return a.y > b.y)
	for lump in lumps:
		for i in 130:
			var direction_from_center := Vector2.from_angle(_random.randf() * TAU) * sqrt(_random.randf())
			var root := corner + (Vector2(lump.x, lump.y) + direction_from_center * lump.z) * CELL
			var light := 0.62 - 0.28 * direction_from_center.y + 0.22 * (0.5 - lump.y) + _random.randf_range(-0.1, 0.1)
			var direction := Vector2.from_angle(direction_from_center.angle() + _random.randf_range(-1.0, 1.0))
			var length := CELL * _random.randf_range(0.028, 0.045)
			_stroke(root - direction * length, root + direction * length, length * 0.7, clampf(light, 0.3, 1.0), true)


## Draws a whole conifer from the lowest bough to the tip.
func _draw_conifer() -> void:
	var corner := _begin(Atlas.CONIFER)
	var width := CELL * 0.5
	_stroke(corner + Vector2(width * 0.5, CELL * 0.99), corner + Vector2(width * 0.5, CELL * 0.05), 5.0, 0.4, false)
	var count := 420
	for i in count:
		var fraction := 1.0 - sqrt(1.0 - float(i) / count)
		var side := _random.randf_range(-1.0, 1.0)
		var length := width * 0.48 * pow(1.0 - fraction, 0.9) * _random.randf_range(0.75, 1.0) + 6.0
		var start := corner + Vector2(width * 0.5 + side * length * 0.15, CELL * (0.93 - 0.9 * fraction))
		var end := start + Vector2(side * length, length * (0.42 - 0.5 * fraction) * _random.randf_range(0.6, 1.3))
		var light := lerpf(0.55, 0.85, absf(side)) * lerpf(0.85, 1.1, fraction) * _random.randf_range(0.8, 1.1)
		_stroke(start, end, 7.0 + 3.0 * (1.0 - fraction), minf(light, 1.0), true)


## Draws a leaf (pointed at both ends, with a lighter rib) or a needle, with a half-width of [param width] texels.
func _stroke(from: Vector2, to: Vector2, width: float, shade: float, is_leaf: bool) -> void:
	var axis := to - from
	var length := axis.length()
	var forward := axis / length
	var warmth := _random.randf_range(-0.05, 0.05)
	var box := Rect2i(Rect2(from, Vector2.ZERO).expand(to).grow(width + 1.0)).intersection(_bounds)
	for y in range(box.position.y, box.end.y):
		for x in range(box.position.x, box.end.x):
			var offset := Vector2(x + 0.5, y + 0.5) - from
			var fraction := offset.dot(forward) / length
			if fraction < 0.0 or fraction > 1.0:
				continue
			var axis_distance := absf(offset.cross(forward))
			var half_width := width * (pow(sin(PI * fraction), 0.75) if is_leaf else 1.0 - 0.6 * fraction)
			if axis_distance > half_width:
				continue
			var value := shade
			if is_leaf:
				value *= 1.0 + 0.12 * maxf(0.0, 1.0 - axis_distance * 0.5) - 0.16 * axis_distance / width
			_image.set_pixel(x, y, Color(value * (1.0 + warmth), value, value * (1.0 - warmth), 1.0))
