extends "harness.gd"
## Tests the files of ScatterState and ScatterMask: saving and loading as in a game, rejected files, and failures that leave the old data
## unchanged. test_saves.py tests full disks.

const FOLDER := "user://saves"
const PATH := FOLDER + "/forest.state"
const PART := PATH + ".part"


## Returns the ID of the point in a cell (x, y) of layer 3.
func point(x: int, y := 0) -> int:
	return 3 << 48 | (x + (1 << 23)) << 24 | (y + (1 << 23))


func make_state(count := 20) -> ScatterState:
	var state := ScatterState.new()
	for x in count:
		state.remove(point(x, x * x), 0.0 if x % 2 else 100.0)
	state.set_instance_data(point(1, 1), {"name": "Old oak", "age": 312})
	state.advance(1.5)
	return state


func make_mask() -> ScatterMask:
	var mask := ScatterMask.new()
	mask.pixel_size = 0.5
	mask.background = 0.0
	mask.paint(Vector2(10, 20), 8.0)
	return mask


func make_folder() -> void:
	DirAccess.make_dir_recursive_absolute(FOLDER)
	for file in DirAccess.get_files_at(FOLDER):
		DirAccess.remove_absolute(FOLDER.path_join(file))


func files_there() -> Array:
	var files := Array(DirAccess.get_files_at(FOLDER))
	files.sort()
	return files


## Saves, loads, removes more instances and loads again. Each load restores the saved state and the visible tiles.
func test_loading_twice_restores_the_saved_state() -> void:
	make_folder()
	var scatter := make_scatter([make_layer()], ScatterGroundFlat.new(), make_viewer())
	await settle(scatter)
	scatter.remove_in_sphere(Vector3.ZERO, 10.0)
	var felled := scatter.state.get_removed()
	check(felled.size() > 5, "some instances are removed")
	check_equal(scatter.state.save_to_file(PATH), OK, "saved")
	await settle(scatter)
	var shown_digests := digests(scatter, 0)
	for time in 2:
		check_equal(scatter.state.load_from_file(PATH), OK, "loaded")
		check_equal(scatter.state.get_removed(), felled, "load number %d" % (time + 1))
		await settle(scatter)
		check_equal(digests(scatter, 0), shown_digests, "the visible tiles after loading")
		scatter.remove_in_sphere(Vector3.ZERO, 30.0)
		check(scatter.state.get_removed_count() > felled.size(), "more instances are removed before the next load")
	check_equal(files_there(), ["forest.state"], "no other file is left")


func test_the_file_contains_the_bytes() -> void:
	make_folder()
	var folder := ProjectSettings.globalize_path(FOLDER)
	for path: String in [PATH, folder + "/absolute.state", "res://thicket_test.state", FOLDER + "/wäldchen 🌲.state"]:
		for count: int in [30, 0, 7]: # A shorter file must also replace a longer one.
			var state := make_state(count)
			check_equal(state.save_to_file(path), OK, "saved to " + path)
			check_equal(FileAccess.get_file_as_bytes(path), state.to_bytes(), "the bytes of " + path)
			var loaded := make_state(3)
			check_equal(loaded.load_from_file(path), OK, "loaded from " + path)
			check_equal(loaded.to_bytes(), state.to_bytes(), "the content loaded from " + path)
		DirAccess.remove_absolute(path)
	var blank := ScatterState.new()
	check_equal(blank.save_to_file(PATH), OK, "a blank state is saved")
	var filled := make_state()
	check_equal(filled.load_from_file(PATH), OK, "the blank state is loaded")
	check_equal(filled.get_digest(), blank.get_digest(), "the blank state replaces the content of the other")


func test_loading_emits_signals() -> void:
	make_folder()
	var state := make_state(2)
	state.save_to_file(PATH)
	state.remove(point(50))
	var emitted: Array = []
	state.instances_changed.connect(func(ids: PackedInt64Array) -> void: emitted.append_array(ids))
	check_equal(state.load_from_file(PATH), OK, "loaded")
	check(emitted.has(point(50)), "a restored instance is reported: %s" % [emitted])


