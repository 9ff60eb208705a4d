@tool
extends "res://tests/steps.gd"
## Checks that files that the editor's tools replace keep the UIDs by which scenes refer to them, and that no partial file appears in the FileSystem
## dock.

const WholeFile := preload("res://addons/thicket/whole_file.gd")


func make_mask(radius: float) -> Resource:
	var mask: Resource = ClassDB.instantiate(&"ScatterMask")
	mask.set(&"background", 0.0)
	mask.call(&"paint", Vector2(10.0, 20.0), radius)
	return mask


func id_of(path: String) -> int:
	return ResourceLoader.get_resource_uid(path)


func check_whole(path: String, id: int, mask: Resource, context: String) -> void:
	var system := EditorInterface.get_resource_filesystem()
	check(id != ResourceUID.INVALID_ID and id_of(path) == id, "%s: its id, got %d, expected %d" % [context, id_of(path), id])
	check_equal(ResourceUID.get_id_path(id), path, context + ": the path of the id")
	check_equal(system.get_file_type(path), "ScatterMask", context + ": in the editor's file system")
	check_equal(system.get_file_type(WholeFile.beside(path)), "", context + ": the temporary file is not")
	check(not FileAccess.file_exists(WholeFile.beside(path)), context + ": it is deleted")
	var loaded := ResourceLoader.load(path, "", ResourceLoader.CACHE_MODE_IGNORE)
	check(loaded.get(&"data") == mask.get(&"data"), context + ": its content")


func test_replaced_files_keep_their_ids() -> void:
	await until(func() -> bool: return not EditorInterface.get_resource_filesystem().is_scanning(), "the project is scanned")
	for path: String in ["res://lanes.res", "res://lanes.tres"]:
		var mask := make_mask(4.0)
		check_equal(WholeFile.save(mask, path), OK, "a new file")
		mask.take_over_path(path)
		var id := id_of(path)
		check_whole(path, id, mask, "new " + path)
		for time in 2:
			mask.call(&"paint", Vector2(50.0 * time, 0.0), 6.0)
			check_equal(WholeFile.save(mask, path), OK, "replaced")
			check_whole(path, id, mask, "replaced " + path)
			check(load(path) == mask, "the loaded resource stays")
			await frames(3)
		var bytes := FileAccess.get_file_as_bytes(path)
		check_equal(WholeFile.save(make_mask(9.0), path), OK, "replaced by another mask")
		check_equal(WholeFile.store(path, bytes), OK, "restored, as undo does")
		check(FileAccess.get_file_as_bytes(path) == bytes, "the bytes")
		check_whole(path, id, mask, "restored " + path)
		DirAccess.make_dir_absolute(WholeFile.beside(path))
		check(WholeFile.store(path, bytes.slice(1)) != OK, "the path of the temporary file is blocked")
		DirAccess.remove_absolute(WholeFile.beside(path))
		check_whole(path, id, mask, "after an error, " + path)
