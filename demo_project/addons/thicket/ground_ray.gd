@tool
extends RefCounted
## Finds where a ray meets the ground of a [code]ScatterGround[/code]. Games without the library may contain this script, so it names no class of the
## library.

## In meters: the longest ray, and the shortest and longest step along it.
const REACH := 20000.0
const SHORTEST := 0.05
const LONGEST := 200.0
const MOST_STEPS := 600
const HALVINGS := 24


## Returns the first position, in world meters, where the ray enters the ground from above, or [constant Vector3.INF] if there is none. [param
## direction] has a length of 1. A step is half the height of the ray above the ground. So the ray only misses a ridge if the ground is steeper than
## 60 degrees and the ray grazes it. Queries the ground some hundred times.
static func hit(ground: Resource, from: Vector3, direction: Vector3) -> Vector3:
	var at := 0.0
	var last := NAN
	var last_at := 0.0
	for step in MOST_STEPS:
		var above := _above(ground, from + direction * at)
		if last > 0.0 and above <= 0.0:
			return _refine(ground, from, direction, last_at, at)
		last = above
		last_at = at
		# Over a hole the height is unknown; nearby, small steps matter more than far away.
		var stride := 0.5 * absf(above) if not is_nan(above) else 0.02 * at
		at += clampf(stride, maxf(SHORTEST, 0.001 * at), LONGEST)
		if at > REACH:
			break
	return Vector3.INF


## Returns the meters to the ground along a ray, at most 1000; 100 if there is no ground.
static func distance(ground: Resource, from: Vector3, direction: Vector3) -> float:
	var position := hit(ground, from, direction)
	return minf(position.distance_to(from), 1000.0) if position.is_finite() else 100.0


static func _above(ground: Resource, position: Vector3) -> float:
	return position.y - float(ground.call(&"get_height", position))


static func _refine(ground: Resource, from: Vector3, direction: Vector3, above_at: float, below_at: float) -> Vector3:
	for halving in HALVINGS:
		var middle := 0.5 * (above_at + below_at)
		if _above(ground, from + direction * middle) > 0.0:
			above_at = middle
		else:
			below_at = middle
	return from + direction * below_at
