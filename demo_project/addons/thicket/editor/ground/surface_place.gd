@tool
extends RefCounted
## Positions on the ground of a scatter. Ground of meshes may have several levels, and a planet has ground on all sides. Other ground has one
## height at each x and z. On a planet, up is the direction away from its center, elsewhere the y axis.

const GroundRay := preload("res://addons/thicket/ground_ray.gd")

## The distance above and below a position in which the ground is searched, in meters.
const REACH := 500.0
## The largest number of levels that are searched.
const MOST_LEVELS := 16
## The distance between two levels, in meters.
const GAP := 0.01
## The largest angle from the top of a planet at which the tools edit maps that are projected along the y axis, in degrees.
## There, these maps are stretched to twice their length.
const MAP_DEGREES := 60.0


## Returns the up direction at a position.
static func up_at(scatter: TerrainScatter3D, point: Vector3) -> Vector3:
	return scatter._up_at(point)


## Returns true if the ground of a scatter forms a planet.
static func is_planet(scatter: TerrainScatter3D) -> bool:
	return not scatter._get_planet().is_empty()


## Returns the center of the planet of a scatter, or [constant Vector3.INF] if there is no planet.
static func planet_center(scatter: TerrainScatter3D) -> Vector3:
	var planet := scatter._get_planet()
	return Vector3(planet[0], planet[1], planet[2]) if not planet.is_empty() else Vector3.INF


## Returns the radius of the planet of a scatter in meters, or 0 if there is no planet.
static func planet_radius(scatter: TerrainScatter3D) -> float:
	var planet := scatter._get_planet()
	return planet[3] if not planet.is_empty() else 0.0


## Returns true if the ground may have several levels, or ground on all sides.
static func has_levels(ground: ScatterGround) -> bool:
	return GroundRay.parts(ground).any(GroundRay.is_meshes)


## Returns the first position at which a line enters a surface, and its normal. Returns an empty array if there is none.
static func hit(scatter: TerrainScatter3D, from: Vector3, to: Vector3) -> PackedVector3Array:
	return scatter._hit_surface(from, to)


## Returns the first position on the ground that a ray meets, and its normal. Returns an empty array if there is none. [param direction] must have
## a length of 1.
static func on_ray(scatter: TerrainScatter3D, from: Vector3, direction: Vector3) -> PackedVector3Array:
	return GroundRay.first(scatter, from, direction)


## Returns the distance to the ground along a ray in meters, at most 1000, or 100 if the ray does not meet the ground.
static func distance(scatter: TerrainScatter3D, from: Vector3, direction: Vector3) -> float:
	var position_and_normal := on_ray(scatter, from, direction)
	return minf(from.distance_to(position_and_normal[0]), 1000.0) if not position_and_normal.is_empty() else 100.0


## Returns the position on the ground, straight above or below another position, that is nearest to it and within [param max_distance] meters, and its
## normal. Returns an empty array if there is none. Only ground that faces the direction [param direction] counts.
static func level(scatter: TerrainScatter3D, point: Vector3, direction: Vector3, max_distance := REACH) -> PackedVector3Array:
	var nearest := PackedVector3Array()
	var ground := scatter.ground
	if has_levels(ground):
		var start := point + direction * max_distance
		for index in MOST_LEVELS:
			var surface_hit := hit(scatter, start, point - direction * max_distance)
			if surface_hit.is_empty() or not nearest.is_empty() and point.distance_to(surface_hit[0]) >= point.distance_to(nearest[0]):
				break
			nearest = surface_hit
			start = surface_hit[0] - direction * GAP
	for ground_part: ScatterGround in GroundRay.parts(ground):
		var has_heights := not ground_part is ScatterGroundMeshes or nearest.is_empty() and not is_planet(scatter)
		var height := ground_part.get_height(point) if has_heights and direction.y > 0.0 else NAN
		if absf(height - point.y) <= max_distance and (nearest.is_empty() or absf(height - point.y) < point.distance_to(nearest[0])):
			var position := Vector3(point.x, height, point.z)
			nearest = PackedVector3Array([position, ground_part.get_normal(position)])
	return nearest


## Returns an empty string if a map that is projected along the y axis can be edited at a position on the ground. Otherwise, returns the reason and
## the remedy. [param subject] is the beginning of the sentence, and [param fix] the sentence after it.
static func map_problem(scatter: TerrainScatter3D, point: Vector3, subject: String, fix: String) -> String:
	if not is_planet(scatter) or up_at(scatter, point).y >= cos(deg_to_rad(MAP_DEGREES)):
		return ""
	return "%s at most %d° from the top of a planet. %s" % [subject, roundi(MAP_DEGREES), fix]


## Returns the rotation that turns the y axis to a direction.
static func upright(up: Vector3) -> Basis:
	if up.y > -0.999:
		return Basis(Quaternion(Vector3.UP, up))
	# Opposite directions have no shortest rotation.
	return Basis(Quaternion(Vector3.DOWN, up)) * Basis(Vector3.RIGHT, PI)
