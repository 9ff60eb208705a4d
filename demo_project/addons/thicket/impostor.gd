extends RefCounted
## Bakes an octahedral impostor of a model: a mesh of two triangles with a material that shows the model from any direction and in the scene's light.
## Use it as the last of [member ScatterModel.lods] or [member ScatterModel.far_lods].
##
## The bake needs neither an editor nor a renderer, so it also works headless:
## [codeblock]
## var impostor := preload("res://addons/thicket/impostor.gd").new()
## var far := impostor.bake([load("res://oak.res")])
## if far == null:
##     print(impostor.problem)
## else:
##     ResourceSaver.save(far, "res://oak_impostor.res")
## [/codeblock]
## [method bake] blocks until the views are rendered, which takes seconds. [method begin] renders them on another thread.

const Reader := preload("res://addons/thicket/impostor_materials.gd")
const SHADER := preload("res://addons/thicket/shaders/impostor.gdshader")

## The number of impostor pixels per screen pixel at the switch distance. It is above 1, because blending views loses some sharpness.
const DETAIL := 1.75

## The number of views along each side of the atlas, from 2 to 32. They show the model from all directions above the
## ground or, with [member full_sphere], from all directions. More views reproduce a model's shape more closely.
var frames := 16
## The width and height of a view in pixels: a power of two from 16 to 512. The width of the atlas, [code]frames *
## frame_size[/code], is at most 8192.
var frame_size := 128
## The number of samples along each axis of a pixel, from 1 to 8. The time grows with the square of this number.
var samples := 2
## If true, the impostor also shows the model from below, for models that float or can be seen from underneath. The same
## number of views then covers more directions.
var full_sphere := false
## The material that replaces all materials, like [member ScatterLayer.material_override]; null for none.
var material_override: Material
## Substitutes for materials, the keys of the dictionary. Use them for shaders whose colors cannot be determined without a renderer.
var stand_ins: Dictionary[Material, BaseMaterial3D] = {}

## The error message; empty if there is none.
var problem := ""
## Warnings about material properties that the impostor cannot reproduce, one message each.
var warnings := PackedStringArray()

var _baker: RefCounted # A ScatterImpostorBaker. The class is not named as a type, because the editor also compiles this script without the library.
var _reader: Reader
var _task := -1


func _notification(what: int) -> void:
	if what == NOTIFICATION_PREDELETE and _task >= 0:
		_baker.cancel()
		WorkerThreadPool.wait_for_task_completion(_task)


## Bakes meshes as one model. Each mesh is transformed by the transform with the same index, if there is one. On failure, returns null
## and sets [member problem].
func bake(meshes: Array[Mesh], transforms: Array[Transform3D] = []) -> ArrayMesh:
	if begin(meshes, transforms) != OK:
		return null
	return finish()


## Reads the meshes and starts to render their views on another thread. Call [method is_baking] until it returns false, then
## [method finish]. On failure, returns an error and sets [member problem].
func begin(meshes: Array[Mesh], transforms: Array[Transform3D] = []) -> Error:
	cancel()
	problem = ""
	warnings.clear()
	_baker = ClassDB.instantiate(&"ScatterImpostorBaker")
	_baker.frames = frames
	_baker.frame_size = frame_size
	_baker.samples = samples
	_baker.full_sphere = full_sphere
	if _baker.frames != frames or _baker.frame_size != frame_size or _baker.samples != samples:
		return _fail(ERR_PARAMETER_RANGE_ERROR, "frames must be 2 to 32, frame_size a power of two from 16 to 512, frames * frame_size at most 8192, "
				+ "samples 1 to 8; got %d, %d and %d." % [frames, frame_size, samples])
	_reader = Reader.new()
	_reader.stand_ins = stand_ins
	for index in meshes.size():
		var transform := transforms[index] if index < transforms.size() else Transform3D.IDENTITY
		var error := _add(meshes[index], transform)
		if error != OK:
			return error
	warnings = _reader.warnings
	if _reader.area <= 0.0:
		return _fail(ERR_INVALID_DATA, "There are no triangles to bake: at least one mesh must have triangles, got %d meshes." % meshes.size())
	_task = WorkerThreadPool.add_task(_baker.bake, false, "Bake an impostor")
	return OK


## Returns true while views are being rendered.
func is_baking() -> bool:
	return _task >= 0 and not WorkerThreadPool.is_task_completed(_task)


## Returns the finished fraction of the views, from 0 to 1.
func get_progress() -> float:
	return _baker.get_progress() if _baker != null else 0.0


## Waits for the views and returns the impostor. On failure, returns null and sets [member problem]. Also returns null if no bake is in
## progress.
func finish() -> ArrayMesh:
	if _task < 0:
		return null
	WorkerThreadPool.wait_for_task_completion(_task)
	_task = -1
	var albedo: Image = _baker.get_albedo_image()
	if albedo == null:
		_fail(FAILED, "The impostor cannot be baked. See the Output panel for details.")
		return null
	return _mesh_of(albedo, _baker.get_normal_image())


