@tool
extends RefCounted
## The borders of a [ScatterRegion3D] on a planet. They are lines on a flat map around the middle of the region: for polygons and paths, the map on
## which the library evaluates them, otherwise the shadow of the region along up.

const Outline := preload("res://addons/thicket/editor/regions/region_outline.gd")
const SurfacePlace := preload("res://addons/thicket/editor/ground/surface_place.gd")

## The largest distance from the middle of a shadow, as a fraction of the distance from the planet's center.
const RIM := 0.999
## The distance from the planet's center from which the ground is searched, in radii of the planet.
const RADII := 2.0
## The largest angle between a corner of a polygon and the polygon's y axis, seen from the planet's center, in degrees. A corner at 90 degrees would
## be infinitely far away in the polygon's plane.
const FARTHEST := 80.0

var _region: ScatterRegion3D
var _scatter: TerrainScatter3D
var _center: Vector3
var _radius: float
var _distance: float ## The distance of the middle from the planet's center.
var _axes: Basis ## The axes of the map; y is the up direction of the middle.


## Prepares the borders of a region below a scatter whose ground forms a planet.
func _init(region: ScatterRegion3D, scatter: TerrainScatter3D) -> void:
	_region = region
	_scatter = scatter
	_center = SurfacePlace.planet_center(scatter)
	_radius = SurfacePlace.planet_of(scatter.ground).planet_radius
	var middle := region.global_position
	var points := _points()
	if not points.is_empty():
		middle = Vector3.ZERO
		for point in points:
			middle += point / points.size()
	_distance = middle.distance_to(_center)
	_axes = SurfacePlace.upright(_center.direction_to(middle)) if _distance > 0.0 else Basis.IDENTITY


## Returns the region's borders, moved inward by [param inwards] meters, as closed lines on the map.
func borders(inwards: float) -> Array[PackedVector2Array]:
	var places := PackedVector2Array()
	if _is_flat():
		var scale := 0.0 # Lengths on the map grow with the distance from its middle. The mean is exact enough for a drawing.
		for point in _points():
			var place := _place_of(point)
			places.append(place)
			scale += 1.0 + place.length_squared() / (4.0 * _radius * _radius)
		scale /= maxf(places.size(), 1.0)
		if _region.shape == ScatterRegion3D.SHAPE_PATH:
			return Outline.strip(places, (0.5 * _region.width - inwards) * scale)
		return Outline.inset(places, inwards * scale)
	for corner in Outline.body(_region):
		var offset := (_region.global_transform * corner - _region.global_position) * _axes
		places.append(Vector2(offset.x, offset.z))
	return Outline.inset(Outline.hull(places), inwards)


## Returns the position on the ground at a place on the map, raised by [param lift] meters. Without ground there, it is on the sphere.
func to_ground(place: Vector2, lift: float) -> Vector3:
	return on_ground(_center + _direction(place), lift)


## Returns the position on the ground straight above or below another position, as [method to_ground].
func on_ground(position: Vector3, lift: float) -> Vector3:
	var up := _center.direction_to(position)
	var found := SurfacePlace.hit(_scatter, _center + up * RADII * _radius, _center)
	return (found[0] if not found.is_empty() else _center + up * _radius) + up * lift


## Returns the corner of a polygon whose direction from the planet's center is that of a world position. Returns [constant Vector2.INF] if the
## polygon's plane does not have such a corner.
static func corner_toward(position: Vector3, center: Vector3, frame: Transform3D) -> Vector2:
	var to_frame := frame.affine_inverse()
	var start := to_frame * center
	var way := to_frame * position - start
	var angle := way.angle_to(Vector3(0.0, -start.y, 0.0))
	if start.y == 0.0 or not angle < deg_to_rad(FARTHEST):
		return Vector2.INF
	var corner := start - way * (start.y / way.y)
	return Vector2(corner.x, corner.z)


func _is_flat() -> bool:
	return _region.shape in [ScatterRegion3D.SHAPE_POLYGON, ScatterRegion3D.SHAPE_PATH]


## Returns the world positions of a polygon's corners or of a path's points. Empty for other shapes.
func _points() -> PackedVector3Array:
	match _region.shape:
		ScatterRegion3D.SHAPE_POLYGON:
			return Outline.corners(_region)
		ScatterRegion3D.SHAPE_PATH:
			return Outline.path_positions(_region)
	return PackedVector3Array()


## Returns the stereographic projection of a position. See PlanetMap in the library.
func _place_of(position: Vector3) -> Vector2:
	var up := _center.direction_to(position) * _axes
	return 2.0 * _radius / maxf(1.0 + up.y, 1e-6) * Vector2(up.x, up.z)


## Returns the up direction at a place on the map.
func _direction(place: Vector2) -> Vector3:
	if _is_flat():
		var tangent := place / (2.0 * _radius)
		var squared := tangent.length_squared()
		return _axes * (Vector3(2.0 * tangent.x, 1.0 - squared, 2.0 * tangent.y) / (1.0 + squared))
	var limited := (place / maxf(_distance, 1e-6)).limit_length(RIM)
	return _axes * Vector3(limited.x, sqrt(1.0 - limited.length_squared()), limited.y)
