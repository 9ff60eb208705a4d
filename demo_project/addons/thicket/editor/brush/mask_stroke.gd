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

var _before: Dictionary[Vector2i, PackedByteArray] = {}


func _init(painted: ScatterMask) -> void:
	mask = painted


## Adds a dab at world x and z or, on a planet, at a position relative to its center. The other parameters have the same meaning as in
## [method ScatterMask.paint].
func dab(at: Vector3, radius: float, strength: float, hardness: float, mode: ScatterMask.Mode) -> void:
	if planet_radius > 0.0:
		for touched in mask.get_pixel_rects_on_planet(planet_radius, at, radius):
			_store(touched)
		mask.paint_on_planet(planet_radius, at, radius, strength, hardness, mode)
		return
	var center := Vector2(at.x, at.z)
	var reach := Vector2(radius, radius)
	_store(mask.get_pixel_rect(Rect2(center - reach, 2.0 * reach)))
	mask.paint(center, radius, strength, hardness, mode)


## Adds the changed blocks to the dictionaries: [param r_before] gets their pixels before the stroke, and [param r_after] those after it.
func changes(r_before: Dictionary, r_after: Dictionary) -> void:
	for block in _before:
		var now := mask.get_pixels(_pixels(block))
		if now != _before[block]:
			r_before[block] = _before[block].compress(FileAccess.COMPRESSION_ZSTD)
			r_after[block] = now.compress(FileAccess.COMPRESSION_ZSTD)


## Stores the blocks that contain these pixels, as they were before the stroke.
func _store(touched: Rect2i) -> void:
	var first := _block_of(touched.position)
	var last := _block_of(touched.end - Vector2i.ONE)
	for y in range(first.y, last.y + 1):
		for x in range(first.x, last.x + 1):
			var block := Vector2i(x, y)
			if not _before.has(block):
				_before[block] = mask.get_pixels(_pixels(block))


## Writes compressed blocks of pixels to a mask.
static func put(painted: ScatterMask, blocks: Dictionary) -> void:
	for block: Vector2i in blocks:
		var packed: PackedByteArray = blocks[block]
		painted.set_pixels(_pixels(block), packed.decompress(BLOCK * BLOCK, FileAccess.COMPRESSION_ZSTD))


static func _pixels(block: Vector2i) -> Rect2i:
	return Rect2i(block * BLOCK, Vector2i(BLOCK, BLOCK))


static func _block_of(pixel: Vector2i) -> Vector2i:
	return Vector2i(floori(pixel.x / float(BLOCK)), floori(pixel.y / float(BLOCK)))
