@tool
extends RefCounted
## A colored overlay on the ground around a position. It exists only in the renderer, without a node, so it adds nothing
## to the scene. It is generated in parts, a few in each frame, and replaces the previous overlay when all parts are
## complete.

const SurfacePlace := preload("res://addons/thicket/editor/ground/surface_place.gd")

## The number of quads and of parts along an edge of the overlay.
const QUADS := 48
const PARTS := 4
## The width of the overlay, as a multiple of the distance from the camera, and its limits in meters.
const WIDTH := 2.0
const WIDTHS := Vector2(24.0, 1200.0)
## The height of the overlay above the ground, as a multiple of a quad's edge length.
const LIFT := 0.04

var _meshes: Array[ArrayMesh] = [ArrayMesh.new(), ArrayMesh.new()] ## The visible mesh, and the mesh that is being generated.
var _material := StandardMaterial3D.new()
var _instance := RID()
var _scatter: TerrainScatter3D
var _ground: ScatterGround
var _middle := Vector2i.ZERO ## The center of the overlay, in quads.
var _planet_point := Vector3.INF ## The center of an overlay on any side of a planet; not finite for one that is projected along the y axis.
var _quad := 0.0 ## The edge length of a quad, in meters.
var _request: Array = [] ## All values that determine the overlay; empty if there is none.
var _colors: Callable
var _parts: Array[Vector2i] = [] ## The parts that are still to be generated.


func _init() -> void:
	_material.shading_mode = BaseMaterial3D.SHADING_MODE_UNSHADED
	_material.transparency = BaseMaterial3D.TRANSPARENCY_ALPHA
	_material.vertex_color_use_as_albedo = true
	_material.vertex_color_is_srgb = true
	_material.cull_mode = BaseMaterial3D.CULL_DISABLED


func _notification(what: int) -> void:
	if what == NOTIFICATION_PREDELETE and _instance.is_valid():
		RenderingServer.free_rid(_instance)


## Removes the overlay.
func hide() -> void:
	_request = []
	_ground = null
	_parts.clear()
	_remove_from_view()


## Returns true if an overlay is shown or being generated.
func is_shown() -> bool:
	return not _request.is_empty()


## Returns true if no overlay is being generated.
func is_complete() -> bool:
	return _parts.is_empty()


## Begins an overlay on the ground of a scatter around a position, with quads of at most [param max_quad] meters. The
## view is [param distance] meters from that position. Has no effect if the ground, the position and [param version] are the
## same as last time. [param colors] is called with a rectangle of world x and z and the number of columns and rows that
## divide it. It returns a color for the center of each cell, row by row. If it returns an empty array, the overlay is
## removed. If [param on_planet] is true, the overlay lies on the side of the planet around the position, and
## [param colors] must use its third argument instead: the position of each cell on the ground, not finite without ground.
func cover(scatter: TerrainScatter3D, center: Vector3, distance: float, version: Variant, colors: Callable, max_quad := INF, on_planet := false) -> void:
	var quad := pow(2.0, floorf(log(minf(clampf(distance * WIDTH, WIDTHS.x, WIDTHS.y) / QUADS * sqrt(2.0), max_quad)) / log(2.0)))
	var center_quad := Vector2i((Vector2(center.x, center.z) / (quad * 4.0)).round()) * 4
	var planet_point := (center / (quad * 4.0)).round() * quad * 4.0 if on_planet else Vector3.INF
	if on_planet:
		center_quad = Vector2i.ZERO
	var request := [scatter, scatter.ground, center_quad, planet_point, quad, version]
	if request == _request:
		return
	_request = request
	_scatter = scatter
	_ground = scatter.ground
	_middle = center_quad
	_planet_point = planet_point
	_quad = quad
	_colors = colors
	_meshes[1].clear_surfaces()
	_parts.clear()
	for z in PARTS:
		for x in PARTS:
			_parts.append(Vector2i(x, z))


