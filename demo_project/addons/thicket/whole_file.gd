extends RefCounted
## Replaces files of a project completely or not at all. The new content is written to a file next to the old one, and replaces it once the disk has
## stored all of it. After an error, the old file is unchanged. The library does the same for [ScatterState] and [ScatterMask].

## The number of bytes appended to a file to find out whether the disk has room left: more than a usual disk block.
const PROBE_BYTES := 1 << 14
## The first and the last bytes of files that ResourceSaver writes as binary.
const MARKS: Array[String] = ["RSRC", "RSCC"]


## Writes [param bytes] to a file.
static func store(path: String, bytes: PackedByteArray) -> Error:
	if not _may_be_replaced(path):
		return ERR_FILE_NO_PERMISSION
	var partial := beside(path)
	var file := FileAccess.open(partial, FileAccess.WRITE)
	if file == null:
		return FileAccess.get_open_error()
	var stored := file.store_buffer(bytes)
	file.close()
	# Closing the file writes the last buffered bytes, and the disk may have been full by then.
	return _put(partial, path, OK if stored and _length(partial) == bytes.size() else ERR_FILE_CANT_WRITE)


## Writes a resource to a file. The resource keeps its path. [param flags] are [enum ResourceSaver.SaverFlags].
static func save(resource: Resource, path: String, flags := 0) -> Error:
	if not _may_be_replaced(path):
		return ERR_FILE_NO_PERMISSION
	var partial := beside(path)
	var error := OK
	if Engine.is_editor_hint() and FileAccess.file_exists(path):
		# The old file contains the id by which scenes find it, and the editor keeps the id of an existing file.
		error = DirAccess.copy_absolute(path, partial)
	return _put(partial, path, save_new(resource, partial, flags) if error == OK else error)


## Saves a resource to a file that is not in use. Unlike [method ResourceSaver.save], it returns an error if the disk is full.
static func save_new(resource: Resource, path: String, flags := 0) -> Error:
	var error := ResourceSaver.save(resource, path, flags)
	return ERR_FILE_CANT_WRITE if error == OK and not _is_whole(path) else error


## The path where a file is written before it replaces the final one. It is hidden from the editor's file system and has the same
## extension, which determines the format.
static func beside(path: String) -> String:
	var name := path.get_file()
	var extension := name.get_extension()
	return path.get_base_dir().path_join(".%s.part%s" % [name.get_basename(), "." + extension if not extension.is_empty() else ""])


## A read-only file must not be replaced, even if its folder would allow it.
static func _may_be_replaced(path: String) -> bool:
	return not FileAccess.file_exists(path) or FileAccess.open(path, FileAccess.READ_WRITE) != null


static func _put(partial: String, path: String, error: Error) -> Error:
	if error == OK:
		error = DirAccess.rename_absolute(partial, path)
	if error != OK and FileAccess.file_exists(partial):
		DirAccess.remove_absolute(partial)
	if Engine.is_editor_hint() and path.begins_with("res://"):
		# Scripts of the add-on that are exported with games must not name the editor's singleton.
		var files: Object = Engine.get_singleton(&"EditorInterface").call(&"get_resource_filesystem")
		files.call(&"update_file", partial)
		files.call(&"update_file", path)
	return error


## ResourceSaver returns OK even if the disk is full. If the disk had no room then, it has none now, so appending bytes fails.
static func _is_whole(path: String) -> bool:
	var file := FileAccess.open(path, FileAccess.READ_WRITE)
	if file == null:
		return false
	var length := file.get_length()
	var begin := file.get_buffer(4).get_string_from_ascii()
	file.seek(maxi(length - 4, 0))
	var ending := file.get_buffer(4).get_string_from_ascii()
	if length == 0 or (begin in MARKS and begin != ending):
		return false
	var probe := PackedByteArray()
	probe.resize(PROBE_BYTES)
	file.seek_end()
	var stored := file.store_buffer(probe)
	file.flush()
	var found := _length(path)
	var error := file.resize(length)
	file.close()
	return stored and found == length + PROBE_BYTES and error == OK and _length(path) == length


static func _length(path: String) -> int:
	var file := FileAccess.open(path, FileAccess.READ)
	return file.get_length() if file != null else -1
