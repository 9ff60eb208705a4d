extends "models_harness.gd"
## Tests that bakes, and the scripts that read them, use the same LODs that the extension draws.

const ModelFiles := preload("res://addons/thicket/baking/model_files.gd")
const ReadModels := preload("../../tools/bake/reading/scripts/read_models.gd")

## Pairs of part names. The first belongs to the finer LOD.
const NAMES: Array[Array] = [
	["Tree_LOD0", "Tree_LOD1"], ["Tree-LOD-0", "Tree-LOD-1"], ["Tree LOD0", "Tree LOD 1"], ["TrunkLOD0", "TrunkLOD1"],
	["Tree_LOD0_leaves", "Tree_LOD1_leaves"], ["Trunk", "Trunk_LOD2"], ["Trunk", "Melod1"], ["Trunk", "Part_LOD100"],
]


## Saves a scene of parts with these names and returns it. Each part is a smaller box than the previous one.
func saved_scene(names: Array, file: String) -> PackedScene:
	var scene := Node3D.new()
	scene.name = "Model"
	for index in names.size():
		put_mesh(box(Vector3.ONE * (4.0 - index), null), names[index], scene, scene)
	var packed := pack(scene)
	ResourceSaver.save(packed, file)
	packed.take_over_path(file)
	return packed


func model_of(scene: PackedScene) -> ScatterModel:
	var model := ScatterModel.new()
	model.scene = scene
	return model


## Returns the LODs that a bake writes for one of the layer's meshes, as [distance, mesh size] read from the files.
func baked_lods(layer: ScatterLayer, entry: int) -> Array:
	var files := ModelFiles.new(layer, 3)
	check_equal(files.problem, "", "no problem")
	var result := []
	for lod: Dictionary in files.models[entry].lods:
		check(not lod.path.is_empty(), "every LOD has a file")
		if lod.path.begins_with("res://"):
			result.append([lod.distance, (load(lod.path) as Mesh).get_aabb().size])
		else:
			var at := "user://%s" % lod.path.get_file()
			FileAccess.open(at, FileAccess.WRITE).store_buffer(files.new_files[lod.path])
			result.append([lod.distance, (ResourceLoader.load(at, "", ResourceLoader.CACHE_MODE_IGNORE) as Mesh).get_aabb().size])
			DirAccess.remove_absolute(at)
	return result


func drawn_lods(layer: ScatterLayer, entry: int) -> Array:
	return layer.get_mesh_lods(entry).map(func(lod: ScatterLod) -> Array: return [lod.distance, lod.mesh.get_aabb().size])


func test_scene_among_the_meshes_has_all_its_levels() -> void:
	var scene := saved_scene(["Oak_LOD0", "Oak_LOD1", "Oak_LOD2"], "res://oak.tscn")
	var layer := make_layer()
	layer.meshes = [scene, model_of(scene)]
	var lods := baked_lods(layer, 0)
	check_equal(lods.size(), 3, "LODs of the scene")
	check_equal(lods, drawn_lods(layer, 0), "the manifest lists the LODs that are drawn")
	check_equal(baked_lods(layer, 1), lods, "the same LODs for a model of the scene")
	# Default distances grow with the model's size and double from LOD to LOD.
	check(lods[1][0] > 4.0 and is_equal_approx(lods[2][0], 2.0 * lods[1][0]), "distances: %s" % [lods])
	check_equal(ModelFiles.new(layer, 3).models[0].path, "res://oak.tscn", "the file of the entry")


func test_levels_behind_a_scene_are_among_them() -> void:
	var far := BoxMesh.new()
	var layer := make_layer()
	var scene := saved_scene(["Oak_LOD0", "Oak_LOD1"], "res://oak.tscn")
	layer.meshes = with_lods([SphereMesh.new(), null, scene], [[far, null, null], [null, null, far]], [40.0, 500.0])
	check_equal(baked_lods(layer, 0), drawn_lods(layer, 0), "a mesh")
	check_equal(drawn_lods(layer, 0).map(func(lod: Array) -> float: return lod[0]), [0.0, 40.0], "the empty entry has its own added LOD")
	check_equal(ModelFiles.new(layer, 3).models[1].lods, [], "an empty entry draws nothing")
	check_equal(baked_lods(layer, 2), drawn_lods(layer, 2), "a scene")
	check_equal(baked_lods(layer, 2).size(), 3, "the scene has the added LOD after its own LODs")
	check_equal(layer.get_mesh_lods(3), [] as Array[ScatterLod], "no such entry")
	check_error(["get_mesh_lods", "index", 3], "an index beyond the list")


func test_reader_finds_the_finest_level_by_the_extensions_names() -> void:
	for index in NAMES.size():
		var file := "res://named_%d.tscn" % index
		var model := model_of(saved_scene(NAMES[index], file))
		var read: Mesh = ReadModels.new().mesh_at(file)
		if check(read != null, "%s can be read" % [NAMES[index]]):
			check_equal(read.get_aabb(), model.get_mesh().get_aabb(), "the bounds of the finest LOD of %s" % [NAMES[index]])
			check_equal(read.get_faces().size(), model.get_mesh().get_faces().size(), "the triangles of all parts of the finest LOD of %s" % [NAMES[index]])
	var empty := pack(Node3D.new())
	ResourceSaver.save(empty, "res://empty.tscn")
	var models := ReadModels.new()
	check(models.mesh_at("res://empty.tscn") == null and "res://empty.tscn" in models.problem, models.problem)
	errors.take()
