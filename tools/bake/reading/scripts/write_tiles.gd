extends SceneTree
## Writes the tiles of a bake as scenes of MultiMeshInstance3Ds, without the extension. godot.py says what to write.

const JobReader := preload("job_reader.gd")
const Models := preload("read_models.gd")
const Index := preload("res://addons/thicket/baked_world_index.gd")
const World := preload("res://addons/thicket/baked_world.gd")

var _reader := JobReader.new()
var _meshes: Array[Mesh] = []
var _materials: Array[Material] = []
var _folder := ""


func _initialize() -> void:
	# Meshes that build themselves do so at the end of a frame.
	await process_frame
	while _reader.read():
		var problem := ""
		match _reader.job.do:
			"mesh":
				problem = await _take_mesh(_reader.job)
			"material":
				problem = _take_material(_reader.job)
			"tile":
				problem = _write_tile(_reader.job, _reader.payload)
			"world":
				problem = _write_world(_reader.job, _reader.payload)
		_reader.answer({"problem": problem} if problem else {})
	_meshes.clear()
	_materials.clear()
	quit()


func _take_mesh(job: Dictionary) -> String:
	var models := Models.new()
	var mesh := models.mesh_at(job.path)
	await process_frame
	await process_frame
	if mesh == null:
		return models.problem
	if mesh.resource_path == job.own and mesh is ArrayMesh and mesh.get_script() != null:
		mesh = _built(mesh)
	# What lies in no file of its own would be in every tile again.
	if mesh.resource_path.is_empty() or "::" in mesh.resource_path:
		var error := ResourceSaver.save(mesh, job.own, ResourceSaver.FLAG_COMPRESS)
		if error != OK:
			return "Cannot write %s: %s. Check that its folder has room and may be written." % [job.own, error_string(error)]
		mesh = ResourceLoader.load(job.own, "", ResourceLoader.CACHE_MODE_REPLACE)
		if mesh == null:
			return "%s was written and cannot be loaded: export again." % job.own
	_meshes.append(mesh)
	return ""


## What a mesh that builds itself has built, so that a game neither needs its script nor builds it anew.
func _built(mesh: ArrayMesh) -> ArrayMesh:
	var plain := ArrayMesh.new()
	plain.set(&"_surfaces", mesh.get(&"_surfaces"))
	plain.resource_name = mesh.resource_name
	return plain


func _take_material(job: Dictionary) -> String:
	var material := ResourceLoader.load(job.path) as Material
	if material == null:
		return "%s cannot be loaded as a material: is it in the project?" % job.path
	_materials.append(material)
	return ""


func _write_tile(job: Dictionary, payload: PackedByteArray) -> String:
	var root := Node3D.new()
	root.name = "Tile_%d_%d" % job.tile
	# By which a world knows its own tiles.
	root.set_meta(&"baked", [Vector2i(int(job.tile[0]), int(job.tile[1])), int(job.instances), job.scene_digest])
	for entry: Dictionary in job.nodes:
		var node := _instance(entry, payload)
		root.add_child(node, true)
		node.owner = root
	var scene := PackedScene.new()
	var error := scene.pack(root)
	root.free()
	return _save(scene, job.file) if error == OK else "Cannot pack the scene of %s: %s." % [job.file, error_string(error)]


func _instance(entry: Dictionary, payload: PackedByteArray) -> MultiMeshInstance3D:
	var multimesh := MultiMesh.new()
	multimesh.transform_format = MultiMesh.TRANSFORM_3D
	multimesh.use_colors = entry.use_colors
	multimesh.use_custom_data = entry.use_custom_data
	multimesh.mesh = _meshes[entry.mesh]
	multimesh.instance_count = entry.count
	multimesh.buffer = payload.slice(entry.from, entry.to).to_float32_array()
	var node := MultiMeshInstance3D.new()
	node.name = entry.name
	node.multimesh = multimesh
	node.cast_shadow = entry.cast_shadow as GeometryInstance3D.ShadowCastingSetting
	node.layers = entry.render_layers
	if entry.material >= 0:
		node.material_override = _materials[entry.material]
	node.visibility_range_begin = entry.begin
	node.visibility_range_end = entry.end
	if entry.has("least"):
		node.custom_aabb = _box(entry)
	return node


## The box around what a node may draw in any of its levels of detail. The engine measures distances from the middle of a box, so the levels of a
## model need the same one, or there would be a gap between them.
func _box(entry: Dictionary) -> AABB:
	var least := Vector3(entry.least[0], entry.least[1], entry.least[2])
	var greatest := Vector3(entry.greatest[0], entry.greatest[1], entry.greatest[2])
	var reach := 0.0
	for mesh: int in entry.meshes:
		var box := _meshes[mesh].get_aabb()
		for corner in 8:
			reach = maxf(reach, box.get_endpoint(corner).length())
	return AABB(least, greatest - least).grow(reach * float(entry.largest_scale))


func _write_world(job: Dictionary, payload: PackedByteArray) -> String:
	var index := Index.new()
	index.scene_digest = job.scene_digest
	index.tile_size = job.tile_size
	index.world_offset = PackedFloat64Array(job.world_offset)
	index.layer_names = PackedStringArray(job.layer_names)
	var count := int(job.count)
	index.tiles = payload.slice(0, count * 8).to_int32_array()
	index.instances = payload.slice(count * 8, count * 12).to_int32_array()
	index.centers = payload.slice(count * 12, count * 36).to_float64_array()
	var problem := _save(index, job.index)
	if problem:
		return problem
	var world := World.new()
	world.name = "BakedWorld"
	world.index = ResourceLoader.load(job.index, "", ResourceLoader.CACHE_MODE_REPLACE)
	if world.index == null:
		world.free()
		return "%s was written and cannot be loaded: export again." % job.index
	var scene := PackedScene.new()
	var error := scene.pack(world)
	world.free()
	return _save(scene, job.scene) if error == OK else "Cannot pack the scene of %s: %s." % [job.scene, error_string(error)]


## Writes beside the final path first, and moves there what is whole.
func _save(resource: Resource, path: String) -> String:
	var partial := "%s.partial.%s" % [path.get_basename(), path.get_extension()]
	var error := ResourceSaver.save(resource, partial, ResourceSaver.FLAG_COMPRESS)
	if error == OK:
		error = DirAccess.rename_absolute(partial, path)
	return "" if error == OK else "Cannot write %s: %s. Check that its folder has room and may be written." % [path, error_string(error)]
