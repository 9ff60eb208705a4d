@tool
extends MeshInstance3D
## Draws any [ScatterGround] of moderate size as one mesh: a grid of its heights, cut along the edges of holes, with walls
## below these edges.
##
## UV.x of every vertex is its distance to [member path] in meters, up to [constant FAR]. UV.y is 1 on walls and 0 elsewhere.

const NoiseTexture := preload("res://terrain/noise_texture.gd")
## The largest distance from the path that UV.x can have, in meters.
const FAR := 16.0
## The number of bisection steps for finding the edge of the ground on a quad's edge.
const HALVINGS := 8
## The time in seconds for which a path must stay unchanged before the mesh is rebuilt. It avoids a rebuild at every step of a drag.
const PATH_REST := 0.25
## The number of rows of quads from the top of a wall to its foot.
const WALL_ROWS := 9

## The ground to draw. The mesh is rebuilt when the ground changes.
@export var ground: ScatterGround:
	set(value):
		if ground != null:
			ground.changed.disconnect(_request_build)
		ground = value
		if ground != null:
			ground.changed.connect(_request_build)
		_request_build()
## The part of the world to draw, in meters of x and z.
@export var rect := Rect2(-200.0, -200.0, 400.0, 400.0):
	set(value):
		rect = value
		_request_build()
## The distance between two vertices, in meters.
@export_range(0.25, 16.0, 0.25, "suffix:m") var spacing := 2.0:
	set(value):
		spacing = maxf(value, 0.25)
		_request_build()
## The world height of the foot of walls, in meters.
@export_range(-100.0, 100.0, 0.5, "suffix:m") var wall_foot := -4.0:
	set(value):
		wall_foot = value
		_request_build()
## The path from which UV.x measures the distance; null for none.
@export var path: Path3D:
	set(value):
		if path != null:
			path.curve_changed.disconnect(_on_path_changed)
		path = value
		if path != null:
			path.curve_changed.connect(_on_path_changed)
		_request_build()
## A map of soils that covers [member rect], for a [member material] whose [code]soil_used[/code] is 1. Its channels are the weights of meadow (red),
## forest floor (green), rock (blue) and sand (alpha). Null for none.
@export var soil: Image:
	set(value):
		soil = value
		_request_build()
## The material of the ground and the walls. The shared noise is set on it.
@export var material: ShaderMaterial:
	set(value):
		material = value
		_request_build()

var _is_build_requested := false
var _path_changes := 0
var _soil_texture: ImageTexture
var _columns := 0
var _vertices := PackedVector3Array()
## For each post (height sample), 1 if it has ground, otherwise 0.
var _has_ground := PackedByteArray()
var _indices := PackedInt32Array()
## The vertex at the edge of the ground between two posts, by the indices of both.
var _cuts := {}
## The next vertex along the edge of the ground, for each vertex on the edge. The ground is to the right, as seen from above.
var _next_on_edge := {}


func _validate_property(property: Dictionary) -> void:
	if property.name == "mesh":
		property.usage &= ~PROPERTY_USAGE_STORAGE


func _enter_tree() -> void:
	if _is_build_requested:
		_build.call_deferred()


func _request_build() -> void:
	if not _is_build_requested:
		_is_build_requested = true
		_build.call_deferred()


func _on_path_changed() -> void:
	_path_changes += 1
	if is_inside_tree():
		get_tree().create_timer(PATH_REST).timeout.connect(_on_path_rested.bind(_path_changes))


func _on_path_rested(changes: int) -> void:
	if changes == _path_changes:
		_request_build()


