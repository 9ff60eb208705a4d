extends "harness.gd"
## Files of ScatterState and ScatterMask: saved and loaded as a player does, refused, and left as they were after a failure. tests/test_saves.py
## fills the disk.

const FOLDER := "user://saves"
const PATH := FOLDER + "/forest.state"
const PART := PATH + ".part"


## The id of a cell of layer 3.
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


## Save with some felled, load, fell on, load again: what was saved is there each time, in the picture too.
func test_loading_twice_brings_back_what_was_saved() -> void:
	make_folder()
	var scatter := make_scatter([make_layer()], ScatterGroundFlat.new(), make_viewer())
	await settle(scatter)
	scatter.remove_in_sphere(Vector3.ZERO, 10.0)
	var felled := scatter.state.get_removed()
	check(felled.size() > 5, "some are felled")
	check_equal(scatter.state.save_to_file(PATH), OK, "saved")
	await settle(scatter)
	var shown := digests(scatter, 0)
	for time in 2:
		check_equal(scatter.state.load_from_file(PATH), OK, "loaded")
		check_equal(scatter.state.get_removed(), felled, "loaded for the %d. time" % (time + 1))
		await settle(scatter)
		check_equal(digests(scatter, 0), shown, "the picture")
		scatter.remove_in_sphere(Vector3.ZERO, 30.0)
		check(scatter.state.get_removed_count() > felled.size(), "played on")
	check_equal(files_there(), ["forest.state"], "no other file is left")


func test_the_file_holds_the_bytes() -> void:
	make_folder()
	var folder := ProjectSettings.globalize_path(FOLDER)
	for path: String in [PATH, folder + "/absolute.state", "res://thicket_test.state", FOLDER + "/wäldchen 🌲.state"]:
		for count: int in [30, 0, 7]: # Replaced by a shorter one, too.
			var state := make_state(count)
			check_equal(state.save_to_file(path), OK, "saved to " + path)
			check_equal(FileAccess.get_file_as_bytes(path), state.to_bytes(), "the bytes of " + path)
			var loaded := make_state(3)
			check_equal(loaded.load_from_file(path), OK, "loaded from " + path)
			check_equal(loaded.to_bytes(), state.to_bytes(), "what was loaded from " + path)
		DirAccess.remove_absolute(path)
	var blank := ScatterState.new()
	check_equal(blank.save_to_file(PATH), OK, "a blank state is saved")
	var filled := make_state()
	check_equal(filled.load_from_file(PATH), OK, "and loaded")
	check_equal(filled.get_digest(), blank.get_digest(), "over a filled one")


func test_what_listens_hears_of_loading() -> void:
	make_folder()
	var state := make_state(2)
	state.save_to_file(PATH)
	state.remove(point(50))
	var emitted: Array = []
	state.instances_changed.connect(func(ids: PackedInt64Array) -> void: emitted.append_array(ids))
	check_equal(state.load_from_file(PATH), OK, "loaded")
	check(emitted.has(point(50)), "what stands again is told: %s" % [emitted])


func test_a_diff_under_way_is_not_in_the_file() -> void:
	make_folder()
	var state := make_state(3)
	var before := state.to_bytes()
	var diff := make_state(40).diff_since(0)
	var results: Array = []
	state.apply_diff_async(diff, func(error: Error) -> void: results.push_back(error))
	check_equal(state.save_to_file(PATH), OK, "saved meanwhile")
	check_equal(FileAccess.get_file_as_bytes(PATH), before, "as it was before the diff")
	await until(func() -> bool: return results == [OK], "applied")
	check_equal(state.get_removed_count(), 40, "the diff is in")
	state.apply_diff_async(make_state(60).diff_since(0), func(error: Error) -> void: results.push_back(error))
	check_equal(state.load_from_file(PATH), OK, "loaded meanwhile")
	check_equal(state.to_bytes(), before, "what was saved, not the diff")
	await until(func() -> bool: return results == [OK, OK], "the callback is called all the same")
	check_equal(state.to_bytes(), before, "nothing comes after")


func refuse_saving(path: String, error: Error, words: Array, what: String) -> void:
	check_equal(make_state().save_to_file(path), error, what)
	check_error(["ScatterState.save_to_file: cannot write " + path] + words, what)
	check_equal(make_mask().save_to_file(path), error, what + ", a mask")
	check_error(["ScatterMask.save_to_file: cannot write " + path] + words, what + ", a mask")


