@tool
extends RefCounted
## A preview of the next instance at the position where it would be planted. It exists only in the renderer, without a
## node, so it adds nothing to the scene.

const COLOR := Color(0.3, 0.8, 1.0, 0.65)

var _instance := RID()
var _material := StandardMaterial3D.new()
var _mesh: Mesh
var _is_shown := false


func _init() -> void:
	_material.transparency = BaseMaterial3D.TRANSPARENCY_ALPHA
	_material.albedo_color = COLOR
	_material.emission_enabled = true
	_material.emission = Color(COLOR, 1.0) * 0.35


func _notification(what: int) -> void:
	if what == NOTIFICATION_PREDELETE and _instance.is_valid():
		RenderingServer.free_rid(_instance)


## Shows a mesh in the world of a scatter. Hides the preview if the mesh is null.
func show(scatter: TerrainScatter3D, mesh: Mesh, transform: Transform3D) -> void:
	if mesh == null:
		hide()
		return
	if not _instance.is_valid():
		_instance = RenderingServer.instance_create()
		RenderingServer.instance_geometry_set_cast_shadows_setting(_instance, RenderingServer.SHADOW_CASTING_SETTING_OFF)
		RenderingServer.instance_geometry_set_material_override(_instance, _material.get_rid())
	if mesh != _mesh:
		_mesh = mesh # Keeps a reference, because the renderer must not draw a freed mesh.
		RenderingServer.instance_set_base(_instance, mesh.get_rid())
	RenderingServer.instance_set_scenario(_instance, scatter.get_world_3d().scenario)
	RenderingServer.instance_set_transform(_instance, transform)
	_is_shown = true


func hide() -> void:
	if _is_shown:
		RenderingServer.instance_set_scenario(_instance, RID())
	_is_shown = false


func is_shown() -> bool:
	return _is_shown