func test_a_pending_diff_is_not_saved() -> void:
	make_folder()
	var state := make_state(3)
	var before := state.to_bytes()
	var diff := make_state(40).diff_since(0)
	var results: Array = []
	state.apply_diff_async(diff, func(error: Error) -> void: results.push_back(error))
	check_equal(state.save_to_file(PATH), OK, "saved during the work")
	check_equal(FileAccess.get_file_as_bytes(PATH), before, "the state before the diff")
	await until(func() -> bool: return results == [OK], "applied")
	check_equal(state.get_removed_count(), 40, "the diff is applied")
	state.apply_diff_async(make_state(60).diff_since(0), func(error: Error) -> void: results.push_back(error))
	check_equal(state.load_from_file(PATH), OK, "loaded during the work")
	check_equal(state.to_bytes(), before, "the saved state without the diff")
	await until(func() -> bool: return results == [OK, OK], "both callbacks are called")
	check_equal(state.to_bytes(), before, "nothing changes afterwards")


func refuse_saving(path: String, error: Error, words: Array, context: String) -> void:
	check_equal(make_state().save_to_file(path), error, context)
	check_error(["ScatterState.save_to_file: cannot write " + path] + words, context)
	check_equal(make_mask().save_to_file(path), error, context + ", a mask")
	check_error(["ScatterMask.save_to_file: cannot write " + path] + words, context + ", a mask")


func test_files_that_cannot_be_written() -> void:
	make_folder()
	refuse_saving("", ERR_FILE_BAD_PATH, ["path is empty", "user://"], "no path")
	refuse_saving(FOLDER + "/none/forest.state", ERR_FILE_NOT_FOUND, ["folder is missing", "make_dir_recursive_absolute"], "no folder")
	DirAccess.make_dir_absolute(FOLDER + "/folder")
	refuse_saving(FOLDER + "/folder", ERR_FILE_NO_PERMISSION, ["is not a file", "another path"], "a folder")
	check(DirAccess.dir_exists_absolute(FOLDER + "/folder"), "the folder still exists")
	DirAccess.remove_absolute(FOLDER + "/folder")
	make_state(4).save_to_file(PATH)
	var before := FileAccess.get_file_as_bytes(PATH)
	DirAccess.make_dir_absolute(PART) # This folder blocks the path of the temporary file.
	check(make_state().save_to_file(PATH) != OK, "the path is blocked")
	check_error(["ScatterState.save_to_file: cannot write " + PATH], "the path is blocked")
	check_equal(FileAccess.get_file_as_bytes(PATH), before, "the content of the old file")
	DirAccess.remove_absolute(PART)
	if FileAccess.set_unix_permissions(PATH, FileAccess.UNIX_READ_OWNER) == OK and FileAccess.open(PATH, FileAccess.READ_WRITE) == null:
		# Root is not checked, because root can write read-only files anyway.
		refuse_saving(PATH, ERR_FILE_NO_PERMISSION, ["may not be written"], "read-only")
	check_equal(FileAccess.get_file_as_bytes(PATH), before, "the content of the old file")


## Saving never replaces a device, even as root.
func test_a_device_stays() -> void:
	if OS.get_name() != "Linux":
		check(true, "not on this system")
		return
	refuse_saving("/dev/null", ERR_FILE_NO_PERMISSION, ["is not a file"], "a device")
	check(not FileAccess.file_exists("/dev/null"), "it is not a file")


func test_links_and_permissions_stay() -> void:
	if OS.get_name() == "Windows":
		check(true, "not on this system")
		return
	make_folder()
	make_state(1).save_to_file(PATH)
	FileAccess.set_unix_permissions(PATH, 0x190) # The permissions are 0620 in octal.
	var folder := DirAccess.open(FOLDER)
	check_equal(folder.create_link(ProjectSettings.globalize_path(PATH), "link.state"), OK, "a link")
	var state := make_state(9)
	check_equal(state.save_to_file(FOLDER + "/link.state"), OK, "saved through the link")
	check(folder.is_link("link.state"), "the link is still a link")
	check_equal(FileAccess.get_file_as_bytes(PATH), state.to_bytes(), "the target of the link")
	check_equal(FileAccess.get_unix_permissions(PATH), 0x190, "its permissions")


