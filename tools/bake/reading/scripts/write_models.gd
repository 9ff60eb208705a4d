extends SceneTree
## Writes models as binary glTF, one mesh each, for gltf.py.

const JobReader := preload("job_reader.gd")
const Models := preload("read_models.gd")
## What shaders call a color, and a picture of colors.
const COLORS: Array[StringName] = [&"albedo", &"albedo_color", &"base_color", &"color", &"tint"]
const TEXTURES: Array[StringName] = [&"albedo_texture", &"texture_albedo", &"base_color_texture", &"color_texture"]

var _reader := JobReader.new()


func _initialize() -> void:
	# Meshes that build themselves do so at the end of a frame.
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
			instance.set_surface_override_material(surface, _plain(material))
	scene.add_child(instance)
	var state := GLTFState.new()
	var document := GLTFDocument.new()
	var error := document.append_from_scene(scene, state)
	if error == OK:
		error = document.write_to_filesystem(state, file)
	scene.free()
	return "" if error == OK else "it cannot be written as glTF: %s" % error_string(error)


## glTF has no shaders: what is left are the colors of vertices, and a color and a picture by their usual names.
func _plain(shaded: ShaderMaterial) -> StandardMaterial3D:
	var plain := StandardMaterial3D.new()
	plain.resource_name = shaded.resource_name
	plain.vertex_color_use_as_albedo = true
	plain.cull_mode = BaseMaterial3D.CULL_DISABLED
	for parameter in COLORS:
		var value: Variant = shaded.get_shader_parameter(parameter)
		if value is Color:
			plain.albedo_color = value
			break
	for parameter in TEXTURES:
		var value: Variant = shaded.get_shader_parameter(parameter)
		if value is Texture2D:
			plain.albedo_texture = value
			plain.transparency = BaseMaterial3D.TRANSPARENCY_ALPHA_SCISSOR
			break
	return plain
