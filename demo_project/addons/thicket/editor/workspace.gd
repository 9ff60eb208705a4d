@tool
extends RefCounted
## Creates and connects all parts of Thicket in the editor: tools for the 3D view, gizmos, presets and bakes. The plugin forwards the editor's calls
## to this object. Thicket's nodes also work without it.

const Bake := preload("res://addons/thicket/editor/bake/bake_dialog.gd")
const ExtentGizmos := preload("res://addons/thicket/editor/ground/extent_gizmos.gd")
const NewLayersWatcher := preload("res://addons/thicket/editor/layers/new_layers_watcher.gd")
const Presets := preload("res://addons/thicket/editor/layers/presets.gd")
const GroundButtons := preload("res://addons/thicket/editor/ground/ground_buttons.gd")
const HelpLinks := preload("res://addons/thicket/editor/help/help_links.gd")
const HelpMenu := preload("res://addons/thicket/editor/help/help_menu.gd")
const Import := preload("res://addons/thicket/editor/import/import_dialog.gd")
const LayerInspector := preload("res://addons/thicket/editor/inspector/layer_inspector.gd")
const LayersDock := preload("res://addons/thicket/editor/layers/layers_dock.gd")
const LooseStates := preload("res://addons/thicket/editor/hand/loose_states.gd")
const RegionGizmos := preload("res://addons/thicket/editor/regions/region_gizmos.gd")
const ScatterLayers := preload("res://addons/thicket/editor/layers/scatter_layers.gd")
const ServerExport := preload("res://addons/thicket/editor/export/server_export.gd")
const Shared := preload("res://addons/thicket/editor/layers/shared_layers.gd")
const Toolbar := preload("res://addons/thicket/editor/toolbar.gd")
const WaterGizmos := preload("res://addons/thicket/editor/ground/water_gizmos.gd")
const Tutorials := preload("res://addons/thicket/editor/help/tutorial_window.gd")

## The time between two updates of the extent and the tools, in seconds.
const UPDATE_SECONDS := 0.25

## The row above the 3D view, with the tools.
var toolbar: Toolbar
## The buttons that set and refresh the ground. They are in the toolbar while it is visible, otherwise next to it.
var ground_buttons: GroundButtons
## The panel with the layers, the marks on layers, and the preview bar.
var dock: LayersDock
## The dialog for bakes.
var bake: Bake
## The dialog for imports.
var imports: Import
## The window with the add-on's tutorials.
var tutorials: Tutorials
## The menu in Project > Tools.
var help: HelpMenu

var _plugin: EditorPlugin
var _regions := RegionGizmos.new()
var _extent := ExtentGizmos.new()
var _water := WaterGizmos.new()
var _inspector: LayerInspector
var _new_layers := NewLayersWatcher.new()
var _help_links: HelpLinks
var _loose_states: LooseStates
var _server_export := ServerExport.new()
var _scatter: TerrainScatter3D
var _keeps_scatter := false ## True while a descendant of the scatter is selected instead of the scatter.
var _shown_state: Array = []
var _tiles := 0
var _since_update := 0.0


