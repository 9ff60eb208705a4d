@tool
extends RefCounted
## Layers to start from: copies of those in the scenes of the presets folder.

const FOLDER := "res://addons/thicket/presets/"
const NAMES: PackedStringArray = ["forest", "meadow", "scree"]


## New layers of a preset, as an array that fits the scatter's, whose index there starts at [param first_index]; names
## that [param taken] holds get a number, and so do their mentions in other layers. Empty if there is no such preset.
static func layers(name: String, taken: PackedStringArray, first_index := 0) -> Array:
	var scene := load(FOLDER + name + ".tscn") as PackedScene
	if scene == null:
		return []
	var source := scene.instantiate()
	var found: Array = source.get(&"layers")
	var copies: Dictionary[Resource, Resource] = {}
	var result := found.duplicate()
	result.clear()
	for layer: Resource in found:
		var copy := _copy(layer, copies)
		if copy != layer:
			copy.set(&"layer_id", -1) # The scatter that it joins gives it one.
		result.append(copy)
	source.free()
	_rename(result, taken, first_index)
	return result


## Adds a preset's layers to a scatter, as one step of undo.
static func add(name: String, scatter: Node3D, undo_redo: EditorUndoRedoManager) -> void:
	var old: Array = scatter.get(&"layers")
	var taken := PackedStringArray()
	for layer: Resource in old:
		if layer != null:
			taken.append(layer.resource_name)
	var new := old.duplicate()
	new.append_array(layers(name, taken, old.size()))
	undo_redo.create_action("Add Layers: " + name.capitalize(), UndoRedo.MERGE_DISABLE, scatter)
	undo_redo.add_do_property(scatter, &"layers", new)
	undo_redo.add_undo_property(scatter, &"layers", old)
	undo_redo.commit_action()


## What new layers ask for that stand nowhere, in a sentence; empty for none.
static func why_missing(missing: Array) -> String:
	if missing.is_empty():
		return ""
	var parts := PackedStringArray()
	for layer: Resource in missing:
		var asks := PackedStringArray()
		var least: float = layer.get(&"min_slope_degrees")
		if least > 0.0:
			asks.append("slopes from %.0f degrees" % least)
		if not (layer.get(&"ground_textures") as PackedInt32Array).is_empty():
			asks.append("its ground textures")
		if layer.get(&"proximity_layer"):
			asks.append("%s near by" % layer.get(&"proximity_layer"))
		parts.append("%s (needs %s)" % [layer.resource_name, ", ".join(asks)] if not asks.is_empty() else layer.resource_name)
	return "Nothing stands here of %s." % ", ".join(parts)


## A copy of a resource and of those in it, without their paths; files of their own are shared. What is used twice is
## copied once.
static func _copy(resource: Resource, copies: Dictionary[Resource, Resource]) -> Resource:
	if not resource.resource_path.is_empty() and not "::" in resource.resource_path:
		return resource
	if not copies.has(resource):
		var copy := resource.duplicate(false)
		copies[resource] = copy
		for property in copy.get_property_list():
			if property.usage & PROPERTY_USAGE_STORAGE and property.name != "script":
				var value: Variant = copy.get(property.name)
				if value is Resource or value is Array:
					copy.set(property.name, _copy_value(value, copies))
				elif property.name == "spacing":
					copy.set(property.name, _copy_keys(value, copies))
	return copies[resource]


static func _copy_value(value: Variant, copies: Dictionary[Resource, Resource]) -> Variant:
	if value is Resource:
		return _copy(value as Resource, copies)
	if value is Array:
		var array: Array = value.duplicate()
		for index in array.size():
			array[index] = _copy_value(array[index], copies)
		return array
	return value


static func _copy_keys(dictionary: Dictionary, copies: Dictionary[Resource, Resource]) -> Dictionary:
	var result := {}
	for key: Variant in dictionary:
		result[_copy_value(key, copies)] = dictionary[key]
	return result


static func _rename(new_layers: Array, taken: PackedStringArray, first_index: int) -> void:
	var names := {}
	for layer: Resource in new_layers:
		var name := layer.resource_name
		var number := 2
		while taken.has(name):
			name = "%s %d" % [layer.resource_name, number]
			number += 1
		names[layer.resource_name] = name
		layer.resource_name = name
	for layer: Resource in new_layers:
		var spacing: Dictionary = layer.get(&"spacing")
		var renamed := {}
		for key: Variant in spacing:
			renamed[_renamed(key, names, first_index)] = spacing[key]
		layer.set(&"spacing", renamed)
		for property: StringName in [&"proximity_layer", &"color_source_layer", &"variation_source_layer"]:
			layer.set(property, _renamed(layer.get(property), names, first_index))


## What a layer is referred to by in the scatter: its new name, its new index, or itself.
static func _renamed(reference: Variant, names: Dictionary, first_index: int) -> Variant:
	return reference + first_index if reference is int else names.get(reference, reference)
