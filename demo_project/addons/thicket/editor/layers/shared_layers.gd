@tool
extends RefCounted
## Finds resources that a scatter shares by accident with other scatters, and makes them unique. A duplicated or pasted
## scatter shares its layers, masks, state and seed with the original. Layers that were saved as files are shared on
## purpose.

const Copies := preload("res://addons/thicket/editor/layers/layer_copies.gd")
const SceneFiles := preload("res://addons/thicket/editor/scene_files.gd")

## The resources that a scatter shares.
class Shared:
	## Layers without their own files that also belong to another scatter.
	var layers: Array[ScatterLayer] = []
	## Layers with their own files that also belong to another scatter of an open scene.
	var files: Array[ScatterLayer] = []
	## The files of masks that another scatter or scene also uses.
	var masks := PackedStringArray()
	## True if another scatter uses the same state.
	var state := false
	## True if that state contains a designer's changes, not a game's changes.
	var has_hand_edits := false
	## True if the seed is the same, so that the same layers have the same instances.
	var seed := false
	## The names of the scatters and scenes with which resources are shared.
	var others := PackedStringArray()

	## Returns true if the user probably did not intend to share the resources.
	func is_by_accident() -> bool:
		return not layers.is_empty() or not masks.is_empty() or has_hand_edits

	## Returns a message that describes the sharing.
	func describe(name: String) -> String:
		var parts := PackedStringArray()
		if not layers.is_empty():
			parts.append("its layers")
		if not masks.is_empty():
			parts.append("its painted masks")
		if state:
			parts.append("its state")
		if seed:
			parts.append("its seed")
		var resources := " and ".join(PackedStringArray([", ".join(parts.slice(0, -1)), parts[-1]])) if parts.size() > 1 else parts[0]
		var effect := ": both show the same instances" if seed and not layers.is_empty() else ""
		return "%s shares %s with %s%s." % [name, resources, ", ".join(others), effect]


## Finds the resources that a scatter shares with other scatters in the open scenes and with scenes whose masks or states it uses.
static func find(scatter: TerrainScatter3D) -> Shared:
	var result := Shared.new()
	var own_layers: Array[ScatterLayer] = scatter.layers.filter(func(layer: ScatterLayer) -> bool: return layer != null)
	var state := scatter.state
	var scenes := PackedStringArray()
	for other in open_scatters():
		if other == scatter:
			continue
		var old_count := result.layers.size() + result.masks.size()
		for layer in other.layers:
			if layer == null:
				continue
			if layer in own_layers:
				(result.files if Copies.is_file(layer) else result.layers).append(layer)
			for own_layer in own_layers:
				var mask := own_layer.mask
				if mask != null and mask == layer.mask and own_layer != layer and not result.masks.has(mask.resource_path):
					result.masks.append(mask.resource_path)
		var same_state := state != null and other.state == state
		if result.layers.size() + result.masks.size() > old_count or same_state and state.copy_at_runtime:
			var other_path := _scene_of(other)
			scenes.append(other_path.get_basename())
			result.others.append(other.name if other_path == _scene_of(scatter) else StringName("%s of %s" % [other.name, other_path.get_file()]))
			result.seed = result.seed or other.seed == scatter.seed
			result.state = result.state or same_state
			result.has_hand_edits = result.has_hand_edits or same_state and state.copy_at_runtime
	_find_files_of_other_scenes(scatter, own_layers, scenes, result)
	return result


## Returns all scatters of the scenes that are open in the editor. Before Godot 4.5, returns only those of the edited scene.
static func open_scatters() -> Array[TerrainScatter3D]:
	var roots: Array = [EditorInterface.get_edited_scene_root()]
	if EditorInterface.has_method(&"get_open_scene_roots"):
		roots = EditorInterface.call(&"get_open_scene_roots")
	var result: Array[TerrainScatter3D] = []
	for root: Node in roots.filter(is_instance_valid):
		result.append_array(scatters_of(root))
	return result


static func scatters_of(root: Node) -> Array[TerrainScatter3D]:
	var result: Array[TerrainScatter3D] = []
	for node: Node in [root] + root.find_children("*", "TerrainScatter3D", true, false):
		if node is TerrainScatter3D:
			result.append(node as TerrainScatter3D)
	return result