## Adds the tools to the editor.
func _init(plugin: EditorPlugin) -> void:
	_plugin = plugin
	var undo_redo := plugin.get_undo_redo()
	dock = LayersDock.new(plugin)
	toolbar = Toolbar.new(undo_redo, dock.marks)
	toolbar.redraw_requested.connect(plugin.update_overlays)
	toolbar.preset_chosen.connect(_add_preset)
	toolbar.bake_requested.connect(_open_bake)
	toolbar.import_requested.connect(_open_import)
	plugin.add_control_to_container(EditorPlugin.CONTAINER_SPATIAL_EDITOR_MENU, toolbar)
	toolbar.hide()
	ground_buttons = GroundButtons.new(undo_redo)
	plugin.add_control_to_container(EditorPlugin.CONTAINER_SPATIAL_EDITOR_MENU, ground_buttons)
	dock.enter(toolbar)
	dock.panel.preset_chosen.connect(_add_preset)
	dock.panel.adding.connect(func() -> void: _new_layers.record_counts(_scatter))
	dock.panel.added.connect(func() -> void: _new_layers.watch())
	dock.panel.notes.ground_wanted.connect(ground_buttons.choose)
	bake = Bake.new()
	EditorInterface.get_base_control().add_child(bake)
	bake.edits = toolbar.hand.edits
	bake.drawing_requested.connect(toolbar.rectangle.set_on.bind(true))
	toolbar.rectangle.drawn.connect(bake.take_drawn)
	imports = Import.new()
	imports.undo_redo = undo_redo
	imports.files = toolbar.paint.brush.files
	EditorInterface.get_base_control().add_child(imports)
	tutorials = Tutorials.new()
	EditorInterface.get_base_control().add_child(tutorials)
	_help_links = HelpLinks.new(tutorials)
	help = HelpMenu.new(tutorials)
	plugin.add_tool_submenu_item(HelpMenu.TITLE, help)
	dock.panel.welcome.example_wanted.connect(help.open_example)
	dock.panel.welcome.first_forest_wanted.connect(help.open_first_forest)
	dock.panel.welcome.documentation_wanted.connect(help.choose.bind(HelpMenu.Item.DOCUMENTATION))
	_regions.undo_redo = undo_redo
	plugin.add_node_3d_gizmo_plugin(_regions)
	plugin.add_node_3d_gizmo_plugin(_extent)
	_water.undo_redo = undo_redo
	plugin.add_node_3d_gizmo_plugin(_water)
	_inspector = LayerInspector.new(toolbar.paint.brush.files)
	plugin.add_inspector_plugin(_inspector)
	plugin.add_export_plugin(_server_export)
	_loose_states = LooseStates.new(toolbar.paint.brush.files)
	EditorInterface.get_resource_filesystem().resources_reimported.connect(_reload_scenes)
	plugin.scene_saved.connect(_on_scene_saved)
	plugin.scene_closed.connect(toolbar.paint.brush.files.on_scene_closed)
	EditorInterface.get_selection().selection_changed.connect(_on_selection_changed, CONNECT_DEFERRED)
	for tool in toolbar.tools:
		tool.button.toggled.connect(_on_tool_toggled)


## Removes everything from the editor.
func leave() -> void:
	EditorInterface.get_selection().selection_changed.disconnect(_on_selection_changed)
	edit(null)
	EditorInterface.get_resource_filesystem().resources_reimported.disconnect(_reload_scenes)
	_plugin.remove_tool_menu_item(HelpMenu.TITLE) # Also frees the menu.
	_help_links.leave()
	_plugin.remove_export_plugin(_server_export)
	_plugin.remove_inspector_plugin(_inspector)
	_plugin.remove_node_3d_gizmo_plugin(_water)
	_plugin.remove_node_3d_gizmo_plugin(_extent)
	_plugin.remove_node_3d_gizmo_plugin(_regions)
	_plugin.remove_control_from_container(EditorPlugin.CONTAINER_SPATIAL_EDITOR_MENU, toolbar)
	_place_ground_buttons(false)
	_plugin.remove_control_from_container(EditorPlugin.CONTAINER_SPATIAL_EDITOR_MENU, ground_buttons)
	dock.leave()
	toolbar.queue_free()
	ground_buttons.queue_free()
	bake.queue_free()
	imports.queue_free()
	tutorials.queue_free()


## Returns true for a node that the tools edit.
func handles(object: Object) -> bool:
	return object is TerrainScatter3D


## Sets the node that the tools edit, or null for none.
func edit(object: Object) -> void:
	var last_scatter := _scatter
	_scatter = object as TerrainScatter3D
	toolbar.set_scatter(_scatter)
	dock.set_scatter(_scatter)
	_extent.scatter = _scatter
	_water.scatter = _scatter
	for node: TerrainScatter3D in [last_scatter, _scatter]:
		if is_instance_valid(node):
			node.update_gizmos()


## Shows or hides the tools.
func make_visible(visible: bool) -> void:
	toolbar.visible = visible
	_place_ground_buttons(visible)
	if not visible:
		edit(null)


## Keeps the panel and the tools on a scatter while a region or another descendant of it is selected. Runs after the editor has called
## [method make_visible].
func _on_selection_changed() -> void:
	var scatter := _scatter_above_selection()
	if scatter != null:
		_keeps_scatter = true
		make_visible(true)
		edit(scatter)
	elif _keeps_scatter:
		_keeps_scatter = false
		if not EditorInterface.get_selection().get_selected_nodes().any(handles):
			make_visible(false)


## Returns the scatter above the selected node. Returns null if there is none, if several nodes are selected, or if the node is a scatter itself.
func _scatter_above_selection() -> TerrainScatter3D:
	var selected := EditorInterface.get_selection().get_selected_nodes()
	var node: Node = selected[0].get_parent() if selected.size() == 1 and not handles(selected[0]) else null
	while node != null and not node is TerrainScatter3D:
		node = node.get_parent()
	return node as TerrainScatter3D


