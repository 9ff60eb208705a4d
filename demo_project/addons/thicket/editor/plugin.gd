@tool
extends EditorPlugin
## The editor's side of Thicket: a brush for densities, gizmos, presets and bake. The nodes work without it.

const Bake := preload("res://addons/thicket/editor/bake_dialog.gd")
const Brush := preload("res://addons/thicket/editor/brush.gd")
const Cursor := preload("res://addons/thicket/editor/brush_cursor.gd")
const ExtentGizmos := preload("res://addons/thicket/editor/extent_gizmos.gd")
const FirstStroke := preload("res://addons/thicket/editor/first_stroke.gd")
const LayerInspector := preload("res://addons/thicket/editor/layer_inspector.gd")
const MaskOverlay := preload("res://addons/thicket/editor/mask_overlay.gd")
const Presets := preload("res://addons/thicket/editor/presets.gd")
const RegionGizmos := preload("res://addons/thicket/editor/region_gizmos.gd")
const Toolbar := preload("res://addons/thicket/editor/toolbar.gd")

## Seconds between two looks at what the extent and the toolbar show.
const REDRAW_SECONDS := 0.25
const RADIUS_STEP := 1.15

## What stands above the 3D view.
var toolbar: Toolbar
## Asks what to bake, and bakes.
var bake: Bake
## Asks what painting a layer that stands everywhere means.
var first_stroke: FirstStroke
## What is painted on the chosen layer.
var mask_overlay := MaskOverlay.new()

var _cursor := Cursor.new()
var _regions := RegionGizmos.new()
var _extent := ExtentGizmos.new()
var _inspector := LayerInspector.new()
var _scatter: Node3D
var _shown: Array = []
var _tiles := 0
var _since_redraw := 0.0
var _watched_mask: Resource
var _mask_version := 0
var _fresh: Array = [] ## Layers of a preset, until they stand or it was told why they do not.


func _enter_tree() -> void:
	toolbar = Toolbar.new()
	toolbar.brush_changed.connect(update_overlays)
	toolbar.preset_chosen.connect(_add_preset)
	toolbar.bake_requested.connect(_open_bake)
	add_control_to_container(CONTAINER_SPATIAL_EDITOR_MENU, toolbar)
	toolbar.hide()
	bake = Bake.new()
	EditorInterface.get_base_control().add_child(bake)
	first_stroke = FirstStroke.new()
	first_stroke.chosen.connect(_stroke_once)
	EditorInterface.get_base_control().add_child(first_stroke)
	_regions.undo_redo = get_undo_redo()
	add_node_3d_gizmo_plugin(_regions)
	add_node_3d_gizmo_plugin(_extent)
	add_inspector_plugin(_inspector)
	EditorInterface.get_resource_filesystem().resources_reimported.connect(_reload_scenes)
	scene_saved.connect(_on_scene_saved)
	scene_closed.connect(toolbar.brush.files.on_scene_closed)


func _exit_tree() -> void:
	_edit(null)
	EditorInterface.get_resource_filesystem().resources_reimported.disconnect(_reload_scenes)
	remove_inspector_plugin(_inspector)
	remove_node_3d_gizmo_plugin(_extent)
	remove_node_3d_gizmo_plugin(_regions)
	remove_control_from_container(CONTAINER_SPATIAL_EDITOR_MENU, toolbar)
	toolbar.queue_free()
	bake.queue_free()
	first_stroke.queue_free()


func _handles(object: Object) -> bool:
	return object is Node3D and object.is_class("TerrainScatter3D")


func _edit(object: Object) -> void:
	toolbar.brush.finish(get_undo_redo())
	var last := _scatter
	_scatter = object as Node3D
	if _scatter != last:
		toolbar.set_brush_on(false) # A click on another node must not paint.
		_fresh.clear()
	_extent.scatter = _scatter
	_cursor.hide()
	for node: Node3D in [last, _scatter]:
		if is_instance_valid(node):
			node.update_gizmos()
	toolbar.show_layers(_scatter)


func _make_visible(visible: bool) -> void:
	toolbar.visible = visible
	if not visible:
		_edit(null)


