@tool
extends "res://terrain/built_mesh.gd"
## Builds walls of stone blocks. A script that extends this class defines which blocks exist and where their corners are.
##
## The red channel of a vertex color is how open the vertex is to the sky.

const SIDES: Array[Vector3i] = [Vector3i(1, 0, 0), Vector3i(-1, 0, 0), Vector3i(0, 1, 0), Vector3i(0, -1, 0), Vector3i(0, 0, 1), Vector3i(0, 0, -1)]
## The maximum distance by which corners of blocks are moved, in meters.
const WEAR := 0.05

var _surface: SurfaceTool


## Returns the number of blocks along each axis.
func counts() -> Vector3i:
	return Vector3i.ZERO


## Returns true if a block exists at this index.
func is_solid(_block: Vector3i) -> bool:
	return false


## Returns the position in meters of the corner of a block with the lowest x, y and z.
func corner(_block: Vector3i) -> Vector3:
	return Vector3.ZERO


func build() -> ArrayMesh:
	_surface = SurfaceTool.new()
	_surface.begin(Mesh.PRIMITIVE_TRIANGLES)
	# Flat shading, because blocks have flat faces.
	_surface.set_smooth_group(-1)
	var block_counts := counts()
	for x in block_counts.x:
		for y in block_counts.y:
			for z in block_counts.z:
				var block := Vector3i(x, y, z)
				if is_solid(block):
					_add_block(block)
	_surface.generate_normals()
	return _surface.commit()


func _add_block(block: Vector3i) -> void:
	var middle := Vector3.ZERO
	for i in 8:
		middle += _jittered_corner(block + Vector3i(i & 1, i >> 1 & 1, i >> 2)) / 8.0
	for side in SIDES:
		if not is_solid(block + side):
			_add_face(block, side, middle)


## Adds the outer face of a block, clockwise as seen from outside.
func _add_face(block: Vector3i, side: Vector3i, middle: Vector3) -> void:
	var axis := side.abs().max_axis_index()
	var first := block + (side if side[axis] > 0 else Vector3i.ZERO)
	var u := Vector3i.ZERO
	var v := Vector3i.ZERO
	u[(axis + 1) % 3] = 1
	v[(axis + 2) % 3] = 1
	var points: Array[Vector3] = [_jittered_corner(first), _jittered_corner(first + u), _jittered_corner(first + u + v), _jittered_corner(first + v)]
	var color := Color(0.35 if side.y < 0 else 1.0, 0.0, 0.0)
	for corners: Array in [[0, 1, 2], [0, 2, 3]]:
		var a := points[corners[0]]
		var face := (points[corners[2]] - a).cross(points[corners[1]] - a)
		if face.length() < 0.004:
			continue
		if face.dot(a - middle) < 0.0:
			corners.reverse()
		for index: int in corners:
			_surface.set_color(color)
			_surface.add_vertex(points[index])


## Returns the position of a corner, moved a little at random as if by wear.
func _jittered_corner(block: Vector3i) -> Vector3:
	return corner(block) + (Vector3(_random(block, 1), _random(block, 2), _random(block, 3)) - Vector3.ONE * 0.5) * 2.0 * WEAR


## Returns a pseudorandom number from 0 to 1 for a block.
static func _random(block: Vector3i, salt: int) -> float:
	return float(hash(Vector4i(block.x, block.y, block.z, salt)) % 4096) / 4096.0