## If a tool is turned on while a descendant of the scatter is selected, selects the scatter. Tools get input over the 3D view only while it is selected.
func _on_tool_toggled(on: bool) -> void:
	if on and _keeps_scatter and is_instance_valid(_scatter):
		EditorInterface.get_selection().clear()
		EditorInterface.get_selection().add_node(_scatter)
		EditorInterface.edit_node(_scatter)


## Moves the ground buttons into the toolbar, whose buttons wrap into several lines, or next to the toolbar.
func _place_ground_buttons(in_toolbar: bool) -> void:
	if in_toolbar == (ground_buttons.get_parent() == toolbar):
		return
	if in_toolbar:
		_plugin.remove_control_from_container(EditorPlugin.CONTAINER_SPATIAL_EDITOR_MENU, ground_buttons)
		toolbar.add_child(ground_buttons)
	else:
		toolbar.remove_child(ground_buttons)
		_plugin.add_control_to_container(EditorPlugin.CONTAINER_SPATIAL_EDITOR_MENU, ground_buttons)


## Moves the states of the open scenes to files before a scene is saved.
func apply_changes() -> void:
	for root in _open_roots():
		_loose_states.move_to_files(root)


## Writes painted masks and other changed files when the scene is saved.
func save_external_data() -> void:
	toolbar.paint.brush.files.save()


## Updates everything several times per second. Called in each frame.
func process(delta: float) -> void:
	_since_update += delta
	if _since_update < UPDATE_SECONDS:
		return
	_since_update = 0.0
	_new_layers.refresh()
	dock.refresh()
	if is_instance_valid(_scatter):
		var displayed_state := _state(_scatter)
		if displayed_state != _shown_state:
			_shown_state = displayed_state
			_scatter.update_gizmos()
			toolbar.update_layers()
	for tool in toolbar.tools:
		tool.refresh()


## Returns the data of a scatter that the gizmos and the toolbar show.
func _state(scatter: TerrainScatter3D) -> Array:
	var state: Array = [scatter, scatter.global_transform, scatter.ground, scatter._get_planet(), scatter.water_enabled, scatter.water_level]
	for layer in ScatterLayers.of(scatter):
		state.append_array([layer, layer.resource_name if layer != null else ""])
	# Tiles are added and removed as the camera moves, so the extent is only updated once the scatter has settled.
	if scatter.is_settled():
		_tiles = 0
		for layer in ScatterLayers.of(scatter):
			if layer != null:
				_tiles = hash([_tiles, scatter.get_shown_tiles(layer)])
	state.append(_tiles)
	return state


## Forwards input over the 3D view to the tool that is on.
func input(camera: Camera3D, event: InputEvent) -> int:
	var tool := toolbar.active_tool()
	return tool.input(camera, event) if tool != null and is_instance_valid(_scatter) else EditorPlugin.AFTER_GUI_INPUT_PASS


## Draws the overlay of the active tool over the 3D view.
func draw_over(overlay: Control) -> void:
	var tool := toolbar.active_tool()
	if tool != null and is_instance_valid(_scatter):
		tool.draw_over(overlay)


func _add_preset(name: String) -> void:
	if is_instance_valid(_scatter):
		_new_layers.record_counts(_scatter)
		Presets.add(name, _scatter, dock.panel.keeps_apart(), _plugin.get_undo_redo())
		_new_layers.watch(true)
		toolbar.update_layers()


func _on_scene_saved(path: String) -> void:
	toolbar.paint.brush.files.on_scene_saved(path)
	_loose_states.on_scene_saved.call_deferred(path) # Deferred, because a new scene has no path yet.
	_reload_scenes([path])


## Reloads models whose files have changed.
func _reload_scenes(paths: PackedStringArray) -> void:
	for scatter in Shared.open_scatters():
		for layer in ScatterLayers.of(scatter):
			if layer != null:
				layer.reload_scenes(paths)


func _open_roots() -> Array[Node]:
	var roots: Array = [EditorInterface.get_edited_scene_root()]
	if EditorInterface.has_method(&"get_open_scene_roots"): # Since Godot 4.5, includes the scenes in other tabs.
		roots = EditorInterface.call(&"get_open_scene_roots")
	return Array(roots.filter(is_instance_valid), TYPE_OBJECT, &"Node", null)


func _open_bake() -> void:
	if is_instance_valid(_scatter):
		bake.open(_scatter, EditorInterface.get_editor_viewport_3d(0).get_camera_3d().global_position)


func _open_import() -> void:
	if is_instance_valid(_scatter):
		imports.open(_scatter, EditorInterface.get_edited_scene_root())
