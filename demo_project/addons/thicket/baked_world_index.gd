class_name ScatterBakedWorldIndex
extends RefCounted
## The index of a baked world: its tiles, and the meshes and materials that they use. [code]demo_project/bake_export.sh[/code]
## writes it as [code]baked_world.baked[/code], and [ScatterBakedWorld] reads it.

const BakedFile := preload("res://addons/thicket/baked_world_file.gd")

const _DIGEST_BYTES := 32
const _TILE_BYTES := 36 + _DIGEST_BYTES
const MOST_METERS := 1e12

## The path of the file from which the index was read.
var path := ""
## A hash of the settings that determine all instances.
var scene_digest := ""
## The edge length of a tile in meters.
var tile_size := 0.0
## The world position of the origin of the baked scene: x, y, z in meters.
var world_offset := PackedFloat64Array([0.0, 0.0, 0.0])
## The names of the layers, in the order of the bake.
var layer_names := PackedStringArray()
## The paths of the meshes, all in [code]res://[/code]. Tiles refer to them by index.
var meshes := PackedStringArray()
## The paths of the materials, all in [code]res://[/code]. Tiles refer to them by index.
var materials := PackedStringArray()
## The column and row of each tile. Tile (i, j) begins at world x = i * [member tile_size] and z = j * [member tile_size].
var tiles := PackedInt32Array()
## The number of instances in each tile.
var instances := PackedInt32Array()
## The origin of each tile's transforms in the world: x, y, z in meters.
var centers := PackedFloat64Array()
## The SHA-256 of each tile's file, 32 bytes each; see [code]baked_world_file.gd[/code].
var digests := PackedByteArray()

## The error in the file; empty if there is none.
var problem := ""


## Reads the index from a file. Returns false and sets [member problem] if the file is not a valid index.
func read(from: String) -> bool:
	path = from
	var file := BakedFile.new()
	if file.read(from):
		_read_content(file)
	problem = file.problem if file.problem else problem
	return problem.is_empty()


## Returns the content of a file that [method read] can read.
func packed() -> PackedByteArray:
	var header := {
		"kind": "index", "scene_digest": scene_digest, "tile_size": tile_size, "world_offset": Array(world_offset), "count": instances.size(),
		"layer_names": layer_names, "meshes": meshes, "materials": materials,
	}
	var payload := tiles.to_byte_array()
	for bytes: PackedByteArray in [instances.to_byte_array(), centers.to_byte_array(), digests]:
		payload.append_array(bytes)
	return BakedFile.packed(header, payload)


## Returns the path of the file for the tile with this column and row, in a folder next to the index file.
func tile_path(tile: Vector2i) -> String:
	return "%s/tiles/tile_%d_%d.%s" % [path.get_base_dir(), tile.x, tile.y, BakedFile.EXTENSION]


## Returns the SHA-256 that the file of the tile at this index must have.
func digest_of(index: int) -> PackedByteArray:
	return digests.slice(index * _DIGEST_BYTES, (index + 1) * _DIGEST_BYTES)


func _read_content(file: BakedFile) -> void:
	var header := file.header
	if file.text(header, "kind") != "index":
		problem = "it is not an index of a baked world"
		return
	scene_digest = file.text(header, "scene_digest")
	tile_size = file.number(header, "tile_size", 0.01, MOST_METERS)
	world_offset = file.numbers(header, "world_offset", 3)
	layer_names = PackedStringArray(file.list(header, "layer_names", TYPE_STRING))
	meshes = PackedStringArray(file.list(header, "meshes", TYPE_STRING))
	materials = PackedStringArray(file.list(header, "materials", TYPE_STRING))
	for resource in meshes + materials:
		if not is_in_project(resource):
			problem = "its meshes and materials must be in res://, got %s" % resource.left(80)
	var count := file.whole(header, "count", 0, BakedFile.MOST_BYTES / _TILE_BYTES)
	if file.payload.size() != count * _TILE_BYTES:
		problem = "it must have %d bytes for %d tiles, got %d" % [count * _TILE_BYTES, count, file.payload.size()]
	if problem or file.problem:
		return
	tiles = file.payload.slice(0, count * 8).to_int32_array()
	instances = file.payload.slice(count * 8, count * 12).to_int32_array()
	centers = file.payload.slice(count * 12, count * 36).to_float64_array()
	digests = file.payload.slice(count * 36)


## Returns true if a path can only refer to a file of the game itself. Resources from elsewhere may contain untrusted scripts.
static func is_in_project(resource: String) -> bool:
	return resource.begins_with("res://") and not ".." in resource
