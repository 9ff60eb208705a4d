extends RefCounted
## A small seamless noise texture that the ground and the sky share, generated once per run.
##
## Red contains soft patches, green contains grain, blue contains billows, and alpha contains different soft patches.

const SIZE := 256

static var _texture: ImageTexture


## Returns the texture, which the first call generates.
static func texture() -> ImageTexture:
	if _texture == null:
		var soft_patches := _noise(1, 0.02, FastNoiseLite.FRACTAL_FBM)
		var grain := _noise(2, 0.09, FastNoiseLite.FRACTAL_FBM)
		var billow := _noise(3, 0.016, FastNoiseLite.FRACTAL_RIDGED)
		var more_patches := _noise(4, 0.026, FastNoiseLite.FRACTAL_FBM)
		var bytes := PackedByteArray()
		bytes.resize(SIZE * SIZE * 4)
		for i in SIZE * SIZE:
			bytes[4 * i] = soft_patches[i]
			bytes[4 * i + 1] = grain[i]
			bytes[4 * i + 2] = billow[i]
			bytes[4 * i + 3] = more_patches[i]
		var image := Image.create_from_data(SIZE, SIZE, false, Image.FORMAT_RGBA8, bytes)
		image.generate_mipmaps()
		_texture = ImageTexture.create_from_image(image)
	return _texture


static func _noise(noise_seed: int, frequency: float, fractal: FastNoiseLite.FractalType) -> PackedByteArray:
	var noise := FastNoiseLite.new()
	noise.seed = noise_seed
	noise.noise_type = FastNoiseLite.TYPE_SIMPLEX_SMOOTH
	noise.frequency = frequency
	noise.fractal_type = fractal
	noise.fractal_octaves = 4
	return noise.get_seamless_image(SIZE, SIZE, false, false, 0.25, true).get_data()
