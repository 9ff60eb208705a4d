extends RefCounted
## Reads the material properties that [ScatterImpostorBaker] needs, and sums the properties that apply to the whole impostor.

const Parameters := preload("res://addons/thicket/shader_parameters.gd")

## The properties with which a surface is drawn.
class Appearance:
	var arrays: Array
	var albedo := Color.WHITE
	var texture: Image
	var alpha_threshold := 0.0
	var cull_mode := 0 # A value of ScatterImpostorBaker.CullMode.
	var vertex_colors := 0 # A value of ScatterImpostorBaker.VertexColorMode.
	var roughness := 1.0
	var specular := 0.5
	var backlight := Color.BLACK

## The alpha threshold for materials with alpha blending. Each pixel of an impostor is either opaque or transparent.
const HALF := 0.5

var stand_ins: Dictionary[Material, BaseMaterial3D] = {}
var warnings := PackedStringArray()

## The area of all triangles in square meters. The following sums are weighted by area; divide them by this value.
var area := 0.0
var roughness := 0.0
var specular := 0.0
var backlight := Color(0.0, 0.0, 0.0, 0.0)

var _images: Dictionary[Texture2D, Image] = {}


## Returns the properties of a surface with these arrays and this material, which may be null, and adds them to the sums.
func read(material: Material, arrays: Array, transform: Transform3D) -> Appearance:
	var appearance := Appearance.new()
	appearance.arrays = arrays
	appearance.cull_mode = _constant(&"CULL_BACK")
	appearance.vertex_colors = _constant(&"VERTEX_COLOR_UNUSED")
	var source: Material = stand_ins.get(material, material)
	if source is BaseMaterial3D:
		_read_material(source as BaseMaterial3D, appearance)
	elif source is ShaderMaterial:
		_read_shader(source as ShaderMaterial, appearance)
	elif source != null:
		_warn("%s is baked white: the colors of a %s are unknown. Set stand_ins." % [_name_of(source), source.get_class()])
	var surface_area := _area_of(arrays, transform)
	area += surface_area
	roughness += surface_area * appearance.roughness
	specular += surface_area * appearance.specular
	backlight += appearance.backlight * surface_area
	return appearance


## Returns one of ScatterImpostorBaker's constants. This script must not name the class, because the editor also compiles it without the library.
static func _constant(name: StringName) -> int:
	return ClassDB.class_get_integer_constant(&"ScatterImpostorBaker", name)


func _read_material(material: BaseMaterial3D, appearance: Appearance) -> void:
	appearance.albedo = material.albedo_color
	appearance.texture = _image_of(material.albedo_texture, material)
	appearance.cull_mode = _constant([&"CULL_BACK", &"CULL_FRONT", &"CULL_DISABLED"][material.cull_mode])
	match material.transparency:
		BaseMaterial3D.TRANSPARENCY_DISABLED:
			appearance.alpha_threshold = 0.0
		BaseMaterial3D.TRANSPARENCY_ALPHA_SCISSOR:
			appearance.alpha_threshold = clampf(material.alpha_scissor_threshold, 0.0, 1.0)
		_:
			appearance.alpha_threshold = HALF
	if material.vertex_color_use_as_albedo:
		appearance.vertex_colors = _constant(&"VERTEX_COLOR_SRGB" if material.vertex_color_is_srgb else &"VERTEX_COLOR_LINEAR")
	appearance.roughness = material.roughness
	appearance.specular = material.metallic_specular
	if material.backlight_enabled:
		appearance.backlight = material.backlight
	if material.uv1_triplanar:
		_warn("%s is triplanar and is baked with the mesh's UVs instead. Set stand_ins to a material without uv1_triplanar." % _name_of(material))
	var uvs: Variant = appearance.arrays[Mesh.ARRAY_TEX_UV]
	if uvs != null and (material.uv1_scale != Vector3.ONE or material.uv1_offset != Vector3.ZERO):
		var scale := Vector2(material.uv1_scale.x, material.uv1_scale.y)
		var uv_transform := Transform2D(0.0, scale, 0.0, Vector2(material.uv1_offset.x, material.uv1_offset.y))
		appearance.arrays = appearance.arrays.duplicate()
		appearance.arrays[Mesh.ARRAY_TEX_UV] = uv_transform * (uvs as PackedVector2Array)


