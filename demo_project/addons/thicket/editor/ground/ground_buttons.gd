@tool
extends HBoxContainer
## Buttons that make the selected nodes the ground of a scatter or add them to it, and that refresh its ground. They are visible above the 3D view while a
## scatter is selected, or a node that can be the ground of the current scatter.

const Controls := preload("res://addons/thicket/editor/editor_controls.gd")

const MESH_CLASSES: Array[StringName] = [&"MeshInstance3D", &"GridMap", &"CSGShape3D"]
const SCATTER := &"TerrainScatter3D"

var undo_redo: EditorUndoRedoManager

var _use := Controls.button("Use as Ground", &"MeshInstance3D", "")
var _add := Controls.button("Add to Ground", &"Add", "")
var _refresh := Controls.button("Refresh Ground", &"Reload",
		"Read the ground again after changes that emit no signal. Nodes that move in the scene are detected automatically.")
var _last_scatter: TerrainScatter3D ## The last scatter that was selected.


func _init(manager: EditorUndoRedoManager) -> void:
	undo_redo = manager
	_use.pressed.connect(choose)
	_add.pressed.connect(choose.bind(true))
	_refresh.pressed.connect(_on_refresh)
	add_child(_use)
	add_child(_add)
	add_child(_refresh)
	EditorInterface.get_selection().selection_changed.connect(update)
	update()


func _notification(what: int) -> void:
	if what == NOTIFICATION_THEME_CHANGED:
		Controls.update_icons(self)


## Shows the buttons that apply to the selection.
func update() -> void:
	var selected := EditorInterface.get_selection().get_selected_nodes()
	var scatters := selected.filter(func(node: Node) -> bool: return node is TerrainScatter3D)
	if not scatters.is_empty():
		_last_scatter = scatters[0]
	var scatter := _current_scatter()
	var ground_nodes := _grounds_of(selected)
	visible = scatter != null and not (scatters.is_empty() and ground_nodes.is_empty())
	_refresh.visible = visible and not scatters.is_empty() and scatter.ground != null
	_add.visible = visible and _replaces(scatter, ground_nodes)
	if visible:
		var addition := "." if not _add.visible else ", in addition to its current ground. The highest ground is used."
		_use.tooltip_text = "Choose a mesh, a static body or a terrain as the ground of %s." % scatter.name if ground_nodes.is_empty() \
				else "Make the selected %s the ground of %s." % [_names(ground_nodes), scatter.name]
		_add.tooltip_text = _use.tooltip_text.trim_suffix(".") + addition


## Makes nodes the ground of a scatter, as one undo step. Meshes are added to the group of its ground, and the layers of
## bodies to the ground's collision mask. Ground of another kind is replaced, or combined with the new ground if [param
## is_addition] is [code]true[/code]. Returns an empty string on success, or the reason why nothing was changed.
static func use(scatter: TerrainScatter3D, nodes: Array[Node], manager: EditorUndoRedoManager, is_addition := false) -> String:
	var current_grounds := _parts(scatter, is_addition)
	var terrains := nodes.filter(_is_terrain)
	if not terrains.is_empty():
		return _use_terrain(scatter, terrains, current_grounds, manager, is_addition)
	var meshes := _meshes_to_use(nodes, current_grounds)
	var bodies := nodes.filter(_has_bodies)
	if meshes.is_empty() and bodies.is_empty():
		return ("%s cannot be ground: select a StaticBody3D, a MeshInstance3D with a mesh, a GridMap, a CSG node, a terrain of a plugin, or a node " \
				+ "whose descendants include meshes.") % _names(nodes)
	return _use_bodies(scatter, bodies, current_grounds, manager, is_addition) if meshes.is_empty() else _use_meshes(scatter, meshes, current_grounds, manager, is_addition)


## Returns whether [method use] would replace the ground of a scatter. Without nodes, returns whether it has a ground.
static func _replaces(scatter: TerrainScatter3D, nodes: Array[Node]) -> bool:
	var grounds := _parts(scatter, false)
	if nodes.any(_is_terrain):
		return not grounds.is_empty()
	var extendable := _first(grounds, ScatterGroundColliders if _meshes_to_use(nodes, grounds).is_empty() else ScatterGroundMeshes)
	return not grounds.is_empty() and (nodes.is_empty() or extendable == null)


## Returns the ground of a scatter in an array, or the grounds that it combines if [param combined] is [code]true[/code].
static func _parts(scatter: TerrainScatter3D, combined: bool) -> Array[ScatterGround]:
	var grounds: Array[ScatterGround] = [scatter.ground]
	if combined and scatter.ground is ScatterGroundCombined:
		grounds = (scatter.ground as ScatterGroundCombined).grounds
	return grounds.filter(func(ground: ScatterGround) -> bool: return ground != null)


