@tool
extends RefCounted
## Changes a scatter's list of layers. Each change is one undo step. Layers keep their IDs, and references to deleted layers are removed.

const Copies := preload("res://addons/thicket/editor/layers/layer_copies.gd")
const FoliageMaterials := preload("res://addons/thicket/editor/materials/foliage_materials.gd")
const SceneFiles := preload("res://addons/thicket/editor/scene_files.gd")
const ScatterLayers := preload("res://addons/thicket/editor/layers/scatter_layers.gd")
const NewLayers := preload("res://addons/thicket/editor/layers/new_layers.gd")
const Names := preload("res://addons/thicket/editor/inspector/layer_names.gd")


## Adds a layer at an index for each of these meshes, scenes and models. Also inserts the layers among them that are not in the list yet. If the index
## is -1, each is inserted at a suitable position. If [param keeps_apart] is true, layers without their own files keep distances from the others. If the
## edited scene has a file, scenes of plants get foliage materials in files next to that file. Returns the new layers.
static func add(scatter: TerrainScatter3D, resources: Array[Resource], insert_index: int, keeps_apart: bool, files: SceneFiles,
		undo_redo: EditorUndoRedoManager) -> Array[ScatterLayer]:
	var old_layers := scatter.layers
	var resources_to_add := resources.filter(func(resource: Resource) -> bool: return not resource is ScatterLayer or not resource in old_layers)
	var new_layers := NewLayers.of_resources(resources_to_add, Copies.names(old_layers))
	if new_layers.is_empty():
		return new_layers
	var new_list: Array[ScatterLayer] = old_layers.duplicate()
	for index in new_layers.size():
		new_list.insert(insert_index + index if insert_index >= 0 else NewLayers.insert_index_for(new_layers[index], new_list), new_layers[index])
	var unshared_layers := new_layers.filter(func(layer: ScatterLayer) -> bool: return not Copies.is_file(layer))
	NewLayers.use_levels(unshared_layers, scatter.ground)
	if keeps_apart:
		NewLayers.keep_apart(unshared_layers, new_list)
	_commit("Add Layers", scatter, new_list, undo_redo, func() -> void:
		for layer in new_layers:
			files.add_new_to_undo(_make_foliage(layer), layer, undo_redo))
	return new_layers


## Creates foliage materials for a new layer of plants, unless there is no path for their files. Returns the materials.
static func _make_foliage(layer: ScatterLayer) -> Array[Resource]:
	var location := SceneFiles.path_prefix_of(layer)
	if location.is_empty() or Copies.is_file(layer) or layer.get_model_kind() == ScatterLayer.KIND_ROCK:
		return []
	return FoliageMaterials.new(location).convert_new_layer(layer)


## Returns a message that names the resources for which [method add] has not added a layer, or an empty string if there
## are none. [param new_layers] is the result of [method add].
static func skipped_message(resources: Array[Resource], new_layers: Array[ScatterLayer]) -> String:
	var names := PackedStringArray()
	for resource in resources:
		if not new_layers.any(func(layer: ScatterLayer) -> bool: return layer == resource or _draws(layer, resource)):
			names.append(resource.resource_path if resource.resource_path else resource.get_class())
	return "" if names.is_empty() else "Not added: %s. A mesh needs surfaces, a scene a visible MeshInstance3D, and a layer must not be in the list yet." % \
			", ".join(names)


static func _draws(layer: ScatterLayer, resource: Resource) -> bool:
	return layer.meshes.any(func(entry: Variant) -> bool:
		return entry == resource or entry is ScatterModel and (entry as ScatterModel).scene == resource)


