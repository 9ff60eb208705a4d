extends RefCounted
## A small texture with the distance to a path, for ground whose vertices are too far apart to store it.

## The width of a pixel in meters.
const PIXEL := 1.0
## The distance in meters at which the texture is white. Larger distances are also white.
const MAX_DISTANCE := 6.0

## The rectangle that the texture covers, in world meters. Its x is the world's x, and its y is the world's z.
var rect := Rect2()
## Distances in meters divided by [constant REACH].
var texture: ImageTexture


func _init(path: Path3D) -> void:
	var points := path.curve.get_baked_points()
	for i in points.size():
		points[i] = path.global_transform * points[i]
	rect = _bounds_of(points)
	var size := Vector2i((rect.size / PIXEL).ceil())
	rect.size = Vector2(size) * PIXEL
	var distances := PackedByteArray()
	distances.resize(size.x * size.y)
	distances.fill(255)
	for point in points:
		_lower(distances, size, (Vector2(point.x, point.z) - rect.position) / PIXEL)
	texture = ImageTexture.create_from_image(Image.create_from_data(size.x, size.y, false, Image.FORMAT_L8, distances))


## Lowers the distances around [param pixel], a position in pixels.
static func _lower(distances: PackedByteArray, size: Vector2i, pixel: Vector2) -> void:
	var first := Vector2i(pixel - Vector2.ONE * MAX_DISTANCE / PIXEL).max(Vector2i.ZERO)
	var last := Vector2i(pixel + Vector2.ONE * MAX_DISTANCE / PIXEL).min(size - Vector2i.ONE)
	for y in range(first.y, last.y + 1):
		for x in range(first.x, last.x + 1):
			var distance := pixel.distance_to(Vector2(x + 0.5, y + 0.5)) * PIXEL
			var index := y * size.x + x
			distances[index] = mini(distances[index], int(distance / MAX_DISTANCE * 255.0))


## Returns a rectangle that contains all points, with a margin of white pixels on each side.
static func _bounds_of(points: PackedVector3Array) -> Rect2:
	var bounds := Rect2(points[0].x, points[0].z, 0.0, 0.0)
	for point in points:
		bounds = bounds.expand(Vector2(point.x, point.z))
	return bounds.grow(MAX_DISTANCE + 2.0 * PIXEL)
