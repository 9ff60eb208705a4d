@tool
extends EditorNode3DGizmoPlugin
## Draws the extent of the layers of the selected [code]TerrainScatter3D[/code] as a line around the visible tiles, except on a planet.

const GroundLines := preload("res://addons/thicket/editor/ground/ground_lines.gd")
const ScatterLayers := preload("res://addons/thicket/editor/layers/scatter_layers.gd")
const SurfacePlace := preload("res://addons/thicket/editor/ground/surface_place.gd")

const COLOR := Color(0.99, 0.62, 0.5)
const SIDES: Array[Vector2i] = [Vector2i.UP, Vector2i.RIGHT, Vector2i.DOWN, Vector2i.LEFT]
## The largest number of ground heights to query for one drawing, for all layers together.
const MOST_HEIGHTS := 2000

## The selected scatter. The extents of other scatters are not drawn.
var scatter: TerrainScatter3D

var _line := GroundLines.material(Color(COLOR, 0.6))


func _get_gizmo_name() -> String:
	return "TerrainScatter3D"


func _has_gizmo(node: Node3D) -> bool:
	return node is TerrainScatter3D


func _redraw(gizmo: EditorNode3DGizmo) -> void:
	gizmo.clear()
	# On a planet, a tile is a cube, and its outline as seen from above is not where its instances are.
	if gizmo.get_node_3d() != scatter or SurfacePlace.is_planet(scatter):
		return
	var edges: Array[PackedVector2Array] = []
	var drawn_extents := {}
	for layer in ScatterLayers.of(scatter):
		if layer == null:
			continue
		var extent := Vector2(layer.tile_size, layer.view_distance)
		if not drawn_extents.has(extent):
			drawn_extents[extent] = true
			_add_edges(edges, scatter.get_shown_tiles(layer), extent.x)
	if edges.is_empty():
		return
	var lines := GroundLines.new(scatter)
	var pieces_per_edge := maxi(1, MOST_HEIGHTS / edges.size())
	for edge in edges:
		lines.add(edge, false, maxf(2.0, edge[0].distance_to(edge[1]) / pieces_per_edge))
	gizmo.add_lines(lines.segments, _line)


## Adds the edges at which a tile has no neighbor.
static func _add_edges(edges: Array[PackedVector2Array], tiles: Array, size: float) -> void:
	var visible_keys := {}
	for tile: Vector2i in tiles:
		visible_keys[tile] = true
	for tile: Vector2i in tiles:
		for side in SIDES.size():
			if not visible_keys.has(tile + SIDES[side]):
				var edge_center := Vector2(tile) + Vector2(0.5, 0.5) + Vector2(SIDES[side]) * 0.5
				var half_edge := Vector2(SIDES[side]).orthogonal() * 0.5
				edges.append(PackedVector2Array([(edge_center - half_edge) * size, (edge_center + half_edge) * size]))
