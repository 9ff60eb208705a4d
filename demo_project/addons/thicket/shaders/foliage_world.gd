@tool
class_name ScatterFoliageWorld
extends Node3D
## Hands wind and moving bodies to materials whose shader includes [code]foliage.gdshaderinc[/code].
##
## One node in a scene is enough. It works in the editor and in exported games, and asks for no project setting. In the
## editor it shows the wind and leaves the materials as they are, so that nothing is saved with them; bodies are a game's.
## Without the native library it still serves [member materials]. So it names none of the library's classes as a type.
##
## @tutorial(Your own tree): res://addons/thicket/tutorials/your_own_tree.md

const LibraryGate := preload("res://addons/thicket/library_gate.gd")

## As many bodies as the shader takes.
const MOST_BODIES := 16

## Materials that get the wind and the bodies, besides those of scatters. Empty entries are left alone.
@export var materials: Array[ShaderMaterial] = []
## Whether the materials of all [TerrainScatter3D]s in the tree get them as well: [method ScatterLayer.get_materials] of
## each layer, as far as their shader includes [code]foliage.gdshaderinc[/code]. They are looked up anew when such a node
## comes or goes, or its list of layers or a layer changes; a material that gets another shader counts from then on.
@export var include_scatters := true:
	set(value):
		include_scatters = value
		if is_inside_tree():
			_watch_tree(value)
## How strong the wind is, 0 for none.
@export_range(0.0, 2.0) var wind_strength := 1.0
## Where the wind blows to: x and z of the world. Its length does not matter.
@export var wind_direction := Vector2(1.0, 0.35)
## The group of the [Node3D]s that bend plants. Of more than 16, those nearest to the camera count.
@export var bodies_group := &"scatter_interaction"
## The radius of each body in meters.
@export_range(0.0, 10.0) var body_radius := 0.6

var _scatters: Dictionary[Node, Array] = {} ## The layers of each when its materials were looked up.
var _layers: Array[Resource] = []
var _found: Array[ShaderMaterial] = []
var _is_stale := false
var _shown: Dictionary[ShaderMaterial, PackedStringArray] = {} ## What the renderer was told in the editor.


func _enter_tree() -> void:
	_watch_tree(include_scatters)


func _exit_tree() -> void:
	_watch_tree(false)
	for material in _shown:
		for parameter in _shown[material]:
			RenderingServer.material_set_param(material.get_rid(), parameter, material.get_shader_parameter(parameter))
	_shown.clear()


func _process(_delta: float) -> void:
	for scatter in _scatters:
		_is_stale = _is_stale or LibraryGate.layers_of(scatter) != _scatters[scatter]
	if _is_stale:
		_find_materials()
	var parameters := {&"wind_strength": wind_strength, &"wind_direction": wind_direction}
	if not Engine.is_editor_hint():
		var bodies := _bodies()
		parameters[&"bend_count"] = bodies[0]
		parameters[&"bend_bodies"] = bodies[1]
	for list: Array[ShaderMaterial] in [materials, _found]:
		for material in list:
			if material:
				_tell(material, parameters)


## What is set in the editor would be saved with the material, so only the renderer gets it there.
func _tell(material: ShaderMaterial, parameters: Dictionary) -> void:
	for parameter: StringName in parameters:
		if Engine.is_editor_hint():
			RenderingServer.material_set_param(material.get_rid(), parameter, parameters[parameter])
		else:
			material.set_shader_parameter(parameter, parameters[parameter])
	if Engine.is_editor_hint():
		_shown[material] = PackedStringArray(parameters.keys())


## Hears of scatters that come and go, beginning with those that are there; or forgets all of them.
func _watch_tree(watch: bool) -> void:
	var tree := get_tree()
	if tree.node_added.is_connected(_on_node_added) == watch:
		return
	if watch:
		tree.node_added.connect(_on_node_added)
		tree.node_removed.connect(_on_node_removed)
		for scatter in _top().find_children("*", LibraryGate.SCATTER, true, false):
			_on_node_added(scatter)
		_on_node_added(_top())
	else:
		tree.node_added.disconnect(_on_node_added)
		tree.node_removed.disconnect(_on_node_removed)
		_scatters.clear()
		_find_materials()


## The node above all others, in the editor that of the scene.
func _top() -> Node:
	var top: Node = self
	while top.get_parent() and not (Engine.is_editor_hint() and top.get_parent() is Viewport):
		top = top.get_parent()
	return top


func _on_node_added(node: Node) -> void:
	if LibraryGate.is_scatter(node):
		_scatters[node] = []
		_is_stale = true


func _on_node_removed(node: Node) -> void:
	if _scatters.erase(node):
		_is_stale = true


func _on_layer_changed() -> void:
	_is_stale = true


func _find_materials() -> void:
	_is_stale = false
	for layer in _layers:
		layer.changed.disconnect(_on_layer_changed)
	_layers.clear()
	_found.clear()
	for scatter in _scatters:
		var of_scatter := LibraryGate.layers_of(scatter)
		_scatters[scatter] = of_scatter
		for layer in of_scatter:
			if layer and layer not in _layers:
				_layers.append(layer)
				layer.changed.connect(_on_layer_changed)
				_add_materials(layer)


func _add_materials(layer: Resource) -> void:
	for material in LibraryGate.materials_of(layer):
		var with_shader := material as ShaderMaterial
		if with_shader and with_shader not in _found and _is_foliage(with_shader.shader):
			_found.append(with_shader)


func _is_foliage(shader: Shader) -> bool:
	var names: Array = []
	if shader:
		names = shader.get_shader_uniform_list().map(func(uniform: Dictionary) -> String: return uniform.name)
	return "wind_strength" in names and "bend_bodies" in names


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
