@tool
extends RefCounted
## Creates layers for meshes, scenes and models. The layers are named after their files, their values suit the size and the kind of the mesh, and
## they keep distances to each other.

const Copies := preload("res://addons/thicket/editor/layers/layer_copies.gd")

## The view distance of a layer, in meters per meter of its radius, with its limits, and the same for the side of its tiles.
const VIEW := 100.0
const VIEW_RANGE := Vector2(10.0, 600.0)
const TILE := 30.0
const TILE_RANGE := Vector2(8.0, 128.0)
## A later layer whose radius is less than [constant UNDERGROWTH] times an earlier one's grows beneath the earlier layer. The later layer keeps a
## distance of [constant TRUNK] times the earlier radius.
const UNDERGROWTH := 0.35
const TRUNK := 0.2
## The largest distance to an earlier layer, as a part of that layer's radius. Beyond that, hardly any instance remains: at full density, no position
## is farther from the earlier layer than its radius.
const ROOM := 0.62


## Creates a layer with these meshes, whose values fit their sizes; null if there is nothing to draw.
static func of_meshes(meshes: Array, kind := ScatterLayer.KIND_AUTOMATIC) -> ScatterLayer:
	var layer := ScatterLayer.new()
	for mesh: Variant in meshes: # One by one, because a layer keeps an invalid entry only if its list was empty before.
		layer.meshes = layer.meshes + [mesh]
	return layer if layer.fit_to_meshes(kind) and layer.meshes.size() == meshes.size() else null


## Adds to an undo step that a layer gets the values which fit_to_meshes has set on a different one.
static func add_fit(layer: ScatterLayer, fitted: ScatterLayer, undo_redo: EditorUndoRedoManager) -> void:
	for property in layer.get_fitted_properties():
		undo_redo.add_do_property(layer, property, fitted.get(property))
		undo_redo.add_undo_property(layer, property, layer.get(property))


## Creates a layer for each resource that can be drawn, the widest first, with names that are not taken. Resources that are layers
## are returned unchanged.
static func of_resources(resources: Array[Resource], taken: PackedStringArray) -> Array[ScatterLayer]:
	var result: Array[ScatterLayer] = []
	var made: Array[ScatterLayer] = []
	var names := taken.duplicate()
	for resource in resources:
		if resource is ScatterLayer:
			result.append(resource)
			continue
		var layer := of_meshes([resource])
		if layer == null:
			continue
		layer.resource_name = Copies.free_name(_name_of(resource), names)
		names.append(layer.resource_name)
		_fit_view(layer)
		made.append(layer)
	made.sort_custom(func(a: ScatterLayer, b: ScatterLayer) -> bool: return a.radius > b.radius)
	_share_ground(made)
	result.append_array(made)
	return result


## The index for a new layer in a list: before the first layer that is less than half as wide, so that small layers avoid large ones.
static func place_for(layer: ScatterLayer, layers: Array[ScatterLayer]) -> int:
	for index in layers.size():
		var other := layers[index]
		if other != null and other.radius < 0.5 * layer.radius:
			return index
	return layers.size()


## Sets the spacing of new layers to all others of a list, by name. Large layers keep no distance to those that grow beneath them.
static func keep_apart(new: Array[ScatterLayer], layers: Array[ScatterLayer]) -> void:
	var done: Array[ScatterLayer] = []
	for layer in new:
		var spacing := layer.spacing.duplicate()
		for other in layers:
			var later := new.has(other) and not done.has(other)
			if other == null or other == layer or other.resource_name.is_empty() or later or spacing.size() >= ScatterLayer.MAX_NEIGHBORS:
				continue
			var is_first := layers.find(layer) < layers.find(other)
			var meters := distance(layer if is_first else other, other if is_first else layer)
			if meters > 0.0:
				spacing[other.resource_name] = meters
		layer.spacing = spacing
		done.append(layer)


## Sets the spacing of later layers to all earlier ones, by name. The distances that the later ones keep to each other stay.
static func give_way(later: Array[ScatterLayer], earlier: Array[ScatterLayer]) -> void:
	for layer in later:
		var spacing := layer.spacing.duplicate()
		for other in earlier:
			var meters := distance(other, layer) if other != null and not other.resource_name.is_empty() else 0.0
			if meters > 0.0 and spacing.size() < ScatterLayer.MAX_NEIGHBORS:
				spacing[other.resource_name] = meters
		layer.spacing = spacing


## The distance in meters that a later layer keeps to an earlier one: half the sum of both radii. The distance is less if that would leave no room, or
## if the later layer is undergrowth. It is 0 if the earlier layer is undergrowth.
static func distance(earlier: ScatterLayer, later: ScatterLayer) -> float:
	var wide := earlier.radius
	var other := later.radius
	if wide < other * UNDERGROWTH:
		return 0.0
	var apart := wide * TRUNK if other < wide * UNDERGROWTH else 0.5 * (wide + other)
	var room := ROOM * wide / sqrt(maxf(earlier.density, 0.05))
	return maxf(snappedf(minf(apart, room), 0.01), 0.01)


static func _name_of(resource: Resource) -> String:
	if resource.resource_name and not Copies.is_file(resource):
		return resource.resource_name
	var file := resource.resource_path.get_file().get_basename()
	return file.capitalize() if file and not "::" in resource.resource_path else resource.get_class().capitalize()


static func _fit_view(layer: ScatterLayer) -> void:
	var radius := layer.radius
	layer.view_distance = roundf(clampf(radius * VIEW, VIEW_RANGE.x, VIEW_RANGE.y))
	layer.tile_size = pow(2.0, roundf(log(clampf(radius * TILE, TILE_RANGE.x, TILE_RANGE.y)) / log(2.0)))


## New layers of similar width share the ground: the first one gets its share, the second one its share of the rest, and so on.
static func _share_ground(layers: Array[ScatterLayer]) -> void:
	for index in layers.size():
		var rest := 1
		for later in range(index + 1, layers.size()):
			if layers[later].radius > 0.5 * layers[index].radius:
				rest += 1
		layers[index].density = snappedf(layers[index].density / rest, 0.01)
