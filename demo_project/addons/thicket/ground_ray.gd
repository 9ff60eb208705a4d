@tool
extends RefCounted
## Intersects a ray with the ground of a [code]TerrainScatter3D[/code]. Games without the native library may contain this script, so it uses none of the
## library's classes as a type.

## The length of a ray, and the shortest and longest step along it, in meters.
const REACH := 20000.0
const SHORTEST := 0.05
const LONGEST := 200.0
const MOST_STEPS := 600
const HALVINGS := 24
## The largest error of a position on ground that has only heights, in meters.
const TOLERANCE := 0.05


## Returns the first position on the ground of a scatter that a ray meets, and its normal. Returns an empty array if there is none. Ground of meshes
## may have several levels, and a planet has ground on all sides. Other ground has one height at each x and z. [param direction] must have a length of 1.
static func first(scatter: Node3D, from: Vector3, direction: Vector3) -> PackedVector3Array:
	var nearest := PackedVector3Array()
	var grounds := parts(scatter.get(&"ground") as Resource)
	if grounds.any(is_meshes):
		nearest = scatter.call(&"_hit_surface", from, from + direction * REACH)
	# Meshes whose triangles are inside out have no fronts, but heights.
	var has_heights := nearest.is_empty() and (scatter.call(&"_get_planet") as PackedFloat64Array).is_empty()
	for ground in grounds:
		if is_meshes(ground) and not has_heights:
			continue
		var position := hit(ground, from, direction)
		# At a vertical step, the ray enters the space below the upper height without meeting ground.
		if position.is_finite() and absf(_height_above(ground, position)) < TOLERANCE:
			if nearest.is_empty() or from.distance_squared_to(position) < from.distance_squared_to(nearest[0]):
				nearest = PackedVector3Array([position, ground.call(&"get_normal", position)])
	return nearest


## Returns the grounds that a ground combines, or the ground itself. Empty if the ground is null.
static func parts(combined: Resource) -> Array[Resource]:
	var result: Array[Resource] = []
	if combined != null and combined.is_class("ScatterGroundCombined"):
		for ground: Resource in combined.get(&"grounds"):
			result.append_array(parts(ground))
	elif combined != null:
		result.append(combined)
	return result


## Returns true if a ground consists of meshes.
static func is_meshes(ground: Resource) -> bool:
	return ground.is_class("ScatterGroundMeshes")


## Returns the first position, in meters, where the ray enters the ground from above, or [constant Vector3.INF] if there is none within
## [constant REACH] and [constant MOST_STEPS]. [param direction] must have a length of 1. Each step is half as long as the ray's height above the
## ground, between [constant SHORTEST] (or a thousandth of the distance) and [constant LONGEST]. The ray can therefore
## miss a ridge only if it grazes the ridge and the ground there is steeper than 60 degrees. A call queries the ground
## several hundred times.
static func hit(ground: Resource, from: Vector3, direction: Vector3) -> Vector3:
	var traveled := 0.0
	var last_height := NAN
	var last_traveled := 0.0
	for step in MOST_STEPS:
		var height := _height_above(ground, from + direction * traveled)
		if last_height > 0.0 and height <= 0.0:
			return _refine(ground, from, direction, last_traveled, traveled)
		last_height = height
		last_traveled = traveled
		# Above a hole, the height is unknown. The step then grows with the distance, because small steps matter more near the camera.
		var stride := 0.5 * absf(height) if not is_nan(height) else 0.02 * traveled
		traveled += clampf(stride, maxf(SHORTEST, 0.001 * traveled), LONGEST)
		if traveled > REACH:
			break
	return Vector3.INF


## Returns the distance to the ground along a ray in meters, at most 1000, or 100 if the ray does not hit the ground.
static func distance(ground: Resource, from: Vector3, direction: Vector3) -> float:
	var position := hit(ground, from, direction)
	return minf(position.distance_to(from), 1000.0) if position.is_finite() else 100.0


static func _height_above(ground: Resource, position: Vector3) -> float:
	return position.y - float(ground.call(&"get_height", position))


static func _refine(ground: Resource, from: Vector3, direction: Vector3, distance_above: float, distance_below: float) -> Vector3:
	for halving in HALVINGS:
		var middle := 0.5 * (distance_above + distance_below)
		if _height_above(ground, from + direction * middle) > 0.0:
			distance_above = middle
		else:
			distance_below = middle
	return from + direction * distance_below
