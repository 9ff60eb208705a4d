@tool
extends WorldEnvironment
## The light of the demo's scenes. It sets the shared noise on the sky's shader through the RenderingServer, so that the scene never
## stores the texture. It also makes the afternoon look the same in each renderer.
##
## The numbers in the scenes are for the Compatibility renderer, which lights in sRGB. The others light in linear space, where the same
## numbers result in less light and more haze.

const NoiseTexture := preload("res://terrain/noise_texture.gd")

## Factors of brightness relative to the Compatibility renderer, in linear space.
const SUN := 1.8
const AMBIENT := 1.4
const FOG := 1.7


func _ready() -> void:
	if environment == null:
		return
	if environment.sky != null and environment.sky.sky_material is ShaderMaterial:
		RenderingServer.material_set_param(environment.sky.sky_material.get_rid(), &"noise",
				NoiseTexture.texture().get_rid())
	if not Engine.is_editor_hint() and RenderingServer.get_current_rendering_method() != "gl_compatibility":
		var sun := get_node(^"../Sun") as DirectionalLight3D
		sun.light_energy *= SUN
		environment = environment.duplicate()
		environment.ambient_light_energy *= AMBIENT
		environment.fog_light_energy *= FOG