## Returns the first ground of a class; null if there is none.
static func _first(grounds: Array[ScatterGround], of_class: Variant) -> ScatterGround:
	for ground in grounds:
		if is_instance_of(ground, of_class):
			return ground
	return null


## Returns the meshes that become ground. A static body is treated as a collider unless meshes are already ground.
static func _meshes_to_use(nodes: Array[Node], grounds: Array[ScatterGround]) -> Array[Node]:
	var meshes: Array[Node] = []
	for node in nodes:
		if not (_has_bodies(node) or _is_terrain(node)) or node is StaticBody3D and _first(grounds, ScatterGroundMeshes) != null:
			meshes.append_array(_meshes_of(node))
	return meshes


static func _use_meshes(
		scatter: TerrainScatter3D, meshes: Array[Node], grounds: Array[ScatterGround], manager: EditorUndoRedoManager, is_addition: bool) -> String:
	var ground := _first(grounds, ScatterGroundMeshes) as ScatterGroundMeshes
	var group := ground.group if ground != null else &""
	var new_group := group if group else StringName(str(scatter.name).to_snake_case() + "_ground")
	meshes = meshes.filter(func(mesh: Node) -> bool: return not mesh.is_in_group(new_group))
	if meshes.is_empty() and group:
		return "This is already the ground of %s." % scatter.name
	manager.create_action("Use as Ground", UndoRedo.MERGE_DISABLE, scatter)
	var root := EditorInterface.get_edited_scene_root()
	for instance in _instances_to_open(meshes):
		manager.add_do_method(root, &"set_editable_instance", instance, true)
		manager.add_undo_method(root, &"set_editable_instance", instance, false)
	for mesh in meshes:
		manager.add_do_method(mesh, &"add_to_group", new_group, true)
		manager.add_undo_method(mesh, &"remove_from_group", new_group)
	if ground == null:
		var new_ground := ScatterGroundMeshes.new()
		new_ground.group = new_group
		_set_ground(scatter, new_ground, manager, is_addition)
	elif not group:
		manager.add_do_property(ground, &"group", new_group)
		manager.add_undo_property(ground, &"group", group)
	manager.commit_action()
	return ""


static func _use_bodies(
		scatter: TerrainScatter3D, bodies: Array[Node], grounds: Array[ScatterGround], manager: EditorUndoRedoManager, is_addition: bool) -> String:
	var layers := 0
	for body in bodies:
		if _is_voxels(body) and body.get(&"generate_collisions") == false:
			return "%s has no bodies that rays could hit: set its property generate_collisions." % body.name
		var layer: int = body.get(&"collision_layer")
		layers |= layer
	if layers == 0:
		return "collision_layer of %s is 0, so no ray can hit it: set at least one layer." % _names(bodies)
	var ground := _first(grounds, ScatterGroundColliders) as ScatterGroundColliders
	var mask := ground.collision_mask if ground != null else 0
	if ground != null and mask | layers == mask:
		return "This is already the ground of %s." % scatter.name
	manager.create_action("Use as Ground", UndoRedo.MERGE_DISABLE, scatter)
	if ground != null:
		manager.add_do_property(ground, &"collision_mask", mask | layers)
		manager.add_undo_property(ground, &"collision_mask", mask)
	else:
		var new_ground := ScatterGroundColliders.new()
		new_ground.collision_mask = layers
		_set_ground(scatter, new_ground, manager, is_addition)
	manager.commit_action()
	return ""


static func _use_terrain(
		scatter: TerrainScatter3D, terrains: Array[Node], grounds: Array[ScatterGround], manager: EditorUndoRedoManager, is_addition: bool) -> String:
	if terrains.size() > 1:
		return "Several terrains are selected: select one of them, and add the others with Add to Ground."
	for ground in grounds:
		var node_ground := ground as ScatterGroundNode
		if node_ground != null and scatter.get_node_or_null(node_ground.node) == terrains[0]:
			return "This is already the ground of %s." % scatter.name
	manager.create_action("Use as Ground", UndoRedo.MERGE_DISABLE, scatter)
	var new_ground := ScatterGroundNode.new()
	new_ground.node = scatter.get_path_to(terrains[0])
	_set_ground(scatter, new_ground, manager, is_addition)
	manager.commit_action()
	return ""


## Replaces the ground of a scatter, or combines it with another one.
static func _set_ground(scatter: TerrainScatter3D, ground: ScatterGround, manager: EditorUndoRedoManager, is_addition: bool) -> void:
	var combined := scatter.ground as ScatterGroundCombined
	if is_addition and combined != null:
		var grounds := combined.grounds.duplicate()
		manager.add_undo_property(combined, &"grounds", grounds)
		manager.add_do_property(combined, &"grounds", grounds + ([ground] as Array[ScatterGround]))
		return
	if is_addition and scatter.ground != null:
		combined = ScatterGroundCombined.new()
		combined.grounds = [scatter.ground, ground]
	manager.add_do_property(scatter, &"ground", combined if combined != null and is_addition else ground)
	manager.add_undo_property(scatter, &"ground", scatter.ground)