func refuse_loading(bytes: Variant, error: Error, words: Array, context: String) -> void:
	if bytes is PackedByteArray:
		FileAccess.open(PATH, FileAccess.WRITE).store_buffer(bytes as PackedByteArray)
	var state := make_state()
	var before := [state.to_bytes(), state.get_revision()]
	var emitted: Array = []
	state.changed.connect(func() -> void: emitted.push_back(true))
	check_equal(state.load_from_file(PATH), error, context)
	check_error(["ScatterState.load_from_file: cannot load " + PATH] + words, context)
	check([state.to_bytes(), state.get_revision()] == before and emitted.is_empty(), context + " does not change the state")
	var mask := make_mask()
	mask.changed.connect(func() -> void: emitted.push_back(true))
	var painted := mask.data
	check_equal(mask.load_from_file(PATH), error, context + ", for a mask")
	check_error(["ScatterMask.load_from_file: cannot load " + PATH] + words, context + ", for a mask")
	check(mask.data == painted and emitted.is_empty(), context + " does not change the mask")


func test_other_files_are_rejected() -> void:
	make_folder()
	refuse_loading(null, ERR_FILE_NOT_FOUND, ["no such file", "file_exists"], "no file")
	for damage: Array in [[PackedByteArray(), "an empty file"], ["a list of trees".to_utf8_buffer(), "a text file"]]:
		refuse_loading(damage[0], ERR_FILE_CORRUPT, ["truncated, corrupt"], damage[1])
	for ending: String in [".res", ".tres"]:
		for flags: int in [0, ResourceSaver.FLAG_COMPRESS]:
			ResourceSaver.save(make_state(), FOLDER + "/old" + ending, flags)
			refuse_loading(FileAccess.get_file_as_bytes(FOLDER + "/old" + ending), ERR_FILE_UNRECOGNIZED,
					["is a Godot resource", "ResourceLoader", "save_to_file()"], ending)
	check_equal(make_mask().save_to_file(PATH), OK, "a mask")
	var state := make_state()
	check_equal(state.load_from_file(PATH), ERR_FILE_CORRUPT, "a mask is not a state")
	check_error([PATH, "in another format"], "a mask is not a state")
	check_equal(make_state().save_to_file(PATH), OK, "a state")
	check_equal(make_mask().load_from_file(PATH), ERR_FILE_CORRUPT, "a state is not a mask")
	check_error([PATH, "in another format"], "a state is not a mask")


func test_damaged_files_are_rejected() -> void:
	make_folder()
	var whole := make_state(8).to_bytes()
	for at in range(0, whole.size(), 5):
		var damaged := whole.duplicate()
		damaged[at] ^= 1 << at % 8
		refuse_loading_of_a_state(damaged, "byte %d" % at)
		refuse_loading_of_a_state(whole.slice(0, at), "the first %d bytes" % at)


func refuse_loading_of_a_state(bytes: PackedByteArray, context: String) -> void:
	FileAccess.open(PATH, FileAccess.WRITE).store_buffer(bytes)
	var state := make_state(5)
	var before := state.to_bytes()
	check(state.load_from_file(PATH) in [ERR_FILE_CORRUPT, ERR_INVALID_DATA], context)
	check_error(["ScatterState.load_from_file: cannot load " + PATH], context)
	check_equal(state.to_bytes(), before, context + " leaves the state unchanged")


