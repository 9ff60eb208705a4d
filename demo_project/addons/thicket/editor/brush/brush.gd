@tool
extends RefCounted
## Paints the density of layers. A stroke consists of dabs, which are overlapping round marks, and is one undo step for
## all of its layers.

const MaskStroke := preload("res://addons/thicket/editor/brush/mask_stroke.gd")
const SceneFiles := preload("res://addons/thicket/editor/scene_files.gd")
const StrokePlaces := preload("res://addons/thicket/editor/brush/stroke_places.gd")
const SurfacePlace := preload("res://addons/thicket/editor/ground/surface_place.gd")

var mode: ScatterMask.Mode = ScatterMask.MODE_PAINT
## The radius of the brush in meters, above 0.
var radius := 8.0
## The effect of a single dab at its center, from 0 to 1.
var strength := 0.5
## The fraction of the radius with full strength, from 0 to 1.
var hardness := 0.5
## The manager of the files in which masks are stored.
var files := SceneFiles.new()

var _scatter: TerrainScatter3D
var _strokes: Array[MaskStroke] = []
var _title := ""
var _stroke_mode: ScatterMask.Mode = ScatterMask.MODE_PAINT
var _scene_path := ""
var _planet_radius := 0.0 ## The radius of the planet that the masks cover; 0 if they are projected along the y axis.
var _last_position := Vector3.ZERO


## Returns true between [method begin] and [method finish].
func is_painting() -> bool:
	return not _strokes.is_empty()


## Starts a stroke on layers of a scatter with a dab at a position on the ground. A layer without a mask gets one. For painting,
## the mask is empty, so that the layer grows only where it is painted; for erasing, it is full. Returns an empty string
## on success, or the reason for a failure.
func begin(scatter: TerrainScatter3D, layers: Array[ScatterLayer], scene_path: String, stroke_mode: ScatterMask.Mode,
		position: Vector3) -> String:
	finish(null)
	if SurfacePlace.is_planet(scatter) and not covers_planet(scatter, layers) and layers.any(func(layer: ScatterLayer) -> bool: return layer.on_surfaces):
		return "Some of these layers grow on all sides of the planet, and some only on its top: select layers of one kind (on_surfaces)."
	_planet_radius = SurfacePlace.planet_radius(scatter) if covers_planet(scatter, layers) else 0.0
	for layer in layers:
		if layer.mask == null and stroke_mode != ScatterMask.MODE_SMOOTH:
			var mask := ScatterMask.new()
			mask.background = 0.0 if stroke_mode == ScatterMask.MODE_PAINT else 1.0
			if not files.create(scene_path, mask, layer.resource_name, "mask"):
				_discard_strokes(scene_path)
				return files.problem
			layer.mask = mask
			_stroke_of(mask).new_layers.append(layer)
		elif layer.mask != null:
			_stroke_of(layer.mask)
	if _strokes.is_empty():
		return "Smooth needs a mask, but %s none yet: paint or erase first." % ("these layers have" if layers.size() > 1 else "this layer has")
	_scatter = scatter
	_scene_path = scene_path
	_stroke_mode = stroke_mode
	var verb: String = ["Paint", "Erase", "Smooth"][stroke_mode]
	_title = "%s Density of %s" % [verb, layers[0].resource_name if layers.size() == 1 else "%d Layers" % layers.size()]
	_dab(_mask_position(position))
	return ""


## Continues the stroke to a position on the ground, and adds dabs along the way.
func move(position: Vector3) -> void:
	if not is_painting():
		return
	for point in StrokePlaces.between(_last_position, _mask_position(position), radius):
		_dab(point)


## Ends the stroke and adds an undo step, unless nothing has changed.
func finish(undo_redo: EditorUndoRedoManager) -> void:
	var old_blocks: Array[Dictionary] = []
	var new_blocks: Array[Dictionary] = []
	var has_changed := false
	for stroke in _strokes:
		files.mark(stroke.mask)
		old_blocks.append({})
		new_blocks.append({})
		stroke.changes(old_blocks[-1], new_blocks[-1])
		has_changed = has_changed or not stroke.new_layers.is_empty() or not new_blocks[-1].is_empty()
	if has_changed and undo_redo != null and is_instance_valid(_scatter):
		undo_redo.create_action(_title, UndoRedo.MERGE_DISABLE, _scatter)
		for index in _strokes.size():
			var stroke := _strokes[index]
			for layer: ScatterLayer in stroke.new_layers:
				undo_redo.add_do_property(layer, &"mask", stroke.mask)
				undo_redo.add_undo_property(layer, &"mask", null)
			undo_redo.add_do_method(self, &"restore", stroke.mask, new_blocks[index])
			undo_redo.add_undo_method(self, &"restore", stroke.mask, old_blocks[index])
			if not stroke.new_layers.is_empty():
				files.add_to_undo([stroke.mask], _scene_path, undo_redo)
		undo_redo.commit_action(false)
	_scatter = null
	_strokes.clear()


## Restores compressed blocks of pixels. For undo and redo.
func restore(mask: ScatterMask, blocks: Dictionary) -> void:
	MaskStroke.put(mask, blocks)
	files.mark(mask)


## Returns true if the masks of layers cover a planet, because all of these layers grow on its surfaces.
static func covers_planet(scatter: TerrainScatter3D, layers: Array[ScatterLayer]) -> bool:
	return SurfacePlace.is_planet(scatter) and layers.all(func(layer: ScatterLayer) -> bool: return layer.on_surfaces)


## Returns the masks' coordinates of a position: world x and z or, on a planet, the position relative to its center.
func _mask_position(position: Vector3) -> Vector3:
	return _scatter._to_planet(PackedVector3Array([position]))[0] if _planet_radius > 0.0 else Vector3(position.x, 0.0, position.z)


## Returns the stroke on a mask. Layers may share a mask, which is then painted only once.
func _stroke_of(mask: ScatterMask) -> MaskStroke:
	for stroke in _strokes:
		if stroke.mask == mask:
			return stroke
	_strokes.append(MaskStroke.new(mask))
	_strokes[-1].planet_radius = _planet_radius
	return _strokes[-1]


func _discard_strokes(scene_path: String) -> void:
	for stroke in _strokes:
		for layer in stroke.new_layers:
			layer.mask = null
			files.drop(stroke.mask, scene_path)
	_strokes.clear()


func _dab(position: Vector3) -> void:
	_last_position = position
	for stroke in _strokes:
		stroke.dab(position, radius, strength, hardness, _stroke_mode)