func test_what_cannot_be_written() -> void:
	make_folder()
	refuse_saving("", ERR_FILE_BAD_PATH, ["path is empty", "user://"], "no path")
	refuse_saving(FOLDER + "/none/forest.state", ERR_FILE_NOT_FOUND, ["folder is missing", "make_dir_recursive_absolute"], "no folder")
	DirAccess.make_dir_absolute(FOLDER + "/folder")
	refuse_saving(FOLDER + "/folder", ERR_FILE_NO_PERMISSION, ["is no file", "different path"], "a folder")
	check(DirAccess.dir_exists_absolute(FOLDER + "/folder"), "it is there")
	DirAccess.remove_absolute(FOLDER + "/folder")
	make_state(4).save_to_file(PATH)
	var before := FileAccess.get_file_as_bytes(PATH)
	DirAccess.make_dir_absolute(PART) # In the way of the new file.
	check(make_state().save_to_file(PATH) != OK, "something is in the way")
	check_error(["ScatterState.save_to_file: cannot write " + PATH], "something is in the way")
	check_equal(FileAccess.get_file_as_bytes(PATH), before, "the old file")
	DirAccess.remove_absolute(PART)
	if FileAccess.set_unix_permissions(PATH, FileAccess.UNIX_READ_OWNER) == OK and FileAccess.open(PATH, FileAccess.READ_WRITE) == null:
		refuse_saving(PATH, ERR_FILE_NO_PERMISSION, ["may not be written"], "read-only") # The superuser may write it all the same.
	check_equal(FileAccess.get_file_as_bytes(PATH), before, "the old file")


## Devices are replaced by nobody who saves, not even by the superuser.
func test_a_device_stays() -> void:
	if OS.get_name() != "Linux":
		check(true, "no such system")
		return
	refuse_saving("/dev/null", ERR_FILE_NO_PERMISSION, ["is no file"], "a device")
	check(not FileAccess.file_exists("/dev/null"), "it is no file")


func test_links_and_permissions_stay() -> void:
	if OS.get_name() == "Windows":
		check(true, "no such system")
		return
	make_folder()
	make_state(1).save_to_file(PATH)
	FileAccess.set_unix_permissions(PATH, 0x190) # 0620
	var folder := DirAccess.open(FOLDER)
	check_equal(folder.create_link(ProjectSettings.globalize_path(PATH), "link.state"), OK, "a link")
	var state := make_state(9)
	check_equal(state.save_to_file(FOLDER + "/link.state"), OK, "saved by the link")
	check(folder.is_link("link.state"), "it is a link")
	check_equal(FileAccess.get_file_as_bytes(PATH), state.to_bytes(), "the file that it leads to")
	check_equal(FileAccess.get_unix_permissions(PATH), 0x190, "its permissions")


func refuse_loading(bytes: Variant, error: Error, words: Array, what: String) -> void:
	if bytes is PackedByteArray:
		FileAccess.open(PATH, FileAccess.WRITE).store_buffer(bytes as PackedByteArray)
	var state := make_state()
	var before := [state.to_bytes(), state.get_revision()]
	var emitted: Array = []
	state.changed.connect(func() -> void: emitted.push_back(true))
	check_equal(state.load_from_file(PATH), error, what)
	check_error(["ScatterState.load_from_file: cannot load " + PATH] + words, what)
	check([state.to_bytes(), state.get_revision()] == before and emitted.is_empty(), what + " has changed nothing")
	var mask := make_mask()
	mask.changed.connect(func() -> void: emitted.push_back(true))
	var painted := mask.data
	check_equal(mask.load_from_file(PATH), error, what + ", for a mask")
	check_error(["ScatterMask.load_from_file: cannot load " + PATH] + words, what + ", for a mask")
	check(mask.data == painted and emitted.is_empty(), what + " has changed nothing of a mask")


func test_what_is_no_such_file_is_refused() -> void:
	make_folder()
	refuse_loading(null, ERR_FILE_NOT_FOUND, ["no such file", "file_exists"], "no file")
	for damage: Array in [[PackedByteArray(), "an empty file"], ["a list of trees".to_utf8_buffer(), "a text"]]:
		refuse_loading(damage[0], ERR_FILE_CORRUPT, ["damaged"], damage[1])
	for ending: String in [".res", ".tres"]:
		for flags: int in [0, ResourceSaver.FLAG_COMPRESS]:
			ResourceSaver.save(make_state(), FOLDER + "/old" + ending, flags)
			refuse_loading(FileAccess.get_file_as_bytes(FOLDER + "/old" + ending), ERR_FILE_UNRECOGNIZED,
					["is a resource of Godot", "ResourceLoader", "save_to_file()"], ending)
	check_equal(make_mask().save_to_file(PATH), OK, "a mask")
	var state := make_state()
	check_equal(state.load_from_file(PATH), ERR_FILE_CORRUPT, "a mask is no state")
	check_error([PATH, "of another kind"], "a mask is no state")
	check_equal(make_state().save_to_file(PATH), OK, "a state")
	check_equal(make_mask().load_from_file(PATH), ERR_FILE_CORRUPT, "a state is no mask")
	check_error([PATH, "of another kind"], "a state is no mask")