## Reads the parameters with common names, and the render modes, of a custom shader.
func _read_shader(material: ShaderMaterial, appearance: Appearance) -> void:
	if material.shader == null:
		return
	var color: Variant = Parameters.value_of(material, Parameters.COLORS, TYPE_COLOR)
	var texture: Variant = Parameters.value_of(material, Parameters.TEXTURES, TYPE_OBJECT)
	var threshold: Variant = Parameters.value_of(material, Parameters.THRESHOLDS, TYPE_FLOAT)
	var code := material.shader.code
	appearance.albedo = color if color != null else Color.WHITE
	appearance.texture = _image_of(texture as Texture2D, material)
	if threshold != null:
		appearance.alpha_threshold = clampf(threshold, 0.0, 1.0)
	elif code.contains("ALPHA") or code.contains("discard"):
		appearance.alpha_threshold = HALF
	if code.contains("cull_disabled"):
		appearance.cull_mode = _constant(&"CULL_DISABLED")
	elif code.contains("cull_front"):
		appearance.cull_mode = _constant(&"CULL_FRONT")
	if appearance.arrays[Mesh.ARRAY_COLOR] != null and Parameters.has_word(code, "COLOR"):
		appearance.vertex_colors = _constant(&"VERTEX_COLOR_LINEAR")
	var custom_roughness: Variant = Parameters.value_of(material, [&"roughness"], TYPE_FLOAT)
	appearance.roughness = clampf(custom_roughness, 0.0, 1.0) if custom_roughness != null else appearance.roughness
	var custom_specular: Variant = Parameters.value_of(material, [&"specular"], TYPE_FLOAT)
	appearance.specular = clampf(custom_specular, 0.0, 1.0) if custom_specular != null else appearance.specular
	var custom_backlight: Variant = Parameters.value_of(material, [&"backlight"], TYPE_COLOR)
	appearance.backlight = custom_backlight if custom_backlight != null else appearance.backlight
	if color == null and texture == null:
		_warn("%s is baked white: its shader has no parameter with a common name for a color or a texture (%s, %s). Set stand_ins."
				% [_name_of(material), Parameters.COLORS[0], Parameters.TEXTURES[0]])


func _image_of(texture: Texture2D, material: Material) -> Image:
	if texture == null:
		return null
	if not _images.has(texture):
		_images[texture] = texture.get_image()
	if _images[texture] == null or _images[texture].is_empty():
		_warn("%s is baked without its texture %s, whose pixels cannot be read. Set stand_ins, or use an imported image." % [
				_name_of(material), texture.resource_path if texture.resource_path else texture.get_class()])
		return null
	return _images[texture]


func _warn(message: String) -> void:
	if not warnings.has(message):
		warnings.append(message)


static func _name_of(material: Material) -> String:
	if not material.resource_name.is_empty():
		return "The material '%s'" % material.resource_name
	return "The material %s" % (material.resource_path if not material.resource_path.is_empty() else material.get_class())


static func _area_of(arrays: Array, transform: Transform3D) -> float:
	var vertices: PackedVector3Array = transform * (arrays[Mesh.ARRAY_VERTEX] as PackedVector3Array)
	var indices := PackedInt32Array(range(vertices.size()))
	if arrays[Mesh.ARRAY_INDEX] != null:
		indices = arrays[Mesh.ARRAY_INDEX]
	var sum := 0.0
	for first in range(0, indices.size() - 2, 3):
		var corner := vertices[indices[first]]
		sum += 0.5 * (vertices[indices[first + 1]] - corner).cross(vertices[indices[first + 2]] - corner).length()
	return sum
