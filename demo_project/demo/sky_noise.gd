@tool
extends WorldEnvironment
## Hands the shared noise to the sky's shader, past the resource, so that the scene never stores the texture.

const NoiseTexture := preload("res://terrain/noise_texture.gd")


func _ready() -> void:
	if environment != null and environment.sky != null and environment.sky.sky_material is ShaderMaterial:
		RenderingServer.material_set_param(environment.sky.sky_material.get_rid(), &"noise",
				NoiseTexture.texture().get_rid())
