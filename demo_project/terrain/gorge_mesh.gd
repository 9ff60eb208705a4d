@tool
extends "res://terrain/built_mesh.gd"
## Draws the rock of [code]gorge_shape.gd[/code]. Around the gorge, which has caves and overhangs, the mesh is built with surface nets. The land
## around it is a grid.
##
## The red channel of a vertex color is how open the vertex is to the sky.

const Shape := preload("res://terrain/gorge_shape.gd")
## The lowest corner and the size of the space around the gorge, in meters. The size is a multiple of [constant BLOCK].
const FROM := Vector3i(-52, -4, -76)
const SIZE := Vector3i(104, 28, 152)
## The number of cells along an edge of a block. A cell is 1 m wide. Blocks that are far from the rock's surface are skipped.
const BLOCK := 4
## Half the width of the land around the gorge, and the length of the land's cells, in meters.
const LAND := 320
const LAND_CELL := 8
const CORNERS: Array[Vector3i] = [
	Vector3i(0, 0, 0), Vector3i(1, 0, 0), Vector3i(0, 1, 0), Vector3i(1, 1, 0), Vector3i(0, 0, 1), Vector3i(1, 0, 1), Vector3i(0, 1, 1), Vector3i(1, 1, 1),
]

## If true, draws the land around the gorge instead of the gorge.
@export var surroundings := false

var _shape := Shape.new()
var _distances := {}
var _indices := {}
var _vertices := PackedVector3Array()
var _normals := PackedVector3Array()
var _colors := PackedColorArray()
var _triangles := PackedInt32Array()


func build() -> ArrayMesh:
	if surroundings:
		_add_land()
	else:
		_add_rock()
	var arrays: Array = []
	arrays.resize(Mesh.ARRAY_MAX)
	arrays[Mesh.ARRAY_VERTEX] = _vertices
	arrays[Mesh.ARRAY_NORMAL] = _normals
	arrays[Mesh.ARRAY_COLOR] = _colors
	arrays[Mesh.ARRAY_INDEX] = _triangles
	var result := ArrayMesh.new()
	result.add_surface_from_arrays(Mesh.PRIMITIVE_TRIANGLES, arrays)
	_distances.clear()
	_indices.clear()
	return result


func _add_rock() -> void:
	var cells: Array[Vector3i] = []
	for x in range(0, SIZE.x, BLOCK):
		for y in range(0, SIZE.y, BLOCK):
			for z in range(0, SIZE.z, BLOCK):
				var corner := FROM + Vector3i(x, y, z)
				if absf(_shape.air(Vector3(corner) + Vector3.ONE * BLOCK * 0.5)) > 1.3 * BLOCK:
					continue
				for cell in BLOCK * BLOCK * BLOCK:
					cells.append(corner + Vector3i(cell % BLOCK, cell / BLOCK % BLOCK, cell / BLOCK / BLOCK))
	for cell in cells:
		_add_vertex(cell)
	for cell: Vector3i in _indices:
		var distance: float = _distances[cell]
		for axis in 3:
			var step := Vector3i.ZERO
			step[axis] = 1
			if (distance < 0.0) == (_distances[cell + step] < 0.0):
				continue
			var u := Vector3i.ZERO
			var v := Vector3i.ZERO
			u[(axis + 1) % 3] = 1
			v[(axis + 2) % 3] = 1
			if _indices.has(cell - u) and _indices.has(cell - v) and _indices.has(cell - u - v):
				_add_quad(_indices[cell - u - v], _indices[cell - u], _indices[cell], _indices[cell - v])


func _distance(point: Vector3i) -> float:
	if not _distances.has(point):
		_distances[point] = _shape.air(Vector3(point))
	return _distances[point]


## Adds a vertex for a cell that the surface crosses, at the mean of the points where the surface crosses the cell's edges.
func _add_vertex(cell: Vector3i) -> void:
	var values := PackedFloat32Array()
	var solid_corners := 0
	for corner in CORNERS:
		values.append(_distance(cell + corner))
		solid_corners += int(values[-1] < 0.0)
	if solid_corners == 0 or solid_corners == 8:
		return
	var sum := Vector3.ZERO
	var count := 0
	var normal := Vector3.ZERO
	for a in 8:
		normal += (Vector3(CORNERS[a]) - Vector3.ONE * 0.5) * values[a]
		for bit: int in [1, 2, 4]:
			var b := a | bit
			if b == a or (values[a] < 0.0) == (values[b] < 0.0):
				continue
			sum += Vector3(CORNERS[a]).lerp(Vector3(CORNERS[b]), values[a] / (values[a] - values[b]))
			count += 1
	_indices[cell] = _vertices.size()
	var position := Vector3(cell) + sum / count
	normal = normal.normalized()
	_vertices.append(position)
	_normals.append(normal)
	_colors.append(Color(_shape.openness(position, normal), 0.0, 0.0))


## Adds two triangles that are clockwise as seen from the air.
func _add_quad(a: int, b: int, c: int, d: int) -> void:
	var face := (_vertices[c] - _vertices[a]).cross(_vertices[b] - _vertices[d])
	if face.dot(_normals[a] + _normals[b] + _normals[c] + _normals[d]) > 0.0:
		_triangles.append_array([a, b, c, a, c, d])
	else:
		_triangles.append_array([a, c, b, a, d, c])


func _add_land() -> void:
	var posts := 2 * LAND / LAND_CELL + 1
	for row in posts:
		for column in posts:
			var x := float(column * LAND_CELL - LAND)
			var z := float(row * LAND_CELL - LAND)
			_vertices.append(Vector3(x, _shape.plateau(x, z), z))
			var rise_x := _shape.plateau(x + 1.0, z) - _shape.plateau(x - 1.0, z)
			var rise_z := _shape.plateau(x, z + 1.0) - _shape.plateau(x, z - 1.0)
			_normals.append(Vector3(-rise_x, 2.0, -rise_z).normalized())
			_colors.append(Color(1.0, 0.0, 0.0))
	var hole := Rect2i(FROM.x, FROM.z, SIZE.x, SIZE.z).grow(-LAND_CELL)
	for row in posts - 1:
		for column in posts - 1:
			var cell := Rect2i(column * LAND_CELL - LAND, row * LAND_CELL - LAND, LAND_CELL, LAND_CELL)
			if not hole.encloses(cell):
				var first := row * posts + column
				_add_quad(first, first + posts, first + posts + 1, first + 1)
	# At the border of the gorge's mesh, the land passes below the rock.
	var gorge_rect := Rect2i(FROM.x, FROM.z, SIZE.x, SIZE.z).grow(1)
	for vertex in _vertices.size():
		if gorge_rect.has_point(Vector2i(Vector2(_vertices[vertex].x, _vertices[vertex].z))):
			_vertices[vertex].y -= 1.2
