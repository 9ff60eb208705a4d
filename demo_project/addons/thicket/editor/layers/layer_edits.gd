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
## is -1, each is inserted at a suitable position. If [param apart] is true, layers without their own files keep distances from the others. If the
## edited scene has a file, scenes of plants get foliage materials in files next to that file. Returns the new layers.
static func add(scatter: TerrainScatter3D, resources: Array[Resource], at: int, apart: bool, files: SceneFiles,
		undo_redo: EditorUndoRedoManager) -> Array[ScatterLayer]:
	var old := scatter.layers
	var fresh := resources.filter(func(resource: Resource) -> bool: return not resource is ScatterLayer or not resource in old)
	var added := NewLayers.of_resources(fresh, Copies.names(old))
	if added.is_empty():
		return added
	var new: Array[ScatterLayer] = old.duplicate()
	for index in added.size():
		new.insert(at + index if at >= 0 else NewLayers.place_for(added[index], new), added[index])
	var own := added.filter(func(layer: ScatterLayer) -> bool: return not Copies.is_file(layer))
	NewLayers.use_levels(own, scatter.ground)
	if apart:
		NewLayers.keep_apart(own, new)
	_commit("Add Layers", scatter, new, undo_redo, func() -> void:
		for layer in added:
			files.add_new_to_undo(_make_foliage(layer), layer, undo_redo))
	return added


## Creates foliage materials for a new layer of plants, unless there is no path for their files. Returns the materials.
static func _make_foliage(layer: ScatterLayer) -> Array[Resource]:
	var location := SceneFiles.place_of(layer)
	if location.is_empty() or Copies.is_file(layer) or layer.get_model_kind() == ScatterLayer.KIND_ROCK:
		return []
	return FoliageMaterials.new(location).give(layer)


## Returns a message that names the resources for which [method add] has not added a layer, or an empty string if there
## are none. [param added] is the result of [method add].
static func left_out(resources: Array[Resource], added: Array[ScatterLayer]) -> String:
	var names := PackedStringArray()
	for resource in resources:
		if not added.any(func(layer: ScatterLayer) -> bool: return layer == resource or _draws(layer, resource)):
			names.append(resource.resource_path if resource.resource_path else resource.get_class())
	return "" if names.is_empty() else "Not added: %s. A mesh needs surfaces, a scene a visible MeshInstance3D, and a layer must not be in the list yet." % \
			", ".join(names)


static func _draws(layer: ScatterLayer, resource: Resource) -> bool:
	return layer.meshes.any(func(entry: Variant) -> bool:
		return entry == resource or entry is ScatterModel and (entry as ScatterModel).scene == resource)


## Adds copies of layers, with copies of their masks, after the last of the layers. Returns the copies, or an empty array on failure.
static func copy(scatter: TerrainScatter3D, layers: Array[ScatterLayer], apart: bool, files: SceneFiles, scene_path: String,
		undo_redo: EditorUndoRedoManager) -> Array[ScatterLayer]:
	var old := scatter.layers
	var names := Copies.names(old)
	var result: Array[ScatterLayer] = []
	var masks: Dictionary[Resource, Resource] = {}
	for layer in layers:
		var copied := Copies.of(layer, {}, false)
		copied.resource_name = Copies.free_name(layer.resource_name if layer.resource_name else "Layer", names)
		copied.layer_id = -1
		names.append(copied.resource_name)
		if apart and layer.resource_name:
			var spacing := copied.spacing.duplicate()
			spacing[layer.resource_name] = NewLayers.distance(layer, copied)
			copied.spacing = spacing
		if not files.copy_mask(copied, scene_path, masks):
			return []
		result.append(copied)
	var new: Array[ScatterLayer] = old.duplicate()
	var at: int = layers.map(func(layer: ScatterLayer) -> int: return old.find(layer)).max() + 1
	for index in result.size():
		new.insert(at + index, result[index])
	_commit("Duplicate Layers", scatter, new, undo_redo, func() -> void: files.add_to_undo(masks.values(), scene_path, undo_redo))
	return result


## Removes layers. Returns messages about the effects on other layers and regions.
static func remove(scatter: TerrainScatter3D, layers: Array[ScatterLayer], undo_redo: EditorUndoRedoManager) -> PackedStringArray:
	var new: Array[ScatterLayer] = scatter.layers.filter(func(layer: ScatterLayer) -> bool: return not layer in layers)
	return _commit("Delete Layers", scatter, new, undo_redo)


## Moves layers in front of the layer at an index, without changing their order. Returns false if they are already there.
static func move(scatter: TerrainScatter3D, layers: Array[ScatterLayer], to: int, undo_redo: EditorUndoRedoManager) -> bool:
	var old := scatter.layers
	var new: Array[ScatterLayer] = []
	for index in old.size() + 1:
		if index == to:
			new.append_array(old.filter(func(layer: ScatterLayer) -> bool: return layer in layers))
		if index < old.size() and not old[index] in layers:
			new.append(old[index])
	if new == old:
		return false
	_commit("Move Layers", scatter, new, undo_redo)
	return true


