extends RefCounted
## Bakes an octahedral impostor of a model: a mesh of two triangles with a material of its own that shows the model from wherever
## one looks, lit by the lights that are there. For the last entry of a layer's [member ScatterLayer.lod_meshes].
##
## Needs neither an editor nor a renderer, so it works headless as well:
## [codeblock]
## var impostor := preload("res://addons/thicket/impostor.gd").new()
## var far := impostor.bake([load("res://oak.res")])
## if far == null:
##     print(impostor.problem)
## else:
##     ResourceSaver.save(far, "res://oak_impostor.res")
## [/codeblock]
## [method bake] waits for the pictures, which takes seconds; [method begin] leaves them to another thread.

const Reader := preload("res://addons/thicket/impostor_materials.gd")
const SHADER := preload("res://addons/thicket/shaders/impostor.gdshader")

## Pixels of an impostor for one of the screen where it takes over: pictures that are mixed lose some sharpness.
const DETAIL := 1.75

## Pictures on a side of the atlas, 2 to 32, taken from all directions above the ground, or from all with
## [member full_sphere]. More of them follow a model's shape more closely.
var frames := 16
## Pixels on a side of a picture: a power of two, 16 to 512. The side of the atlas, [code]frames * frame_size[/code], is 8192 at most.
var frame_size := 128
## Samples on a side of a pixel, 1 to 8. Time grows with their square.
var samples := 2
## Also from below, for what floats or can be looked at from underneath; the same pictures are shared out over more directions then.
var full_sphere := false
## Replaces all materials; as [member ScatterLayer.material_override].
var material_override: Material
## Materials to bake instead of others: for shaders whose colors cannot be known without a renderer.
var stand_ins: Dictionary[Material, BaseMaterial3D] = {}

## What went wrong, in a sentence; empty while nothing has.
var problem := ""
## What could not be taken over from materials, in sentences.
var warnings := PackedStringArray()

var _baker: RefCounted # An ScatterImpostorBaker; the editor reads this script where the library is missing, too.
var _reader: Reader
var _task := -1


func _notification(what: int) -> void:
	if what == NOTIFICATION_PREDELETE and _task >= 0:
		_baker.cancel()
		WorkerThreadPool.wait_for_task_completion(_task)


## Bakes meshes, each moved by the transform of the same index, if there is one, as one model. Returns null, with the reason in
## [member problem], where that cannot be.
func bake(meshes: Array[Mesh], transforms: Array[Transform3D] = []) -> ArrayMesh:
	if begin(meshes, transforms) != OK:
		return null
	return finish()


## Begins what [method bake] does, on another thread. Ask [method is_baking], then call [method finish].
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
		return _refuse(ERR_PARAMETER_RANGE_ERROR, "frames must be 2 to 32, frame_size a power of two from 16 to 512, frames * frame_size at most 8192, "
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
		return _refuse(ERR_INVALID_DATA, "There are no triangles to bake: meshes must have one with triangles, got %d meshes." % meshes.size())
	_task = WorkerThreadPool.add_task(_baker.bake, false, "Bake an impostor")
	return OK


## Whether pictures are still being taken.
func is_baking() -> bool:
	return _task >= 0 and not WorkerThreadPool.is_task_completed(_task)


## Of the pictures that [method begin] asked for: 0 to 1.
func get_progress() -> float:
	return _baker.get_progress() if _baker != null else 0.0


## Waits for the pictures and returns the impostor; null, with the reason in [member problem], where there is none.
func finish() -> ArrayMesh:
	if _task < 0:
		return null
	WorkerThreadPool.wait_for_task_completion(_task)
	_task = -1
	var albedo: Image = _baker.get_albedo_image()
	if albedo == null:
		_refuse(FAILED, "The impostor cannot be baked; the error that was printed says why.")
		return null
	return _mesh_of(albedo, _baker.get_normal_image())


## Gives up what has been begun. Without effect when nothing is under way.
func cancel() -> void:
	if _task >= 0:
		_baker.cancel()
		WorkerThreadPool.wait_for_task_completion(_task)
		_task = -1


## The distance in meters from which on an impostor can stand for its model: a pixel of the screen is [constant DETAIL] of its own
## there. [param fov] is the camera's vertical angle in degrees, [param height] that of the picture in pixels. 0 for any other mesh.
static func switch_distance(impostor: Mesh, fov := 75.0, height := 1080.0) -> float:
	var material := impostor.surface_get_material(0) as ShaderMaterial if impostor.get_surface_count() == 1 else null
	if material == null or material.shader != SHADER:
		return 0.0
	var radius: float = material.get_shader_parameter(&"impostor_radius")
	var size: int = material.get_shader_parameter(&"impostor_frame_size")
	return DETAIL * radius * height / (size * tan(deg_to_rad(fov) * 0.5))


func _refuse(error: Error, why: String) -> Error:
	problem = why
	return error


func _add(mesh: Mesh, transform: Transform3D) -> Error:
	if mesh == null:
		return _refuse(ERR_INVALID_PARAMETER, "A mesh is missing: an entry of meshes is null. Remove it, or set a mesh.")
	for surface in mesh.get_surface_count():
		if mesh is ArrayMesh and (mesh as ArrayMesh).surface_get_primitive_type(surface) != Mesh.PRIMITIVE_TRIANGLES:
			_reader.warnings.append("Surface %d of %s has no triangles and is left out: impostors show triangles only." % [surface, _name_of(mesh)])
			continue
		var material := material_override if material_override != null else mesh.surface_get_material(surface)
		var arrays := mesh.surface_get_arrays(surface)
		var look := _reader.read(material, arrays, transform)
		var error: Error = _baker.add_surface(look.arrays, transform, look.albedo, look.texture, look.alpha_threshold,
				look.cull_mode, look.vertex_colors)
		if error != OK:
			return _refuse(error, "Surface %d of %s cannot be baked; the error that was printed says why." % [surface, _name_of(mesh)])
	return OK


static func _name_of(mesh: Mesh) -> String:
	return mesh.resource_path if not mesh.resource_path.is_empty() else "the mesh '%s'" % mesh.resource_name


## A quad whose box is the model's, so that nothing that is culled by it is missed; the shader turns it to the camera.
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


## Stored without loss, and small; [ImageTexture] would be stored as it lies in memory.
static func _texture_of(image: Image) -> Texture2D:
	var texture := PortableCompressedTexture2D.new()
	texture.keep_compressed_buffer = true # Without an editor it could not be stored otherwise.
	texture.create_from_image(image, PortableCompressedTexture2D.COMPRESSION_MODE_LOSSLESS)
	return texture
