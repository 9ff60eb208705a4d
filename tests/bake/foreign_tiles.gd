extends SceneTree
## Reads malicious files of a baked world and prints the error with which each was rejected. In some files, bits are flipped. In the other files,
## fields are replaced and the digests match. Arguments: the path of the index, and a folder for the files.

const BakedFile := preload("res://addons/thicket/baked_world_file.gd")
const Index := preload("res://addons/thicket/baked_world_index.gd")
const Tile := preload("res://addons/thicket/baked_world_tile.gd")
const FLIPS := 200

var _index := Index.new()
var _good := BakedFile.new() # The first tile.
var _bytes := PackedByteArray()
var _folder := ""
var _meshes: Array[Mesh] = []


func _initialize() -> void:
	_folder = OS.get_cmdline_user_args()[1]
	_index.read(OS.get_cmdline_user_args()[0])
	for mesh in _index.meshes:
		_meshes.append(load(mesh))
	var path := _index.tile_path(Vector2i(_index.tiles[0], _index.tiles[1]))
	_good.read(path)
	_bytes = FileAccess.get_file_as_bytes(path)
	_index.path = _folder.path_join("index.baked")
	DirAccess.make_dir_recursive_absolute(_folder.path_join("tiles"))
	_print("good", _refusal_of(_bytes))
	_flip_bits()
	_replace_fields(_good.header)
	_replace_fields(_good.header.nodes[0])
	_cut()
	_replace_fields_of_index()
	_change_index()
	_meshes.clear()
	quit()


func _print(what: String, refused: String) -> void:
	print("case ", JSON.stringify([what, refused]))


## Returns the error with which the first tile is rejected if its file has these bytes, or an empty string if it is
## accepted. Leaves the digest in the index unchanged.
func _refusal_of(bytes: PackedByteArray) -> String:
	var at := Vector2i(_index.tiles[0], _index.tiles[1])
	FileAccess.open(_index.tile_path(at), FileAccess.WRITE).store_buffer(bytes)
	var tile := Tile.new(_index, 0, _meshes, [])
	tile.run()
	if (tile.node == null) == tile.problem.is_empty():
		return "BOTH OR NEITHER"
	tile.drop()
	return tile.problem


func _flip_bits() -> void:
	var random := RandomNumberGenerator.new()
	random.seed = 5
	for flip in FLIPS:
		var bytes := _bytes.duplicate()
		var at := random.randi_range(0, bytes.size() - 1)
		bytes[at] ^= 1 << random.randi_range(0, 7)
		_print("flip", _refusal_of(bytes))


## Reads a changed tile with a matching digest in the index, as if an attacker had written the index as well.
func _foreign(header: Dictionary, payload: PackedByteArray) -> String:
	var bytes := BakedFile.packed(header, payload)
	var kept := _index.digests
	_index.digests = BakedFile.digest_in(bytes)
	var refused := _refusal_of(bytes)
	_index.digests = kept
	return refused


func _replace_fields(of: Dictionary) -> void:
	for field: String in of.keys():
		var kept: Variant = of[field]
		for value: Variant in _values():
			if typeof(value) != typeof(kept) or value != kept:
				of[field] = value
				_print("%s = %s" % [field, JSON.stringify(value).left(40)], _foreign(_good.header, _good.payload))
		of.erase(field)
		_print("no " + field, _foreign(_good.header, _good.payload))
		of[field] = kept


func _values() -> Array:
	var deep: Array = []
	for level in 300:
		deep = [deep]
	return [null, true, "x", "x".repeat(5000), -1, -2, 0.5, 1e9, 1e300, INF, NAN, [], {}, [1], [{}], [[[]]], deep, [1, 2, 3, 4, 5, "6"], [NAN, 1], 4294967296.0]


func _cut() -> void:
	for part in 20:
		_print("cut", _refusal_of(_bytes.slice(0, _bytes.size() * part / 20)))
	_print("payload cut", _foreign(_good.header, _good.payload.slice(0, 100)))
	_print("no payload", _foreign(_good.header, PackedByteArray()))
	var bomb := _bytes.duplicate() # This payload claims to unpack to 4 GB.
	bomb.encode_u32(44, 0xffffffff)
	bomb = _with_digest(bomb)
	_index.digests = BakedFile.digest_in(bomb)
	_print("bomb", _refusal_of(bomb))
	bomb.encode_u32(44, 1 << 29)
	bomb = _with_digest(bomb)
	_index.digests = BakedFile.digest_in(bomb)
	_print("small bomb", _refusal_of(bomb))


static func _with_digest(bytes: PackedByteArray) -> PackedByteArray:
	var hashing := HashingContext.new()
	hashing.start(HashingContext.HASH_SHA256)
	hashing.update(bytes.slice(40))
	return bytes.slice(0, 8) + hashing.finish() + bytes.slice(40)


func _index_refusal_of(bytes: PackedByteArray) -> String:
	var path := _folder.path_join("foreign.baked")
	FileAccess.open(path, FileAccess.WRITE).store_buffer(bytes)
	var index := Index.new()
	index.read(path)
	return index.problem


func _replace_fields_of_index() -> void:
	var file := BakedFile.new()
	file.read(OS.get_cmdline_user_args()[0])
	for field: String in file.header.keys():
		var kept: Variant = file.header[field]
		for value: Variant in _values():
			if typeof(value) != typeof(kept) or value != kept:
				file.header[field] = value
				_print("index %s = %s" % [field, JSON.stringify(value).left(40)], _index_refusal_of(BakedFile.packed(file.header, file.payload)))
		file.header[field] = kept
	for mesh: String in ["user://evil.tscn", "/tmp/evil.res", "res://../evil.res", "uid://evil", "evil.res"]:
		file.header.meshes = [mesh]
		_print("index mesh " + mesh, _index_refusal_of(BakedFile.packed(file.header, file.payload)))


func _change_index() -> void:
	var bytes := FileAccess.get_file_as_bytes(OS.get_cmdline_user_args()[0])
	for at in bytes.size():
		var changed := bytes.duplicate()
		changed[at] ^= 1 << (at % 8)
		_print("index flip", _index_refusal_of(changed))
