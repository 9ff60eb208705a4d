@tool
extends EditorNode3DGizmoPlugin
## Draws the water of the selected [code]TerrainScatter3D[/code]: as a plane over its tiles or, on a planet, as a sphere around its center. A handle
## changes the water level. It is in the center of the plane, or on the planet in the middle of the view.

const EditorSnap := preload("res://addons/thicket/editor/editor_snap.gd")
const ScatterLayers := preload("res://addons/thicket/editor/layers/scatter_layers.gd")
const SurfacePlace := preload("res://addons/thicket/editor/ground/surface_place.gd")

const COLOR := Color(0.25, 0.55, 0.95, 0.35)
## The distance in meters from the center to the edges if no tile is shown.
const REACH := 100.0
## The step, in meters, to which the handle rounds the level if snapping is off.
const STEP := 0.01
## The number of segments around a planet's water. The middles of its facets are 0.04 m too low if the planet has a radius of 2 km.
const SEGMENTS := 512

var undo_redo: EditorUndoRedoManager
## The selected scatter. The water of other scatters is not drawn.
var scatter: TerrainScatter3D

var _material := StandardMaterial3D.new()
var _sphere := SphereMesh.new()
## The position of the handle at a water level of 0, and the direction in which the level rises.
var _origin := Vector3.ZERO
var _up := Vector3.UP


func _init() -> void:
	_material.albedo_color = COLOR
	_material.transparency = BaseMaterial3D.TRANSPARENCY_ALPHA
	_material.shading_mode = BaseMaterial3D.SHADING_MODE_UNSHADED
	_material.cull_mode = BaseMaterial3D.CULL_DISABLED
	_sphere.radius = 1.0
	_sphere.height = 2.0
	_sphere.radial_segments = SEGMENTS
	@warning_ignore("integer_division")
	_sphere.rings = SEGMENTS / 2
	create_handle_material("handles")


func _get_gizmo_name() -> String:
	return "TerrainScatter3D Water"


func _has_gizmo(node: Node3D) -> bool:
	return node is TerrainScatter3D


func _redraw(gizmo: EditorNode3DGizmo) -> void:
	gizmo.clear()
	if gizmo.get_node_3d() != scatter or not scatter.water_enabled:
		return
	# The water does not move with the node.
	var to_node := scatter.global_transform.affine_inverse()
	var center := SurfacePlace.planet_center(scatter)
	if center.is_finite():
		_aim(center, SurfacePlace.planet_radius(scatter))
		var radius := maxf(SurfacePlace.planet_radius(scatter) + scatter.water_level, STEP)
		gizmo.add_mesh(_sphere, _material, to_node * Transform3D(Basis.from_scale(Vector3.ONE * radius), center))
	else:
		var area := _area()
		var mesh := PlaneMesh.new()
		mesh.size = area.size
		_origin = Vector3(area.get_center().x, 0.0, area.get_center().y)
		_up = Vector3.UP
		gizmo.add_mesh(mesh, _material, to_node * Transform3D(Basis.IDENTITY, _origin + _up * scatter.water_level))
	gizmo.add_handles([to_node * (_origin + _up * scatter.water_level)], get_material("handles", gizmo), [])


func _get_handle_name(_gizmo: EditorNode3DGizmo, _id: int, _secondary: bool) -> String:
	return "Water Level"


func _get_handle_value(gizmo: EditorNode3DGizmo, _id: int, _secondary: bool) -> Variant:
	return (gizmo.get_node_3d() as TerrainScatter3D).water_level


func _set_handle(gizmo: EditorNode3DGizmo, _id: int, _secondary: bool, camera: Camera3D, point: Vector2) -> void:
	var node := gizmo.get_node_3d() as TerrainScatter3D
	var ray_start := camera.project_ray_origin(point)
	var ray_end := ray_start + camera.project_ray_normal(point) * camera.far
	var ray_height := (ray_start - _origin).dot(_up)
	var low := _origin + _up * (ray_height - camera.far)
	var high := _origin + _up * (ray_height + camera.far)
	var level := (Geometry3D.get_closest_points_between_segments(low, high, ray_start, ray_end)[0] - _origin).dot(_up)
	node.water_level = snappedf(level, EditorSnap.meters() if EditorSnap.is_on() else STEP)
	node.update_gizmos()


func _commit_handle(gizmo: EditorNode3DGizmo, _id: int, _secondary: bool, restore: Variant, cancel: bool) -> void:
	var node := gizmo.get_node_3d() as TerrainScatter3D
	if cancel:
		node.water_level = restore
		return
	undo_redo.create_action("Change Water Level", UndoRedo.MERGE_DISABLE, node)
	undo_redo.add_do_property(node, &"water_level", node.water_level)
	undo_redo.add_undo_property(node, &"water_level", restore)
	undo_redo.commit_action()


## Moves the handle to the middle of the view of a planet or, if the planet is not there, to the ground below the camera.
func _aim(center: Vector3, radius: float) -> void:
	var camera := EditorInterface.get_editor_viewport_3d(0).get_camera_3d()
	var camera_position := camera.global_position
	var direction := -camera.global_basis.z
	var hits := Geometry3D.segment_intersects_sphere(camera_position, camera_position + direction * camera.far, center, radius)
	_up = center.direction_to(hits[0] if not hits.is_empty() and hits[1].dot(direction) < 0.0 else camera_position)
	if _up == Vector3.ZERO:
		_up = Vector3.UP
	_origin = center + _up * radius


## Returns the rectangle of all visible tiles, with x and z in meters. Without visible tiles, returns a square around the origin.
func _area() -> Rect2:
	var area := Rect2()
	for layer in ScatterLayers.of(scatter):
		if layer == null:
			continue
		for tile in scatter.get_shown_tiles(layer):
			var tile_rect := Rect2(Vector2(tile) * layer.tile_size, Vector2.ONE * layer.tile_size)
			area = tile_rect if not area.has_area() else area.merge(tile_rect)
	return area if area.has_area() else Rect2(-REACH, -REACH, 2.0 * REACH, 2.0 * REACH)
