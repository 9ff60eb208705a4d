extends RefCounted
## Finds the common parameters of custom shaders, such as the color, by name. Use it to read materials without rendering them.

## The names of colors, of color textures and of alpha thresholds, the most common first.
const COLORS: Array[StringName] = [&"albedo", &"albedo_color", &"base_color", &"color", &"tint"]
const TEXTURES: Array[StringName] = [
	&"texture_albedo", &"albedo_texture", &"albedo_map", &"base_color_texture", &"color_texture", &"main_texture", &"diffuse_texture",
]
const THRESHOLDS: Array[StringName] = [
	&"alpha_scissor_threshold", &"alpha_scissor", &"alpha_threshold", &"alpha_cutoff",
]


## Returns the value of the first parameter in [param names] that has the type, and is set or has a known default. Returns null if there is none. A
## [Vector3] is converted to a color. Objects are returned only if they are textures.
static func value_of(material: ShaderMaterial, names: Array[StringName], type: Variant.Type) -> Variant:
	for name in names:
		# A material keeps parameters that were set for a previous shader, so the code must contain the name. Includes may define any name.
		if not has_word(material.shader.code, name) and not material.shader.code.contains("#include"):
			continue
		var value: Variant = material.get_shader_parameter(name)
		if value == null:
			value = RenderingServer.shader_get_parameter_default(material.shader.get_rid(), name)
		if value is Vector3:
			value = Color(value.x, value.y, value.z)
		if typeof(value) == type and (type != TYPE_OBJECT or value is Texture2D):
			return value
	return null


static func has_word(code: String, word: String) -> bool:
	return RegEx.create_from_string("\\b%s\\b" % word).search(code) != null
