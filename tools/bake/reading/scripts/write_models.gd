extends SceneTree
## Writes models as binary glTF, one mesh each, for gltf.py.

const JobReader := preload("job_reader.gd")
const Models := preload("read_models.gd")
# Use the script of this checkout, because the project may have only the part of the add-on that displays bakes.
const Parameters := preload("../../../../demo_project/addons/thicket/shader_parameters.gd")

var _reader := JobReader.new()


func _initialize() -> void:
	# Procedural meshes are built at the end of a frame.
	await process_frame
	while _reader.read():
		var models := Models.new()
		var mesh := models.mesh_at(_reader.job.path)
		await process_frame
		await process_frame
		_reader.answer({"reason": models.problem if mesh == null else _write(mesh, _reader.job.file)})
	quit()


func _write(mesh: Mesh, file: String) -> String:
	var scene := Node3D.new()
	var instance := MeshInstance3D.new()
	instance.mesh = mesh
	for surface: int in mesh.get_surface_count():
		var material := mesh.surface_get_material(surface)
		if material is ShaderMaterial:
			instance.set_surface_override_material(surface, _standard_material(material))
	scene.add_child(instance)
	var state := GLTFState.new()
	var document := GLTFDocument.new()
	var error := document.append_from_scene(scene, state)
	if error == OK:
		error = document.write_to_filesystem(state, file)
	scene.free()
	return "" if error == OK else "it cannot be written as glTF: %s" % error_string(error)


## Converts a shader material to a standard material, because glTF has no shaders. Keeps only the vertex colors, and a color and a texture if their
## parameters have common names.
func _standard_material(shader_material: ShaderMaterial) -> StandardMaterial3D:
	var standard_material := StandardMaterial3D.new()
	standard_material.resource_name = shader_material.resource_name
	standard_material.vertex_color_use_as_albedo = true
	standard_material.cull_mode = BaseMaterial3D.CULL_DISABLED
	if shader_material.shader == null:
		return standard_material
	var color: Variant = Parameters.value_of(shader_material, Parameters.COLORS, TYPE_COLOR)
	if color != null:
		standard_material.albedo_color = color
	var texture: Variant = Parameters.value_of(shader_material, Parameters.TEXTURES, TYPE_OBJECT)
	if texture != null:
		standard_material.albedo_texture = texture
		standard_material.transparency = BaseMaterial3D.TRANSPARENCY_ALPHA_SCISSOR
	return standard_material