## Adds copies of layers, with copies of their masks, after the last of the layers. Returns the copies, or an empty array on failure.
static func copy(scatter: TerrainScatter3D, layers: Array[ScatterLayer], keeps_apart: bool, files: SceneFiles, scene_path: String,
		undo_redo: EditorUndoRedoManager) -> Array[ScatterLayer]:
	var old_layers := scatter.layers
	var names := Copies.names(old_layers)
	var result: Array[ScatterLayer] = []
	var masks: Dictionary[Resource, Resource] = {}
	for layer in layers:
		var new_layer := Copies.of(layer, {}, false)
		new_layer.resource_name = Copies.free_name(layer.resource_name if layer.resource_name else "Layer", names)
		new_layer.layer_id = -1
		names.append(new_layer.resource_name)
		if keeps_apart and layer.resource_name:
			var spacing := new_layer.spacing.duplicate()
			spacing[layer.resource_name] = NewLayers.distance(layer, new_layer)
			new_layer.spacing = spacing
		if not files.copy_mask(new_layer, scene_path, masks):
			return []
		result.append(new_layer)
	var new_list: Array[ScatterLayer] = old_layers.duplicate()
	var insert_index: int = layers.map(func(layer: ScatterLayer) -> int: return old_layers.find(layer)).max() + 1
	for index in result.size():
		new_list.insert(insert_index + index, result[index])
	_commit("Duplicate Layers", scatter, new_list, undo_redo, func() -> void: files.add_to_undo(masks.values(), scene_path, undo_redo))
	return result


## Removes layers. Returns messages about the effects on other layers and regions.
static func remove(scatter: TerrainScatter3D, layers: Array[ScatterLayer], undo_redo: EditorUndoRedoManager) -> PackedStringArray:
	var remaining: Array[ScatterLayer] = scatter.layers.filter(func(layer: ScatterLayer) -> bool: return not layer in layers)
	return _commit("Delete Layers", scatter, remaining, undo_redo)


## Moves layers in front of the layer at an index, without changing their order. Returns false if they are already there.
static func move(scatter: TerrainScatter3D, layers: Array[ScatterLayer], target_index: int, undo_redo: EditorUndoRedoManager) -> bool:
	var old_layers := scatter.layers
	var new_list: Array[ScatterLayer] = []
	for index in old_layers.size() + 1:
		if index == target_index:
			new_list.append_array(old_layers.filter(func(layer: ScatterLayer) -> bool: return layer in layers))
		if index < old_layers.size() and not old_layers[index] in layers:
			new_list.append(old_layers[index])
	if new_list == old_layers:
		return false
	_commit("Move Layers", scatter, new_list, undo_redo)
	return true


## Renames a layer. A number is added to the name if another layer has it. References by name are updated automatically.
static func rename(scatter: TerrainScatter3D, layer: ScatterLayer, name: String, undo_redo: EditorUndoRedoManager) -> void:
	var others: Array[ScatterLayer] = ScatterLayers.of(scatter).filter(func(other: ScatterLayer) -> bool: return other != layer)
	var free_name := Copies.free_name(name.strip_edges(), Copies.names(others))
	if name.strip_edges().is_empty() or free_name == layer.resource_name:
		return
	undo_redo.create_action("Rename Layer", UndoRedo.MERGE_DISABLE, scatter)
	undo_redo.add_do_property(layer, &"resource_name", free_name)
	undo_redo.add_undo_property(layer, &"resource_name", layer.resource_name)
	undo_redo.commit_action()


## Sets the scatter's list of layers and removes references to layers that are no longer in it. Returns a message for each removed reference.
static func _commit(title: String, scatter: TerrainScatter3D, new: Array[ScatterLayer], undo_redo: EditorUndoRedoManager,
		add_more := Callable()) -> PackedStringArray:
	var old := scatter.layers
	var messages := PackedStringArray()
	undo_redo.create_action(title, UndoRedo.MERGE_DISABLE, scatter)
	# Undo and redo set the list first, because it must contain the layers to which references are set.
	undo_redo.add_do_property(scatter, &"layers", new)
	undo_redo.add_undo_property(scatter, &"layers", old)
	for layer in new:
		if layer != null and layer in old:
			_update_layer_references(layer, old, new, messages, undo_redo)
		elif layer != null and Copies.is_file(layer) and layer.layer_id == -1:
			# The layer gets an ID when it is added to the list, and its file must store the ID. Because of this method call on the layer, the
			# editor saves that file together with the scene.
			undo_redo.add_do_method(layer, &"get_layer_id")
			undo_redo.add_undo_property(layer, &"layer_id", -1)
	for region: ScatterRegion3D in scatter.find_children("*", "ScatterRegion3D", true, false):
		_update_region_references(region, old, new, messages, undo_redo)
	if add_more.is_valid():
		add_more.call()
	undo_redo.commit_action()
	return messages