func _build() -> void:
	# A path outside of the tree has no global transform. The editor instantiates scenes before it adds them to the tree.
	if not _is_build_requested or not is_inside_tree():
		return
	_is_build_requested = false
	if ground == null:
		mesh = null
		return
	_vertices.clear()
	_has_ground.clear()
	_indices.clear()
	_cuts.clear()
	_next_on_edge.clear()
	_columns = int(rect.size.x / spacing) + 1
	var rows := int(rect.size.y / spacing) + 1
	for row in rows:
		for column in _columns:
			var point := rect.position + Vector2(column, row) * spacing
			var height := ground.get_height(Vector3(point.x, 0.0, point.y))
			_vertices.append(Vector3(point.x, height, point.y))
			_has_ground.append(int(is_finite(height)))
	for row in rows - 1:
		for column in _columns - 1:
			_add_quad(row * _columns + column)
	var new_mesh := ArrayMesh.new()
	_add_ground(new_mesh)
	if not _next_on_edge.is_empty():
		_add_walls(new_mesh)
	for surface in new_mesh.get_surface_count():
		new_mesh.surface_set_material(surface, material)
	_fill_material()
	mesh = new_mesh


## Sets the parameters of the material through the RenderingServer, because values that the editor sets on a material would be saved with the scene.
func _fill_material() -> void:
	if material == null:
		return
	var rid := material.get_rid()
	RenderingServer.material_set_param(rid, &"noise", NoiseTexture.texture().get_rid())
	if soil != null:
		_soil_texture = ImageTexture.create_from_image(soil)
		RenderingServer.material_set_param(rid, &"soil", _soil_texture.get_rid())
		RenderingServer.material_set_param(rid, &"soil_origin", rect.position)
		RenderingServer.material_set_param(rid, &"soil_size", rect.size)


## Adds the part of a quad that has ground, as a polygon with up to six corners.
func _add_quad(first: int) -> void:
	var south := first + _columns
	if _has_ground[first] + _has_ground[first + 1] + _has_ground[south] + _has_ground[south + 1] == 4:
		_indices.append(first)
		_indices.append(first + 1)
		_indices.append(south + 1)
		_indices.append(first)
		_indices.append(south + 1)
		_indices.append(south)
		return
	var corners: Array[int] = [first, first + 1, south + 1, south]
	var polygon: Array[int] = []
	var exit_cut := -1
	var first_entry_cut := -1
	for i in 4:
		var post := corners[i]
		var next_post := corners[(i + 1) % 4]
		var is_solid := _has_ground[post] == 1
		if is_solid:
			polygon.append(post)
		if is_solid == (_has_ground[next_post] == 1):
			continue
		var cut := _cut(post, next_post) if is_solid else _cut(next_post, post)
		polygon.append(cut)
		if is_solid:
			exit_cut = cut
		elif exit_cut >= 0:
			_next_on_edge[exit_cut] = cut
			exit_cut = -1
		else:
			first_entry_cut = cut
	if exit_cut >= 0:
		_next_on_edge[exit_cut] = first_entry_cut
	for i in range(2, polygon.size()):
		_indices.append_array([polygon[0], polygon[i - 1], polygon[i]])


## Adds a vertex at the edge of the ground, between a post with ground and one without, and returns its index.
func _cut(solid: int, hollow: int) -> int:
	var key := Vector2i(solid, hollow)
	if not _cuts.has(key):
		var start := _vertices[solid]
		var end := Vector3(_vertices[hollow].x, start.y, _vertices[hollow].z)
		for step in HALVINGS:
			var middle := (start + end) * 0.5
			middle.y = ground.get_height(middle)
			if is_finite(middle.y):
				start = middle
			else:
				end = middle
		_cuts[key] = _vertices.size()
		_vertices.append(start)
	return _cuts[key]


func _add_ground(target: ArrayMesh) -> void:
	if _indices.is_empty():
		return
	var normals := PackedVector3Array()
	var uvs := PackedVector2Array()
	var near_path := _path_bounds()
	for vertex in _vertices.size():
		var point := _vertices[vertex]
		normals.append(_normal(vertex))
		var is_near_path := near_path.has_point(Vector2(point.x, point.z))
		uvs.append(Vector2(_distance_to_path(point) if is_near_path else FAR, 0.0))
		# A post without ground is in no triangle, but it is included in the bounding box, which must be finite for culling.
		if is_nan(point.y):
			_vertices[vertex].y = wall_foot
	var arrays: Array = []
	arrays.resize(Mesh.ARRAY_MAX)
	arrays[Mesh.ARRAY_VERTEX] = _vertices
	arrays[Mesh.ARRAY_NORMAL] = normals
	arrays[Mesh.ARRAY_TEX_UV] = uvs
	arrays[Mesh.ARRAY_INDEX] = _indices
	target.add_surface_from_arrays(Mesh.PRIMITIVE_TRIANGLES, arrays)


