extends RefCounted
## Replaces files of a project whole or not at all: what is written goes into a file beside the old one, and takes its place once the disk
## has all of it. After an error the old file is as it was. The library does the same for [ScatterState] and [ScatterMask].

## Added after a file to find out whether the disk has room left: more than the blocks in which disks are usually divided.
const PROBE_BYTES := 1 << 14
## How files begin and end that ResourceSaver writes as binary.
const MARKS: Array[String] = ["RSRC", "RSCC"]


## Makes a file hold [param bytes].
static func store(path: String, bytes: PackedByteArray) -> Error:
	if not _may_be_replaced(path):
		return ERR_FILE_NO_PERMISSION
	var partial := beside(path)
	var file := FileAccess.open(partial, FileAccess.WRITE)
	if file == null:
		return FileAccess.get_open_error()
	var stored := file.store_buffer(bytes)
	file.close()
	# What was kept back until now may have found no room.
	return _put(partial, path, OK if stored and _length(partial) == bytes.size() else ERR_FILE_CANT_WRITE)


## Makes a file hold a resource, which keeps its path. [param flags] are [enum ResourceSaver.SaverFlags].
static func save(resource: Resource, path: String, flags := 0) -> Error:
	if not _may_be_replaced(path):
		return ERR_FILE_NO_PERMISSION
	var partial := beside(path)
	var error := OK
	if Engine.is_editor_hint() and FileAccess.file_exists(path):
		# The id by which scenes find the file is in it, and the editor takes over what a file has.
		error = DirAccess.copy_absolute(path, partial)
	return _put(partial, path, save_new(resource, partial, flags) if error == OK else error)


## Saves a resource to a file that is in use by nothing. Unlike [method ResourceSaver.save] it has an error where the disk is full.
static func save_new(resource: Resource, path: String, flags := 0) -> Error:
	var error := ResourceSaver.save(resource, path, flags)
	return ERR_FILE_CANT_WRITE if error == OK and not _is_whole(path) else error


## Where a file is written before it takes its place. Hidden from the editor's file system, with the extension that tells its format.
static func beside(path: String) -> String:
	var name := path.get_file()
	var extension := name.get_extension()
	return path.get_base_dir().path_join(".%s.part%s" % [name.get_basename(), "." + extension if not extension.is_empty() else ""])


## A file that may not be written stays as it is, though its folder would let another take its place.
static func _may_be_replaced(path: String) -> bool:
	return not FileAccess.file_exists(path) or FileAccess.open(path, FileAccess.READ_WRITE) != null


static func _put(partial: String, path: String, error: Error) -> Error:
	if error == OK:
		error = DirAccess.rename_absolute(partial, path)
	if error != OK and FileAccess.file_exists(partial):
		DirAccess.remove_absolute(partial)
	if Engine.is_editor_hint() and path.begins_with("res://"):
		# Scripts of the add-on that games export cannot name the editor's singleton.
		var files: Object = Engine.get_singleton(&"EditorInterface").call(&"get_resource_filesystem")
		files.call(&"update_file", partial)
		files.call(&"update_file", path)
	return error


## ResourceSaver returns OK for what found no room on the disk. Where it has found none, there is none now.
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
