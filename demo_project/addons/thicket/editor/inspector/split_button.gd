@tool
extends Button
## A button that splits a layer's only mesh, a scene with several models side by side, into separate models, as one undo step.

const NewLayers := preload("res://addons/thicket/editor/layers/new_layers.gd")

## The maximum overlap of two models that are considered side by side, as a fraction of the area of the smaller box, seen from above.
const MAX_OVERLAP := 0.1

static var _parts_cache: Dictionary[int, PackedStringArray] = {} ## The parts of scenes, by the instance ID of the scene.

var _layer: ScatterLayer
var _scene: PackedScene
var _parts: PackedStringArray


## Creates a button for a layer. The button is hidden if there is nothing to split.
func _init(layer: ScatterLayer) -> void:
	_layer = layer
	_scene = _scene_of(layer)
	_parts = parts_of(_scene) if _scene != null else PackedStringArray()
	visible = _parts.size() > 1
	text = "Split into %d Models" % _parts.size()
	tooltip_text = "The scene contains several models side by side: %s. Makes each model a mesh of the layer and fits the layer to the models." % ", ".join(_parts)
	pressed.connect(func() -> void: split(_layer, _scene, _parts, EditorInterface.get_editor_undo_redo()))


## Returns the paths of the nodes that are separate models in a scene, or an empty array if the scene is a single model.
static func parts_of(scene: PackedScene) -> PackedStringArray:
	var id := scene.get_instance_id()
	if not _parts_cache.has(id):
		_parts_cache[id] = _find_parts(scene)
	return _parts_cache[id]


static func split(layer: ScatterLayer, scene: PackedScene, parts: PackedStringArray, undo_redo: EditorUndoRedoManager) -> void:
	var models := []
	for path in parts:
		var model := ScatterModel.new()
		model.resource_name = path.get_file().capitalize()
		model.scene_part = path
		model.scene = scene
		models.append(model)
	var template := NewLayers.of_meshes(models)
	if template == null:
		return
	undo_redo.create_action("Split into %d Models" % parts.size(), UndoRedo.MERGE_DISABLE, layer)
	undo_redo.add_do_property(layer, &"meshes", models)
	undo_redo.add_undo_property(layer, &"meshes", layer.meshes)
	NewLayers.add_fit(layer, template, undo_redo)
	undo_redo.commit_action()


static func _scene_of(layer: ScatterLayer) -> PackedScene:
	var model: Variant = layer.meshes[0] if layer.meshes.size() == 1 else null
	if model is ScatterModel:
		return (model as ScatterModel).scene if (model as ScatterModel).scene_part.is_empty() else null
	return model as PackedScene


static func _find_parts(scene: PackedScene) -> PackedStringArray:
	var paths := PackedStringArray()
	var root := scene.instantiate() if scene.can_instantiate() else null
	if root == null:
		return paths
	var parent := root
	var models := _children_with_meshes(root)
	while models.size() == 1 and not models[0] is MeshInstance3D: # The models of a pack are often below one or more parent nodes.
		parent = models[0]
		models = _children_with_meshes(parent)
	var areas: Array[Rect2] = []
	for child in models:
		var area := _area_of(child, root)
		if areas.any(func(other: Rect2) -> bool: return _overlap(area, other)):
			areas.clear()
			break
		areas.append(area)
	if areas.size() > 1 and not parent is MeshInstance3D:
		for child in models:
			paths.append(root.get_path_to(child))
	root.free()
	return paths


static func _children_with_meshes(node: Node) -> Array[Node]:
	return node.get_children().filter(func(child: Node) -> bool:
		return child is Node3D and (child as Node3D).visible and not _meshes_in(child).is_empty())


static func _meshes_in(node: Node) -> Array[Node]:
	var meshes := node.find_children("*", "MeshInstance3D", true, false)
	if node is MeshInstance3D:
		meshes.append(node)
	return meshes.filter(func(mesh: MeshInstance3D) -> bool: return mesh.mesh != null)


## Returns the bounding box of a node's meshes in the scene, as seen from above.
static func _area_of(node: Node, root: Node) -> Rect2:
	var box := AABB()
	for mesh: MeshInstance3D in _meshes_in(node):
		var to_scene := Transform3D()
		var ancestor: Node = mesh
		while ancestor != root:
			to_scene = (ancestor as Node3D).transform * to_scene if ancestor is Node3D else to_scene
			ancestor = ancestor.get_parent()
		var mesh_box := to_scene * mesh.mesh.get_aabb()
		box = mesh_box if box == AABB() else box.merge(mesh_box)
	return Rect2(box.position.x, box.position.z, box.size.x, box.size.z)


static func _overlap(a: Rect2, b: Rect2) -> bool:
	return a.intersection(b).get_area() > MAX_OVERLAP * minf(a.get_area(), b.get_area())
