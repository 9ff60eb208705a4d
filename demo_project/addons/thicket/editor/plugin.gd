@tool
extends EditorPlugin
## The editor's side of Thicket: a brush for densities, gizmos, presets and bake. The nodes work without it.

const Bake := preload("res://addons/thicket/editor/bake_dialog.gd")
const Brush := preload("res://addons/thicket/editor/brush.gd")
const Cursor := preload("res://addons/thicket/editor/brush_cursor.gd")
const ExtentGizmos := preload("res://addons/thicket/editor/extent_gizmos.gd")
const LayerInspector := preload("res://addons/thicket/editor/layer_inspector.gd")
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

var _cursor := Cursor.new()
var _regions := RegionGizmos.new()
var _extent := ExtentGizmos.new()
var _inspector := LayerInspector.new()
var _scatter: Node3D
var _shown: Array = []
var _tiles := 0
var _since_redraw := 0.0


func _enter_tree() -> void:
	toolbar = Toolbar.new()
	toolbar.brush_changed.connect(update_overlays)
	toolbar.preset_chosen.connect(_add_preset)
	toolbar.bake_requested.connect(_open_bake)
	add_control_to_container(CONTAINER_SPATIAL_EDITOR_MENU, toolbar)
	toolbar.hide()
	bake = Bake.new()
	EditorInterface.get_base_control().add_child(bake)
	_regions.undo_redo = get_undo_redo()
	add_node_3d_gizmo_plugin(_regions)
	add_node_3d_gizmo_plugin(_extent)
	add_inspector_plugin(_inspector)
	EditorInterface.get_resource_filesystem().resources_reimported.connect(_reload_scenes)
	scene_saved.connect(_on_scene_saved)


func _exit_tree() -> void:
	_edit(null)
	EditorInterface.get_resource_filesystem().resources_reimported.disconnect(_reload_scenes)
	remove_inspector_plugin(_inspector)
	remove_node_3d_gizmo_plugin(_extent)
	remove_node_3d_gizmo_plugin(_regions)
	remove_control_from_container(CONTAINER_SPATIAL_EDITOR_MENU, toolbar)
	toolbar.queue_free()
	bake.queue_free()


func _handles(object: Object) -> bool:
	return object is Node3D and object.is_class("TerrainScatter3D")


func _edit(object: Object) -> void:
	toolbar.brush.finish(get_undo_redo())
	var last := _scatter
	_scatter = object as Node3D
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
	if is_instance_valid(_scatter):
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
	if not is_instance_valid(_scatter) or not toolbar.is_brush_on() or _scatter.get(&"terrain") == null:
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
	if not button.pressed:
		toolbar.brush.finish(get_undo_redo())
	elif at.is_finite():
		_begin_stroke(Vector2(at.x, at.z), button)
	return AFTER_GUI_INPUT_STOP


func _forward_3d_draw_over_viewport(overlay: Control) -> void:
	if is_instance_valid(_scatter) and toolbar.is_brush_on():
		_cursor.draw(overlay, toolbar.brush, _scatter.get(&"terrain"))


func _on_key(key: InputEventKey) -> int:
	if not key.pressed or not (key.keycode == KEY_BRACKETLEFT or key.keycode == KEY_BRACKETRIGHT):
		return AFTER_GUI_INPUT_PASS
	toolbar.scale_radius(RADIUS_STEP if key.keycode == KEY_BRACKETRIGHT else 1.0 / RADIUS_STEP)
	return AFTER_GUI_INPUT_STOP


func _begin_stroke(at: Vector2, button: InputEventMouseButton) -> void:
	var layers: Array = _scatter.get(&"layers")
	var index := toolbar.layer_index()
	if index < 0 or index >= layers.size() or layers[index] == null:
		return
	var mode := toolbar.brush.mode
	if button.shift_pressed:
		mode = Brush.Mode.SMOOTH
	elif button.ctrl_pressed:
		mode = Brush.Mode.ERASE
	var scene := EditorInterface.get_edited_scene_root().scene_file_path
	var problem := toolbar.brush.begin(_scatter, layers[index], scene, mode, at)
	if not problem.is_empty():
		EditorInterface.get_editor_toaster().push_toast(problem, EditorToaster.SEVERITY_WARNING)


func _add_preset(name: String) -> void:
	if is_instance_valid(_scatter):
		Presets.add(name, _scatter, get_undo_redo())
		toolbar.show_layers(_scatter)


func _on_scene_saved(path: String) -> void:
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
