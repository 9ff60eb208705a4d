@tool
extends WorldEnvironment
## The light of the demo's scenes: hands the shared noise to the sky's shader, past the resource, so that the scene never stores the
## texture, and has the same afternoon in each renderer.
##
## The numbers in the scenes are for the Compatibility renderer, which lights in sRGB. The others light in linear space, where the same
## numbers give less light and more haze.

const NoiseTexture := preload("res://terrain/noise_texture.gd")

## How many times as bright as in the Compatibility renderer, in linear space.
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