## Creates separate layers, masks and a separate state for a scatter, as one undo step. Sets an unused seed if [param
## new_seed] is true. Layers with their own files are copied only if [param with_files] is true. Returns an empty string
## on success, or the reason for a failure.
static func make_unique(scatter: TerrainScatter3D, new_seed: bool, with_files: bool, files: SceneFiles, scene_path: String,
		undo_redo: EditorUndoRedoManager) -> String:
	var old_layers := scatter.layers
	var new_layers: Array[ScatterLayer] = old_layers.duplicate()
	var copies: Dictionary[Resource, Resource] = {}
	var masks: Dictionary[Resource, Resource] = {}
	for layer in old_layers: # Copies these layers first. Otherwise references from other layers would copy them.
		if layer != null and Copies.is_file(layer) and not with_files:
			copies[layer] = layer
	for index in old_layers.size():
		if old_layers[index] == null:
			continue
		new_layers[index] = Copies.of(old_layers[index], copies, false)
		if new_layers[index] != old_layers[index] and not files.copy_mask(new_layers[index], scene_path, masks):
			return files.problem
	var states: Array[ScatterState] = []
	if not _copy_state(scatter, new_seed, files, scene_path, states):
		return files.problem
	undo_redo.create_action("Make %s Unique" % scatter.name, UndoRedo.MERGE_DISABLE, scatter)
	if states[0] != scatter.state: # A state is valid for one seed only, so the scatter has no state while the seed changes.
		undo_redo.add_do_property(scatter, &"state", null)
		undo_redo.add_undo_property(scatter, &"state", null)
	undo_redo.add_do_property(scatter, &"layers", new_layers)
	undo_redo.add_undo_property(scatter, &"layers", old_layers)
	if new_seed:
		undo_redo.add_do_property(scatter, &"seed", free_seed(scatter))
		undo_redo.add_undo_property(scatter, &"seed", scatter.seed)
	# A state is checked against the last seed that the scatter has processed. The query makes the scatter process the new seed.
	undo_redo.add_do_method(scatter, &"query_rect", Rect2(0.0, 0.0, 0.01, 0.01))
	undo_redo.add_undo_method(scatter, &"query_rect", Rect2(0.0, 0.0, 0.01, 0.01))
	undo_redo.add_do_property(scatter, &"state", states[0])
	undo_redo.add_undo_property(scatter, &"state", scatter.state)
	for region: ScatterRegion3D in scatter.find_children("*", "ScatterRegion3D", true, false):
		var references := region.layers
		var new_references := references.map(func(layer: Variant) -> Variant: return copies.get(layer, layer) if layer is Resource else layer)
		if new_references != references:
			undo_redo.add_do_property(region, &"layers", new_references)
			undo_redo.add_undo_property(region, &"layers", references)
	var new_resources := masks.values()
	if states[0] != scatter.state and states[0] != null and Copies.is_file(states[0]):
		new_resources.append(states[0])
	files.add_to_undo(new_resources, scene_path, undo_redo)
	undo_redo.commit_action()
	return ""


## Returns the smallest seed, from 0 on, that no scatter of the open scenes has.
static func free_seed(scatter: TerrainScatter3D) -> int:
	var used_seeds := open_scatters().map(func(other: TerrainScatter3D) -> int: return other.seed)
	if scatter != null:
		used_seeds.append(scatter.seed)
	var result := 0
	while result in used_seeds:
		result += 1
	return result


## Copies a state with a designer's changes, into its own file if the original has a file. A state that a game writes is not copied,
## because many nodes may share it. If [param new_seed] is true, the removed instances no longer exist, so only hand-placed instances
## are kept. Returns false on failure, with the reason in [code]files.problem[/code].
static func _copy_state(scatter: TerrainScatter3D, new_seed: bool, files: SceneFiles, scene_path: String,
		r_copies: Array[ScatterState]) -> bool:
	var state := scatter.state
	if state == null or (Copies.is_file(state) and not state.copy_at_runtime):
		r_copies.append(null if new_seed else state)
		return true
	var copy := state.duplicate() as ScatterState
	if new_seed:
		for id in state.get_removed():
			copy.restore(id)
	r_copies.append(copy)
	return not Copies.is_file(state) or files.create(scene_path, copy, scatter.name, "state")


## Finds masks and states whose files belong to another scene.
static func _find_files_of_other_scenes(scatter: TerrainScatter3D, own_layers: Array[ScatterLayer], scenes: PackedStringArray,
		r_shared: Shared) -> void:
	for layer in own_layers:
		var mask := layer.mask
		if mask == null or Copies.is_file(layer) or r_shared.masks.has(mask.resource_path):
			continue
		var stem := _other_scene_of(mask, scatter)
		if not stem.is_empty():
			r_shared.masks.append(mask.resource_path)
			_add_scene(stem, scenes, r_shared)
	var state := scatter.state
	var other_scene := _other_scene_of(state, scatter) if state != null and state.copy_at_runtime else ""
	if not other_scene.is_empty():
		r_shared.state = true
		r_shared.has_hand_edits = true
		_add_scene(other_scene, scenes, r_shared)


## Returns the path, without its extension, of the scene for which a file was created, or an empty string if it is the scene of the scatter or if
## there is none.
## Files without this information are named after their scene.
static func _other_scene_of(resource: Resource, scatter: TerrainScatter3D) -> String:
	var stem := resource.resource_path.get_basename()
	if not Copies.is_file(resource):
		return ""
	var known_scene := SceneFiles.scene_of(resource)
	if not known_scene.is_empty():
		return "" if known_scene == _scene_of(scatter) else known_scene.get_basename()
	if stem.begins_with(_scene_of(scatter).get_basename() + "_"):
		return ""
	while "_" in stem.get_file():
		stem = stem.get_base_dir().path_join(stem.get_file().rsplit("_", true, 1)[0])
		if FileAccess.file_exists(stem + ".tscn") or FileAccess.file_exists(stem + ".scn"):
			return stem
	return ""


static func _add_scene(stem: String, r_scenes: PackedStringArray, r_shared: Shared) -> void:
	if not r_scenes.has(stem):
		r_scenes.append(stem)
		r_shared.others.append((stem + ".tscn").get_file())


static func _scene_of(scatter: TerrainScatter3D) -> String:
	return (scatter.owner if scatter.owner != null else scatter).scene_file_path
