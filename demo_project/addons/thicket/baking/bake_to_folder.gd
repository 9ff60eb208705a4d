extends RefCounted
## Generates tiles of a scene as files, from which another machine can build a bake. This is the [code]out=FOLDER[/code]
## mode of [code]bake_world.gd[/code], for machines with an engine but without Python. [code]tools/bake/README.md[/code]
## in Thicket's repository describes how to use the folder. It contains:
## - [code]world.json[/code]: the description of the scene from [code]scene_description.gd[/code], and the models of the layers;
## - [code]models/[/code]: files for the models that have no file in the project;
## - [code]tiles/tile_I_J.rows[/code]: messages like those that a driver receives. Each is a JSON object, preceded by its length (32 bits,
##   little-endian) and followed by as many bytes as its [code]bytes[/code] field specifies. The first message has the column and row of the
##   tile, identifies the bake in [code]of[/code], and has the [code]sha256[/code] of everything that follows. Each additional message has one
##   game tile, as [code]bake_grid.gd[/code] describes it, with the rows from [method ScatterTile.get_rows].
##
## Files are moved to their final paths only when they are complete. Complete files are not generated again.

const SceneDescription := preload("res://addons/thicket/baking/scene_description.gd")
const ModelFiles := preload("res://addons/thicket/baking/model_files.gd")

const WORLD := "world.json"
const PART := ".part"
const UNWRITABLE := "Cannot write %s: %s. Check that the disk has room and the folder is writable, or choose another out."
const SECONDS_A_LINE := 10.0
const CHUNK_BYTES := 1 << 22
## The keys whose values must not change when a bake continues in an existing folder. If a value has changed, the error
## contains the string for its key, the value in the folder and the current value.
const FIXED_KEYS: Dictionary[String, String] = {
	"scene": "the scene is different (%s, not %s)", "rect": "the rectangle is different (%s, not %s)",
	"tile_size": "the tile size is different (%s m, not %s m)", "layers": "the layers are different (%s, not %s)", "parts": "",
}

## The error in the arguments or the reason why no more tiles can be generated; empty if there is neither.
var problem := ""

var _out_folder := ""
var _description: SceneDescription
var _tiles: Array[PackedInt64Array] = [] ## The requested columns and rows; empty for all tiles.
var _slice := PackedInt64Array([1, 1]) ## Which part of the tiles to generate, from 1, and the number of parts.
var _world := {}
var _stored_bytes := 0 ## The number of bytes already stored in the current file.
var _counts := {"made": 0, "kept": 0, "failed": 0}


## Reads the arguments of the command line. Sets [member problem] if one is invalid.
func _init(arguments: Dictionary[String, String]) -> void:
	_out_folder = arguments.get("out", "")
	if not _out_folder.is_absolute_path() or ("://" in _out_folder and not _out_folder.begins_with("res://") and not _out_folder.begins_with("user://")):
		problem = "out must be the absolute path of a folder, such as out=/data/baked, got '%s'." % _out_folder
	_description = SceneDescription.new(arguments)
	problem = problem if problem else _description.problem
	if arguments.has("tiles"):
		for text in arguments.tiles.split(" ", false):
			var pair := text.split(",")
			if pair.size() != 2 or not (pair[0].is_valid_int() and pair[1].is_valid_int()):
				problem = "tiles must be pairs of integers I,J separated by spaces, got '%s'." % text
			else:
				_tiles.append(PackedInt64Array([pair[0].to_int(), pair[1].to_int()]))
	if arguments.has("share"):
		var slice := SceneDescription.numbers_in(arguments.share, "/")
		if slice.size() != 2 or slice[0] != int(slice[0]) or slice[1] != int(slice[1]) or slice[0] < 1.0 or slice[0] > slice[1]:
			problem = "share must be K/N, for part K of the tiles in N parts, with K from 1 to N, got '%s'." % arguments.share
		else:
			_slice = PackedInt64Array(slice)


## Generates the missing tiles and returns the exit code: 0 if all requested tiles exist, 1 if tiles failed or could not be written, and 2 if the
## bake could not start.
func make(scatter: TerrainScatter3D, scene: String) -> int:
	if not _describe(scatter, scene) or not _can_continue() or not _begin(scatter):
		printerr("bake_world: ", problem)
		return 2
	var next_line := Time.get_ticks_msec() + 1000.0 * SECONDS_A_LINE
	var count := _count()
	for index in range(_slice[0] - 1, count, _slice[1]):
		_make_tile(scatter, _tile(index))
		if problem:
			printerr("bake_world: ", problem, " Run the same command again to generate the missing tiles.")
			return 1
		if Time.get_ticks_msec() >= next_line:
			next_line = Time.get_ticks_msec() + 1000.0 * SECONDS_A_LINE
			print("bake_world: %d of %d tiles" % [index / _slice[1] + 1, ceili(float(count - _slice[0] + 1) / _slice[1])])
	print("bake_world: {made} tiles generated, {kept} already present, {failed} failed".format(_counts))
	return 0 if _counts.failed == 0 else 1


