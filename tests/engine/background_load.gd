extends "models_harness.gd"
## Loads resources in the background. No setter of a resource may wait for the main thread, which may itself be waiting for the loader. If a
## setter waits, the test hangs, and the runner stops this script after a minute.

const LAYERS := 12
const PARTS_TO_READ := 4 ## The parts of each scene that are read one by one: its nodes, and the meshes of three LODs.


## Saves a scene whose layers scatter scenes and returns its path. No part of the scene is in the engine's cache.
func save_level() -> String:
	var level := Node3D.new()
	var scatter := put(TerrainScatter3D.new(), "Scatter", level, level) as TerrainScatter3D
	scatter.ground = ScatterGroundFlat.new()
	for number in LAYERS:
		ResourceSaver.save(pack(make_tree()), "user://tree_%d.scn" % number)
		var layer := make_layer(12.0)
		layer.resource_name = "Trees %d" % number
		layer.meshes = [load("user://tree_%d.scn" % number)]
		scatter.layers.append(layer)
	ResourceSaver.save(pack(level), "user://level.scn")
	return "user://level.scn"


func load_deep(path: String) -> Resource:
	return ResourceLoader.load(path, "", ResourceLoader.CACHE_MODE_IGNORE_DEEP)


func check_level(scene: Resource) -> void:
	if not check(scene is PackedScene, "the scene is loaded: %s" % scene):
		return
	var level := (scene as PackedScene).instantiate()
	var layer: ScatterLayer = (level.get_child(0) as TerrainScatter3D).layers[0]
	check_equal(layer.meshes[0] is PackedScene, true, "the scene's layers keep their scenes")
	check_equal(layer.get_materials().size(), 2, "their materials can be read")
	level.free()


func test_the_main_thread_may_wait_for_a_thread_that_loads() -> void:
	var path := save_level()
	var thread := Thread.new()
	thread.start(load_deep.bind(path))
	check_level(thread.wait_to_finish())


func test_the_main_thread_may_wait_for_a_worker_that_loads() -> void:
	var path := save_level()
	var loaded: Array[Resource] = []
	WorkerThreadPool.wait_for_task_completion(WorkerThreadPool.add_task(func() -> void: loaded.append(load_deep(path))))
	check_level(loaded[0])


func test_a_threaded_request_is_served_without_a_frame() -> void:
	var path := save_level()
	var frame := Engine.get_process_frames()
	ResourceLoader.load_threaded_request(path, "", false, ResourceLoader.CACHE_MODE_IGNORE_DEEP)
	check_level(ResourceLoader.load_threaded_get(path))
	check_equal(Engine.get_process_frames(), frame, "no frame passed")


func test_a_saved_model_loads_on_a_thread() -> void:
	ResourceSaver.save(pack(make_tree()), "user://oak.scn")
	var saved := ScatterModel.new()
	saved.scene = load("user://oak.scn")
	ResourceSaver.save(saved, "user://oak_model.tres")
	var thread := Thread.new()
	thread.start(load_deep.bind("user://oak_model.tres"))
	var model := thread.wait_to_finish() as ScatterModel
	check_equal(model.lods.size(), 3, "the main thread reads the model on demand")
	check_equal(model.shapes.size(), 2, "including its shapes")


## Sets the properties of the library's resources that refer to other resources, on a thread. No setter may block.
func test_every_property_can_be_set_on_a_thread() -> void:
	var values := {
		"Mesh": BoxMesh.new(),
		"PackedScene": pack(make_tree()),
		"Texture2D": ImageTexture.create_from_image(Image.create_empty(8, 8, false, Image.FORMAT_R8)),
		"Image,Texture2D": ImageTexture.create_from_image(Image.create_empty(8, 8, false, Image.FORMAT_R8)),
		"Noise": FastNoiseLite.new(),
		"Curve": make_line(Vector2.ZERO, Vector2.ONE),
		"Gradient": Gradient.new(),
		"ScatterMask": ScatterMask.new(),
		"PhysicsMaterial": PhysicsMaterial.new(),
		"BaseMaterial3D,ShaderMaterial": StandardMaterial3D.new(),
	}
	var made: Array[Resource] = []
	for type in ClassDB.get_inheriters_from_class("Resource"):
		if type.begins_with("Scatter") and ClassDB.can_instantiate(type):
			made.append(ClassDB.instantiate(type))
	check(made.size() > 8, "%d resource classes" % made.size())
	var thread := Thread.new()
	thread.start(func() -> int:
		var count := 0
		for resource in made:
			for property in resource.get_property_list():
				if property["usage"] & PROPERTY_USAGE_STORAGE and property["type"] == TYPE_OBJECT and values.has(property["hint_string"]):
					resource.set(property["name"], values[property["hint_string"]])
					count += 1
				elif property["name"] == &"meshes":
					resource.set(&"meshes", [values["Mesh"], values["PackedScene"]])
					count += 1
		return count)
	var count: int = thread.wait_to_finish()
	check(count > 15, "%d properties were set" % count)


func test_getters_on_other_threads_return_the_part_read_so_far() -> void:
	var model := ScatterModel.new()
	model.scene = pack(make_tree())
	var thread := Thread.new()
	thread.start(func() -> Array: return [model.lods.size(), model.get_mesh() == null, model.get_aabb(), model.shapes.size()])
	check_equal(thread.wait_to_finish(), [0, true, AABB(), 0], "before the main thread reads the model, it is empty")
	check_equal(model.lods.size(), 3, "the main thread reads it")
	thread.start(func() -> Array: return [model.lods.size(), model.shapes.size()])
	check_equal(thread.wait_to_finish(), [3, 2], "afterwards all threads see the result")


## Each frame reads as many parts as its budget allows, and at least one.
func test_models_are_read_under_the_budget_of_a_frame() -> void:
	var viewer := make_viewer()
	var scatter := make_scatter([], ScatterGroundFlat.new(), viewer)
	scatter.frame_budget_usec = 1
	for number in LAYERS:
		var layer := make_layer(12.0)
		layer.meshes = [pack(make_tree())]
		scatter.layers.append(layer)
	var frames_read := 0
	while scatter.get_stats()["tiles"] == 0 and frames_read < 1000:
		check(not scatter.is_settled(), "the scatter is not settled before its models are read")
		await process_frame
		frames_read += 1
	check(frames_read >= LAYERS * PARTS_TO_READ, "%d frames for %d parts" % [frames_read, LAYERS * PARTS_TO_READ])
	check(frames_read < 1000, "tiles are shown afterwards")
	# build_rect cannot wait for later frames, so it reads the model immediately.
	var late := make_layer(12.0)
	late.meshes = [pack(make_tree())]
	scatter.layers = [late]
	check(scatter.build_rect(scatter.layers[0], Rect2(0, 0, 64, 64)).get_mesh(0) != null, "build_rect has the mesh immediately")
