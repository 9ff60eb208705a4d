extends Control
## A map of the instances around the player, drawn from a query. North is up, and each instance is a dot.

## The color of the dots for each layer name. Instances of other layers are not on the map.
const COLORS := {
	"Oak": Color(0.62, 0.8, 0.27),
	"Spruce": Color(0.2, 0.55, 0.33),
	"Boulders": Color(0.72, 0.71, 0.68),
	"Stump": Color(0.98, 0.6, 0.2),
}
const BACKGROUND := Color(0.08, 0.11, 0.07, 0.85)
const FRAME := Color(0.9, 0.93, 0.85, 0.7)
const PLAYER := Color(1.0, 1.0, 1.0)
## The distance in meters that the player walks before the map runs a new query.
const STEP := 2.0
## The radius of a dot, as a fraction of its layer's radius.
const DOT := 0.42
## The smallest radius of a dot in pixels.
const SMALLEST_DOT := 3.5

## The world to draw.
@export var world: TerrainScatter3D
## The player, shown at the center.
@export var player: Node3D
## The distance from the center to the edges of the map, in meters.
@export_range(10.0, 500.0, 1.0, "suffix:m") var reach := 60.0:
	set(value):
		reach = clampf(value, 10.0, 500.0)
		_is_stale = true

## The number of dots on the map.
var dots := 0

var _is_stale := true
var _center := Vector2.INF
var _instances: ScatterInstances
var _last_revision := []


func _process(_delta: float) -> void:
	if not is_visible_in_tree():
		return
	# Comparing the state itself also detects that the game has loaded another state.
	var revision := [world.state, world.state.get_revision()]
	_is_stale = _is_stale or revision != _last_revision
	_last_revision = revision
	var player_xz := Vector2(player.global_position.x, player.global_position.z)
	if _is_stale or player_xz.distance_to(_center) > STEP:
		_query_instances(player_xz)
	queue_redraw()


func _query_instances(player_xz: Vector2) -> void:
	var mapped_layers := world.layers.filter(func(layer: ScatterLayer) -> bool: return layer != null and COLORS.has(layer.resource_name))
	var half_size := Vector2(reach + STEP, reach + STEP)
	_instances = world.query_rect(Rect2(player_xz - half_size, half_size * 2.0), mapped_layers)
	_center = player_xz
	_is_stale = false


func _draw() -> void:
	draw_rect(Rect2(Vector2.ZERO, size), BACKGROUND)
	var player_xz := Vector2(player.global_position.x, player.global_position.z)
	var pixels_per_meter := size.x * 0.5 / reach
	var visible_rect := Rect2(Vector2.ZERO, size).grow(-2.0)
	var positions := _instances.positions if _instances != null else PackedVector3Array()
	dots = 0
	for i in positions.size():
		var layer := _instances.get_layer(i)
		var dot := size * 0.5 + (Vector2(positions[i].x, positions[i].z) - player_xz) * pixels_per_meter
		if visible_rect.has_point(dot):
			dots += 1
			draw_circle(dot, maxf(layer.radius * DOT * pixels_per_meter, SMALLEST_DOT), COLORS[layer.resource_name])
	var forward := Vector2.UP.rotated(-player.global_rotation.y)
	var side := forward.orthogonal() * 5.0
	draw_colored_polygon([size * 0.5 + forward * 11.0, size * 0.5 + side - forward * 6.0, size * 0.5 - side - forward * 6.0],
			PLAYER)
	draw_rect(Rect2(Vector2.ZERO, size), FRAME, false, 2.0)
