@tool
extends RefCounted
## Lines for gizmos that follow the ground of a scatter.

## Meters above the ground, so that lines are not lost in it.
const LIFT := 0.1

## The ground to follow; null for lines at [member level].
var ground: ScatterGround
## World height in meters of lines where there is no ground.
var level := 0.0
## How often the ground may still be asked; after that lines go straight from corner to corner.
var budget := 4000
## Pairs of ends, in the space of the node.
var segments := PackedVector3Array()

var _to_node: Transform3D


## Lines for [param node], which need not be below a scatter.
func _init(node: Node3D) -> void:
	_to_node = node.global_transform.affine_inverse()
	level = node.global_position.y
	var scatter := scatter_of(node)
	if scatter != null:
		ground = scatter.ground


## The scatter above a node, or the node itself; null if there is none.
static func scatter_of(node: Node) -> TerrainScatter3D:
	while node != null and not node is TerrainScatter3D:
		node = node.get_parent()
	return node as TerrainScatter3D


## A material for lines that are seen through everything, and in full whether their node is selected or not, which those
## of a gizmo plugin's own are not.
static func material(color: Color) -> StandardMaterial3D:
	var made := StandardMaterial3D.new()
	made.shading_mode = BaseMaterial3D.SHADING_MODE_UNSHADED
	made.transparency = BaseMaterial3D.TRANSPARENCY_ALPHA
	made.no_depth_test = true
	made.disable_fog = true
	made.albedo_color = color
	return made


## Adds a line through world positions (x, z), at most [param piece] meters from one asked height to the next.
func add(points: PackedVector2Array, closed: bool, piece: float) -> void:
	var count := points.size() if closed else points.size() - 1
	for index in count:
		var from := points[index]
		var to := points[(index + 1) % points.size()]
		var pieces := clampi(ceili(from.distance_to(to) / piece), 1, maxi(1, budget))
		budget -= pieces
		var last := _on_ground(from)
		for step in pieces:
			var next := _on_ground(from.lerp(to, (step + 1.0) / pieces))
			segments.append(last)
			segments.append(next)
			last = next


func _on_ground(at: Vector2) -> Vector3:
	var position := Vector3(at.x, level, at.y)
	if ground != null:
		var height := ground.get_height(position)
		if not is_nan(height):
			position.y = height + LIFT
	return _to_node * position