## What is painted is written when the scene is.
func _save_external_data() -> void:
	toolbar.brush.files.save()


func _process(delta: float) -> void:
	_since_redraw += delta
	if _since_redraw < REDRAW_SECONDS:
		return
	_since_redraw = 0.0
	_update_mask_overlay()
	if is_instance_valid(_scatter):
		_tell_of_fresh_layers()
		var shown := _state(_scatter)
		if shown != _shown:
			_shown = shown
			_scatter.update_gizmos()
			toolbar.show_layers(_scatter)


## What the extent and the toolbar show of a scatter.
func _state(scatter: Node3D) -> Array:
	var state: Array = [scatter, scatter.global_transform, scatter.get(&"terrain")]
	for layer: Resource in scatter.get(&"layers"):
		state.append(layer.resource_name if layer != null else null)
	# Tiles come and go as the camera moves; the line waits until they stay.
	if scatter.call(&"is_settled"):
		_tiles = 0
		for index: int in scatter.get(&"layers").size():
			_tiles = hash([_tiles, scatter.call(&"get_shown_tiles", index)])
	state.append(_tiles)
	return state


func _forward_3d_gui_input(camera: Camera3D, event: InputEvent) -> int:
	if not is_instance_valid(_scatter) or not toolbar.is_brush_on():
		return AFTER_GUI_INPUT_PASS
	if event is InputEventKey:
		return _on_key(event as InputEventKey)
	if not event is InputEventMouse:
		return AFTER_GUI_INPUT_PASS
	var mouse := event as InputEventMouse
	_cursor.aim(camera, mouse.position, _scatter.get(&"terrain"))
	update_overlays()
	var at := _cursor.on_ground
	if mouse is InputEventMouseMotion:
		if not toolbar.brush.is_painting():
			return AFTER_GUI_INPUT_PASS
		if at.is_finite():
			toolbar.brush.move(Vector2(at.x, at.z))
		return AFTER_GUI_INPUT_STOP
	var button := mouse as InputEventMouseButton
	if button == null or button.button_index != MOUSE_BUTTON_LEFT or button.alt_pressed:
		return AFTER_GUI_INPUT_PASS
	# The button is the brush's, even where there is nothing to paint: a box to select with would lose the selection.
	if not button.pressed:
		toolbar.brush.finish(get_undo_redo())
	else:
		_cursor.problem = _begin_stroke(at, button)
		update_overlays()
	return AFTER_GUI_INPUT_STOP


func _forward_3d_draw_over_viewport(overlay: Control) -> void:
	if is_instance_valid(_scatter) and toolbar.is_brush_on():
		_cursor.draw(overlay, toolbar.brush, _scatter.get(&"terrain"))


func _on_key(key: InputEventKey) -> int:
	if not key.pressed or not (key.keycode == KEY_BRACKETLEFT or key.keycode == KEY_BRACKETRIGHT):
		return AFTER_GUI_INPUT_PASS
	toolbar.scale_radius(RADIUS_STEP if key.keycode == KEY_BRACKETRIGHT else 1.0 / RADIUS_STEP)
	return AFTER_GUI_INPUT_STOP


## The layer to paint; null for none.
func _layer() -> Resource:
	var layers: Array = _scatter.get(&"layers")
	var index := toolbar.layer_index()
	return layers[index] if index >= 0 and index < layers.size() else null


## Begins a stroke at a place on the ground. Returns why it cannot, in a sentence.
func _begin_stroke(at: Vector3, button: InputEventMouseButton) -> String:
	var layer := _layer()
	if _scatter.get(&"terrain") == null:
		return "There is no ground to paint on: give %s a terrain." % _scatter.name
	if layer == null:
		return "There is nothing to paint: give %s a layer." % _scatter.name
	if not at.is_finite():
		return "There is no ground below the brush."
	var mode := toolbar.brush.mode
	if button.shift_pressed:
		mode = Brush.Mode.SMOOTH
	elif button.ctrl_pressed:
		mode = Brush.Mode.ERASE
	var on_map := Vector2(at.x, at.z)
	if mode == Brush.Mode.PAINT and layer.get(&"mask") == null:
		first_stroke.ask(layer.resource_name, _on_show(toolbar.layer_index()), on_map)
		return ""
	return toolbar.brush.begin(_scatter, layer, _scene(), mode, on_map)


