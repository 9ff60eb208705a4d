@tool
extends RefCounted
## The borders of a [ScatterRegion3D] on a planet. They are lines on a flat map around the middle of the region: for polygons and paths, the map on
## which the library evaluates them, otherwise the shadow of the region along up. The library converts positions to this map and back.

const Outline := preload("res://addons/thicket/editor/regions/region_outline.gd")
const SurfacePlace := preload("res://addons/thicket/editor/ground/surface_place.gd")

## The distance from the planet's center from which the ground is searched, in radii of the planet.
const RADII := 2.0
## The largest angle between a corner of a polygon and the polygon's y axis, seen from the planet's center, in degrees. A corner at 90 degrees would
## be infinitely far away in the polygon's plane.
const MAX_DEGREES := 80.0

var _region: ScatterRegion3D
var _scatter: TerrainScatter3D
var _center: Vector3
var _radius: float


## Prepares the borders of a region below a scatter whose ground forms a planet.
func _init(region: ScatterRegion3D, scatter: TerrainScatter3D) -> void:
	_region = region
	_scatter = scatter
	_center = SurfacePlace.planet_center(scatter)
	_radius = SurfacePlace.planet_radius(scatter)


## Returns the region's borders, moved inward by [param inset] meters, as closed lines on the map.
func borders(inset: float) -> Array[PackedVector2Array]:
	match _region.shape:
		ScatterRegion3D.SHAPE_PATH:
			var points := _region._to_planet_map(Outline.path_positions(_region))
			return Outline.strip(_to_map_points(points), (0.5 * _region.width - inset) * _scale(points))
		ScatterRegion3D.SHAPE_POLYGON:
			var points := _region._to_planet_map(Outline.corners(_region))
			return Outline.inset(_to_map_points(points), inset * _scale(points))
	var corners := _region._to_planet_map(_region.global_transform * Outline.body(_region))
	return Outline.inset(Outline.hull(_to_map_points(corners)), inset)


## Returns the positions on the ground at places on the map, raised by [param lift] meters. Without ground there, they are on the sphere.
func to_ground(map_points: PackedVector2Array, lift: float) -> PackedVector3Array:
	var positions := PackedVector3Array()
	for up in _region._from_planet_map(map_points):
		positions.append(on_ground(_center + up * _radius, lift))
	return positions


## Returns the position on the ground straight above or below another position, as [method to_ground].
func on_ground(position: Vector3, lift: float) -> Vector3:
	var up := _center.direction_to(position)
	var hit := SurfacePlace.hit(_scatter, _center + up * RADII * _radius, _center)
	return (hit[0] if not hit.is_empty() else _center + up * _radius) + up * lift


## Returns the corner of a polygon whose direction from the planet's center is that of a world position. Returns [constant Vector2.INF] if the
## polygon's plane does not have such a corner.
static func corner_toward(position: Vector3, center: Vector3, frame: Transform3D) -> Vector2:
	var to_frame := frame.affine_inverse()
	var start := to_frame * center
	var direction := to_frame * position - start
	var angle := direction.angle_to(Vector3(0.0, -start.y, 0.0))
	if start.y == 0.0 or not angle < deg_to_rad(MAX_DEGREES):
		return Vector2.INF
	var corner := start - direction * (start.y / direction.y)
	return Vector2(corner.x, corner.z)


static func _to_map_points(points: PackedVector3Array) -> PackedVector2Array:
	var map_points := PackedVector2Array()
	for point in points:
		map_points.append(Vector2(point.x, point.z))
	return map_points


## Returns the mean scale of the map. Lengths on it grow with the distance from its middle; the mean is exact enough for a drawing.
static func _scale(points: PackedVector3Array) -> float:
	var sum := 0.0
	for point in points:
		sum += point.y
	return sum / maxf(points.size(), 1.0)
