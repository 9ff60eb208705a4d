@tool
extends RefCounted
## The changes that a brush stroke makes to one mask, as compressed blocks of pixels before and after the stroke.

## The edge length of a block in pixels.
const BLOCK := 64

var mask: ScatterMask
## The layers that had no mask before the stroke and now use this one.
var new_layers: Array[ScatterLayer] = []
## The radius of the planet that the mask covers, in meters; 0 if it is projected along the y axis.
var planet_radius := 0.0

var _old_blocks: Dictionary[Vector2i, PackedByteArray] = {}


func _init(painted: ScatterMask) -> void:
	mask = painted


## Adds a dab at world x and z or, on a planet, at a position relative to its center. The other parameters have the same meaning as in
## [method ScatterMask.paint].
func dab(position: Vector3, radius: float, strength: float, hardness: float, mode: ScatterMask.Mode) -> void:
	if planet_radius > 0.0:
		for rect in mask.get_pixel_rects_on_planet(planet_radius, position, radius):
			_store_blocks(rect)
		mask.paint_on_planet(planet_radius, position, radius, strength, hardness, mode)
		return
	var center := Vector2(position.x, position.z)
	var half_size := Vector2(radius, radius)
	_store_blocks(mask.get_pixel_rect(Rect2(center - half_size, 2.0 * half_size)))
	mask.paint(center, radius, strength, hardness, mode)


## Adds the changed blocks to the dictionaries: [param r_before] gets their pixels before the stroke, and [param r_after] those after it.
func changes(r_before: Dictionary, r_after: Dictionary) -> void:
	for block in _old_blocks:
		var pixels := mask.get_pixels(_pixels(block))
		if pixels != _old_blocks[block]:
			r_before[block] = _old_blocks[block].compress(FileAccess.COMPRESSION_ZSTD)
			r_after[block] = pixels.compress(FileAccess.COMPRESSION_ZSTD)


## Stores the blocks that contain these pixels, as they were before the stroke.
func _store_blocks(rect: Rect2i) -> void:
	var first := _block_of(rect.position)
	var last := _block_of(rect.end - Vector2i.ONE)
	for y in range(first.y, last.y + 1):
		for x in range(first.x, last.x + 1):
			var block := Vector2i(x, y)
			if not _old_blocks.has(block):
				_old_blocks[block] = mask.get_pixels(_pixels(block))


## Writes compressed blocks of pixels to a mask.
static func put(painted: ScatterMask, blocks: Dictionary) -> void:
	for block: Vector2i in blocks:
		var packed: PackedByteArray = blocks[block]
		painted.set_pixels(_pixels(block), packed.decompress(BLOCK * BLOCK, FileAccess.COMPRESSION_ZSTD))


static func _pixels(block: Vector2i) -> Rect2i:
	return Rect2i(block * BLOCK, Vector2i(BLOCK, BLOCK))


static func _block_of(pixel: Vector2i) -> Vector2i:
	return Vector2i(floori(pixel.x / float(BLOCK)), floori(pixel.y / float(BLOCK)))
