@tool
extends RefCounted
## The layers that an object of the edited scene can refer to: those of its scatter.

const ScatterLayers := preload("res://addons/thicket/editor/layers/scatter_layers.gd")


## The [TerrainScatter3D] above a region in the tree, or the first one of the edited scene that has the layer, or a layer that uses the value;
## null if there is none.
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
		if scatter != null and ScatterLayers.of(scatter).any(_is_of.bind(object)):
			return scatter
	return null


## Whether an object is the layer, or a value of the layer.
static func _is_of(layer: ScatterLayer, object: Object) -> bool:
	return layer != null and object in [layer, layer.color_value, layer.variation_value]


## The layers that an object can refer to, without itself. [param before] leaves out those after it in the list.
static func others(object: Object, before := false) -> Array[ScatterLayer]:
	var result: Array[ScatterLayer] = []
	var scatter := scatter_of(object)
	if scatter == null:
		return result
	for layer in ScatterLayers.of(scatter):
		if before and _is_of(layer, object):
			break
		if layer != null and layer != object:
			result.append(layer)
	return result


## The layers and their values, which may refer to layers, each of them once.
static func referring(layers: Array[ScatterLayer]) -> Array[Resource]:
	var result: Array[Resource] = []
	for layer in layers:
		for object: Resource in [layer, layer.color_value, layer.variation_value]:
			if object != null and not object in result:
				result.append(object)
	return result


## The properties of a layer or a value that refer to one other layer. These properties accept a layer or a name, and no other property accepts
## several types. Empty for other objects.
static func reference_properties(object: Object) -> PackedStringArray:
	var result := PackedStringArray()
	if not (object is ScatterLayer or object is ScatterValueSource):
		return result
	for property in ClassDB.class_get_property_list(object.get_class(), true):
		if property.usage & PROPERTY_USAGE_NIL_IS_VARIANT:
			result.append(property.name)
	return result


## The value of a property that refers to a layer: the layer's name, or the layer itself if it has none.
static func reference_to(layer: ScatterLayer) -> Variant:
	return layer.resource_name if layer.resource_name else layer


## The layer that a value of an object's property refers to; null if there is none.
static func layer_of(object: Object, value: Variant) -> ScatterLayer:
	if value is ScatterLayer:
		return value
	for layer in ScatterLayers.of(scatter_of(object)):
		if layer != null and value and layer.resource_name == str(value):
			return layer
	return null


## The text that is shown for a value.
static func title(object: Object, value: Variant) -> String:
	var layer := layer_of(object, value)
	if layer == null:
		return "%s (no such layer)" % value
	if layer.resource_name:
		return layer.resource_name
	var scatter := scatter_of(object)
	return "Layer %d" % ScatterLayers.of(scatter).find(layer) if scatter != null else "Layer without a name"
