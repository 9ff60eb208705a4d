extends RefCounted
## Collects the triangles of one plant or stone for each LOD. Builds one mesh for each LOD, or one mesh with all LODs.
##
## In a mesh with all LODs, the LODs share one vertex array and one surface. Each LOD is an index list, which the engine selects by distance, even for
## the instances of a MultiMesh. COLOR.rgb of a vertex is the albedo (sRGB), and UV refers to the texture of [code]leaf_atlas.gd[/code].

const Atlas := preload("res://meshes/leaf_atlas.gd")

## The length, in meters, that appears one pixel long at a distance of one meter. The engine draws an LOD where the LOD's edge length is below one
## pixel. The key of an LOD is therefore its distance times this factor. The factor is for a view that is 1280 pixels wide, with a vertical angle of
## 65 degrees. It is twice the tangent of half the horizontal angle, divided by the width.
const EDGE_PER_METER := 0.00177

## The UV for surfaces without a texture: stones, blades and petals, and the dark inside of a crown.
const OPAQUE_UV := Atlas.OPAQUE_UV

## The brightness of a vertex that is not open to the sky.
const ENCLOSED := 0.45

var _vertices := PackedVector3Array()
var _normals := PackedVector3Array()
var _colors := PackedColorArray()
var _uvs := PackedVector2Array()
var _levels: Array[PackedInt32Array] = []
var _distances := PackedFloat32Array()


## Starts the next coarser level. The first call starts level 0.
func begin_level() -> void:
	_levels.append(PackedInt32Array())


## Adds a vertex and returns its index. [param normal] may have any length. The alpha of [param color] is how open to the sky the vertex is, from 0 to
## 1. Enclosed vertices are drawn darker.
func vertex(position: Vector3, normal: Vector3, color: Color, uv: Vector2) -> int:
	_vertices.append(position)
	_normals.append(normal.normalized())
	_colors.append(Color(color * lerpf(ENCLOSED, 1.0, clampf(color.a, 0.0, 1.0)), 1.0))
	_uvs.append(uv)
	return _vertices.size() - 1


## Adds a triangle of three vertex indices to the current level, in clockwise order as seen from its front.
func triangle(a: int, b: int, c: int) -> void:
	var level := _levels[_levels.size() - 1]
	level.append(a)
	level.append(b)
	level.append(c)
	_levels[_levels.size() - 1] = level


## Adds the quad a, b, c, d to the current level, in the order of its outline.
func quad(a: int, b: int, c: int, d: int) -> void:
	triangle(a, b, c)
	triangle(a, c, d)


## Adds a flat leaf card with a normal at its center. [param bulge] bends the normals of the corners outward, from 0 (flat) to 1
## (strongly), so that a crown of cards is lit like a round body.
func card(center: Vector3, right: Vector3, up: Vector3, normal: Vector3, region: Rect2, color: Color,
		bulge := 0.45) -> void:
	var corners: Array[int] = []
	for corner: Vector2 in [Vector2(-1, -1), Vector2(1, -1), Vector2(1, 1), Vector2(-1, 1)]:
		var offset := right * corner.x + up * corner.y
		var uv := region.position + region.size * (corner * Vector2(0.5, -0.5) + Vector2(0.5, 0.5))
		corners.append(vertex(center + offset, normal.normalized() + offset.normalized() * bulge, color, uv))
	quad(corners[0], corners[3], corners[2], corners[1])


## Adds [param count] upright cards with an image of a whole crown, crossed at [param bottom], for distant LODs. [param low] and [param high] are the
## colors at the bottom and at the top.
func crossed(bottom: Vector3, half_width: float, height: float, region: Rect2, low: Color, high: Color, count: int) -> void:
	for plane in count:
		var angle := PI * (plane + 0.25) / count
		var right := Vector3(cos(angle), 0.0, sin(angle))
		var front := right.cross(Vector3.UP)
		var corners: Array[int] = []
		for corner: Vector2 in [Vector2(-1, 0), Vector2(1, 0), Vector2(1, 1), Vector2(-1, 1)]:
			var uv := region.position + region.size * Vector2(0.5 + 0.5 * corner.x, 1.0 - corner.y)
			var normal := right * corner.x * 0.7 + front * 0.3 + Vector3.UP * (0.2 + 0.6 * corner.y)
			corners.append(vertex(bottom + right * half_width * corner.x + Vector3.UP * height * corner.y, normal,
					high if corner.y > 0.0 else low, uv))
		quad(corners[0], corners[3], corners[2], corners[1])


