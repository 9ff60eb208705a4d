@tool
extends Node3D
## Draws the elevation model around the camera as a quadtree of square patches, which are finer near the camera. All
## patches use the same small grid. The vertex shader places it on the bilinearly interpolated ground. Where the level
## of detail changes, the vertices of one level gradually move to the positions of the next level.
##
## Every vertex lies exactly on the interpolated ground. Up to 220 m from the camera, vertices are 5 to 6 m apart. Within that distance, triangles
## differ from the ground by at most 2 cm on 97 % of this map, and by at most 5 cm anywhere. Plants therefore touch the drawn ground. The edges of the
## grid follow the rows and columns of height samples.

const Elevation := preload("res://terrain/elevation.gd")
const GroundCover := preload("res://terrain/ground_cover.gd")
const NoiseTexture := preload("res://terrain/noise_texture.gd")
const PathMap := preload("res://terrain/path_map.gd")

## The number of quads along a patch's edge.
const QUADS := 16
## The distance in meters up to which the finest patches are drawn. Each coarser level reaches twice as far.
const FINEST_RANGE := 300.0
## The coarsest level. Its patch has 2^9 posts (height samples) along its edge and is wider than the map.
const TOP_LEVEL := 9
## The distance in meters that the camera must move before patches are chosen again.
const STEP := 6.0

## The description that [code]convert_dem.py[/code] writes.
@export_file("*.json") var description := "res://terrain/jacksboro.json"
## The ground's material. The elevation textures are set on it.
@export var material: ShaderMaterial
## The scatter on this ground. The material receives the rules of its layers.
@export var scatter: TerrainScatter3D
## The names of the layers whose rules the material receives, in the order of its shader's arrays.
@export var cover: PackedStringArray = ["Oak", "Spruce", "Grass"]
## A path that the material draws; null for none.
@export var path: Path3D

## The ground that is drawn; null until the node is ready.
var elevation: Elevation

var _cover := GroundCover.new()
var _path_map: PathMap
var _heights: ImageTexture
var _relief: ImageTexture
var _patch := ArrayMesh.new()
var _quarter := ArrayMesh.new()
var _instances: Array[RID] = []
var _used_count := 0
var _last_camera := Vector3.INF


func _ready() -> void:
	elevation = Elevation.new()
	if not elevation.load_description(description) or material == null:
		set_process(false)
		return
	_heights = elevation.height_texture()
	_relief = elevation.relief_texture()
	# Sets the parameters through the RenderingServer, because values that the editor sets on the material would be saved with the scene.
	var rid := material.get_rid()
	RenderingServer.material_set_param(rid, &"heights", _heights.get_rid())
	RenderingServer.material_set_param(rid, &"relief", _relief.get_rid())
	RenderingServer.material_set_param(rid, &"noise", NoiseTexture.texture().get_rid())
	RenderingServer.material_set_param(rid, &"map_origin", elevation.rect.position)
	RenderingServer.material_set_param(rid, &"post_spacing", elevation.spacing)
	RenderingServer.material_set_param(rid, &"finest_range", FINEST_RANGE)
	_set_cover(rid)
	_set_path(rid)
	_fill_grid(_patch, QUADS)
	_fill_grid(_quarter, QUADS / 2)


func _exit_tree() -> void:
	for instance in _instances:
		RenderingServer.free_rid(instance)
	_instances.clear()
	_last_camera = Vector3.INF


func _process(_delta: float) -> void:
	var camera := _camera()
	if camera == null or camera.global_position.distance_to(_last_camera) < STEP:
		return
	_last_camera = camera.global_position
	_used_count = 0
	_draw_square(TOP_LEVEL, Vector2i.ZERO)
	for i in range(_used_count, _instances.size()):
		RenderingServer.instance_set_visible(_instances[i], false)


## Returns the number of triangles of the current patches, before culling.
func triangle_count() -> int:
	return _used_count * QUADS * QUADS * 2


func _set_cover(rid: RID) -> void:
	if scatter == null:
		return
	var layers: Array[ScatterLayer] = []
	for title in cover:
		for layer: ScatterLayer in scatter.layers:
			if layer != null and layer.resource_name == title:
				layers.append(layer)
	if layers.size() == cover.size():
		_cover.apply(rid, elevation.rect, layers)


func _set_path(rid: RID) -> void:
	if path == null or path.curve == null or path.curve.point_count < 2:
		return
	_path_map = PathMap.new(path)
	RenderingServer.material_set_param(rid, &"path_map", _path_map.texture.get_rid())
	RenderingServer.material_set_param(rid, &"path_rect", Vector4(_path_map.rect.position.x, _path_map.rect.position.y,
			_path_map.rect.size.x, _path_map.rect.size.y))
	RenderingServer.material_set_param(rid, &"path_reach", PathMap.MAX_DISTANCE)


