@tool
extends RefCounted
## Creates layers for meshes, scenes and models. The layers are named after their files, have settings that suit the
## size and the kind of the mesh, and keep distances from each other.

const Copies := preload("res://addons/thicket/editor/layers/layer_copies.gd")
const SurfacePlace := preload("res://addons/thicket/editor/ground/surface_place.gd")

## The view distance of a layer is its radius times [constant VIEW_FACTOR], limited to [constant VIEW_RANGE] in meters. [constant TILE_FACTOR] and
## [constant TILE_RANGE] define its tile size in the same way, but the tile size is rounded to a power of two.
const VIEW_FACTOR := 100.0
const VIEW_RANGE := Vector2(10.0, 600.0)
const TILE_FACTOR := 30.0
const TILE_RANGE := Vector2(8.0, 128.0)
## A later layer grows beneath an earlier one if its radius is less than [constant UNDERGROWTH] times the earlier radius. It then keeps a distance of
## [constant TRUNK_FACTOR] times the earlier radius.
const UNDERGROWTH := 0.35
const TRUNK_FACTOR := 0.2
## The largest distance to an earlier layer of full density, as a fraction of that layer's radius. At a larger distance,
## hardly any instance would remain, because no position is farther than its radius from one of its instances. A lower
## density of the earlier layer allows a larger distance.
const MAX_SPACING := 0.62
## Two layers have similar radii if the smaller radius is at least this fraction of the larger one.
const SIMILARITY := 0.5
## The steepest slope in degrees on which new layers on surfaces grow. Walls would otherwise be as densely covered as floors.
const MAX_SLOPE := 60.0


## Creates a layer with these meshes and with settings that fit their sizes. Returns null if there is nothing to draw, or if the layer
## rejects one of the meshes.
static func of_meshes(meshes: Array, kind := ScatterLayer.KIND_AUTOMATIC) -> ScatterLayer:
	var layer := ScatterLayer.new()
	for mesh: Variant in meshes: # Added one by one, because a layer accepts an invalid entry only while its list is empty.
		layer.meshes = layer.meshes + [mesh]
	return layer if layer.fit_to_meshes(kind) and layer.meshes.size() == meshes.size() else null


## Adds to an undo step that [param layer] gets the fitted properties of [param template], on which fit_to_meshes was called.
static func add_fit(layer: ScatterLayer, template: ScatterLayer, undo_redo: EditorUndoRedoManager) -> void:
	for property in layer.get_fitted_properties():
		undo_redo.add_do_property(layer, property, template.get(property))
		undo_redo.add_undo_property(layer, property, layer.get(property))


## Creates a layer for each resource that can be drawn, the widest first, with names that are not in [param used_names]. Resources that
## are layers come first in the result, unchanged.
static func of_resources(resources: Array[Resource], used_names: PackedStringArray) -> Array[ScatterLayer]:
	var result: Array[ScatterLayer] = []
	var new_layers: Array[ScatterLayer] = []
	var names := used_names.duplicate()
	for resource in resources:
		if resource is ScatterLayer:
			result.append(resource)
			continue
		var layer := of_meshes([resource])
		if layer == null:
			continue
		layer.resource_name = Copies.free_name(_name_of(resource), names)
		names.append(layer.resource_name)
		_fit_distances(layer)
		new_layers.append(layer)
	new_layers.sort_custom(func(a: ScatterLayer, b: ScatterLayer) -> bool: return a.radius > b.radius)
	_share_ground(new_layers)
	result.append_array(new_layers)
	return result


## Lets new layers grow on all levels of the ground, such as the floors of a house or the land below a bridge, if the ground contains meshes. They
## then have one progressive level, because three levels would make their tiles 2 to 18 times slower on surfaces.
static func use_levels(new_layers: Array[ScatterLayer], ground: ScatterGround) -> void:
	if SurfacePlace.has_levels(ground):
		for layer in new_layers:
			layer.on_surfaces = true
			layer.max_slope_degrees = minf(layer.max_slope_degrees, MAX_SLOPE)
			layer.progressive_levels = 1


## Returns the index at which to insert a new layer in a list. It is in front of the first layer whose radius is less than half of the new layer's
## radius. As a result, small layers avoid large ones.
static func insert_index_for(layer: ScatterLayer, layers: Array[ScatterLayer]) -> int:
	for index in layers.size():
		var other := layers[index]
		if other != null and other.radius < 0.5 * layer.radius:
			return index
	return layers.size()