## Adds an open tapered tube from [param from] to [param to] with [param sides] sides, for a trunk or branch. [param bark] is the index
## of its bark in [constant Atlas.BARKS].
func tube(from: Vector3, to: Vector3, from_radius: float, to_radius: float, sides: int, color: Color, bark: int) -> void:
	var axis := (to - from).normalized()
	var right := axis.cross(Vector3.FORWARD if absf(axis.z) < 0.9 else Vector3.RIGHT).normalized()
	var forward := right.cross(axis)
	var first := _vertices.size()
	var column := Atlas.BARKS[bark]
	var length := from.distance_to(to) / (PI * (from_radius + to_radius) * Atlas.BARK_LENGTH)
	for i in sides + 1:
		var angle := TAU * i / sides
		var radial := right * cos(angle) + forward * sin(angle)
		var u := column.position.x + column.size.x * i / sides
		vertex(from + radial * from_radius, radial, color, Vector2(u, length))
		vertex(to + radial * to_radius, radial, color, Vector2(u, 0.0))
	for i in sides:
		var a := first + 2 * i
		quad(a, a + 2, a + 3, a + 1)


## Adds a cone without a base surface, whose apex is above [param base].
func cone(base: Vector3, radius: float, height: float, sides: int, color: Color) -> void:
	var apex := vertex(base + Vector3.UP * height, Vector3.UP, color, OPAQUE_UV)
	var first := _vertices.size()
	for i in sides:
		var angle := TAU * i / sides
		var radial := Vector3(cos(angle), 0.0, sin(angle))
		vertex(base + radial * radius, radial + Vector3.UP * 0.55, color, OPAQUE_UV)
	for i in sides:
		triangle(apex, first + i, first + (i + 1) % sides)


## Adds a surface of revolution from [param base] along [param axis]. Each point of [param profile] is a radius and a distance along the axis, and has a color.
func revolve(base: Vector3, axis: Vector3, profile: PackedVector2Array, colors: PackedColorArray, sides: int) -> void:
	var right := axis.cross(Vector3.FORWARD if absf(axis.z) < 0.9 else Vector3.RIGHT).normalized()
	var forward := right.cross(axis)
	var first := _vertices.size()
	for point in profile.size():
		var tangent := profile[mini(point + 1, profile.size() - 1)] - profile[maxi(point - 1, 0)]
		for i in sides + 1:
			var angle := TAU * i / sides
			var radial := right * cos(angle) + forward * sin(angle)
			vertex(base + radial * profile[point].x + axis * profile[point].y, radial * tangent.y - axis * tangent.x, colors[point], OPAQUE_UV)
	for point in profile.size() - 1:
		for i in sides:
			var a := first + point * (sides + 1) + i
			quad(a + 1, a + sides + 2, a + sides + 1, a)


## Sets the distances in meters from which levels 1, 2, ... are drawn. The number of distances must be one less than the number of levels.
func end(distances: PackedFloat32Array) -> void:
	assert(distances.size() == _levels.size() - 1)
	_distances = distances


## Returns the number of levels.
func level_count() -> int:
	return _levels.size()


## Returns the distance in meters from which a level is drawn.
func distance(level: int) -> float:
	return _distances[level - 1] if level > 0 else 0.0