## Stops a bake in progress. Has no effect if none is in progress.
func cancel() -> void:
	if _task >= 0:
		_baker.cancel()
		WorkerThreadPool.wait_for_task_completion(_task)
		_task = -1


## Returns the distance in meters from which an impostor can replace its model. At that distance, [constant DETAIL] pixels of the
## impostor cover one pixel of the screen. [param fov] is the camera's vertical field of view in degrees, and [param height] is the
## height of the viewport in pixels. Returns 0 for a mesh that is not an impostor.
static func switch_distance(impostor: Mesh, fov := 75.0, height := 1080.0) -> float:
	var material := impostor.surface_get_material(0) as ShaderMaterial if impostor.get_surface_count() == 1 else null
	if material == null or material.shader != SHADER:
		return 0.0
	var radius: float = material.get_shader_parameter(&"impostor_radius")
	var size: int = material.get_shader_parameter(&"impostor_frame_size")
	return DETAIL * radius * height / (size * tan(deg_to_rad(fov) * 0.5))


func _fail(error: Error, message: String) -> Error:
	problem = message
	return error


func _add(mesh: Mesh, transform: Transform3D) -> Error:
	if mesh == null:
		return _fail(ERR_INVALID_PARAMETER, "A mesh is missing: an entry of meshes is null. Remove it, or set a mesh.")
	for surface in mesh.get_surface_count():
		if mesh is ArrayMesh and (mesh as ArrayMesh).surface_get_primitive_type(surface) != Mesh.PRIMITIVE_TRIANGLES:
			_reader.warnings.append("Surface %d of %s has no triangles and is skipped: impostors show only triangles." % [surface, _name_of(mesh)])
			continue
		var material := material_override if material_override != null else mesh.surface_get_material(surface)
		var arrays := mesh.surface_get_arrays(surface)
		var appearance := _reader.read(material, arrays, transform)
		var error: Error = _baker.add_surface(appearance.arrays, transform, appearance.albedo, appearance.texture, appearance.alpha_threshold,
				appearance.cull_mode, appearance.vertex_colors)
		if error != OK:
			return _fail(error, "Surface %d of %s cannot be baked. See the Output panel for details." % [surface, _name_of(mesh)])
	return OK


static func _name_of(mesh: Mesh) -> String:
	return mesh.resource_path if not mesh.resource_path.is_empty() else "the mesh '%s'" % mesh.resource_name


## Builds a quad with the model's bounding box, so that culling does not hide visible parts. The shader turns the quad toward the camera.
func _mesh_of(albedo: Image, normal: Image) -> ArrayMesh:
	var box: AABB = _baker.get_box()
	var arrays := []
	arrays.resize(Mesh.ARRAY_MAX)
	arrays[Mesh.ARRAY_VERTEX] = PackedVector3Array([
		Vector3(box.position.x, box.end.y, box.position.z), box.end,
		Vector3(box.end.x, box.position.y, box.end.z), box.position,
	])
	arrays[Mesh.ARRAY_NORMAL] = PackedVector3Array([Vector3.UP, Vector3.UP, Vector3.UP, Vector3.UP])
	arrays[Mesh.ARRAY_TEX_UV] = PackedVector2Array([Vector2(0, 0), Vector2(1, 0), Vector2(1, 1), Vector2(0, 1)])
	arrays[Mesh.ARRAY_INDEX] = PackedInt32Array([0, 1, 2, 0, 2, 3])
	var mesh := ArrayMesh.new()
	mesh.add_surface_from_arrays(Mesh.PRIMITIVE_TRIANGLES, arrays)
	var material := ShaderMaterial.new()
	material.shader = SHADER
	material.set_shader_parameter(&"impostor_albedo", _texture_of(albedo))
	material.set_shader_parameter(&"impostor_normal", _texture_of(normal))
	material.set_shader_parameter(&"impostor_frames", frames)
	material.set_shader_parameter(&"impostor_frame_size", frame_size)
	material.set_shader_parameter(&"impostor_full_sphere", full_sphere)
	material.set_shader_parameter(&"impostor_center", _baker.get_center())
	material.set_shader_parameter(&"impostor_radius", _baker.get_radius())
	material.set_shader_parameter(&"roughness", _reader.roughness / _reader.area)
	material.set_shader_parameter(&"specular", _reader.specular / _reader.area)
	material.set_shader_parameter(&"backlight", _reader.backlight / _reader.area)
	mesh.surface_set_material(0, material)
	return mesh


## Returns a texture that is stored with lossless compression. An [ImageTexture] would be stored uncompressed.
static func _texture_of(image: Image) -> Texture2D:
	var texture := PortableCompressedTexture2D.new()
	texture.keep_compressed_buffer = true # Without this, the texture could not be saved outside of the editor.
	texture.create_from_image(image, PortableCompressedTexture2D.COMPRESSION_MODE_LOSSLESS)
	return texture
