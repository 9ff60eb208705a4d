@tool
extends WorldEnvironment
## The light of the demo's scenes, adjusted so that it looks the same in every renderer. The node also sets the shared noise texture on the sky's
## shader, through the RenderingServer, so that the scene never stores the texture.
##
## The values in the scenes are for the Compatibility renderer, which computes lighting in sRGB. The other renderers use linear space, where
## the same values result in less light and more haze.

const NoiseTexture := preload("res://terrain/noise_texture.gd")

## Factors for the brightness of the sun, of the ambient light and of the fog in renderers that use linear space.
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
