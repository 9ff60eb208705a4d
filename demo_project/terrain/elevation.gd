extends RefCounted
## The demo's elevation model for drawing and walking, from the height samples ("posts") that
## [code]convert_dem.py[/code] has written. Heights between posts are interpolated bilinearly, as in a
## [ScatterGroundHeightmap] with the same file.
##
## The file is read directly from the project. To export the demo, add [code]*.r16, *.json[/code] to the preset's filter
## for non-resource files.

## The edge length of a block, in posts. For each block, the lowest and highest ground are stored.
const BLOCK := 8

## The number of columns (west to east) and rows (north to south) of posts.
var posts := Vector2i.ZERO
## The rectangle from the first post to the last, in world meters. Its x is the world's x, and its y is the world's z.
var rect := Rect2()
## The distance between posts along x and z, in meters.
var spacing := Vector2.ONE

var _heights := PackedFloat32Array()
var _blocks := Vector2i.ZERO
var _block_low := PackedFloat32Array()
var _block_high := PackedFloat32Array()


## Reads the description at [param path] and the samples next to it. On failure, prints an error and returns false.
func load_description(path: String) -> bool:
	var parsed: Variant = JSON.parse_string(FileAccess.get_file_as_string(path))
	if not parsed is Dictionary:
		push_error("%s is not a description of an elevation model" % path)
		return false
	var description: Dictionary = parsed
	posts = Vector2i(int(description.columns), int(description.rows))
	spacing = Vector2(description.post_meters_x, description.post_meters_z)
	var size := Vector2(description.size_x, description.size_z)
	rect = Rect2(size * -0.5, size)
	var bytes := FileAccess.get_file_as_bytes(path.get_base_dir().path_join(description.samples))
	if bytes.size() != posts.x * posts.y * 2:
		push_error("%s must have %d bytes of samples, got %d" % [path, bytes.size(), posts.x * posts.y * 2])
		return false
	_decode(bytes, description.min_height, description.max_height)
	_bound_blocks()
	return true


## Returns the height of the ground in meters at world x and z, or NAN outside of the map.
func height(x: float, z: float) -> float:
	var post_position := (Vector2(x, z) - rect.position) / spacing
	if post_position.x < 0.0 or post_position.y < 0.0 or post_position.x > posts.x - 1 or post_position.y > posts.y - 1:
		return NAN
	var i := mini(int(post_position.x), posts.x - 2)
	var j := mini(int(post_position.y), posts.y - 2)
	var first := j * posts.x + i
	var north := lerpf(_heights[first], _heights[first + 1], post_position.x - i)
	var south := lerpf(_heights[first + posts.x], _heights[first + posts.x + 1], post_position.x - i)
	return lerpf(north, south, post_position.y - j)


## Returns the lowest and highest height in meters between the posts [param from] and [param to], extended to whole blocks.
func bounds(from: Vector2i, to: Vector2i) -> Vector2:
	var low := INF
	var high := -INF
	var last := (to / BLOCK).clamp(Vector2i.ZERO, _blocks - Vector2i.ONE)
	for j in range(mini(from.y / BLOCK, last.y), last.y + 1):
		for i in range(mini(from.x / BLOCK, last.x), last.x + 1):
			low = minf(low, _block_low[j * _blocks.x + i])
			high = maxf(high, _block_high[j * _blocks.x + i])
	return Vector2(low, high)


## Returns the heights of the posts in meters as a texture of 32-bit floats, for reading without filtering.
func height_texture() -> ImageTexture:
	var image := Image.create_from_data(posts.x, posts.y, false, Image.FORMAT_RF, _heights.to_byte_array())
	return ImageTexture.create_from_image(image)


## Returns a texture for lighting the ground, with a pixel for each post, for linear filtering. Red and green are the slopes of the ground along x and
## z. Blue is the height of the post above the mean of the four posts 5 posts away (north, south, west and east), in meters. It is negative in a hollow.
func relief_texture() -> ImageTexture:
	var values := PackedFloat32Array()
	values.resize(posts.x * posts.y * 3)
	var far_posts := 5 # In posts.
	for j in posts.y:
		var north := maxi(j - 1, 0)
		var south := mini(j + 1, posts.y - 1)
		var far_north := maxi(j - far_posts, 0) * posts.x
		var far_south := mini(j + far_posts, posts.y - 1) * posts.x
		for i in posts.x:
			var west := maxi(i - 1, 0)
			var east := mini(i + 1, posts.x - 1)
			var row := j * posts.x
			var index := 3 * (row + i)
			values[index] = (_heights[row + east] - _heights[row + west]) / (spacing.x * (east - west))
			var fall := _heights[south * posts.x + i] - _heights[north * posts.x + i]
			values[index + 1] = fall / (spacing.y * (south - north))
			var far_west := maxi(i - far_posts, 0)
			var far_east := mini(i + far_posts, posts.x - 1)
			var far_sum := _heights[far_north + i] + _heights[far_south + i]
			far_sum += _heights[row + far_west] + _heights[row + far_east]
			values[index + 2] = _heights[row + i] - 0.25 * far_sum
	var image := Image.create_from_data(posts.x, posts.y, false, Image.FORMAT_RGBF, values.to_byte_array())
	image.convert(Image.FORMAT_RGBH)
	return ImageTexture.create_from_image(image)


func _decode(bytes: PackedByteArray, min_height: float, max_height: float) -> void:
	_heights.resize(posts.x * posts.y)
	var step := (max_height - min_height) / 65535.0
	for i in _heights.size():
		_heights[i] = min_height + bytes.decode_u16(2 * i) * step


func _bound_blocks() -> void:
	_blocks = Vector2i((posts.x + BLOCK - 2) / BLOCK, (posts.y + BLOCK - 2) / BLOCK)
	_block_low.resize(_blocks.x * _blocks.y)
	_block_high.resize(_blocks.x * _blocks.y)
	_block_low.fill(INF)
	_block_high.fill(-INF)
	for j in posts.y:
		for i in posts.x:
			var value := _heights[j * posts.x + i]
			# A post on the border of a block belongs to the blocks on both sides.
			for block_j in range(maxi(0, (j - 1) / BLOCK), mini(_blocks.y - 1, j / BLOCK) + 1):
				for block_i in range(maxi(0, (i - 1) / BLOCK), mini(_blocks.x - 1, i / BLOCK) + 1):
					var index := block_j * _blocks.x + block_i
					_block_low[index] = minf(_block_low[index], value)
					_block_high[index] = maxf(_block_high[index], value)
