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


## Adds a preset's layers to a scatter, as one undo step. If [param apart] is true, they keep distances from the scatter's existing layers. On a
## planet, they grow on all sides. On other ground, they grow on its top: with dense meshes, surfaces would make their tiles 200 times slower. A preset
## with water enables the scatter's water.
static func add(name: String, scatter: TerrainScatter3D, apart: bool, undo_redo: EditorUndoRedoManager) -> void:
	var source := open(name)
	if source == null:
		return
	var old := scatter.layers
	var added := _copied(source, Copies.names(old))
	if SurfacePlace.is_planet(scatter):
		NewLayers.use_levels(added, scatter.ground)
	if apart:
		NewLayers.give_way(added, old)
	var new: Array[ScatterLayer] = old + added
	undo_redo.create_action("Add Layers: " + name.capitalize(), UndoRedo.MERGE_DISABLE, scatter)
	undo_redo.add_do_property(scatter, &"layers", new)
	undo_redo.add_undo_property(scatter, &"layers", old)
	if source.water_enabled and not scatter.water_enabled:
		undo_redo.add_do_property(scatter, &"water_enabled", true)
		undo_redo.add_undo_property(scatter, &"water_enabled", false)
	source.free()
	undo_redo.commit_action()


## Returns copies of a preset's layers. Names that are in [param taken] get a number, and references to the layers are updated.
static func _copied(source: TerrainScatter3D, taken: PackedStringArray) -> Array[ScatterLayer]:
	var result: Array[ScatterLayer] = []
	var copies: Dictionary[Resource, Resource] = {}
	for layer in source.layers:
		var copy := Copies.of(layer, copies)
		copy.layer_id = -1 # The scatter to which the layer is added assigns an ID.
		result.append(copy)
	_rename(result, taken)
	return result


static func _rename(new_layers: Array[ScatterLayer], taken: PackedStringArray) -> void:
	var names := {}
	for layer in new_layers:
		var name := Copies.free_name(layer.resource_name, taken)
		names[layer.resource_name] = name
		layer.resource_name = name
	for layer in new_layers:
		var spacing := layer.spacing
		var renamed := {}
		for key: Variant in spacing:
			renamed[names.get(key, key)] = spacing[key]
		layer.spacing = renamed
	for object in Names.referring(new_layers):
		for property in Names.reference_properties(object):
			object.set(property, names.get(object.get(property), object.get(property)))
