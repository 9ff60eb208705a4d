@tool
extends MeshInstance3D
## Hands the shared noise to the water's shader, past the resource, so that the scene never stores the texture.

const NoiseTexture := preload("res://terrain/noise_texture.gd")


func _ready() -> void:
	if material_override != null:
		RenderingServer.material_set_param(material_override.get_rid(), &"noise", NoiseTexture.texture().get_rid())
