@tool
extends RefCounted
## Creates deep copies of layers. Resources with their own file are shared; all others are copied.


## Classes of resources that copies may share even if they have no file: a layer's content, as opposed to its settings.
const ASSETS: Array[StringName] = [&"Mesh", &"PackedScene", &"Material", &"Texture", &"ScatterModel", &"PhysicsMaterial"]


## Returns a copy of a layer, even if the layer has its own file. [param copies] maps resources to their copies. Resources in it are not
## copied again, and new copies are added to it, so a resource that is used twice is copied once. If [param with_assets] is true, resources
## of the classes in [constant ASSETS] are copied as well.
static func of(layer: ScatterLayer, copies: Dictionary[Resource, Resource], with_assets := true) -> ScatterLayer:
	if not copies.has(layer):
		_copy_deep(layer, copies, with_assets)
	return copies[layer]


## Returns a name that is not in [param used_names]: the name itself, or the name with a number.
static func free_name(name: String, used_names: PackedStringArray) -> String:
	return ScatterLayer.new().find_free_name(name, used_names)


## Returns the names of layers, without null entries.
static func names(layers: Array[ScatterLayer]) -> PackedStringArray:
	var result := PackedStringArray()
	for layer in layers:
		if layer != null:
			result.append(layer.resource_name)
	return result


static func is_file(resource: Resource) -> bool:
	return not resource.resource_path.is_empty() and not "::" in resource.resource_path


static func _copy_deep(resource: Resource, copies: Dictionary[Resource, Resource], with_assets: bool) -> void:
	var copy := resource.duplicate(false)
	copies[resource] = copy
	for property in copy.get_property_list():
		if property.usage & PROPERTY_USAGE_STORAGE and property.name != "script":
			var value: Variant = copy.get(property.name)
			if value is Resource or value is Array:
				copy.set(property.name, _copy_value(value, copies, with_assets))
			elif property.name == "spacing":
				copy.set(property.name, _copy_keys(value, copies, with_assets))


static func _copy_value(value: Variant, copies: Dictionary[Resource, Resource], with_assets: bool) -> Variant:
	if value is Resource:
		var resource := value as Resource
		if not copies.has(resource) and not is_file(resource) and (with_assets or not ASSETS.any(resource.is_class)):
			_copy_deep(resource, copies, with_assets)
		return copies.get(resource, resource)
	if value is Array:
		var array := (value as Array).duplicate()
		for index in array.size():
			array[index] = _copy_value(array[index], copies, with_assets)
		return array
	return value


static func _copy_keys(dictionary: Dictionary, copies: Dictionary[Resource, Resource], with_assets: bool) -> Dictionary:
	var result := {}
	for key: Variant in dictionary:
		result[_copy_value(key, copies, with_assets)] = dictionary[key]
	return result
