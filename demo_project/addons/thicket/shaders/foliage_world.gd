@tool
class_name FoliageWorld
extends Node3D
## Hands wind and moving bodies to materials whose shader includes [code]foliage.gdshaderinc[/code].
##
## One node in a scene is enough. It works in the editor and in exported games, and asks for no project setting.

## As many bodies as the shader takes.
const MOST_BODIES := 16

## The materials that get the wind and the bodies. Others, and empty entries, are left alone.
@export var materials: Array[ShaderMaterial] = []
## How strong the wind is, 0 for none.
@export_range(0.0, 2.0) var wind_strength := 1.0
## Where the wind blows to: x and z of the world. Its length does not matter.
@export var wind_direction := Vector2(1.0, 0.35)
## The group of the [Node3D]s that bend plants. Of more than 16, those nearest to the camera count.
@export var bodies_group := &"scatter_interaction"
## The radius of each body in meters.
@export_range(0.0, 10.0) var body_radius := 0.6


func _process(_delta: float) -> void:
	# What is set in the editor would be saved with the materials: bodies are a game's.
	var bodies := [0, PackedVector4Array()] if Engine.is_editor_hint() else _bodies()
	for material in materials:
		if material == null:
			continue
		material.set_shader_parameter(&"wind_strength", wind_strength)
		material.set_shader_parameter(&"wind_direction", wind_direction)
		material.set_shader_parameter(&"bend_count", bodies[0])
		material.set_shader_parameter(&"bend_bodies", bodies[1])


## How many bodies there are, and their places and radii.
func _bodies() -> Array:
	var places: Array[Vector3] = []
	for node in get_tree().get_nodes_in_group(bodies_group):
		if node is Node3D:
			places.append((node as Node3D).global_position)
	var camera := get_viewport().get_camera_3d()
	if places.size() > MOST_BODIES and camera:
		var eye := camera.global_position
		places.sort_custom(func(a: Vector3, b: Vector3) -> bool:
			return a.distance_squared_to(eye) < b.distance_squared_to(eye))
	var told: Array[Vector4] = []
	told.resize(MOST_BODIES)
	var count := mini(places.size(), MOST_BODIES)
	for index in count:
		told[index] = Vector4(places[index].x, places[index].y, places[index].z, body_radius)
	return [count, PackedVector4Array(told)]
