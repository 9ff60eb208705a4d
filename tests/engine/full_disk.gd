extends "harness.gd"
## Writes to a full disk, which must leave the old files unchanged, byte for byte. test_saves.py passes a folder on a small disk, or limits
## the file size.

const SceneFiles := preload("res://addons/thicket/editor/scene_files.gd")
const BakeImpostors := preload("res://addons/thicket/bake_impostors.gd")
const Impostor := preload("res://addons/thicket/impostor.gd")
const WholeFile := preload("res://addons/thicket/whole_file.gd")
const MOST := 8 << 20

var folder := ""
var filler := ""


func make_state(count: int) -> ScatterState:
	var random := RandomNumberGenerator.new()
	var state := ScatterState.new()
	for index in count:
		state.remove(3 << 48 | random.randi() << 16 | random.randi() & 0xffff)
	return state


## Returns a mask with `count` blocks of incompressible pixels.
func make_mask(count: int) -> ScatterMask:
	var mask := ScatterMask.new()
	var pixels := PackedByteArray()
	for index in 64 * 64 * count:
		pixels.push_back(randi() & 0xff)
	mask.set_pixels(Rect2i(0, 0, 64 * count, 64), pixels)
	return mask


func make_mesh(detail: int) -> Mesh:
	var sphere := SphereMesh.new()
	sphere.radial_segments = detail
	sphere.rings = detail
	var mesh := ArrayMesh.new()
	mesh.add_surface_from_arrays(Mesh.PRIMITIVE_TRIANGLES, sphere.get_mesh_arrays())
	return mesh


## Fills the disk to the last byte with the file `filler`. Has no effect if the path is empty, which means that the file size is limited
## instead.
func fill() -> void:
	if filler.is_empty():
		return
	var file := FileAccess.open(filler, FileAccess.WRITE)
	for size: int in [65536, 4096, 512, 1]:
		var block := PackedByteArray()
		block.resize(size)
		while file.get_length() < MOST:
			var stored := file.store_buffer(block)
			file.flush()
			if not stored or file.get_error() != OK or FileAccess.get_file_as_bytes(filler).size() != file.get_length():
				break
	file.close()
	check(FileAccess.open(filler, FileAccess.READ).get_length() < MOST, "the disk is full")


func make_room() -> void:
	if not filler.is_empty():
		DirAccess.remove_absolute(filler)


func names() -> Array:
	var list := DirAccess.open(folder)
	list.include_hidden = true
	var files := Array(list.get_files())
	files.erase("filler")
	files.sort()
	return files


## Returns the ways in which the library and the editor write files. Each is [file name, function(path, large) that returns whether it succeeded, start of the error
## message].
func ways() -> Array[Array]:
	var files := SceneFiles.new()
	var marked := func(resource: Resource, path: String) -> bool:
		resource.take_over_path(path)
		files.mark(resource)
		files.save()
		return not "Cannot write" in str(errors.take())
	return [
		["forest.state", func(path: String, large: bool) -> bool: return make_state(200_000 if large else 20).save_to_file(path) == OK,
			"ScatterState.save_to_file"],
		["lanes.mask", func(path: String, large: bool) -> bool: return make_mask(150 if large else 1).save_to_file(path) == OK, "ScatterMask.save_to_file"],
		["painted.res", func(path: String, large: bool) -> bool: return marked.call(make_mask(150 if large else 1), path), ""],
		["painted.tres", func(path: String, large: bool) -> bool: return marked.call(make_mask(150 if large else 1), path), ""],
		["placed.res", func(path: String, large: bool) -> bool: return marked.call(make_state(200_000 if large else 20), path), ""],
		["impostor.res", func(path: String, large: bool) -> bool: return WholeFile.save(make_mesh(128 if large else 4), path) == OK, ""],
		["packed.res", func(path: String, large: bool) -> bool:
			return WholeFile.save(make_mask(150 if large else 1), path, ResourceSaver.FLAG_COMPRESS) == OK, ""],
		["undone.res", func(path: String, large: bool) -> bool:
			var bytes := PackedByteArray()
			bytes.resize(600_000 if large else 600)
			files.put(path, bytes, null)
			return not "Cannot write" in str(errors.take()), ""],
	]


func test_a_full_disk_leaves_the_old_files() -> void:
	for argument in arguments:
		if argument.begins_with("folder="):
			folder = argument.trim_prefix("folder=")
		elif argument == "fill":
			filler = "filler"
	filler = folder.path_join(filler) if not filler.is_empty() else ""
	for way: Array in ways():
		var path := folder.path_join(way[0])
		var write: Callable = way[1]
		check(write.call(path, false), way[0] + " is written")
		var before := FileAccess.get_file_as_bytes(path)
		var there := names()
		check(before.size() > 0, way[0] + " exists")
		fill()
		check(not write.call(path, true), way[0] + " does not fit")
		var messages := errors.take()
		if not (way[2] as String).is_empty() and check(messages.size() == 1, str(messages)):
			for word: String in [way[2], path, "full", "The old file is unchanged"]:
				check(word in messages[0], "'%s' in '%s'" % [word, messages[0]])
		check(FileAccess.get_file_as_bytes(path) == before, way[0] + " is unchanged")
		check_equal(names(), there, "no partial file is left")
		make_room()
		check(write.call(path, false), way[0] + " can be written again")
		errors.take()
		DirAccess.remove_absolute(path)
