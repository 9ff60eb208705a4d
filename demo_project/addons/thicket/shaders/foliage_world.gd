@tool
class_name ScatterFoliageWorld
extends Node3D
## Updates wind and moving bodies in materials whose shader includes [code]foliage.gdshaderinc[/code].
##
## A scene needs only one of these nodes. The node works in the editor and in exported games, and needs no project setting. In the editor, it does not
## change the materials, so nothing is saved with them. Plants do not move there unless [member animate_in_editor] is true. Bodies have an effect only
## in games. Without the native library, the node still updates [member materials]. For that reason, it uses none of the library's classes as a type.
##
## @tutorial(Your own tree): res://addons/thicket/tutorials/your_own_tree.md

const LibraryGate := preload("res://addons/thicket/library_gate.gd")

## The largest number of bodies that the shader supports.
const MOST_BODIES := 16

## Materials to update in addition to those of scatters. Empty entries are ignored.
@export var materials: Array[ShaderMaterial] = []
## If true, the node also updates the materials of all [TerrainScatter3D]s in the tree: for each layer, those materials in
## [method ScatterLayer.get_materials] whose shader includes [code]foliage.gdshaderinc[/code]. It also updates the materials of [MultiMeshInstance3D]s, such
## as baked ones. The node collects the materials when a scatter or a [MultiMeshInstance3D] is added. It updates the materials of scatters when
## a scatter is removed, or when a layer or a list of layers changes. It notices a changed shader only at these times.
@export var include_scatters := true:
	set(value):
		include_scatters = value
		if is_inside_tree():
			_watch_tree(value)
## The strength of the wind; 0 for no wind.
@export_range(0.0, 2.0) var wind_strength := 1.0
## The direction in which the wind blows, as world x and z. Its length has no effect.
@export var wind_direction := Vector2(1.0, 0.35)
## If true, plants also move in the editor. The editor then redraws continuously, which keeps a processor core and the graphics card busy.
@export var animate_in_editor := false
## The group of the [Node3D]s that bend plants. If there are more than 16, the ones nearest to the camera are used.
@export var bodies_group := &"scatter_interaction"
## The radius of each body in meters.
@export_range(0.0, 10.0) var body_radius := 0.6

var _scatters: Dictionary[Node, Array] = {} ## The layers of each scatter at the time when its materials were collected.
var _layers: Array[Resource] = []
var _scatter_materials: Array[ShaderMaterial] = []
var _is_stale := false
var _editor_parameters: Dictionary[ShaderMaterial, PackedStringArray] = {} ## The names of the parameters that were set on the renderer in the editor.
var _last_parameters := {} ## The values that were last set on the renderer in the editor.
var _last_materials: Array[ShaderMaterial] = [] ## The materials that received _last_parameters.
var _new_multimeshes: Array[MultiMeshInstance3D] = [] ## New nodes whose materials have not been read yet.
var _multimesh_materials: Array[ShaderMaterial] = []
var _time := 0.0


func _enter_tree() -> void:
	_watch_tree(include_scatters)


func _exit_tree() -> void:
	_watch_tree(false)
	for material in _editor_parameters:
		for parameter in _editor_parameters[material]:
			RenderingServer.material_set_param(material.get_rid(), parameter, material.get_shader_parameter(parameter))
	_editor_parameters.clear()
	_last_parameters = {}


func _process(delta: float) -> void:
	for scatter in _scatters:
		_is_stale = _is_stale or LibraryGate.layers_of(scatter) != _scatters[scatter]
	if _is_stale:
		_find_materials()
	for node in _new_multimeshes:
		_add_multimesh(node)
	_new_multimeshes.clear()
	var parameters := {&"wind_strength": wind_strength, &"wind_direction": wind_direction}
	if Engine.is_editor_hint():
		_set_on_renderer(parameters, delta)
		return
	var bodies := _bodies()
	parameters[&"bend_count"] = bodies[0]
	parameters[&"bend_bodies"] = bodies[1]
	_time = fmod(_time + delta, 3600.0)
	for material in _all_materials():
		for parameter: StringName in parameters:
			material.set_shader_parameter(parameter, parameters[parameter])
		if material not in _scatter_materials: # The materials in _scatter_materials get the time from their scatter.
			RenderingServer.material_set_param(material.get_rid(), &"wind_time", _time)


