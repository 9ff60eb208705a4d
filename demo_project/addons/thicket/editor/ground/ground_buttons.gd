@tool
extends HBoxContainer
## Makes the selected nodes the ground of a scatter, and refreshes the ground of a scatter. Visible above the 3D view while a scatter is
## selected, or a node that can be the ground of the current one.

const Controls := preload("res://addons/thicket/editor/editor_controls.gd")

const MESH := &"MeshInstance3D"
const SCATTER := &"TerrainScatter3D"

var undo_redo: EditorUndoRedoManager

var _use := Controls.button("Use as Ground", &"MeshInstance3D", "")
var _refresh := Controls.button("Refresh Ground", &"Reload",
		"Read the ground again, for changes that emit no signal. Nodes that move in the scene are followed automatically.")
var _last: TerrainScatter3D ## The last scatter that was selected.


func _init(manager: EditorUndoRedoManager) -> void:
	undo_redo = manager
	_use.pressed.connect(choose)
	_refresh.pressed.connect(_on_refresh)
	add_child(_use)
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
		_last = scatters[0]
	var scatter := _meant()
	var grounds := _grounds_of(selected)
	visible = scatter != null and not (scatters.is_empty() and grounds.is_empty())
	_refresh.visible = visible and not scatters.is_empty() and scatter.ground != null
	if visible:
		_use.tooltip_text = "Choose a mesh or a static body as the ground of %s." % scatter.name if grounds.is_empty() \
				else "Make the selected %s the ground of %s." % [_names(grounds), scatter.name]


## Makes nodes the ground of a scatter, as one undo step: meshes are added to the group of its ground, the layers of bodies to its collision
## mask. The scatter gets a ground of that kind if it has a different one. Returns the reason if nothing was done, as a sentence; empty on
## success.
static func use(scatter: TerrainScatter3D, nodes: Array[Node], manager: EditorUndoRedoManager) -> String:
	var meshes: Array[Node] = []
	var bodies: Array[StaticBody3D] = []
	for node in nodes:
		if node is StaticBody3D:
			bodies.append(node)
		if not node is StaticBody3D or scatter.ground is ScatterGroundMeshes:
			meshes.append_array(_meshes_of(node))
	if meshes.is_empty() and bodies.is_empty():
		return "%s cannot be ground: select a StaticBody3D, a MeshInstance3D with a mesh, or a node that has meshes below it." % _names(nodes)
	return _use_bodies(scatter, bodies, manager) if meshes.is_empty() else _use_meshes(scatter, meshes, manager)


static func _use_meshes(scatter: TerrainScatter3D, meshes: Array[Node], manager: EditorUndoRedoManager) -> String:
	var ground := scatter.ground as ScatterGroundMeshes
	var group := ground.group if ground != null else &""
	var new_group := group if group else StringName(str(scatter.name).to_snake_case() + "_ground")
	meshes = meshes.filter(func(mesh: Node) -> bool: return not mesh.is_in_group(new_group))
	if meshes.is_empty() and group:
		return "This is already the ground of %s." % scatter.name
	manager.create_action("Use as Ground", UndoRedo.MERGE_DISABLE, scatter)
	var root := EditorInterface.get_edited_scene_root()
	for instance in _closed_instances(meshes):
		manager.add_do_method(root, &"set_editable_instance", instance, true)
		manager.add_undo_method(root, &"set_editable_instance", instance, false)
	for mesh in meshes:
		manager.add_do_method(mesh, &"add_to_group", new_group, true)
		manager.add_undo_method(mesh, &"remove_from_group", new_group)
	if ground == null:
		var made := ScatterGroundMeshes.new()
		made.group = new_group
		_replace_ground(scatter, made, manager)
	elif not group:
		manager.add_do_property(ground, &"group", new_group)
		manager.add_undo_property(ground, &"group", group)
	manager.commit_action()
	return ""