func test_damaged_files_are_refused() -> void:
	make_folder()
	var whole := make_state(8).to_bytes()
	for at in range(0, whole.size(), 5):
		var damaged := whole.duplicate()
		damaged[at] ^= 1 << at % 8
		refuse_loading_of_a_state(damaged, "byte %d" % at)
		refuse_loading_of_a_state(whole.slice(0, at), "the first %d bytes" % at)


func refuse_loading_of_a_state(bytes: PackedByteArray, what: String) -> void:
	FileAccess.open(PATH, FileAccess.WRITE).store_buffer(bytes)
	var state := make_state(5)
	var before := state.to_bytes()
	check(state.load_from_file(PATH) in [ERR_FILE_CORRUPT, ERR_INVALID_DATA], what)
	check_error(["ScatterState.load_from_file: cannot load " + PATH], what)
	check_equal(state.to_bytes(), before, what + " has changed nothing")


## What another world has changed is refused, with the file's name.
func test_files_of_other_points_are_refused() -> void:
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
	check_equal(scatters[1].state.load_from_file(PATH), ERR_INVALID_DATA, "a foreign state")
	check_error(["cannot load " + PATH, "another seed"], "a foreign state")
	check_equal(scatters[1].state.to_bytes(), bytes[1], "nothing has changed")


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
		check_equal(emitted.size(), 1, "told once")
		check_equal([loaded.pixel_size, loaded.background, loaded.data], [mask.pixel_size, mask.background, mask.data], "the same mask")
	check_equal(files_there(), ["lanes.mask"], "no other file is left")


## A state that load() returns again is warned of, once; others are not.
func test_a_state_that_load_returns_again_is_warned_of() -> void:
	make_folder()
	var path := FOLDER + "/cut_trees.res"
	ResourceSaver.save(make_state(), path)
	var scatter := make_scatter([], ScatterGroundFlat.new(), make_viewer())
	scatter.state = load(path)
	check_error(["TerrainScatter3D.state", path, "save_to_file()", "load_from_file()", "copy_at_runtime"], "a cached state")
	var cached := scatter.state
	scatter.state = ScatterState.new()
	scatter.state = cached
	check_no_error("once for a state")
	scatter.state = ResourceLoader.load(path, "", ResourceLoader.CACHE_MODE_IGNORE) as ScatterState
	check_no_error("a copy that is not kept")
	scatter.state = null
	cached = null


## What a designer has made is kept in a file, or in the scene, and nobody is warned of it.
func test_no_warning_of_states_of_scenes() -> void:
	make_folder()
	var designed := make_state()
	designed.copy_at_runtime = true
	ResourceSaver.save(designed, FOLDER + "/designed.res")
	for state: ScatterState in [load(FOLDER + "/designed.res"), make_state()]:
		var made := make_scatter([], ScatterGroundFlat.new(), make_viewer())
		made.state = state
		var scene := PackedScene.new()
		made.owner = null
		check_equal(scene.pack(made), OK, "packed")
		ResourceSaver.save(scene, FOLDER + "/level.tscn")
		made.free()
		var level: Node = (ResourceLoader.load(FOLDER + "/level.tscn", "", ResourceLoader.CACHE_MODE_REPLACE) as PackedScene).instantiate()
		root.add_child(level)
		check_equal((level as TerrainScatter3D).state.get_removed_count(), 20, "it is there")
		check_no_error("a state of a scene")


## Files that version 0.2.0 wrote, as resources and as bytes.
func test_states_of_earlier_versions_are_read() -> void:
	var folder := (get_script() as Script).resource_path.get_base_dir().path_join("data")
	for name: String in ["state_0.2.0.res", "state_0.2.0.tres"]:
		var state := ResourceLoader.load(folder.path_join(name), "", ResourceLoader.CACHE_MODE_IGNORE) as ScatterState
		check_equal(state.get_digest() if state != null else 0, make_state().get_digest(), name)
	var state := ScatterState.new()
	check_equal(state.load_from_file(folder.path_join("state_0.2.0.bin")), OK, "bytes")
	check_equal(state.get_digest(), make_state().get_digest(), "bytes")