## Sets the spacing of new layers to the other layers of a list that have a name. Among the new layers, only later ones keep a distance from earlier
## ones. Large layers keep no distance from their undergrowth. A layer has at most [constant ScatterLayer.MAX_NEIGHBORS] distances. It fills the gaps
## between earlier layers only if all of them have similar radii. Otherwise it would gain few instances, or its undergrowth would be slow to generate.
static func keep_apart(new_layers: Array[ScatterLayer], layers: Array[ScatterLayer]) -> void:
	var processed: Array[ScatterLayer] = []
	for layer in new_layers:
		var spacing := layer.spacing.duplicate()
		var similar_count := 0
		var different_count := 0
		for other in layers:
			var is_later := new_layers.has(other) and not processed.has(other)
			if other == null or other == layer or other.resource_name.is_empty() or is_later or spacing.size() >= ScatterLayer.MAX_NEIGHBORS:
				continue
			var is_first := layers.find(layer) < layers.find(other)
			var meters := distance(layer if is_first else other, other if is_first else layer)
			if meters > 0.0:
				spacing[other.resource_name] = meters
				var ratio := minf(layer.radius, other.radius) / maxf(layer.radius, other.radius)
				similar_count += int(not is_first and ratio >= SIMILARITY)
				different_count += int(not is_first and ratio < SIMILARITY)
		layer.spacing = spacing
		layer.spacing_fills = similar_count > 0 and different_count == 0 and not layer.on_surfaces
		processed.append(layer)


## Sets the spacing of later layers to the earlier layers that have a name. The distances among the later layers are not changed. A layer has at most
## [constant ScatterLayer.MAX_NEIGHBORS] distances.
static func keep_from(later_layers: Array[ScatterLayer], earlier_layers: Array[ScatterLayer]) -> void:
	for layer in later_layers:
		var spacing := layer.spacing.duplicate()
		for other in earlier_layers:
			var meters := distance(other, layer) if other != null and not other.resource_name.is_empty() else 0.0
			if meters > 0.0 and spacing.size() < ScatterLayer.MAX_NEIGHBORS:
				spacing[other.resource_name] = meters
		layer.spacing = spacing


## Returns the distance in meters that a later layer keeps from an earlier layer: half the sum of both radii. The distance is smaller if half the sum
## would leave no room, or if the later layer is undergrowth. It is 0 if the earlier layer is undergrowth.
static func distance(earlier: ScatterLayer, later: ScatterLayer) -> float:
	var earlier_radius := earlier.radius
	var later_radius := later.radius
	if earlier_radius < later_radius * UNDERGROWTH:
		return 0.0
	var spacing := earlier_radius * TRUNK_FACTOR if later_radius < earlier_radius * UNDERGROWTH else 0.5 * (earlier_radius + later_radius)
	var max_spacing := MAX_SPACING * earlier_radius / sqrt(maxf(earlier.density, 0.05))
	return maxf(snappedf(minf(spacing, max_spacing), 0.01), 0.01)


static func _name_of(resource: Resource) -> String:
	if resource.resource_name and not Copies.is_file(resource):
		return resource.resource_name
	var file := resource.resource_path.get_file().get_basename()
	return file.capitalize() if file and not "::" in resource.resource_path else resource.get_class().capitalize()


static func _fit_distances(layer: ScatterLayer) -> void:
	var radius := layer.radius
	layer.view_distance = roundf(clampf(radius * VIEW_FACTOR, VIEW_RANGE.x, VIEW_RANGE.y))
	layer.tile_size = pow(2.0, roundf(log(clampf(radius * TILE_FACTOR, TILE_RANGE.x, TILE_RANGE.y)) / log(2.0)))


## Lowers the densities of layers with similar radii, so that the layers share the ground. The first layer keeps its
## proportion, the second layer gets its proportion of the rest, and so on.
static func _share_ground(layers: Array[ScatterLayer]) -> void:
	for index in layers.size():
		var layer_count := 1
		for later in range(index + 1, layers.size()):
			if layers[later].radius > 0.5 * layers[index].radius:
				layer_count += 1
		layers[index].density = snappedf(layers[index].density / layer_count, 0.01)