## Generates parts until this number of microseconds has passed, but at least one.
func work(microseconds: int) -> void:
	if _parts.is_empty():
		return
	if not is_instance_valid(_scatter) or not _scatter.is_inside_tree() or _scatter.ground == null:
		return hide()
	var deadline := Time.get_ticks_usec() + microseconds
	while not _parts.is_empty():
		var arrays := _surface_arrays(_parts.pop_front())
		if arrays.is_empty(): # The request failed and is not repeated.
			_parts.clear()
			return _remove_from_view()
		_meshes[1].add_surface_from_arrays(Mesh.PRIMITIVE_TRIANGLES, arrays)
		_meshes[1].surface_set_material(_meshes[1].get_surface_count() - 1, _material)
		if Time.get_ticks_usec() >= deadline:
			break
	if _parts.is_empty():
		_show()


func _remove_from_view() -> void:
	if _instance.is_valid():
		RenderingServer.instance_set_scenario(_instance, RID())


func _show() -> void:
	_meshes.reverse()
	if not _instance.is_valid():
		_instance = RenderingServer.instance_create()
		RenderingServer.instance_geometry_set_cast_shadows_setting(_instance, RenderingServer.SHADOW_CASTING_SETTING_OFF)
	RenderingServer.instance_set_base(_instance, _meshes[0].get_rid())
	RenderingServer.instance_set_scenario(_instance, _scatter.get_world_3d().scenario)


func _surface_arrays(cell: Vector2i) -> Array:
	const SIDE := QUADS / PARTS
	var first: Vector2 = Vector2(_middle - Vector2i(QUADS, QUADS) / 2 + cell * SIDE) * _quad
	var size := Vector2i(SIDE + 1, SIDE + 1)
	var positions := _positions_on_planet(first, size) if _planet_point.is_finite() else PackedVector3Array()
	var colors: PackedColorArray = _colors.call(Rect2(first - Vector2.ONE * _quad * 0.5, Vector2(size) * _quad), size, positions)
	if colors.size() != size.x * size.y:
		return []
	var vertices := _raised(positions, colors) if _planet_point.is_finite() else PackedVector3Array()
	for index in size.x * size.y if vertices.is_empty() else 0:
		@warning_ignore("integer_division")
		var point := first + Vector2(index % size.x, index / size.x) * _quad
		var height := _ground.get_height(Vector3(point.x, 0.0, point.y))
		vertices.append(Vector3(point.x, (0.0 if is_nan(height) else height) + LIFT * _quad, point.y))
		if is_nan(height):
			colors[index].a = 0.0
	var indices := PackedInt32Array()
	for z in SIDE:
		for x in SIDE:
			var corner := z * size.x + x
			indices.append_array([corner, corner + 1, corner + size.x + 1, corner, corner + size.x + 1, corner + size.x])
	var arrays: Array = []
	arrays.resize(Mesh.ARRAY_MAX)
	arrays[Mesh.ARRAY_VERTEX] = vertices
	arrays[Mesh.ARRAY_COLOR] = colors
	arrays[Mesh.ARRAY_INDEX] = indices
	return arrays


## Returns the positions on the ground of a grid on the side of a planet, row by row.
func _positions_on_planet(first: Vector2, size: Vector2i) -> PackedVector3Array:
	var map_points := PackedVector2Array()
	for z in size.y:
		for x in size.x:
			map_points.append(first + Vector2(x, z) * _quad)
	return _scatter._planet_ground(_planet_point, map_points)


## Returns positions on a planet, raised above the ground. Makes the colors of positions without ground transparent.
func _raised(positions: PackedVector3Array, colors: PackedColorArray) -> PackedVector3Array:
	var vertices := PackedVector3Array()
	for index in positions.size():
		var position := positions[index]
		if not position.is_finite():
			position = _planet_point
			colors[index].a = 0.0
		vertices.append(position + SurfacePlace.up_at(_scatter, position) * LIFT * _quad)
	return vertices
