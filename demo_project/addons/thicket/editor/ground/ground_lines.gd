@tool
extends RefCounted
## Builds lines for gizmos that follow the ground of a scatter.

## The height of lines above the ground in meters, so that the ground does not hide them.
const LIFT := 0.1

## The ground to follow. If null, lines are at [member level].
var ground: ScatterGround
## The world height in meters of lines without a ground.
var level := 0.0
## The number of ground heights that may still be queried. Once it is 0, additional lines are straight from corner to corner.
var budget := 4000
## Returns the world positions on the ground, raised by [constant LIFT], for a [PackedVector2Array] of points. By default, points are world x and z.
var to_ground: Callable = _from_above
## Pairs of end points, in the space of the node.
var segments := PackedVector3Array()

var _to_node: Transform3D


## Prepares lines for [param node]. If the node is not below a scatter, the lines do not follow a ground.
func _init(node: Node3D) -> void:
	_to_node = node.global_transform.affine_inverse()
	level = node.global_position.y
	var scatter := scatter_of(node)
	if scatter != null:
		ground = scatter.ground


## Returns the node itself or the nearest scatter above it, or null if there is none.
static func scatter_of(node: Node) -> TerrainScatter3D:
	while node != null and not node is TerrainScatter3D:
		node = node.get_parent()
	return node as TerrainScatter3D


## Returns a material for lines that are visible through everything and equally opaque whether their node is selected or
## not. The materials that a gizmo plugin creates are less opaque for unselected nodes.
static func material(color: Color) -> StandardMaterial3D:
	var line_material := StandardMaterial3D.new()
	line_material.shading_mode = BaseMaterial3D.SHADING_MODE_UNSHADED
	line_material.transparency = BaseMaterial3D.TRANSPARENCY_ALPHA
	line_material.no_depth_test = true
	line_material.disable_fog = true
	line_material.albedo_color = color
	return line_material


## Adds a line through points (see [member to_ground]), with a ground height at least every [param piece] meters.
func add(points: PackedVector2Array, closed: bool, piece: float) -> void:
	if points.is_empty():
		return
	var line := PackedVector2Array([points[0]])
	var count := points.size() if closed else points.size() - 1
	for index in count:
		var start := points[index]
		var end := points[(index + 1) % points.size()]
		var pieces := clampi(ceili(start.distance_to(end) / piece), 1, maxi(1, budget))
		budget -= pieces
		for step in pieces:
			line.append(start.lerp(end, (step + 1.0) / pieces))
	var positions := _to_node * (to_ground.call(line) as PackedVector3Array)
	for index in range(1, positions.size()):
		segments.append(positions[index - 1])
		segments.append(positions[index])


func _from_above(points: PackedVector2Array) -> PackedVector3Array:
	var positions := PackedVector3Array()
	for point in points:
		var position := Vector3(point.x, level, point.y)
		if ground != null:
			var height := ground.get_height(position)
			if not is_nan(height):
				position.y = height + LIFT
		positions.append(position)
	return positions
