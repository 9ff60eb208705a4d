@tool
extends RefCounted
## Adds the layers of presets, which are scenes in the presets folder.

const Copies := preload("res://addons/thicket/editor/layers/layer_copies.gd")
const NewLayers := preload("res://addons/thicket/editor/layers/new_layers.gd")
const Names := preload("res://addons/thicket/editor/inspector/layer_names.gd")
const SurfacePlace := preload("res://addons/thicket/editor/ground/surface_place.gd")
const FOLDER := "res://addons/thicket/presets/"
const NAMES: PackedStringArray = ["forest", "meadow", "pine_wood", "shore", "scree", "desert"]


## Instantiates the scene of a preset and returns its root, which the caller must free. If there is no such preset, prints an error and returns null.
static func open(name: String) -> TerrainScatter3D:
	var path := FOLDER + name + ".tscn"
	var scene := load(path) as PackedScene if ResourceLoader.exists(path, "PackedScene") else null
	var source := scene.instantiate() as TerrainScatter3D if scene != null else null
	if source == null:
		push_error("The preset %s cannot be loaded from %s: it must be a scene whose root is a TerrainScatter3D. The presets are: %s. Install all files of the add-on again." % [
			name, path, ", ".join(NAMES)])
	return source


## Adds a preset's layers to a scatter, as one undo step. If [param keeps_apart] is true, they keep distances from the scatter's existing layers. On a
## planet, they grow on all sides. On other ground, they grow on its top: with dense meshes, surfaces would make their tiles 200 times slower. A preset
## with water enables the scatter's water.
static func add(name: String, scatter: TerrainScatter3D, keeps_apart: bool, undo_redo: EditorUndoRedoManager) -> void:
	var source := open(name)
	if source == null:
		return
	var old_layers := scatter.layers
	var preset_layers := _copy_layers(source, Copies.names(old_layers))
	if SurfacePlace.is_planet(scatter):
		NewLayers.use_levels(preset_layers, scatter.ground)
	if keeps_apart:
		NewLayers.keep_from(preset_layers, old_layers)
	var new_layers: Array[ScatterLayer] = old_layers + preset_layers
	undo_redo.create_action("Add Layers: " + name.capitalize(), UndoRedo.MERGE_DISABLE, scatter)
	undo_redo.add_do_property(scatter, &"layers", new_layers)
	undo_redo.add_undo_property(scatter, &"layers", old_layers)
	if source.water_enabled and not scatter.water_enabled:
		undo_redo.add_do_property(scatter, &"water_enabled", true)
		undo_redo.add_undo_property(scatter, &"water_enabled", false)
	source.free()
	undo_redo.commit_action()


## Returns copies of a preset's layers. Names that are in [param used_names] get a number, and references to the layers are updated.
static func _copy_layers(source: TerrainScatter3D, used_names: PackedStringArray) -> Array[ScatterLayer]:
	var result: Array[ScatterLayer] = []
	var copies: Dictionary[Resource, Resource] = {}
	for layer in source.layers:
		var copy := Copies.of(layer, copies)
		copy.layer_id = -1 # The scatter to which the layer is added assigns an ID.
		result.append(copy)
	_rename(result, used_names)
	return result


static func _rename(new_layers: Array[ScatterLayer], used_names: PackedStringArray) -> void:
	var names := {}
	for layer in new_layers:
		var name := Copies.free_name(layer.resource_name, used_names)
		names[layer.resource_name] = name
		layer.resource_name = name
	for layer in new_layers:
		var spacing := layer.spacing
		var new_spacing := {}
		for key: Variant in spacing:
			new_spacing[names.get(key, key)] = spacing[key]
		layer.spacing = new_spacing
	for object in Names.with_value_sources(new_layers):
		for property in Names.reference_properties(object):
			object.set(property, names.get(object.get(property), object.get(property)))