func _camera() -> Camera3D:
	if Engine.is_editor_hint():
		return Engine.get_singleton(&"EditorInterface").get_editor_viewport_3d(0).get_camera_3d()
	return get_viewport().get_camera_3d()


## Draws the square with an edge length of 2^level posts whose first post is [param post]. If the camera is near, draws
## the square's four quarters instead.
func _draw_square(level: int, post: Vector2i) -> void:
	if level == 0 or not _in_range(level - 1, post, 1 << level):
		_draw(_patch, level, post, 1 << level)
		return
	var half := 1 << (level - 1)
	for k in 4:
		var corner := post + Vector2i(k % 2, k / 2) * half
		if corner.x >= elevation.posts.x - 1 or corner.y >= elevation.posts.y - 1:
			continue
		if _in_range(level - 1, corner, half):
			_draw_square(level - 1, corner)
		else:
			_draw(_quarter, level, corner, half)


func _in_range(level: int, post: Vector2i, size: int) -> bool:
	var range_end := FINEST_RANGE * (1 << level)
	return _box(post, size).grow(range_end).has_point(_last_camera) and _distance(_box(post, size), _last_camera) < range_end


func _box(post: Vector2i, size: int) -> AABB:
	var heights := elevation.bounds(post, post + Vector2i(size - 1, size - 1))
	var corner := elevation.rect.position + Vector2(post) * elevation.spacing
	var extent := elevation.spacing * size
	return AABB(Vector3(corner.x, heights.x, corner.y), Vector3(extent.x, heights.y - heights.x, extent.y))


static func _distance(box: AABB, point: Vector3) -> float:
	return point.distance_to(point.clamp(box.position, box.end))


func _draw(mesh: ArrayMesh, level: int, post: Vector2i, size: int) -> void:
	if _used_count == _instances.size():
		var new_instance := RenderingServer.instance_create()
		RenderingServer.instance_set_scenario(new_instance, get_world_3d().scenario)
		RenderingServer.instance_geometry_set_cast_shadows_setting(new_instance, RenderingServer.SHADOW_CASTING_SETTING_OFF)
		_instances.append(new_instance)
	var instance := _instances[_used_count]
	_used_count += 1
	var box := _box(post, size)
	# The grid is flat, so the y axis of the basis has no other use. The shader reads the level from it.
	var basis := Basis.from_scale(Vector3(box.size.x, level + 1.0, box.size.z))
	RenderingServer.instance_set_base(instance, mesh.get_rid())
	RenderingServer.instance_geometry_set_material_override(instance, material.get_rid())
	RenderingServer.instance_set_transform(instance, Transform3D(basis, Vector3(box.position.x, 0.0, box.position.z)))
	var scale_y := level + 1.0
	RenderingServer.instance_set_custom_aabb(instance, AABB(Vector3(0.0, box.position.y / scale_y, 0.0),
			Vector3(1.0, box.size.y / scale_y, 1.0)))
	RenderingServer.instance_set_visible(instance, true)


## Fills a unit square with [param quads] by [param quads] quads, for the shader. UV is the position, and UV2.x is the number of
## quads along an edge.
static func _fill_grid(mesh: ArrayMesh, quads: int) -> void:
	var vertices := PackedVector3Array()
	var uvs := PackedVector2Array()
	var counts := PackedVector2Array()
	var indices := PackedInt32Array()
	for j in quads + 1:
		for i in quads + 1:
			uvs.append(Vector2(i, j) / quads)
			counts.append(Vector2(quads, 0.0))
			vertices.append(Vector3(uvs[-1].x, 0.0, uvs[-1].y))
	for j in quads:
		for i in quads:
			var a := j * (quads + 1) + i
			indices.append_array([a, a + 1, a + quads + 1, a + 1, a + quads + 2, a + quads + 1])
	var arrays: Array = []
	arrays.resize(Mesh.ARRAY_MAX)
	arrays[Mesh.ARRAY_VERTEX] = vertices
	arrays[Mesh.ARRAY_TEX_UV] = uvs
	arrays[Mesh.ARRAY_TEX_UV2] = counts
	arrays[Mesh.ARRAY_INDEX] = indices
	mesh.clear_surfaces()
	mesh.add_surface_from_arrays(Mesh.PRIMITIVE_TRIANGLES, arrays)
