@tool
extends RefCounted
## Computes the positions of the dabs in a stroke.

## The distance between dabs, as a multiple of the radius.
const SPACING := 0.25


## Returns the positions of the next dabs from the last dab toward a position.
static func between(last: Vector3, target: Vector3, radius: float) -> PackedVector3Array:
	var step := maxf(radius * SPACING, 0.01)
	var offset := target - last
	var direction := offset.normalized()
	var points := PackedVector3Array()
	for dab in floori(offset.length() / step):
		last += direction * step
		points.append(last)
	return points