## Fills [member _world], except for the models. Returns false and sets [member problem] on an error.
func _describe(scatter: TerrainScatter3D, scene: String) -> bool:
	if not _description.describe(scatter):
		problem = _description.problem
		return false
	_world = _description.values
	_world["scene"] = scene
	for warning: String in _world.problems:
		print("bake_world: the scene warns: ", warning)
	var first := _description.grid.tiles.position
	var last := _description.grid.tiles.end - Vector2i.ONE
	for tile in _tiles:
		if tile[0] < first.x or tile[0] > last.x or tile[1] < first.y or tile[1] > last.y:
			problem = "tiles must be from %d,%d to %d,%d, got '%d,%d'. Change tiles or rect." % [
				first.x, first.y, last.x, last.y, tile[0], tile[1]]
	return problem.is_empty()


## Returns a value as it would be after it was written to a JSON file and read back.
static func _json_round_trip(value: Variant) -> Variant:
	return JSON.parse_string(JSON.stringify(value, "", false, true))


## Returns true if the folder is new, belongs to the same bake, or has a description that cannot be read. [method _begin] replaces
## such a description. Otherwise, returns false
## and sets [member problem].
func _can_continue() -> bool:
	var path := _out_folder.path_join(WORLD)
	if not FileAccess.file_exists(path):
		return true
	var stored := _parsed(FileAccess.get_file_as_bytes(path))
	if not stored.has_all(FIXED_KEYS.keys()):
		return true
	var current: Dictionary = _json_round_trip(_world)
	for world: Dictionary in [stored, current]:
		world["layers"] = _indices(world["layers"])
	for key in FIXED_KEYS:
		if stored[key] != current[key]:
			problem = "%s contains tiles of another bake: %s. Choose another out, or remove the files in this one." % [
				_out_folder, FIXED_KEYS[key] % [stored[key], current[key]] if key != "parts"
				else "these parts of the scene differ: " + _changed_parts(stored.parts, current.parts)]
			return false
	return true


static func _indices(layers: Array) -> Array:
	return layers.map(func(layer: Dictionary) -> int: return int(layer.index))


static func _changed_parts(stored: Dictionary, current: Dictionary) -> String:
	return ", ".join(stored.merged(current).keys().filter(func(name: String) -> bool: return stored.get(name) != current.get(name)))


## Parses bytes as a JSON object. Returns an empty dictionary if they are not one.
static func _parsed(bytes: PackedByteArray) -> Dictionary:
	var json := JSON.new()
	return json.data if json.parse(bytes.get_string_from_utf8()) == OK and json.data is Dictionary else {}


## Writes the models and the description. On failure, returns false and sets [member problem].
func _begin(scatter: TerrainScatter3D) -> bool:
	var models: Array[Dictionary] = []
	var all_layers := scatter.get_all_layers()
	for layer: Dictionary in _world["layers"]:
		var files := ModelFiles.new(all_layers[layer.index], layer.index)
		problem = problem if problem else files.problem
		models.append({"index": layer.index, "models": files.models, "material": files.material})
		for path in files.new_files:
			_write_whole(_out_folder.path_join(path), func(file: FileAccess) -> String: return _store(file, files.new_files[path]))
	_world.models = models
	var text := JSON.stringify(_world, " ", false, true).to_utf8_buffer()
	_write_whole(_out_folder.path_join(WORLD), func(file: FileAccess) -> String: return _store(file, text))
	return problem.is_empty()


func _count() -> int:
	return _description.grid.tiles.size.x * _description.grid.tiles.size.y if _tiles.is_empty() else _tiles.size()


## Returns the tile at this index, counted row by row, or in the order of the requested tiles.
func _tile(index: int) -> Vector2i:
	if not _tiles.is_empty():
		return Vector2i(_tiles[index][0], _tiles[index][1])
	var tiles := _description.grid.tiles
	return tiles.position + Vector2i(index % tiles.size.x, index / tiles.size.x)