## Returns the normal from the posts around a vertex, or from the ground itself at borders.
func _normal(vertex: int) -> Vector3:
	var column := vertex % _columns
	if column > 0 and column < _columns - 1 and vertex >= _columns and vertex + _columns < _has_ground.size():
		var neighbors_with_ground := _has_ground[vertex - 1] + _has_ground[vertex + 1] + _has_ground[vertex - _columns] + _has_ground[vertex + _columns]
		var rise_x := _vertices[vertex + 1].y - _vertices[vertex - 1].y
		var rise_z := _vertices[vertex + _columns].y - _vertices[vertex - _columns].y
		if neighbors_with_ground == 4:
			return Vector3(-rise_x, 2.0 * spacing, -rise_z).normalized()
	var normal := ground.get_normal(_vertices[vertex])
	return normal if normal != Vector3.ZERO else Vector3.UP


func _path_bounds() -> Rect2:
	if path == null or path.curve == null or path.curve.point_count < 2:
		return Rect2()
	var bounds := Rect2()
	var points := path.curve.get_baked_points()
	for i in points.size():
		var point := path.global_transform * points[i]
		var flat := Vector2(point.x, point.z)
		bounds = bounds.expand(flat) if i > 0 else Rect2(flat, Vector2.ZERO)
	return bounds.grow(FAR)


func _distance_to_path(point: Vector3) -> float:
	var local := path.global_transform.affine_inverse() * point
	var nearest := path.curve.get_closest_point(local)
	return minf(Vector2(nearest.x - local.x, nearest.z - local.z).length(), FAR)


func _add_walls(target: ArrayMesh) -> void:
	var outward := {}
	for from: int in _next_on_edge:
		var to: int = _next_on_edge[from]
		var edge := _vertices[to] - _vertices[from]
		var normal := Vector3(edge.z, 0.0, -edge.x)
		outward[from] = outward.get(from, Vector3.ZERO) + normal
		outward[to] = outward.get(to, Vector3.ZERO) + normal
	var noise := FastNoiseLite.new()
	noise.seed = 3
	noise.frequency = 0.09
	var surface := SurfaceTool.new()
	surface.begin(Mesh.PRIMITIVE_TRIANGLES)
	# Flat shading, because rock has flat faces.
	surface.set_smooth_group(-1)
	var firsts := {}
	var count := 0
	for vertex: int in outward:
		firsts[vertex] = count
		count += WALL_ROWS + 1
		var top := _vertices[vertex]
		var normal: Vector3 = (outward[vertex] as Vector3).normalized()
		for row in WALL_ROWS + 1:
			var depth := float(row) / WALL_ROWS
			var point := Vector3(top.x, lerpf(top.y, wall_foot, depth), top.z)
			# Adds pillars and ledges, and rubble at the foot.
			var rough := noise.get_noise_3dv(point * Vector3(1.0, 0.3, 1.0)) + 0.6 * noise.get_noise_3dv(point * 2.7)
			var lean := 2.0 * depth + 3.0 * depth ** 4 + 6.0 * minf(3.0 * depth, 1.0) * rough
			surface.set_uv(Vector2(FAR, 1.0))
			surface.add_vertex(point + normal * lean)
	for from: int in _next_on_edge:
		for row in WALL_ROWS:
			var a: int = firsts[from] + row
			var b: int = firsts[_next_on_edge[from]] + row
			for index: int in [a, a + 1, b + 1, a, b + 1, b]:
				surface.add_index(index)
	surface.generate_normals()
	surface.commit(target)