static func _use_bodies(scatter: TerrainScatter3D, bodies: Array[StaticBody3D], manager: EditorUndoRedoManager) -> String:
	var layers := 0
	for body in bodies:
		layers |= body.collision_layer
	if layers == 0:
		return "collision_layer of %s is 0, so no ray can hit it: set at least one layer." % _names(bodies)
	var ground := scatter.ground as ScatterGroundColliders
	var mask := ground.collision_mask if ground != null else 0
	if ground != null and mask | layers == mask:
		return "This is already the ground of %s." % scatter.name
	manager.create_action("Use as Ground", UndoRedo.MERGE_DISABLE, scatter)
	if ground != null:
		manager.add_do_property(ground, &"collision_mask", mask | layers)
		manager.add_undo_property(ground, &"collision_mask", mask)
	else:
		var made := ScatterGroundColliders.new()
		made.collision_mask = layers
		_replace_ground(scatter, made, manager)
	manager.commit_action()
	return ""


static func _replace_ground(scatter: TerrainScatter3D, ground: ScatterGround, manager: EditorUndoRedoManager) -> void:
	manager.add_do_property(scatter, &"ground", ground)
	manager.add_undo_property(scatter, &"ground", scatter.ground)


## The meshes of a node and of all nodes below it, except for those of scatters.
static func _meshes_of(node: Node) -> Array[Node]:
	if node is TerrainScatter3D:
		return []
	var found: Array[Node] = node.find_children("*", MESH, true, false)
	if node is MeshInstance3D:
		found.push_front(node)
	return found.filter(func(mesh: MeshInstance3D) -> bool: return mesh.mesh != null and mesh.owner != null or mesh == node)


## The instanced scenes whose children must become editable, so that the edited scene stores the changes to their nodes.
static func _closed_instances(nodes: Array[Node]) -> Array[Node]:
	var root := EditorInterface.get_edited_scene_root()
	var closed: Array[Node] = []
	for node in nodes:
		var owner := node.owner
		while owner != null and owner != root:
			if not root.is_editable_instance(owner) and not closed.has(owner):
				closed.append(owner)
			owner = owner.owner
	return closed


## Those of these nodes that can be ground.
static func _grounds_of(nodes: Array[Node]) -> Array[Node]:
	return nodes.filter(func(node: Node) -> bool:
			return node is Node3D and not node is TerrainScatter3D and (node is StaticBody3D or not _meshes_of(node).is_empty()))


static func _names(nodes: Array) -> String:
	return str((nodes[0] as Node).name) if nodes.size() == 1 else "%d nodes" % nodes.size()


## The scatter that is selected, was selected last, or is the only one of the scene; null if there are several or none.
func _meant() -> TerrainScatter3D:
	var root := EditorInterface.get_edited_scene_root()
	if root == null:
		return null
	if is_instance_valid(_last) and _last.is_inside_tree() and (_last == root or root.is_ancestor_of(_last)):
		return _last
	var found := root.find_children("*", SCATTER, true, false)
	if root is TerrainScatter3D:
		found.append(root)
	return found[0] if found.size() == 1 else null


## Makes the selected nodes the ground. If none of them can be ground, opens a dialog with the scene's tree.
func choose() -> void:
	var grounds := _grounds_of(EditorInterface.get_selection().get_selected_nodes())
	if grounds.is_empty():
		# Any node, because the meshes of an imported scene or of a group are below one that is neither a mesh nor a body.
		EditorInterface.popup_node_selector(_on_picked, [&"Node3D"])
	else:
		_use_or_tell(grounds)


func _on_picked(path: NodePath) -> void:
	if not path.is_empty():
		_use_or_tell([EditorInterface.get_edited_scene_root().get_node(path)])


func _use_or_tell(nodes: Array[Node]) -> void:
	var scatter := _meant()
	var problem := use(scatter, nodes, undo_redo) if scatter != null else ""
	if not problem.is_empty():
		EditorInterface.get_editor_toaster().push_toast(problem, EditorToaster.SEVERITY_WARNING)
	update()


func _on_refresh() -> void:
	var scatter := _meant()
	if scatter != null:
		scatter.refresh_ground()
