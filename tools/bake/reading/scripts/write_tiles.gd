extends SceneTree
## Writes the tiles of a bake as files for ScatterBakedWorld, without the extension. godot.py sends the jobs.

const JobReader := preload("job_reader.gd")
const Models := preload("read_models.gd")
const BakedFile := preload("res://addons/thicket/baked_world_file.gd")
const Index := preload("res://addons/thicket/baked_world_index.gd")
const World := preload("res://addons/thicket/baked_world.gd")

const UNWRITABLE := "Cannot write %s: %s. Check that its folder is writable and the disk has room."

var _reader := JobReader.new()
var _meshes: Array[Mesh] = []
var _materials: Array[Material] = []
var _digests := PackedByteArray() # The digests of the tiles, in the order of writing.


func _initialize() -> void:
	# Procedural meshes are built at the end of a frame.
	await process_frame
	while _reader.read():
		var problem := ""
		match _reader.job.do:
			"mesh":
				problem = await _add_mesh(_reader.job)
			"material":
				problem = _add_material(_reader.job)
			"tile":
				problem = _write_tile(_reader.job, _reader.payload)
			"world":
				problem = _write_world(_reader.job, _reader.payload)
		_reader.answer({"problem": problem} if problem else {})
	_meshes.clear()
	_materials.clear()
	quit()


func _add_mesh(job: Dictionary) -> String:
	var models := Models.new()
	var mesh := models.mesh_at(job.path)
	await process_frame
	await process_frame
	if mesh == null:
		return models.problem
	if mesh.resource_path == job.own and mesh is ArrayMesh and mesh.get_script() != null:
		mesh = _without_script(mesh)
	# Save a mesh that has no file to a file. Otherwise every tile would store the mesh.
	if mesh.resource_path.is_empty() or "::" in mesh.resource_path:
		var error := ResourceSaver.save(mesh, job.own, ResourceSaver.FLAG_COMPRESS)
		if error != OK:
			return UNWRITABLE % [job.own, error_string(error)]
		mesh = ResourceLoader.load(job.own, "", ResourceLoader.CACHE_MODE_REPLACE)
		if mesh == null:
			return "%s was written but cannot be loaded: export again." % job.own
	_meshes.append(mesh)
	return ""


## Returns a copy of a procedural mesh without its script, so that a game needs neither the script nor the time to rebuild the mesh.
func _without_script(mesh: ArrayMesh) -> ArrayMesh:
	var copy := ArrayMesh.new()
	copy.set(&"_surfaces", mesh.get(&"_surfaces"))
	copy.resource_name = mesh.resource_name
	return copy


func _add_material(job: Dictionary) -> String:
	var material := ResourceLoader.load(job.path) as Material
	if material == null:
		return "%s cannot be loaded as a material: check that it is in the project." % job.path
	if not Index.is_in_project(material.resource_path):
		return "%s is a material inside another file, to which tiles cannot refer: save it to a separate file." % job.path
	_materials.append(material)
	return ""


func _write_tile(job: Dictionary, payload: PackedByteArray) -> String:
	var nodes: Array[Dictionary] = []
	for entry: Dictionary in job.nodes:
		nodes.append({
			"name": entry.name, "mesh": entry.mesh, "material": entry.material, "count": entry.count, "from": entry.from,
			"use_colors": entry.use_colors, "use_custom_data": entry.use_custom_data, "cast_shadow": entry.cast_shadow,
			"render_layers": entry.render_layers, "begin": entry.begin, "end": entry.end, "box": _box(entry) if entry.has("least") else null,
		})
	var header := {"tile": job.tile, "instances": job.instances, "scene_digest": job.scene_digest, "nodes": nodes}
	var content := BakedFile.packed(header, payload)
	_digests.append_array(BakedFile.digest_in(content))
	return _write(content, job.file)


## Returns the bounding box of everything that any LOD of a model draws. The engine measures distances from the center of a node's box, so all LODs of
## a model need the same box. Otherwise there would be gaps between the LODs.
func _box(entry: Dictionary) -> Array[float]:
	var least := Vector3(entry.least[0], entry.least[1], entry.least[2])
	var greatest := Vector3(entry.greatest[0], entry.greatest[1], entry.greatest[2])
	var radius := 0.0
	for mesh: int in entry.meshes:
		var box := _meshes[mesh].get_aabb()
		for corner in 8:
			radius = maxf(radius, box.get_endpoint(corner).length())
	var box := AABB(least, greatest - least).grow(radius * float(entry.largest_scale))
	return [box.position.x, box.position.y, box.position.z, box.size.x, box.size.y, box.size.z]


func _write_world(job: Dictionary, payload: PackedByteArray) -> String:
	var index := Index.new()
	index.scene_digest = job.scene_digest
	index.tile_size = job.tile_size
	index.world_offset = PackedFloat64Array(job.world_offset)
	index.layer_names = PackedStringArray(job.layer_names)
	index.meshes = PackedStringArray(_meshes.map(func(mesh: Mesh) -> String: return mesh.resource_path))
	index.materials = PackedStringArray(_materials.map(func(material: Material) -> String: return material.resource_path))
	var count := int(job.count)
	index.tiles = payload.slice(0, count * 8).to_int32_array()
	index.instances = payload.slice(count * 8, count * 12).to_int32_array()
	index.centers = payload.slice(count * 12, count * 36).to_float64_array()
	index.digests = _digests
	var problem := _write(index.packed(), job.index)
	if problem:
		return problem
	var world := World.new()
	world.name = "ScatterBakedWorld"
	world.index_file = job.index
	var scene := PackedScene.new()
	var error := scene.pack(world)
	world.free()
	return _save(scene, job.scene) if error == OK else "Cannot pack the scene of %s: %s." % [job.scene, error_string(error)]


func _write(content: PackedByteArray, path: String) -> String:
	var partial := path + ".partial"
	var file := FileAccess.open(partial, FileAccess.WRITE)
	if file == null:
		return _finish(partial, path, FileAccess.get_open_error())
	var error := OK
	if not file.store_buffer(content):
		error = ERR_FILE_CANT_WRITE
	file.close()
	return _finish(partial, path, error)


func _save(resource: Resource, path: String) -> String:
	var partial := "%s.partial.%s" % [path.get_basename(), path.get_extension()]
	return _finish(partial, path, ResourceSaver.save(resource, partial, ResourceSaver.FLAG_COMPRESS))


## Moves a file to its final path if [param error] is OK, which means that the file is complete. Returns an error
## message, or "" if there is no error.
func _finish(partial: String, path: String, error: Error) -> String:
	if error == OK:
		error = DirAccess.rename_absolute(partial, path)
	return "" if error == OK else UNWRITABLE % [path, error_string(error)]
