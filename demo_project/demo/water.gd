@tool
extends MeshInstance3D
## Sets the shared noise on the water's shader through the RenderingServer, so that the scene never stores the
## texture.

const NoiseTexture := preload("res://terrain/noise_texture.gd")


func _ready() -> void:
	if material_override != null:
		RenderingServer.material_set_param(material_override.get_rid(), &"noise", NoiseTexture.texture().get_rid())
