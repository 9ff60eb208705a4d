@tool
extends "res://addons/thicket/editor/wrapping_row.gd"
## The toolbar above the 3D view, visible while a scatter is selected. It contains the tools with their settings, the
## layer on which they work, and buttons for presets, regions, bakes and imports.

const BiomeTool := preload("res://addons/thicket/editor/brush/biome_tool.gd")
const Controls := preload("res://addons/thicket/editor/editor_controls.gd")
const HandTool := preload("res://addons/thicket/editor/hand/hand_tool.gd")
const PaintTool := preload("res://addons/thicket/editor/brush/paint_tool.gd")
const RegionDrawing := preload("res://addons/thicket/editor/regions/region_drawing.gd")
const Presets := preload("res://addons/thicket/editor/layers/presets.gd")
const RectangleTool := preload("res://addons/thicket/editor/bake/rectangle_tool.gd")
const RegionMenu := preload("res://addons/thicket/editor/regions/region_menu.gd")
const ScatterLayers := preload("res://addons/thicket/editor/layers/scatter_layers.gd")
const ScatterTool := preload("res://addons/thicket/editor/scatter_tool.gd")
const WhyTool := preload("res://addons/thicket/editor/explain/why_tool.gd")

signal preset_chosen(name: String)
signal bake_requested
signal import_requested
## Emitted when [member chosen] has changed.
signal layers_chosen
## Emitted when the view must be redrawn.
signal redraw_requested

## The tool that paints masks.
var paint := PaintTool.new()
## The tool that paints the biome map.
var biomes := BiomeTool.new()
## The tool that plants and changes single instances.
var hand := HandTool.new()
## The tool that explains why instances are or are not placed at a position.
var why := WhyTool.new()
## The tool that draws the outline of a region.
var region_drawing := RegionDrawing.new()
## The tool that draws the rectangle of a bake.
var rectangle := RectangleTool.new()
## All tools, in the order of their buttons.
var tools: Array[ScatterTool] = [paint, biomes, hand, why, region_drawing, rectangle]
## The menu that adds regions.
var regions := RegionMenu.new()
## The layers on which tools work. The first is the main one.
var chosen: Array[ScatterLayer] = []

var _scatter: TerrainScatter3D
var _layers := OptionButton.new()
var _buttons := ButtonGroup.new()


func _init(undo_redo: EditorUndoRedoManager, marks: ScatterTool.Marks) -> void:
	super()
	_buttons.allow_unpress = true
	hand.edits.files = paint.brush.files
	biomes.brush.files = paint.brush.files
	hand.edits.undo_redo = undo_redo
	for tool in tools:
		add_child(tool.button)
		tool.undo_redo = undo_redo
		tool.marks = marks
		tool.button.button_group = _buttons
		tool.button.toggled.connect(_on_toggled.bind(tool))
		tool.redraw_requested.connect(redraw_requested.emit)
	_layers.tooltip_text = "The layer that the tool works on."
	_layers.item_selected.connect(func(_index: int) -> void: choose_layer(_layers.get_selected_id()))
	add_child(_layers)
	for tool in tools:
		add_child(tool)
		tool.hide()
	_layers.hide()
	add_child(VSeparator.new())
	_add_presets()
	_add_regions(undo_redo)
	var bake := Controls.button("Bake", &"Bake", "Bake the instances in a rectangle into MultiMesh resources and a scene.")
	bake.pressed.connect(bake_requested.emit)
	add_child(bake)
	var imports := Controls.button("Import", &"Load",
			"Import hand-placed instances from MultiMeshes, ProtonScatter, Terrain3D or a table.")
	imports.pressed.connect(import_requested.emit)
	add_child(imports)


## Sets the scatter of all tools, which may be null. Another scatter turns the active tool off, so that selecting a node with a click
## does not paint.
func set_scatter(scatter: TerrainScatter3D) -> void:
	for tool in tools:
		tool.finish()
		if scatter != _scatter:
			tool.set_on(false)
		tool.scatter = scatter
	_scatter = scatter
	regions.scatter = scatter
	update_layers()


## Updates the list of layers. Selected layers that the scatter still has stay selected. If there are none, the first layer is selected.
func update_layers() -> void:
	_layers.clear()
	var layers := _scatter_layers()
	for index in layers.size():
		var layer := layers[index]
		if layer != null:
			_layers.add_item(layer.resource_name if layer.resource_name else "Layer %d" % index, index)
	var remaining := chosen.filter(func(layer: ScatterLayer) -> bool: return layer in layers)
	if remaining.is_empty():
		remaining.assign(layers.filter(func(layer: ScatterLayer) -> bool: return layer != null).slice(0, 1))
	choose_layers(remaining)


## Selects the layer at an index of [method TerrainScatter3D.get_all_layers], if there is one.
func choose_layer(index: int) -> void:
	var layers := _scatter_layers()
	if index >= 0 and index < layers.size() and layers[index] != null:
		choose_layers([layers[index]])


## Selects layers of the scatter. The first is the main one.
func choose_layers(layers: Array[ScatterLayer]) -> void:
	var has_changed := layers != chosen
	chosen = layers
	var index := _scatter_layers().find(chosen[0]) if not chosen.is_empty() else -1
	_layers.select(_layers.get_item_index(index) if index >= 0 else -1)
	for tool in tools:
		if has_changed and not tool.layers.is_empty():
			tool.finish()
		tool.layers = chosen
		tool.layer_index = index
		tool.layer = chosen[0] if index >= 0 else null
	redraw_requested.emit()
	if has_changed:
		layers_chosen.emit()


## Returns the tool that is on, or null if there is none.
func active_tool() -> ScatterTool:
	for tool in tools:
		if tool.is_on():
			return tool
	return null


func _notification(what: int) -> void: # The engine also calls _notification of the base class.
	if what == NOTIFICATION_THEME_CHANGED:
		Controls.update_icons(self)


func _add_presets() -> void:
	var menu := MenuButton.new()
	menu.text = "Presets"
	menu.set_meta(&"icon", &"Add")
	menu.tooltip_text = "Add the layers of a preset."
	for name in Presets.NAMES:
		menu.get_popup().add_item("Add " + name.capitalize())
	menu.get_popup().index_pressed.connect(func(index: int) -> void: preset_chosen.emit(Presets.NAMES[index]))
	add_child(menu)


func _add_regions(undo_redo: EditorUndoRedoManager) -> void:
	regions.undo_redo = undo_redo
	regions.drawing_requested.connect(func(shape: ScatterRegion3D.Shape, exclude: bool) -> void:
		region_drawing.set_on(true)
		region_drawing.shape = shape
		region_drawing.exclude = exclude)
	region_drawing.drawn.connect(regions.insert)
	add_child(regions)


func _scatter_layers() -> Array[ScatterLayer]:
	return ScatterLayers.of(_scatter if is_instance_valid(_scatter) else null)


func _on_toggled(on: bool, tool: ScatterTool) -> void:
	if not on:
		tool.finish()
	tool.visible = on
	var active := active_tool()
	_layers.visible = active != null and active.needs_layer
