@tool
extends RefCounted
## Paints the density of a layer: a stroke is a row of dabs, and one step of undo.
##
## Of the mask under a stroke those blocks of pixels are kept that have changed, packed, as they were and as they are.

const MaskFiles := preload("res://addons/thicket/editor/mask_files.gd")

## As [code]ScatterMask.Mode[/code].
enum Mode { PAINT, ERASE, SMOOTH }

## Pixels along the side of a block that undo keeps.
const BLOCK := 64
## Dabs are this part of the radius apart.
const SPACING := 0.25

var mode := Mode.PAINT
## Meters, above 0.
var radius := 8.0
## How far a single dab goes in its middle, 0 to 1.
var strength := 0.5
## The part of the radius within which the strength is full, 0 to 1.
var hardness := 0.5
## Where masks are kept.
var files := MaskFiles.new()

var _scatter: Node3D
var _layer: Resource
var _mask: Resource
var _stroke_mode := Mode.PAINT
var _is_new := false
var _scene_path := ""
var _before: Dictionary[Vector2i, PackedByteArray] = {}
var _last := Vector2.ZERO


## True between [method begin] and [method finish].
func is_painting() -> bool:
	return _mask != null


## Starts a stroke on a layer of a scatter with a dab at world x and z. Without a mask the layer gets one: empty for
## painting, so that the layer stands only where it is painted, and full for erasing. Returns what stands in the way, in
## a sentence; empty if the stroke has begun.
func begin(scatter: Node3D, layer: Resource, scene_path: String, stroke_mode: Mode, at: Vector2) -> String:
	finish(null)
	var mask: Resource = layer.get(&"mask")
	if mask == null:
		if stroke_mode == Mode.SMOOTH:
			return "Nothing is painted on this layer yet."
		mask = files.create(scene_path, layer, 0.0 if stroke_mode == Mode.PAINT else 1.0)
		if mask == null:
			return files.problem
		_is_new = true
		layer.set(&"mask", mask)
	_scatter = scatter
	_scene_path = scene_path
	_layer = layer
	_mask = mask
	_stroke_mode = stroke_mode
	_last = at
	_dab(at)
	return ""


## Goes on to world x and z, with dabs on the way.
func move(at: Vector2) -> void:
	if _mask == null:
		return
	var step := maxf(radius * SPACING, 0.01)
	var way := at - _last
	var dabs := floori(way.length() / step)
	var direction := way.normalized()
	for dab in dabs:
		_last += direction * step
		_dab(_last)


## Ends the stroke and makes it a step of undo, unless nothing has changed.
func finish(undo_redo: EditorUndoRedoManager) -> void:
	if _mask == null:
		return
	files.mark(_mask)
	var before := {}
	var after := {}
	for block in _before:
		var now: PackedByteArray = _mask.call(&"get_pixels", _pixels(block))
		if now != _before[block]:
			before[block] = _before[block].compress(FileAccess.COMPRESSION_ZSTD)
			after[block] = now.compress(FileAccess.COMPRESSION_ZSTD)
	if undo_redo != null and is_instance_valid(_scatter) and (_is_new or not after.is_empty()):
		var name: String = ["Paint", "Erase", "Smooth"][_stroke_mode]
		undo_redo.create_action("%s Density of %s" % [name, _layer.resource_name], UndoRedo.MERGE_DISABLE, _scatter)
		if _is_new:
			undo_redo.add_do_property(_layer, &"mask", _mask)
			undo_redo.add_undo_property(_layer, &"mask", null)
		undo_redo.add_do_method(self, &"restore", _mask, after)
		undo_redo.add_undo_method(self, &"restore", _mask, before)
		if _is_new:
			undo_redo.add_do_method(files, &"keep", _mask, _scene_path)
			undo_redo.add_undo_method(files, &"drop", _mask, _scene_path)
		undo_redo.commit_action(false)
	_before.clear()
	_scatter = null
	_layer = null
	_mask = null
	_is_new = false


## Puts packed blocks of pixels back; for undo.
func restore(mask: Resource, blocks: Dictionary) -> void:
	for block: Vector2i in blocks:
		var packed: PackedByteArray = blocks[block]
		mask.call(&"set_pixels", _pixels(block), packed.decompress(BLOCK * BLOCK, FileAccess.COMPRESSION_ZSTD))
	files.mark(mask)


func _dab(at: Vector2) -> void:
	var reach := Vector2(radius, radius)
	var touched: Rect2i = _mask.call(&"get_pixel_rect", Rect2(at - reach, 2.0 * reach))
	var first := _block_of(touched.position)
	var last := _block_of(touched.end - Vector2i.ONE)
	for y in range(first.y, last.y + 1):
		for x in range(first.x, last.x + 1):
			var block := Vector2i(x, y)
			if not _before.has(block):
				_before[block] = _mask.call(&"get_pixels", _pixels(block))
	_mask.call(&"paint", at, radius, strength, hardness, _stroke_mode)


static func _pixels(block: Vector2i) -> Rect2i:
	return Rect2i(block * BLOCK, Vector2i(BLOCK, BLOCK))


static func _block_of(pixel: Vector2i) -> Vector2i:
	return Vector2i(floori(pixel.x / float(BLOCK)), floori(pixel.y / float(BLOCK)))
