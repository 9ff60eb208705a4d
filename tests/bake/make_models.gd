extends SceneTree
## Saves the meshes that only the small test bake uses. Argument: the folder.


func _initialize() -> void:
	var folder := OS.get_cmdline_user_args()[0]
	var tuft := SphereMesh.new()
	tuft.radius = 0.25
	ResourceSaver.save(tuft, folder.path_join("2_0.res"))
	ResourceSaver.save(_rock(), folder.path_join("0_1.res"))
	quit()


## Returns a mesh of two boxes, 2 m apart, with a shader whose color is a vec3 uniform.
func _rock() -> ArrayMesh:
	var gray := ShaderMaterial.new()
	gray.shader = Shader.new()
	gray.shader.code = "shader_type spatial; uniform vec3 base_color; void fragment() { ALBEDO = base_color; }"
	gray.set_shader_parameter(&"base_color", Vector3(0.5, 0.25, 0.5))
	var tool := SurfaceTool.new()
	tool.set_material(gray)
	for height: float in [0.0, 2.0]:
		tool.append_from(BoxMesh.new(), 0, Transform3D(Basis.IDENTITY, Vector3(0.0, height, 0.0)))
	return tool.commit()
