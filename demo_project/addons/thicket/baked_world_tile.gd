extends RefCounted
## Reads the file of one tile of a baked world and builds its nodes.
##
## The header of a tile's file has [code]tile[/code] (column and row), [code]instances[/code], [code]scene_digest[/code] and [code]nodes[/code]. Each
## node has [code]name[/code], [code]mesh[/code] and [code]material[/code] (indices in the lists of the index, -1 for no material),
## [code]count[/code], [code]from[/code] (the offset of its [member MultiMesh.buffer] in the payload, in bytes), [code]use_colors[/code],
## [code]use_custom_data[/code], [code]cast_shadow[/code], [code]render_layers[/code], [code]begin[/code] and [code]end[/code] (the visibility range
## in meters). If LODs share a custom AABB, the node also has [code]box[/code] (the minimum x, y and z, followed by the size).

const BakedFile := preload("res://addons/thicket/baked_world_file.gd")
const Index := preload("res://addons/thicket/baked_world_index.gd")

const MOST_NODES := 1 << 16
const MOST_METERS := 1e9

## The tile's root node, without a parent. Null before [method build], and if there is a [member problem].
var node: Node3D
## The error that prevents building [member node]; empty if there is none.
var problem := ""
## The task of the engine's thread pool that reads this tile; -1 if the engine has no threads.
var task := -1
## Set it to true to end the work early. May be set on any thread.
var is_cancelled := false

var _file := BakedFile.new()
var _path: String
var _tile: Vector2i
var _instances: int
var _scene_digest: String
var _digest: PackedByteArray
var _meshes: Array[Mesh]
var _materials: Array[Material]


## Prepares to read the tile at [param tile_index] in the lists of [param index]. The tile's file refers to meshes and materials by their indices in [param meshes] and
## [param materials]. An entry is null if it could not be loaded.
func _init(index: Index, tile_index: int, meshes: Array[Mesh], materials: Array[Material]) -> void:
	_tile = Vector2i(index.tiles[2 * tile_index], index.tiles[2 * tile_index + 1])
	_path = index.tile_path(_tile)
	_instances = index.instances[tile_index]
	_scene_digest = index.scene_digest
	_digest = index.digest_of(tile_index)
	_meshes = meshes
	_materials = materials


## Reads the file and checks its hash. Sets [member problem] if the file cannot be used. May run on any thread.
func read() -> void:
	if not _file.read(_path):
		problem = "%s cannot be read: %s" % [_path, _file.problem]
	elif _file.digest != _digest:
		problem = "%s is not the file that the index names: its SHA-256 must be %s, got %s" % [_path, _digest.hex_encode(), _file.digest.hex_encode()]


## Builds [member node] from the content that [method read] has read, unless there is a [member problem] or the work was canceled. Sets
## [member problem] if the content is invalid. May run on any thread if the engine has a renderer.
func build() -> void:
	if problem or is_cancelled:
		return
	node = Node3D.new()
	_add_all()
	if _file.problem or is_cancelled:
		problem = "%s has a value that cannot be used: %s" % [_path, _file.problem]
		drop()
	_file = null


## Calls [method read], then [method build].
func run() -> void:
	read()
	build()


## Frees [member node] if it is not null.
func drop() -> void:
	if node != null:
		node.free()
	node = null


func _add_all() -> void:
	var file := _file
	var header := file.header
	node.name = "Tile_%d_%d" % [_tile.x, _tile.y]
	if file.numbers(header, "tile", 2) != PackedFloat64Array([_tile.x, _tile.y]) or file.text(header, "scene_digest") != _scene_digest \
			or file.whole(header, "instances", 0, 0x7fffffff) != _instances:
		file.problem = "it belongs to another tile or bake"
	var entries := file.list(header, "nodes", TYPE_DICTIONARY)
	if entries.size() > MOST_NODES:
		file.problem = "nodes must have %d entries at most, got %d" % [MOST_NODES, entries.size()]
	var remaining_bytes := BakedFile.MOST_BYTES # Nodes may share bytes of the payload, so all nodes together could need far more memory than the file.
	for entry: Dictionary in entries:
		if file.problem or is_cancelled:
			return
		remaining_bytes -= _add(file, entry, remaining_bytes)


## Adds the node of an entry. Returns the size of its buffer in bytes, which is at most [param max_bytes], or 0 if no node was added.
func _add(file: BakedFile, entry: Dictionary, max_bytes: int) -> int:
	var colors := file.flag(entry, "use_colors")
	var custom_data := file.flag(entry, "use_custom_data")
	var stride := 4 * (12 + 4 * int(colors) + 4 * int(custom_data))
	var count := file.whole(entry, "count", 0, mini(max_bytes, file.payload.size()) / stride)
	var from := file.whole(entry, "from", 0, file.payload.size() - count * stride)
	var mesh := file.whole(entry, "mesh", 0, _meshes.size() - 1)
	var material := file.whole(entry, "material", -1, _materials.size() - 1)
	var name := file.text(entry, "name")
	var instance := MultiMeshInstance3D.new()
	instance.name = name if name else "Instances"
	instance.cast_shadow = file.whole(entry, "cast_shadow", 0, 3) as GeometryInstance3D.ShadowCastingSetting
	instance.layers = file.whole(entry, "render_layers", 0, 0xffffffff)
	instance.visibility_range_begin = file.number(entry, "begin", 0.0, MOST_METERS)
	instance.visibility_range_end = file.number(entry, "end", 0.0, MOST_METERS)
	var box := file.numbers(entry, "box", 6) if entry.get("box") != null else PackedFloat64Array()
	if file.problem or _meshes[mesh] == null: # A missing mesh was already reported when it was loaded.
		instance.free()
		return 0
	var multimesh := MultiMesh.new()
	multimesh.transform_format = MultiMesh.TRANSFORM_3D
	multimesh.use_colors = colors
	multimesh.use_custom_data = custom_data
	# The mesh is set before the buffer. Otherwise the renderer would read the buffer back to compute the bounding box of the instances.
	multimesh.mesh = _meshes[mesh]
	multimesh.instance_count = count
	if count > 0:
		multimesh.buffer = file.payload.slice(from, from + count * stride).to_float32_array()
	instance.multimesh = multimesh
	if material >= 0:
		instance.material_override = _materials[material]
	if not box.is_empty():
		instance.custom_aabb = AABB(Vector3(box[0], box[1], box[2]), Vector3(box[3], box[4], box[5]))
	node.add_child(instance, true)
	return count * stride
