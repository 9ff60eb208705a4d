extends RefCounted
## Sets the rules and colors of a scatter's layers on the ground's shader. Distant ground then has the colors of the plants that grow there. The
## rules are defined only once, in the layers.

## The width and height of the noise texture in pixels. On a map of 32 km, a pixel is 62 m wide.
const NOISE_PIXELS := 512
## The number of noise values for which a row of the color table has a color.
const TABLE_PIXELS := 64
## The number of random values over which each color of the table is averaged.
const SAMPLES := 8

var _noise: ImageTexture
var _colors: ImageTexture


## Sets the rules and colors of [param layers] on a ground material, in the order of the shader's arrays. [param rect] is the map in world x and z. All layers
## must take their colors from one Noise resource, or at random.
func apply(material: RID, rect: Rect2, layers: Array[ScatterLayer]) -> void:
	var slopes: Array[Vector3] = []
	var heights: Array[Vector3] = []
	var rows: Array[Color] = []
	var noise: FastNoiseLite
	for layer in layers:
		slopes.append(Vector3(_limit(layer.min_slope_degrees), _limit(layer.max_slope_degrees), layer.slope_falloff_degrees))
		heights.append(Vector3(layer.min_height, layer.max_height, layer.height_falloff))
		rows.append_array(_row(layer.color_value))
		if layer.color_value != null and layer.color_value.noise is FastNoiseLite:
			noise = layer.color_value.noise
	_colors = ImageTexture.create_from_image(_table(rows))
	# A pixel has the same width and depth, so that one frequency applies to both axes.
	var pixel := maxf(rect.size.x, rect.size.y) / NOISE_PIXELS
	_noise = ImageTexture.create_from_image(_map(noise, rect.position, pixel))
	RenderingServer.material_set_param(material, &"layer_slopes", slopes)
	RenderingServer.material_set_param(material, &"layer_heights", heights)
	RenderingServer.material_set_param(material, &"layer_colors", _colors.get_rid())
	RenderingServer.material_set_param(material, &"stands", _noise.get_rid())
	RenderingServer.material_set_param(material, &"stands_size", pixel * NOISE_PIXELS)


## Returns a slope limit for the shader, in degrees. A limit of 0 or 90 degrees must have no effect, so it is replaced by a value that no slope and no
## falloff reaches.
static func _limit(degrees: float) -> float:
	return -90.0 if degrees == 0.0 else 180.0 if degrees == 90.0 else degrees


## Returns the average color of a layer's instances for each value of the noise.
static func _row(source: ScatterValueSource) -> Array[Color]:
	var row: Array[Color] = []
	for i in TABLE_PIXELS:
		var sum := Color(0.0, 0.0, 0.0)
		for k in SAMPLES:
			var random := (k + 0.5) / SAMPLES
			var value := random
			if source != null and source.source == ScatterValueSource.SOURCE_NOISE:
				value = clampf(inverse_lerp(source.min_value, source.max_value, i / (TABLE_PIXELS - 1.0)), 0.0, 1.0)
				value = lerpf(value, random, source.randomness)
			sum += source.gradient.sample(value) if source != null and source.gradient != null else Color.WHITE
		row.append(sum / SAMPLES)
	return row


static func _table(rows: Array[Color]) -> Image:
	var image := Image.create_empty(TABLE_PIXELS, rows.size() / TABLE_PIXELS, false, Image.FORMAT_RGBH)
	for i in rows.size():
		image.set_pixel(i % TABLE_PIXELS, i / TABLE_PIXELS, rows[i])
	return image


## Returns the noise over the map as layers read it: 0.5 plus half of its value. [param pixel] is the width of a pixel in meters.
static func _map(noise: FastNoiseLite, origin: Vector2, pixel: float) -> Image:
	if noise == null:
		var gray := Image.create_empty(1, 1, false, Image.FORMAT_L8)
		gray.fill(Color(0.5, 0.5, 0.5))
		return gray
	var scaled: FastNoiseLite = noise.duplicate()
	scaled.frequency *= pixel
	scaled.offset = Vector3(origin.x / pixel + 0.5, origin.y / pixel + 0.5, 0.0)
	return scaled.get_image(NOISE_PIXELS, NOISE_PIXELS, false, false, false)