static func _update_layer_references(layer: ScatterLayer, old: Array[ScatterLayer], new: Array[ScatterLayer], r_messages: PackedStringArray,
		undo_redo: EditorUndoRedoManager) -> void:
	var spacing := layer.spacing
	var new_spacing := {}
	for key: Variant in spacing:
		var new_reference: Variant = _updated_reference(key, old, new)
		if new_reference != null:
			new_spacing[new_reference] = spacing[key]
		else:
			r_messages.append("%s no longer keeps a distance to %s." % [_title(layer, old), _title_of(key, old)])
	_set_undoable(layer, &"spacing", spacing, new_spacing, undo_redo)
	var hosts := layer.surface_layers
	var new_hosts: Array = hosts.map(_updated_reference.bind(old, new)).filter(func(new_reference: Variant) -> bool: return new_reference != null)
	for host: Variant in hosts.filter(func(host_reference: Variant) -> bool: return _updated_reference(host_reference, old, new) == null):
		r_messages.append("%s no longer grows on %s." % [_title(layer, old), _title_of(host, old)])
	if new_hosts or not hosts: # With an empty list, the layer would grow on the ground instead.
		_set_undoable(layer, &"surface_layers", hosts, new_hosts, undo_redo)
	for object in Names.with_value_sources([layer]):
		for property in Names.reference_properties(object):
			var reference: Variant = object.get(property)
			var new_reference: Variant = _updated_reference(reference, old, new)
			if new_reference == null:
				var name := property if object == layer else _value_name(layer, object) + "." + property
				r_messages.append("%s no longer has a %s: it was %s." % [_title(layer, old), name, _title_of(reference, old)])
			_set_undoable(object, property, reference, new_reference if new_reference != null else "", undo_redo)


## Returns the property of a layer that holds a value source.
static func _value_name(layer: ScatterLayer, value: Object) -> String:
	if value == layer.color_value:
		return "color_value"
	return "variation_value" if value == layer.variation_value else "scale_value"


static func _update_region_references(region: ScatterRegion3D, old: Array[ScatterLayer], new: Array[ScatterLayer], r_messages: PackedStringArray,
		undo_redo: EditorUndoRedoManager) -> void:
	var references := region.layers
	var new_references: Array = references.map(_updated_reference.bind(old, new)).filter(func(new_reference: Variant) -> bool: return new_reference != null)
	if new_references.is_empty() and not references.is_empty(): # An empty list would mean all layers.
		r_messages.append("%s no longer applies to any layer." % region.name)
	elif new_references.size() < references.size():
		r_messages.append("%s no longer applies to the deleted layers." % region.name)
		_set_undoable(region, &"layers", references, new_references, undo_redo)
	else:
		_set_undoable(region, &"layers", references, new_references, undo_redo)


static func _set_undoable(object: Object, property: StringName, before: Variant, after: Variant, undo_redo: EditorUndoRedoManager) -> void:
	if typeof(before) != typeof(after) or before != after:
		undo_redo.add_do_property(object, property, after)
		undo_redo.add_undo_property(object, property, before)


## Returns the new value of a reference to a layer, which is null if the layer is only in the old list and no new layer has its name. Returns an
## invalid reference unchanged.
static func _updated_reference(reference: Variant, old: Array[ScatterLayer], new: Array[ScatterLayer]) -> Variant:
	var layer := _referenced_layer(reference, old)
	if layer == null:
		return reference
	return reference if new.has(layer) or (reference is String and Copies.names(new).has(reference)) else null


static func _referenced_layer(reference: Variant, layers: Array[ScatterLayer]) -> ScatterLayer:
	if reference is Resource:
		return reference if layers.has(reference) else null
	for layer in layers:
		if layer != null and reference and layer.resource_name == str(reference):
			return layer
	return null


static func _title_of(reference: Variant, layers: Array[ScatterLayer]) -> String:
	return _title(_referenced_layer(reference, layers), layers)


static func _title(layer: ScatterLayer, layers: Array[ScatterLayer]) -> String:
	return layer.resource_name if layer.resource_name else "Layer %d" % layers.find(layer)
