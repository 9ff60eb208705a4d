extends RefCounted
## Replaces files of a project atomically. The new content is written to a file next to the old one. It replaces the old
## file once the disk has stored all of it. After an error, the old file is unchanged. The library does the same for
## [ScatterState] and [ScatterMask].

## The number of bytes that are appended to a file to check whether the disk is full. It is larger than a typical disk block.
const PROBE_BYTES := 1 << 14
## The signatures at the beginning and at the end of binary files that [ResourceSaver] writes.
const SIGNATURES: Array[String] = ["RSRC", "RSCC"]


## Writes [param bytes] to the file at [param path].
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
	return _move_into_place(partial, path, OK if stored and _length(partial) == bytes.size() else ERR_FILE_CANT_WRITE)


## Saves a resource to the file at [param path]. [member Resource.resource_path] is not changed. [param flags] are [enum ResourceSaver.SaverFlags].
static func save(resource: Resource, path: String, flags := 0) -> Error:
	if not _may_be_replaced(path):
		return ERR_FILE_NO_PERMISSION
	var partial := beside(path)
	var error := OK
	if Engine.is_editor_hint() and FileAccess.file_exists(path):
		# The old file contains the UID by which scenes refer to it. The editor keeps the UID of an existing file, so the new one starts as a copy.
		error = DirAccess.copy_absolute(path, partial)
	return _move_into_place(partial, path, save_new(resource, partial, flags) if error == OK else error)


## Saves a resource to a new file. Unlike [method ResourceSaver.save], returns an error if the disk is full.
static func save_new(resource: Resource, path: String, flags := 0) -> Error:
	var error := ResourceSaver.save(resource, path, flags)
	return ERR_FILE_CANT_WRITE if error == OK and not _is_whole(path) else error


## Returns the path to which a file is written before it replaces the final one. The name begins with a dot, which hides the file from the
## editor. The extension stays the same, because it determines the format.
static func beside(path: String) -> String:
	var name := path.get_file()
	var extension := name.get_extension()
	return path.get_base_dir().path_join(".%s.part%s" % [name.get_basename(), "." + extension if not extension.is_empty() else ""])


## Returns false for a read-only file, which must not be replaced even if its folder is writable.
static func _may_be_replaced(path: String) -> bool:
	return not FileAccess.file_exists(path) or FileAccess.open(path, FileAccess.READ_WRITE) != null


static func _move_into_place(partial: String, path: String, error: Error) -> Error:
	if error == OK:
		error = DirAccess.rename_absolute(partial, path)
	if error != OK and FileAccess.file_exists(partial):
		DirAccess.remove_absolute(partial)
	if Engine.is_editor_hint() and path.begins_with("res://"):
		# This script is exported with games, so it must not name the editor's singleton.
		var files: Object = Engine.get_singleton(&"EditorInterface").call(&"get_resource_filesystem")
		files.call(&"update_file", partial)
		files.call(&"update_file", path)
	return error


## Returns true if a saved file is complete. ResourceSaver returns OK even if the disk is full, but appending bytes to the file then fails.
static func _is_whole(path: String) -> bool:
	var file := FileAccess.open(path, FileAccess.READ_WRITE)
	if file == null:
		return false
	var length := file.get_length()
	var first_bytes := file.get_buffer(4).get_string_from_ascii()
	file.seek(maxi(length - 4, 0))
	var last_bytes := file.get_buffer(4).get_string_from_ascii()
	if length == 0 or (first_bytes in SIGNATURES and first_bytes != last_bytes):
		return false
	var probe := PackedByteArray()
	probe.resize(PROBE_BYTES)
	file.seek_end()
	var stored := file.store_buffer(probe)
	file.flush()
	var probed_length := _length(path)
	var error := file.resize(length)
	file.close()
	return stored and probed_length == length + PROBE_BYTES and error == OK and _length(path) == length


static func _length(path: String) -> int:
	var file := FileAccess.open(path, FileAccess.READ)
	return file.get_length() if file != null else -1