## Returns a level as a separate mesh.
func mesh_of(level: int, material: Material) -> ArrayMesh:
	var arrays := _arrays()
	var new_indices := {}
	var old_indices := PackedInt32Array()
	var indices := PackedInt32Array()
	for index in _levels[level]:
		if not new_indices.has(index):
			new_indices[index] = old_indices.size()
			old_indices.append(index)
		indices.append(new_indices[index])
	for stream in Mesh.ARRAY_INDEX:
		if arrays[stream] != null:
			var old_values: Variant = arrays[stream]
			var new_values: Variant = old_values.duplicate()
			new_values.resize(old_indices.size())
			for index in old_indices.size():
				new_values[index] = old_values[old_indices[index]]
			arrays[stream] = new_values
	arrays[Mesh.ARRAY_INDEX] = indices
	var mesh := ArrayMesh.new()
	mesh.add_surface_from_arrays(Mesh.PRIMITIVE_TRIANGLES, arrays)
	mesh.surface_set_material(0, material)
	return mesh


## Writes the levels to [param mesh] as one surface, with LODs that the engine selects. The distances are for a width of 1280 pixels
## and an instance scale of 1. Levels finer than [param finest] are left out, except for the last one.
func commit(mesh: ArrayMesh, finest: int, material: Material) -> void:
	finest = mini(finest, _levels.size() - 1)
	var arrays := _arrays()
	arrays[Mesh.ARRAY_INDEX] = _levels[finest]
	var lods := {}
	for i in range(finest, _distances.size()):
		lods[_distances[i] * EDGE_PER_METER] = _levels[i + 1]
	mesh.clear_surfaces()
	mesh.add_surface_from_arrays(Mesh.PRIMITIVE_TRIANGLES, arrays, [], lods)
	mesh.surface_set_material(0, material)


func _arrays() -> Array:
	var arrays: Array = []
	arrays.resize(Mesh.ARRAY_MAX)
	arrays[Mesh.ARRAY_VERTEX] = _vertices
	arrays[Mesh.ARRAY_NORMAL] = _normals
	arrays[Mesh.ARRAY_COLOR] = _colors
	arrays[Mesh.ARRAY_TEX_UV] = _uvs
	return arrays


## Returns the points and the clockwise faces of a unit icosphere, as an array of both.
static func icosphere(subdivisions: int) -> Array:
	var phi := (1.0 + sqrt(5.0)) / 2.0
	var points := PackedVector3Array()
	for p: Vector3 in [
		Vector3(-1, phi, 0), Vector3(1, phi, 0), Vector3(-1, -phi, 0), Vector3(1, -phi, 0), Vector3(0, -1, phi), Vector3(0, 1, phi),
		Vector3(0, -1, -phi), Vector3(0, 1, -phi), Vector3(phi, 0, -1), Vector3(phi, 0, 1), Vector3(-phi, 0, -1),
		Vector3(-phi, 0, 1)]:
		points.append(p.normalized())
	var faces := PackedInt32Array([
		0, 5, 11, 0, 1, 5, 0, 7, 1, 0, 10, 7, 0, 11, 10, 1, 9, 5, 5, 4, 11, 11, 2, 10, 10, 6, 7, 7, 8, 1,
		3, 4, 9, 3, 2, 4, 3, 6, 2, 3, 8, 6, 3, 9, 8, 4, 5, 9, 2, 11, 4, 6, 10, 2, 8, 7, 6, 9, 1, 8])
	for _step in subdivisions:
		var next_faces := PackedInt32Array()
		var midpoints := {}
		for i in range(0, faces.size(), 3):
			var corner := [faces[i], faces[i + 1], faces[i + 2]]
			var edge_midpoints: Array[int] = []
			for k in 3:
				var a: int = mini(corner[k], corner[(k + 1) % 3])
				var b: int = maxi(corner[k], corner[(k + 1) % 3])
				var key := Vector2i(a, b)
				if not midpoints.has(key):
					midpoints[key] = points.size()
					points.append((points[a] + points[b]).normalized())
				edge_midpoints.append(midpoints[key])
			next_faces.append_array([corner[0], edge_midpoints[0], edge_midpoints[2], edge_midpoints[0], corner[1], edge_midpoints[1]])
			next_faces.append_array([edge_midpoints[2], edge_midpoints[1], corner[2], edge_midpoints[0], edge_midpoints[1], edge_midpoints[2]])
		faces = next_faces
	return [points, faces]