## A state that belongs to a different seed is rejected. The error names the file.
func test_files_of_another_world_are_rejected() -> void:
	make_folder()
	var bytes: Array[PackedByteArray] = []
	var scatters: Array[TerrainScatter3D] = []
	for seed: int in [7, 8]:
		var scatter := make_scatter([make_layer()], ScatterGroundFlat.new(), make_viewer())
		scatter.seed = seed
		await settle(scatter)
		scatter.remove_instance(scatter.query_nearest(Vector3.ZERO, 50.0).id)
		scatters.push_back(scatter)
		bytes.push_back(scatter.state.to_bytes())
	check_equal(scatters[0].state.save_to_file(PATH), OK, "saved")
	check_equal(scatters[1].state.load_from_file(PATH), ERR_INVALID_DATA, "a state of another world")
	check_error(["cannot load " + PATH, "a different seed"], "a state of another world")
	check_equal(scatters[1].state.to_bytes(), bytes[1], "the state after the rejected file")


func test_masks() -> void:
	make_folder()
	var path := FOLDER + "/lanes.mask"
	var blank := ScatterMask.new()
	blank.pixel_size = 4.0
	for mask: ScatterMask in [make_mask(), blank]:
		check_equal(mask.save_to_file(path), OK, "saved")
		var loaded := ScatterMask.new()
		loaded.paint(Vector2(-50, 3), 4.0, 1.0, 0.5, ScatterMask.MODE_ERASE)
		var emitted: Array = []
		loaded.changed.connect(func() -> void: emitted.push_back(true))
		check_equal(loaded.load_from_file(path), OK, "loaded")
		check_equal(emitted.size(), 1, "one signal")
		check_equal([loaded.pixel_size, loaded.background, loaded.data], [mask.pixel_size, mask.background, mask.data], "the loaded mask")
	check_equal(files_there(), ["lanes.mask"], "no other file is left")


## Assigning a state from the resource cache prints one warning. Other states cause none.
func test_cached_states_cause_a_warning() -> void:
	make_folder()
	var path := FOLDER + "/cut_trees.res"
	ResourceSaver.save(make_state(), path)
	var scatter := make_scatter([], ScatterGroundFlat.new(), make_viewer())
	scatter.state = load(path)
	check_error(["TerrainScatter3D.state", path, "save_to_file()", "load_from_file()", "copy_at_runtime"], "a cached state")
	var cached := scatter.state
	scatter.state = ScatterState.new()
	scatter.state = cached
	check_no_error("one warning per state")
	scatter.state = ResourceLoader.load(path, "", ResourceLoader.CACHE_MODE_IGNORE) as ScatterState
	check_no_error("a copy that is not cached")
	scatter.state = null
	cached = null


## States that a designer saved in a file or in the scene cause no warning.
func test_states_of_scenes_cause_no_warning() -> void:
	make_folder()
	var designed := make_state()
	designed.copy_at_runtime = true
	ResourceSaver.save(designed, FOLDER + "/designed.res")
	for state: ScatterState in [load(FOLDER + "/designed.res"), make_state()]:
		var new_scatter := make_scatter([], ScatterGroundFlat.new(), make_viewer())
		new_scatter.state = state
		var scene := PackedScene.new()
		new_scatter.owner = null
		check_equal(scene.pack(new_scatter), OK, "packed")
		ResourceSaver.save(scene, FOLDER + "/level.tscn")
		new_scatter.free()
		var level: Node = (ResourceLoader.load(FOLDER + "/level.tscn", "", ResourceLoader.CACHE_MODE_REPLACE) as PackedScene).instantiate()
		root.add_child(level)
		check_equal((level as TerrainScatter3D).state.get_removed_count(), 20, "the state is in the scene")
		check_no_error("a state of a scene")


## Reads files of version 0.2.0, both resources and bytes.
func test_states_of_earlier_versions_are_read() -> void:
	var folder := (get_script() as Script).resource_path.get_base_dir().path_join("data")
	for name: String in ["state_0.2.0.res", "state_0.2.0.tres"]:
		var state := ResourceLoader.load(folder.path_join(name), "", ResourceLoader.CACHE_MODE_IGNORE) as ScatterState
		check_equal(state.get_digest() if state != null else 0, make_state().get_digest(), name)
	var state := ScatterState.new()
	check_equal(state.load_from_file(folder.path_join("state_0.2.0.bin")), OK, "bytes")
	check_equal(state.get_digest(), make_state().get_digest(), "bytes")
