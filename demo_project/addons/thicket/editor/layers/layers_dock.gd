@tool
extends RefCounted
## Manages the layers panel, the marks on layers, and the bar that asks for confirmation before many more instances are shown. It keeps
## the panel and the toolbar in sync, and warns when a scatter is added that shares its layers.

const LayersPanel := preload("res://addons/thicket/editor/layers/layers_panel.gd")
const Marks := preload("res://addons/thicket/editor/layers/layer_marks.gd")
const PreviewBar := preload("res://addons/thicket/editor/layers/preview_bar.gd")
const PreviewSteps := preload("res://addons/thicket/editor/layers/preview_steps.gd")
const Shared := preload("res://addons/thicket/editor/layers/shared_layers.gd")
const Toolbar := preload("res://addons/thicket/editor/toolbar.gd")

const TITLE := "Scatter"

var marks := Marks.new()
var steps := PreviewSteps.new()
## The layers panel; null before [method enter].
var panel: LayersPanel
var bar: PreviewBar

var _plugin: EditorPlugin
var _toolbar: Toolbar
var _scatter: TerrainScatter3D
var _root: Node ## The root of the scene at the last update.
var _new_scatters: Array[TerrainScatter3D] = []


func _init(plugin: EditorPlugin) -> void:
	_plugin = plugin


## Adds the panel and the bar to the editor.
func enter(toolbar: Toolbar) -> void:
	_toolbar = toolbar
	panel = LayersPanel.new(_plugin.get_undo_redo(), marks, toolbar.paint.brush.files, steps)
	_plugin.add_control_to_bottom_panel(panel, TITLE)
	bar = PreviewBar.new(steps)
	_plugin.add_control_to_container(EditorPlugin.CONTAINER_SPATIAL_EDITOR_BOTTOM, bar)
	bar.hide()
	panel.layers_chosen.connect(toolbar.choose_layers)
	toolbar.layers_chosen.connect(func() -> void: panel.choose(toolbar.chosen))
	marks.changed.connect(_apply_marks)
	_plugin.get_tree().node_added.connect(_on_node_added)


func leave() -> void:
	_plugin.get_tree().node_added.disconnect(_on_node_added)
	steps.clear()
	marks.clear()
	_plugin.remove_control_from_bottom_panel(panel)
	_plugin.remove_control_from_container(EditorPlugin.CONTAINER_SPATIAL_EDITOR_BOTTOM, bar)
	panel.queue_free()
	bar.queue_free()


func set_scatter(scatter: TerrainScatter3D) -> void:
	var has_changed := scatter != _scatter
	_scatter = scatter
	panel.set_scatter(scatter)
	panel.choose(_toolbar.chosen)
	if scatter != null:
		marks.apply(scatter)
	if has_changed and scatter != null:
		_plugin.make_bottom_panel_item_visible(panel)


## Updates the panel and its warnings. Called several times per second.
func refresh() -> void:
	_root = EditorInterface.get_edited_scene_root()
	steps.refresh(_scatter if is_instance_valid(_scatter) else null)
	panel.refresh()
	for scatter in _new_scatters:
		if is_instance_valid(scatter) and scatter.is_inside_tree():
			var shared := Shared.find(scatter)
			if shared.is_by_accident():
				EditorInterface.get_editor_toaster().push_toast(
						shared.describe(scatter.name) + " The Scatter panel makes it unique.", EditorToaster.SEVERITY_WARNING)
	_new_scatters.clear()


## Returns the marks on all layers of the scene, for the editor to save.
func state() -> Dictionary:
	var root := EditorInterface.get_edited_scene_root()
	return marks.to_state(root, Shared.scatters_of(root)) if root != null else {}


func set_state(saved_state: Dictionary) -> void:
	var root := EditorInterface.get_edited_scene_root()
	if root != null:
		marks.from_state(root, saved_state)


func _apply_marks() -> void:
	for scatter in Shared.open_scatters():
		marks.apply(scatter)


## Called for every added node. If a scatter is added to a scene that is already open, it was pasted, duplicated or created.
func _on_node_added(node: Node) -> void:
	if not node is TerrainScatter3D:
		_warn_about_dropped_scene(node)
		return
	marks.apply(node as TerrainScatter3D)
	if _is_in_open_scene(node):
		_new_scatters.append(node as TerrainScatter3D)


## Shows a toast if a scene was dropped on a scatter. The editor adds such a scene as a child, but the user most likely wants a layer.
func _warn_about_dropped_scene(node: Node) -> void:
	if node.get_parent() is TerrainScatter3D and not node.scene_file_path.is_empty() and _is_in_open_scene(node):
		EditorInterface.get_editor_toaster().push_toast(
				"%s is now a child of %s. To scatter it, undo and drop its file onto the list in the Scatter panel." % [node.name, node.get_parent().name],
				EditorToaster.SEVERITY_WARNING)


## Returns true for a node in a scene that was already open at the last update.
func _is_in_open_scene(node: Node) -> bool:
	return is_instance_valid(_root) and _root == EditorInterface.get_edited_scene_root() and _root.is_ancestor_of(node)
