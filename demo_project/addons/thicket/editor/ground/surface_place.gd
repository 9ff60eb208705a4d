@tool
extends RefCounted
## Positions on the surface of a scatter's ground. On a planet, up is the direction away from its center, and x and z do not determine a height.

## The distance above and below a position in which the ground is searched, in meters.
const REACH := 500.0


## Returns the up direction at a position.
static func up_at(scatter: TerrainScatter3D, place: Vector3) -> Vector3:
	return scatter._up_at(place)


## Returns true if the ground of a scatter forms a planet.
static func is_planet(ground: ScatterGround) -> bool:
	if ground is ScatterGroundCombined:
		return (ground as ScatterGroundCombined).grounds.any(is_planet)
	return ground is ScatterGroundMeshes and (ground as ScatterGroundMeshes).planet_radius > 0.0


## Returns the first position at which a line enters a surface, and its normal. Returns an empty array if there is none.
static func hit(scatter: TerrainScatter3D, from: Vector3, to: Vector3) -> PackedVector3Array:
	return scatter._hit_surface(from, to)


## Returns the highest ground straight above or below a position within [constant REACH], and its normal. Returns an empty array if there is none.
static func at(scatter: TerrainScatter3D, place: Vector3) -> PackedVector3Array:
	var way := up_at(scatter, place) * REACH
	return hit(scatter, place + way, place - way)


## Returns the rotation that turns the y axis to a direction.
static func upright(up: Vector3) -> Basis:
	if up.y > -0.999:
		return Basis(Quaternion(Vector3.UP, up))
	# Opposite directions have no shortest rotation.
	return Basis(Quaternion(Vector3.DOWN, up)) * Basis(Vector3.RIGHT, PI)
