@tool
extends RefCounted
## The places of the dabs of a stroke.

## The distance between dabs, as a part of the radius.
const SPACING := 0.25


## The places of the next dabs on the way from the last dab to a position.
static func between(last: Vector2, at: Vector2, radius: float) -> PackedVector2Array:
	var step := maxf(radius * SPACING, 0.01)
	var way := at - last
	var direction := way.normalized()
	var places := PackedVector2Array()
	for dab in floori(way.length() / step):
		last += direction * step
		places.append(last)
	return places