## Returns whether a ScatterGroundNode can use a node: Terrain3D, HTerrain, MTerrain, TerraBrush, or any node with the
## methods of one of them. A get_height() without an argument is not sufficient, because it is the getter of a property,
## as in a CSGCylinder3D.
static func _is_terrain(node: Node) -> bool:
	var data: Variant = node.get(&"data")
	return _has_height(node) or data is Object and _has_height(data) or node.has_method(&"getHeightAtPosition") \
			or node.has_method(&"get_internal_transform") and node.has_method(&"get_data")


static func _has_height(object: Object) -> bool:
	return object.has_method(&"get_height") and object.get_method_argument_count(&"get_height") == 1


## Returns whether a node is a terrain of godot_voxel. The terrain's blocks have bodies, but no nodes.
static func _is_voxels(node: Node) -> bool:
	return node.has_method(&"get_voxel_tool") and node.has_method(&"is_area_meshed")


static func _has_bodies(node: Node) -> bool:
	return node is StaticBody3D or _is_voxels(node)


## Returns the nodes with meshes among a node and those of its descendants that a scene stores. A scatter has none.
static func _meshes_of(node: Node) -> Array[Node]:
	if node is TerrainScatter3D:
		return []
	var nodes: Array[Node] = [node]
	for mesh_class in MESH_CLASSES:
		nodes.append_array(node.find_children("*", mesh_class, true, false))
	return nodes.filter(func(mesh: Node) -> bool: return _has_mesh(mesh) and (mesh.owner != null or mesh == node))


## Returns whether a node in the group of a ScatterGroundMeshes is ground. In a CSG tree, only the outermost node is ground.
static func _has_mesh(node: Node) -> bool:
	var instance := node as MeshInstance3D
	var csg := node as CSGShape3D
	return instance != null and instance.mesh != null or csg != null and csg.is_root_shape() or node is GridMap


## Returns the instanced scenes whose children must become editable, so that the edited scene stores the changes to their nodes.
static func _instances_to_open(nodes: Array[Node]) -> Array[Node]:
	var root := EditorInterface.get_edited_scene_root()
	var instances: Array[Node] = []
	for node in nodes:
		var owner := node.owner
		while owner != null and owner != root:
			if not root.is_editable_instance(owner) and not instances.has(owner):
				instances.append(owner)
			owner = owner.owner
	return instances


## Returns those of the given nodes that can be ground.
static func _grounds_of(nodes: Array[Node]) -> Array[Node]:
	return nodes.filter(func(node: Node) -> bool:
			return node is Node3D and not node is TerrainScatter3D and (_has_bodies(node) or _is_terrain(node) or not _meshes_of(node).is_empty()))


static func _names(nodes: Array) -> String:
	return str((nodes[0] as Node).name) if nodes.size() == 1 else "%d nodes" % nodes.size()


## Returns the scatter that is selected or was selected last. If there is none, returns the only scatter in the scene, or null if the scene has none
## or several.
func _current_scatter() -> TerrainScatter3D:
	var root := EditorInterface.get_edited_scene_root()
	if root == null:
		return null
	if is_instance_valid(_last_scatter) and _last_scatter.is_inside_tree() and (_last_scatter == root or root.is_ancestor_of(_last_scatter)):
		return _last_scatter
	var scatters := root.find_children("*", SCATTER, true, false)
	if root is TerrainScatter3D:
		scatters.append(root)
	return scatters[0] if scatters.size() == 1 else null


## Makes the selected nodes the ground, or adds them to the current ground. If none of them can be ground, opens a
## dialog with the scene tree.
func choose(is_addition := false) -> void:
	var nodes := _grounds_of(EditorInterface.get_selection().get_selected_nodes())
	if nodes.is_empty():
		# Offers every Node3D, because the meshes of an imported scene are below a node that is neither a mesh nor a body.
		EditorInterface.popup_node_selector(_on_picked.bind(is_addition), [&"Node3D"])
	else:
		_use_nodes(nodes, is_addition)


func _on_picked(path: NodePath, is_addition: bool) -> void:
	if not path.is_empty():
		_use_nodes([EditorInterface.get_edited_scene_root().get_node(path)], is_addition)


func _use_nodes(nodes: Array[Node], is_addition: bool) -> void:
	var scatter := _current_scatter()
	var problem := use(scatter, nodes, undo_redo, is_addition) if scatter != null else ""
	if not problem.is_empty():
		EditorInterface.get_editor_toaster().push_toast(problem, EditorToaster.SEVERITY_WARNING)
	update()


func _on_refresh() -> void:
	var scatter := _current_scatter()
	if scatter != null:
		scatter.refresh_ground()
