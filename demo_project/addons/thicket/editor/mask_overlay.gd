@tool
extends RefCounted
## Shows what is painted on a layer while the brush is on: a veil over the ground, green where the layer may stand and red where it may
## not. It is the renderer's alone: no node, and nothing in the scene.

## Quads along a side.
const QUADS := 48
## The veil is as wide as the view is far from what it looks at, times this, in meters between these.
const WIDTH := 2.0
const WIDTHS := Vector2(24.0, 1200.0)
## Meters above the ground, for each meter of a quad.
const LIFT := 0.04
const STANDS := Color(0.35, 0.95, 0.3, 0.2)
const GONE := Color(1.0, 0.25, 0.2, 0.4)

var _mesh := ArrayMesh.new()
var _material := StandardMaterial3D.new()
var _instance := RID()
var _shown: Array = []


func _init() -> void:
	_material.shading_mode = BaseMaterial3D.SHADING_MODE_UNSHADED
	_material.transparency = BaseMaterial3D.TRANSPARENCY_ALPHA
	_material.vertex_color_use_as_albedo = true
	_material.vertex_color_is_srgb = true
	_material.cull_mode = BaseMaterial3D.CULL_DISABLED


func _notification(what: int) -> void:
	if what == NOTIFICATION_PREDELETE and _instance.is_valid():
		RenderingServer.free_rid(_instance)


## Draws a mask over the ground around a place of it, seen from [param away] meters; called again with the same, it does nothing.
## [param version] tells one state of the mask from another.
func show(scatter: Node3D, mask: Resource, around: Vector3, away: float, version: int) -> void:
	var quad := pow(2.0, roundf(log(clampf(away * WIDTH, WIDTHS.x, WIDTHS.y) / QUADS) / log(2.0)))
	var middle := Vector2i((Vector2(around.x, around.z) / (quad * 4.0)).round()) * 4
	var asked := [scatter, scatter.get(&"terrain"), mask, middle, quad, version]
	if asked == _shown:
		return
	_shown = asked
	_mesh.clear_surfaces()
	_mesh.add_surface_from_arrays(Mesh.PRIMITIVE_TRIANGLES, _veil(scatter.get(&"terrain"), mask, middle, quad))
	_mesh.surface_set_material(0, _material)
	if not _instance.is_valid():
		_instance = RenderingServer.instance_create()
		RenderingServer.instance_set_base(_instance, _mesh.get_rid())
		RenderingServer.instance_geometry_set_cast_shadows_setting(_instance, RenderingServer.SHADOW_CASTING_SETTING_OFF)
	RenderingServer.instance_set_scenario(_instance, scatter.get_world_3d().scenario)


## Shows nothing.
func hide() -> void:
	_shown = []
	if _instance.is_valid():
		RenderingServer.instance_set_scenario(_instance, RID())


## True if something is shown.
func is_shown() -> bool:
	return not _shown.is_empty()


static func _veil(terrain: Resource, mask: Resource, middle: Vector2i, quad: float) -> Array:
	var vertices := PackedVector3Array()
	var colors := PackedColorArray()
	for z in QUADS + 1:
		for x in QUADS + 1:
			var at := Vector2(middle + Vector2i(x, z) - Vector2i(QUADS, QUADS) / 2) * quad
			var height: float = terrain.call(&"get_height", Vector3(at.x, 0.0, at.y))
			vertices.append(Vector3(at.x, (0.0 if is_nan(height) else height) + LIFT * quad, at.y))
			var color := GONE.lerp(STANDS, mask.call(&"sample", at))
			colors.append(Color(color, 0.0 if is_nan(height) else color.a))
	var indices := PackedInt32Array()
	for z in QUADS:
		for x in QUADS:
			var first := z * (QUADS + 1) + x
			indices.append_array([first, first + 1, first + QUADS + 2, first, first + QUADS + 2, first + QUADS + 1])
	var arrays: Array = []
	arrays.resize(Mesh.ARRAY_MAX)
	arrays[Mesh.ARRAY_VERTEX] = vertices
	arrays[Mesh.ARRAY_COLOR] = colors
	arrays[Mesh.ARRAY_INDEX] = indices
	return arrays
