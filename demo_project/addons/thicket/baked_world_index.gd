class_name BakedWorldIndex
extends Resource
## Which tiles a baked world has. [code]demo_project/bake_export.sh[/code] writes it, [BakedWorld] reads it.

## What names the settings that all instances follow from.
@export var scene_digest := ""
## The side of a tile in meters.
@export var tile_size := 0.0
## By how much places in the world differ from places in the scene that was baked: x, y, z in meters.
@export var world_offset := PackedFloat64Array()
## The layers, in the order of the bake.
@export var layer_names := PackedStringArray()
## Column and row of each tile: tile (i, j) begins at i and j times [member tile_size] in the world's x and z.
@export var tiles := PackedInt32Array()
## How many instances each tile has.
@export var instances := PackedInt32Array()
## Where each tile's transforms start from in the world: x, y, z in meters.
@export var centers := PackedFloat64Array()


## The file of the tile with this column and row, beside the file of this resource.
func tile_path(tile: Vector2i) -> String:
	return "%s/tiles/tile_%d_%d.scn" % [resource_path.get_base_dir(), tile.x, tile.y]
