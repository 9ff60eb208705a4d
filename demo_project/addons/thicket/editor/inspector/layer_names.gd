@tool
extends RefCounted
## Finds the layers to which an object of the edited scene can refer, which are the layers of its scatter.

const ScatterLayers := preload("res://addons/thicket/editor/layers/scatter_layers.gd")


## Returns the [TerrainScatter3D] of an object, or null if there is none. For a region, it is the nearest one above in the tree. For a layer or a
## value source, it is the first one in the edited scene that has the layer or uses the source.
static func scatter_of(object: Object) -> TerrainScatter3D:
	if object is Node:
		var node: Node = object
		while node != null and not node is TerrainScatter3D:
			node = node.get_parent()
		return node as TerrainScatter3D
	var root := EditorInterface.get_edited_scene_root()
	if root == null:
		return null
	var scatters: Array = root.find_children("*", "TerrainScatter3D", true, false)
	scatters.push_front(root)
	for node: Node in scatters:
		var scatter := node as TerrainScatter3D
		if scatter != null and ScatterLayers.of(scatter).any(_belongs_to.bind(object)):
			return scatter
	return null


## Returns true if an object is the layer, or a value source of the layer.
static func _belongs_to(layer: ScatterLayer, object: Object) -> bool:
	return layer != null and object in [layer, layer.color_value, layer.variation_value, layer.scale_value]


## Returns the layers that an object can refer to, without the object itself. If [param only_earlier] is true, only includes layers that come before
## it in the list.
static func others(object: Object, only_earlier := false) -> Array[ScatterLayer]:
	var result: Array[ScatterLayer] = []
	var scatter := scatter_of(object)
	if scatter == null:
		return result
	for layer in ScatterLayers.of(scatter):
		if only_earlier and _belongs_to(layer, object):
			break
		if layer != null and layer != object:
			result.append(layer)
	return result


## Returns the layers and their value sources, which may also refer to layers, without duplicates.
static func with_value_sources(layers: Array[ScatterLayer]) -> Array[Resource]:
	var result: Array[Resource] = []
	for layer in layers:
		for object: Resource in [layer, layer.color_value, layer.variation_value, layer.scale_value]:
			if object != null and not object in result:
				result.append(object)
	return result


## Returns the properties of a layer or a value source that refer to one other layer. Only these properties accept two types, a layer or a name, which
## is how this method recognizes them. For other objects, returns an empty array.
static func reference_properties(object: Object) -> PackedStringArray:
	var result := PackedStringArray()
	if not (object is ScatterLayer or object is ScatterValueSource):
		return result
	for property in ClassDB.class_get_property_list(object.get_class(), true):
		if property.usage & PROPERTY_USAGE_NIL_IS_VARIANT:
			result.append(property.name)
	return result


## Returns the value with which a property refers to a layer: the layer's name, or the layer itself if it has no name.
static func reference_to(layer: ScatterLayer) -> Variant:
	return layer.resource_name if layer.resource_name else layer


## Returns the layer that a value of an object's property refers to, or null if there is none.
static func layer_of(object: Object, value: Variant) -> ScatterLayer:
	if value is ScatterLayer:
		return value
	for layer in ScatterLayers.of(scatter_of(object)):
		if layer != null and value and layer.resource_name == str(value):
			return layer
	return null


## Returns the text that is shown for a value.
static func title(object: Object, value: Variant) -> String:
	var layer := layer_of(object, value)
	if layer == null:
		return "%s (no such layer)" % value
	if layer.resource_name:
		return layer.resource_name
	var scatter := scatter_of(object)
	return "Layer %d" % ScatterLayers.of(scatter).find(layer) if scatter != null else "Layer without a name"
