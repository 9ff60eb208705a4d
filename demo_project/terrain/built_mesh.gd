@tool
extends MeshInstance3D
## The base class of nodes whose mesh is built when they enter the tree, and is not stored in the scene.

const NoiseTexture := preload("res://terrain/noise_texture.gd")

## The material of the mesh. The node sets the shared noise texture on it.
@export var material: ShaderMaterial


## Builds the mesh. The scripts that extend this class override it.
func build() -> ArrayMesh:
	return null


func _validate_property(property: Dictionary) -> void:
	if property.name == "mesh":
		property.usage &= ~PROPERTY_USAGE_STORAGE


func _enter_tree() -> void:
	if mesh != null:
		return
	mesh = build()
	mesh.surface_set_material(0, material)
	if material != null:
		RenderingServer.material_set_param(material.get_rid(), &"noise", NoiseTexture.texture().get_rid())