## Sets the parameters on the renderer only. In the editor, a parameter that is set on a material would be saved with it. Has no effect if nothing has
## changed, because the editor would redraw otherwise.
func _set_on_renderer(parameters: Dictionary, delta: float) -> void:
	if animate_in_editor:
		_time = fmod(_time + delta, 3600.0)
		parameters[&"wind_time"] = _time
	var all_materials := _all_materials()
	if parameters == _last_parameters and all_materials == _last_materials:
		return
	_last_parameters = parameters
	_last_materials = all_materials
	for material in all_materials:
		for parameter: StringName in parameters:
			RenderingServer.material_set_param(material.get_rid(), parameter, parameters[parameter])
		_editor_parameters[material] = PackedStringArray(parameters.keys())


func _all_materials() -> Array[ShaderMaterial]:
	var result: Array[ShaderMaterial] = []
	for list: Array[ShaderMaterial] in [materials, _scatter_materials, _multimesh_materials]:
		for material in list:
			if material and material not in result:
				result.append(material)
	return result


## Starts or stops watching for added and removed scatters, including those that are already in the tree.
func _watch_tree(watch: bool) -> void:
	var tree := get_tree()
	if tree.node_added.is_connected(_on_node_added) == watch:
		return
	if watch:
		tree.node_added.connect(_on_node_added)
		tree.node_removed.connect(_on_node_removed)
		for scatter in _root().find_children("*", LibraryGate.SCATTER, true, false):
			_on_node_added(scatter)
		for multimesh in _root().find_children("*", "MultiMeshInstance3D", true, false):
			_on_node_added(multimesh)
		_on_node_added(_root())
	else:
		tree.node_added.disconnect(_on_node_added)
		tree.node_removed.disconnect(_on_node_removed)
		_scatters.clear()
		_new_multimeshes.clear()
		_multimesh_materials.clear()
		_find_materials()


## Returns the topmost node or, in the editor, the topmost node of the edited scene.
func _root() -> Node:
	var node: Node = self
	while node.get_parent() and not (Engine.is_editor_hint() and node.get_parent() is Viewport):
		node = node.get_parent()
	return node


func _on_node_added(node: Node) -> void:
	if LibraryGate.is_scatter(node):
		_scatters[node] = []
		_is_stale = true
	elif node is MultiMeshInstance3D:
		_new_multimeshes.append(node as MultiMeshInstance3D)


func _on_node_removed(node: Node) -> void:
	if _scatters.erase(node):
		_is_stale = true
	elif node is MultiMeshInstance3D:
		_new_multimeshes.erase(node as MultiMeshInstance3D)


func _on_layer_changed() -> void:
	_is_stale = true


func _find_materials() -> void:
	_is_stale = false
	for layer in _layers:
		layer.changed.disconnect(_on_layer_changed)
	_layers.clear()
	_scatter_materials.clear()
	for scatter in _scatters:
		var layers := LibraryGate.layers_of(scatter)
		_scatters[scatter] = layers
		for layer in layers:
			if layer and layer not in _layers:
				_layers.append(layer)
				layer.changed.connect(_on_layer_changed)
				for material in LibraryGate.materials_of(layer):
					_add_material(material, _scatter_materials)


func _add_multimesh(node: MultiMeshInstance3D) -> void:
	var mesh := node.multimesh.mesh if node.multimesh else null
	for surface in (mesh.get_surface_count() if mesh else 0):
		_add_material(node.material_override if node.material_override else mesh.surface_get_material(surface), _multimesh_materials)


func _add_material(material: Material, list: Array[ShaderMaterial]) -> void:
	var shader_material := material as ShaderMaterial
	if shader_material and shader_material not in list and _is_foliage(shader_material.shader):
		list.append(shader_material)


func _is_foliage(shader: Shader) -> bool:
	var names: Array = []
	if shader:
		names = shader.get_shader_uniform_list().map(func(uniform: Dictionary) -> String: return uniform.name)
	return "wind_strength" in names and "bend_bodies" in names


## Returns the number of bodies, and an array of MOST_BODIES positions with radii.
func _bodies() -> Array:
	var positions: Array[Vector3] = []
	for node in get_tree().get_nodes_in_group(bodies_group):
		if node is Node3D:
			positions.append((node as Node3D).global_position)
	var camera := get_viewport().get_camera_3d()
	if positions.size() > MOST_BODIES and camera:
		var camera_position := camera.global_position
		positions.sort_custom(func(a: Vector3, b: Vector3) -> bool:
			return a.distance_squared_to(camera_position) < b.distance_squared_to(camera_position))
	var packed: Array[Vector4] = []
	packed.resize(MOST_BODIES)
	var count := mini(positions.size(), MOST_BODIES)
	for index in count:
		packed[index] = Vector4(positions[index].x, positions[index].y, positions[index].z, body_radius)
	return [count, PackedVector4Array(packed)]