## Renames a layer. A number is added to the name if another layer has it. References by name are updated automatically.
static func rename(scatter: TerrainScatter3D, layer: ScatterLayer, name: String, undo_redo: EditorUndoRedoManager) -> void:
	var others: Array[ScatterLayer] = ScatterLayers.of(scatter).filter(func(other: ScatterLayer) -> bool: return other != layer)
	var free := Copies.free_name(name.strip_edges(), Copies.names(others))
	if name.strip_edges().is_empty() or free == layer.resource_name:
		return
	undo_redo.create_action("Rename Layer", UndoRedo.MERGE_DISABLE, scatter)
	undo_redo.add_do_property(layer, &"resource_name", free)
	undo_redo.add_undo_property(layer, &"resource_name", layer.resource_name)
	undo_redo.commit_action()


## Sets the scatter's list of layers and removes references to layers that are no longer in it. Returns a message for each removed reference.
static func _commit(title: String, scatter: TerrainScatter3D, new: Array[ScatterLayer], undo_redo: EditorUndoRedoManager,
		more := Callable()) -> PackedStringArray:
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
	if more.is_valid():
		more.call()
	undo_redo.commit_action()
	return messages


static func _update_layer_references(layer: ScatterLayer, old: Array[ScatterLayer], new: Array[ScatterLayer], r_messages: PackedStringArray,
		undo_redo: EditorUndoRedoManager) -> void:
	var spacing := layer.spacing
	var followed := {}
	for key: Variant in spacing:
		var next: Variant = _next(key, old, new)
		if next != null:
			followed[next] = spacing[key]
		else:
			r_messages.append("%s no longer keeps a distance to %s." % [_title(layer, old), _title_of(key, old)])
	_change(layer, &"spacing", spacing, followed, undo_redo)
	var hosts := layer.surface_layers
	var followed_hosts: Array = hosts.map(_next.bind(old, new)).filter(func(next: Variant) -> bool: return next != null)
	for host: Variant in hosts.filter(func(each: Variant) -> bool: return _next(each, old, new) == null):
		r_messages.append("%s no longer grows on %s." % [_title(layer, old), _title_of(host, old)])
	if followed_hosts or not hosts: # With an empty list, the layer would grow on the ground instead.
		_change(layer, &"surface_layers", hosts, followed_hosts, undo_redo)
	for object in Names.referring([layer]):
		for property in Names.reference_properties(object):
			var mentioned: Variant = object.get(property)
			var next: Variant = _next(mentioned, old, new)
			if next == null:
				var name := property if object == layer else _value_name(layer, object) + "." + property
				r_messages.append("%s no longer has a %s: it was %s." % [_title(layer, old), name, _title_of(mentioned, old)])
			_change(object, property, mentioned, next if next != null else "", undo_redo)


## Returns the property of a layer that holds a value source.
static func _value_name(layer: ScatterLayer, value: Object) -> String:
	if value == layer.color_value:
		return "color_value"
	return "variation_value" if value == layer.variation_value else "scale_value"


static func _update_region_references(region: ScatterRegion3D, old: Array[ScatterLayer], new: Array[ScatterLayer], r_messages: PackedStringArray,
		undo_redo: EditorUndoRedoManager) -> void:
	var mentioned := region.layers
	var followed: Array = mentioned.map(_next.bind(old, new)).filter(func(next: Variant) -> bool: return next != null)
	if followed.is_empty() and not mentioned.is_empty(): # An empty list would mean all layers.
		r_messages.append("%s no longer applies to any layer." % region.name)
	elif followed.size() < mentioned.size():
		r_messages.append("%s no longer applies to the deleted layers." % region.name)
		_change(region, &"layers", mentioned, followed, undo_redo)
	else:
		_change(region, &"layers", mentioned, followed, undo_redo)


static func _change(object: Object, property: StringName, before: Variant, after: Variant, undo_redo: EditorUndoRedoManager) -> void:
	if typeof(before) != typeof(after) or before != after:
		undo_redo.add_do_property(object, property, after)
		undo_redo.add_undo_property(object, property, before)


## Returns the new value of a reference to a layer, which is null if the layer is only in the old list and no new layer has its name. Returns an
## invalid reference unchanged.
static func _next(mentioned: Variant, old: Array[ScatterLayer], new: Array[ScatterLayer]) -> Variant:
	var layer := _referenced_layer(mentioned, old)
	if layer == null:
		return mentioned
	return mentioned if new.has(layer) or (mentioned is String and Copies.names(new).has(mentioned)) else null


static func _referenced_layer(mentioned: Variant, layers: Array[ScatterLayer]) -> ScatterLayer:
	if mentioned is Resource:
		return mentioned if layers.has(mentioned) else null
	for layer in layers:
		if layer != null and mentioned and layer.resource_name == str(mentioned):
			return layer
	return null


static func _title_of(mentioned: Variant, layers: Array[ScatterLayer]) -> String:
	return _title(_referenced_layer(mentioned, layers), layers)


static func _title(layer: ScatterLayer, layers: Array[ScatterLayer]) -> String:
	return layer.resource_name if layer.resource_name else "Layer %d" % layers.find(layer)