## A single dab, as the first of a layer; the brush goes on as it began.
func _stroke_once(mode: int, at: Vector2) -> void:
	if not is_instance_valid(_scatter) or _layer() == null:
		return
	toolbar.choose_mode(mode)
	_cursor.problem = toolbar.brush.begin(_scatter, _layer(), _scene(), mode as Brush.Mode, at)
	toolbar.brush.finish(get_undo_redo())
	update_overlays()


func _scene() -> String:
	return EditorInterface.get_edited_scene_root().scene_file_path


## How many instances of a layer are on show.
func _on_show(index: int) -> int:
	var count := 0
	for tile: Vector2i in _scatter.call(&"get_shown_tiles", index):
		var shown: RefCounted = _scatter.call(&"get_tile", index, tile)
		for mesh: int in shown.call(&"get_mesh_count"):
			count += (shown.call(&"get_ids", mesh) as PackedInt64Array).size()
	return count


## The veil of the chosen layer's mask, while the brush is on.
func _update_mask_overlay() -> void:
	var mask: Resource = _layer().get(&"mask") if is_instance_valid(_scatter) and _layer() != null else null
	if not toolbar.is_brush_on() or mask != null and _scatter.get(&"terrain") == null:
		mask = null
	if mask != _watched_mask:
		if _watched_mask != null:
			_watched_mask.disconnect(&"area_changed", _on_mask_changed)
		if mask != null:
			mask.connect(&"area_changed", _on_mask_changed)
		_watched_mask = mask
	if mask == null:
		mask_overlay.hide()
		return
	var camera := EditorInterface.get_editor_viewport_3d(0).get_camera_3d()
	var away := Cursor.distance_to_ground(camera, _scatter.get(&"terrain"))
	mask_overlay.show(_scatter, mask, camera.global_position - camera.global_basis.z * away, away, _mask_version)


func _on_mask_changed(_rect: Rect2) -> void:
	_mask_version += 1


func _add_preset(name: String) -> void:
	if is_instance_valid(_scatter):
		var before: Array = _scatter.get(&"layers").duplicate()
		Presets.add(name, _scatter, get_undo_redo())
		toolbar.show_layers(_scatter)
		_fresh = _scatter.get(&"layers").filter(func(layer: Resource) -> bool: return not before.has(layer))


## Once all is there: which layers of the preset stand nowhere in sight, and what they ask for.
func _tell_of_fresh_layers() -> void:
	if _fresh.is_empty() or not _scatter.call(&"is_settled"):
		return
	var layers: Array = _scatter.get(&"layers")
	var missing := _fresh.filter(func(layer: Resource) -> bool: return layer in layers and _on_show(layers.find(layer)) == 0)
	_fresh.clear()
	var sentence := Presets.why_missing(missing)
	if not sentence.is_empty():
		EditorInterface.get_editor_toaster().push_toast(sentence, EditorToaster.SEVERITY_WARNING)


func _on_scene_saved(path: String) -> void:
	toolbar.brush.files.on_scene_saved(path)
	_reload_scenes([path])


## Plants whose files have changed are drawn as they are now.
func _reload_scenes(paths: PackedStringArray) -> void:
	var roots: Array = [EditorInterface.get_edited_scene_root()]
	if EditorInterface.has_method(&"get_open_scene_roots"): # Since 4.5: those in other tabs, too.
		roots = EditorInterface.call(&"get_open_scene_roots")
	for root: Node in roots.filter(is_instance_valid):
		for scatter: Node in root.find_children("*", "TerrainScatter3D", true, false) + [root]:
			if scatter.is_class("TerrainScatter3D"):
				for layer: Resource in scatter.get(&"layers"):
					if layer != null:
						layer.call(&"reload_scenes", paths)


func _open_bake() -> void:
	if is_instance_valid(_scatter):
		bake.open(_scatter, EditorInterface.get_editor_viewport_3d(0).get_camera_3d().global_position)