func _make_tile(scatter: TerrainScatter3D, tile: Vector2i) -> void:
	var path := _out_folder.path_join("tiles/tile_%d_%d.rows" % [tile.x, tile.y])
	var header := {
		"tile": "%d,%d" % [tile.x, tile.y], "sha256": "0".repeat(64), "bytes": 0,
		"of": {"scene_digest": _world["scene_digest"], "rect": _world["rect"], "tile_size": _world["tile_size"],
			"layers": _indices(_world["layers"])},
	}
	if _is_whole(path, header):
		_counts.kept += 1
		return
	DirAccess.remove_absolute(path)
	var failure := _write_whole(path, func(file: FileAccess) -> String: return _write_rows(file, scatter, tile, header))
	if failure:
		printerr("bake_world: tile %d,%d failed. %s" % [tile.x, tile.y, failure])
	_counts["failed" if failure else "made"] += 1


## Returns true if a tile's file begins with this header, except for the hash, and its content matches the hash in the file.
func _is_whole(path: String, header: Dictionary) -> bool:
	var file := FileAccess.open(path, FileAccess.READ) if FileAccess.file_exists(path) else null
	if file == null or file.get_length() < 4:
		return false
	var header_in_file := _parsed(file.get_buffer(mini(file.get_32(), message(header).size())))
	var expected: Dictionary = _json_round_trip(header)
	expected.sha256 = header_in_file.get("sha256", "")
	var hashing := HashingContext.new()
	hashing.start(HashingContext.HASH_SHA256)
	while file.get_position() < file.get_length():
		hashing.update(file.get_buffer(CHUNK_BYTES))
	return header_in_file == expected and hashing.finish().hex_encode() == expected.sha256


## Writes a file with [param write] and moves it to its path once it is complete. Returns the result of [param write],
## which is the reason for a failure or an empty string. Sets [member problem] if the file cannot be written.
func _write_whole(path: String, write: Callable) -> String:
	var partial := path.get_base_dir().path_join("." + path.get_file() + PART)
	var error := DirAccess.make_dir_recursive_absolute(path.get_base_dir())
	var file := FileAccess.open(partial, FileAccess.WRITE) if error == OK else null
	if file == null:
		problem = UNWRITABLE % [path, error_string(error if error != OK else FileAccess.get_open_error())]
		return ""
	_stored_bytes = 0
	var failure: String = write.call(file)
	file.close()
	# Closing the file writes the last buffered bytes, and the disk may have been full by then.
	if not failure and not problem:
		error = DirAccess.rename_absolute(partial, path) if _length(partial) == _stored_bytes else ERR_FILE_CANT_WRITE
		if error != OK:
			problem = UNWRITABLE % [path, error_string(error)]
	if failure or problem:
		DirAccess.remove_absolute(partial)
	return failure


static func _length(path: String) -> int:
	var file := FileAccess.open(path, FileAccess.READ)
	return file.get_length() if file != null else -1


func _store(file: FileAccess, bytes: PackedByteArray) -> String:
	_stored_bytes += bytes.size()
	if not file.store_buffer(bytes):
		problem = UNWRITABLE % [file.get_path_absolute(), error_string(file.get_error())]
	return ""


## Writes all messages of a tile, then the first message again with the final hash. Returns the reason for a failure, or an empty string.
func _write_rows(file: FileAccess, scatter: TerrainScatter3D, tile: Vector2i, header: Dictionary) -> String:
	var hashing := HashingContext.new()
	hashing.start(HashingContext.HASH_SHA256)
	_store(file, message(header))
	for game_tile in _description.grid.parts_of(tile):
		var rows := rows_of(scatter, game_tile)
		if rows.is_empty():
			return generation_error(game_tile)
		game_tile.bytes = rows.size()
		for bytes: PackedByteArray in [message(game_tile), rows]:
			hashing.update(bytes)
			_store(file, bytes)
		if problem:
			return ""
	header.sha256 = hashing.finish().hex_encode()
	file.seek(0)
	var total_bytes := _stored_bytes
	_store(file, message(header)) # The first header had the same length.
	_stored_bytes = total_bytes
	return ""


## Returns a JSON object as bytes, preceded by its length.
static func message(header: Dictionary) -> PackedByteArray:
	var text := JSON.stringify(header, "", false, true).to_utf8_buffer()
	var length := PackedByteArray([0, 0, 0, 0])
	length.encode_u32(0, text.size())
	return length + text


## Returns the rows of a game tile. If the tile cannot be generated, an error is printed and the result is empty.
static func rows_of(scatter: TerrainScatter3D, game_tile: Dictionary) -> PackedByteArray:
	var layer := scatter.get_all_layers()[game_tile["layer"]]
	var instances := scatter.build_tile(layer, Vector2i(game_tile["x"], game_tile["y"]))
	return instances.get_rows() if instances.get_mesh_count() > 0 else PackedByteArray()


## Returns the error to report if a game tile cannot be generated.
static func generation_error(game_tile: Dictionary) -> String:
	return "Tile %d, %d of layer %d cannot be generated. See the printed error for details." % [game_tile["x"], game_tile["y"], game_tile["layer"]]
