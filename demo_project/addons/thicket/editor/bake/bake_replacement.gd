@tool
extends RefCounted
## Replaces the instances of a scatter in a baked rectangle with the baked scene, as one undo step.

const HandEdits := preload("res://addons/thicket/editor/hand/hand_edits.gd")
const SceneFiles := preload("res://addons/thicket/editor/scene_files.gd")
const RegionMenu := preload("res://addons/thicket/editor/regions/region_menu.gd")


## Adds the scene at [param scene_path] as a child of the scatter, and a region that excludes the baked layers from [param rect]. Removes hand-placed
## instances of these layers there, so that nothing is placed twice. This affects other layers, too: a layer that keeps a distance from a baked layer
## no longer keeps it from the baked instances. Returns an empty string on success, or the reason for the failure.
static func replace(edits: HandEdits, scatter: TerrainScatter3D, scene_path: String, rect: Rect2, layers: Array[ScatterLayer]) -> String:
	var packed := ResourceLoader.load(scene_path, "PackedScene", ResourceLoader.CACHE_MODE_REPLACE) as PackedScene
	if packed == null:
		return "%s cannot be loaded, so the scatter was not replaced. See the Output panel for details." % scene_path
	var hand_placed_ids := _hand_placed_ids(scatter, rect, layers)
	if not hand_placed_ids.is_empty() and not edits.begin(scatter, SceneFiles.edited_scene_path()):
		return edits.problem
	for id in hand_placed_ids:
		edits.remove(id)
	var undo := edits.undo_redo
	undo.create_action("Replace with %s" % scene_path.get_file(), UndoRedo.MERGE_DISABLE, scatter)
	edits.add_to_action()
	var baked: Node3D = packed.instantiate(PackedScene.GEN_EDIT_STATE_INSTANCE)
	baked.transform = scatter.global_transform.affine_inverse()
	RegionMenu.add_as_child(undo, scatter, baked)
	var region := RegionMenu.make(ScatterRegion3D.SHAPE_POLYGON, true)
	region.name = "Baked%s" % baked.name
	var half := rect.size * 0.5
	region.polygon = PackedVector2Array([-half, Vector2(half.x, -half.y), half, Vector2(-half.x, half.y)])
	region.layers = _references(scatter, layers)
	var middle := rect.get_center()
	region.transform = scatter.global_transform.affine_inverse() * Transform3D(Basis.IDENTITY, Vector3(middle.x, 0.0, middle.y))
	RegionMenu.add_as_child(undo, scatter, region)
	undo.commit_action()
	return ""


## Returns references to layers for [member ScatterRegion3D.layers], or an empty array if all layers were chosen.
static func _references(scatter: TerrainScatter3D, selected_layers: Array[ScatterLayer]) -> Array:
	var layers := scatter.layers
	var references: Array = []
	for layer in selected_layers:
		var name := layer.resource_name
		var same_name := layers.filter(func(other: ScatterLayer) -> bool: return other != null and other.resource_name == name)
		if name.is_empty() or same_name.size() == 1:
			references.append(layer)
		else:
			references.append(layers.find(layer)) # By name, the region would refer to the first of several layers with this name.
	return references if selected_layers.size() < layers.size() - layers.count(null) else []


## Returns the IDs of the hand-placed instances of some layers in a rectangle.
static func _hand_placed_ids(scatter: TerrainScatter3D, rect: Rect2, layers: Array[ScatterLayer]) -> PackedInt64Array:
	var ids := PackedInt64Array()
	var state := scatter.state
	if state != null:
		for id in state.get_added():
			var instance := scatter.get_instance(id)
			if instance != null and layers.has(instance.layer) and rect.has_point(Vector2(instance.position.x, instance.position.z)):
				ids.append(id)
	return ids
