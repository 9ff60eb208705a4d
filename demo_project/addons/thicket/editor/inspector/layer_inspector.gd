@tool
extends EditorInspectorPlugin
## Adds controls to the inspector. References to layers can be chosen from the scatter's layers. Layers and scatters
## accept dropped meshes. Buttons fit a layer to its meshes, split packs of models, and create foliage materials. A
## button above a layer's LOD fade bakes impostors. A heightmap has a thumbnail and a summary of its heights.

const ChosenLayers := preload("res://addons/thicket/editor/inspector/chosen_layers.gd")
const FoliageButton := preload("res://addons/thicket/editor/inspector/foliage_button.gd")
const HeightmapSummary := preload("res://addons/thicket/editor/inspector/heightmap_summary.gd")
const KindButtons := preload("res://addons/thicket/editor/inspector/kind_buttons.gd")
const LayerProperty := preload("res://addons/thicket/editor/inspector/layer_property.gd")
const LayerListProperty := preload("res://addons/thicket/editor/inspector/layer_list_property.gd")
const Drop := preload("res://addons/thicket/editor/layers/mesh_drop.gd")
const Impostors := preload("res://addons/thicket/editor/inspector/impostor_button.gd")
const Names := preload("res://addons/thicket/editor/inspector/layer_names.gd")
const SceneFiles := preload("res://addons/thicket/editor/scene_files.gd")
const SplitButton := preload("res://addons/thicket/editor/inspector/split_button.gd")
const Spacing := preload("res://addons/thicket/editor/inspector/spacing_editor.gd")

var _files: SceneFiles


func _init(files: SceneFiles) -> void:
	_files = files


func _can_handle(object: Object) -> bool:
	return object is ChosenLayers or ["ScatterLayer", "ScatterModel", "ScatterValueSource", "ScatterRegion3D", "TerrainScatter3D",
			"ScatterGroundHeightmap"].any(object.is_class)


func _parse_begin(object: Object) -> void:
	if object is ScatterGroundHeightmap:
		add_custom_control(HeightmapSummary.new(object as ScatterGroundHeightmap))
	if object is ScatterLayer or object is TerrainScatter3D:
		add_custom_control(Drop.new(object, _files))
	if object is ScatterLayer and not (object as ScatterLayer).meshes.is_empty():
		add_custom_control(KindButtons.new([object as ScatterLayer]))
		add_custom_control(SplitButton.new(object as ScatterLayer))
	if object is ChosenLayers:
		add_custom_control(KindButtons.new((object as ChosenLayers).layers))
	if object is ScatterLayer or object is ScatterModel:
		add_custom_control(FoliageButton.new(object as Resource, _files))


func _parse_property(object: Object, _type: Variant.Type, name: String, _hint: PropertyHint, _hint_string: String,
		_usage: int, _wide: bool) -> bool:
	if object is ChosenLayers and name == "script":
		return true
	var editor: EditorProperty
	match name:
		_ when name in Names.reference_properties(object):
			editor = LayerProperty.new()
		"spacing":
			editor = Spacing.new()
		"layers" when object is ScatterRegion3D:
			editor = LayerListProperty.new("All layers")
		"surface_layers" when object is ScatterLayer:
			editor = LayerListProperty.new("The ground", true)
		"lod_fade" when object is ScatterLayer:
			add_custom_control(Impostors.new(object as ScatterLayer, _files))
	if editor != null:
		add_property_editor(name, editor)
	return editor != null
