@tool
extends "res://terrain/masonry.gd"
## An old bridge with one arch along x, whose parapets have gaps. The origin is below its middle, at the height of the arch's feet.

## Half the width of the arch's opening, and its height, in meters.
const HALF_SPAN := 8.4
const RISE := 7.2
## The thickness of the bridge above the arch, and the height of a course of blocks, in meters.
const CROWN := 1.1
const COURSE := 0.5
## The number of blocks along the arch, along each approach, and across the bridge.
const ARCH := 30
const APPROACH := 12
const ACROSS := 9
## The width of the bridge in meters.
const WIDTH := 5.2
## The height of the parapets, and the height of the abutments below the arch's feet, in courses.
const PARAPET := 2
const FOOT := 8


func counts() -> Vector3i:
	return Vector3i(ARCH + 2 * APPROACH, FOOT + _deck_courses() + PARAPET, ACROSS)


func is_solid(block: Vector3i) -> bool:
	var block_counts := counts()
	if block.x < 0 or block.x >= block_counts.x or block.y < 0 or block.y >= block_counts.y or block.z < 0 or block.z >= block_counts.z:
		return false
	var courses := FOOT + _deck_courses()
	if block.y >= courses:
		var gap_random := _random(Vector3i(block.x / 3, 0, block.z), 11)
		var parapet_height := 2 if gap_random > 0.34 else (1 if gap_random > 0.18 else 0)
		return (block.z == 0 or block.z == ACROSS - 1) and block.y - courses < parapet_height
	if block.y < FOOT and block.x >= APPROACH and block.x < APPROACH + ARCH:
		return false
	var height_above_arch := maxf(_course(block.x, block.y + 1) - _arch(block.x), _course(block.x + 1, block.y + 1) - _arch(block.x + 1))
	return height_above_arch > 0.16


func corner(block: Vector3i) -> Vector3:
	return Vector3(_column_x(block.x), maxf(_course(block.x, block.y), _arch(block.x)), (float(block.z) / ACROSS - 0.5) * WIDTH)


func _deck_courses() -> int:
	return roundi((RISE + CROWN) / COURSE)


## Returns the height of the bottom of a course in meters. Courses rise toward the middle of the bridge.
func _course(column: int, course: int) -> float:
	var hump := 0.9 * (1.0 - smoothstep(0.0, 15.0, absf(_column_x(column))))
	return (course - FOOT) * COURSE + hump * clampf(float(course - FOOT) / _deck_courses(), 0.0, 1.0)


## Returns the x of a column of corners in meters. Columns are close together where the arch is steep.
func _column_x(column: int) -> float:
	var offset := column - APPROACH - ARCH / 2
	if absi(offset) <= ARCH / 2:
		return HALF_SPAN * sin(PI * 0.5 * offset / (ARCH / 2.0))
	return signf(offset) * (HALF_SPAN + 0.8 * (absi(offset) - ARCH / 2))


## Returns the height of the arch's underside in meters.
func _arch(column: int) -> float:
	var fraction := _column_x(column) / HALF_SPAN
	return RISE * sqrt(maxf(1.0 - fraction * fraction, 0.0)) if absf(fraction) < 0.9999 else -FOOT * COURSE
