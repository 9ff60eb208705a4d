@tool
extends RefCounted
## Finds and adds missing parts that a scene needs to look right in the game: a camera, a light, a sky and wind.

const FoliageWorld := preload("res://addons/thicket/shaders/foliage_world.gd")

const PARTS: PackedStringArray = ["camera", "sun", "sky", "wind"]


## Returns the parts that a scene lacks.
static func missing(root: Node) -> PackedStringArray:
	var nodes: Array[Node] = [root]
	nodes.append_array(root.find_children("*", "", true, false))
	var result := PackedStringArray()
	for part in PARTS:
		if not nodes.any(_is_part.bind(part)):
			result.append(part)
	return result


## Returns true if the game would show a gray window, because there is no camera, or neither a light nor a sky.
static func is_gray(root: Node) -> bool:
	var parts := missing(root)
	return parts.has("camera") or parts.has("sun") and parts.has("sky")


## Adds the missing parts as children of the root, as one undo step. The camera gets the transform of the editor's view.
static func add(root: Node, view: Transform3D, undo_redo: EditorUndoRedoManager) -> void:
	undo_redo.create_action("Add Camera, Sun, Sky and Wind", UndoRedo.MERGE_DISABLE, root)
	for part in missing(root):
		var node := _make(part, _to_local(root, view))
		node.name = part.capitalize()
		undo_redo.add_do_method(root, &"add_child", node, true)
		undo_redo.add_do_property(node, &"owner", root)
		undo_redo.add_do_reference(node)
		undo_redo.add_undo_method(root, &"remove_child", node)
	undo_redo.commit_action()


## Converts a global transform to the local space of the root, which may be moved or rotated.
static func _to_local(root: Node, transform: Transform3D) -> Transform3D:
	return (root as Node3D).global_transform.affine_inverse() * transform if root is Node3D else transform


static func _is_part(node: Node, part: String) -> bool:
	match part:
		"camera":
			return node is Camera3D
		"sun":
			return node is Light3D
		"sky":
			return node is WorldEnvironment
		_:
			return node is FoliageWorld


static func _make(part: String, view: Transform3D) -> Node:
	match part:
		"camera":
			var camera := Camera3D.new()
			camera.transform = view
			camera.far = 2000.0
			return camera
		"sun":
			var sun := DirectionalLight3D.new()
			sun.rotation_degrees = Vector3(-38.0, -55.0, 0.0)
			sun.light_color = Color(1.0, 0.95, 0.86)
			sun.light_energy = 1.3
			sun.shadow_enabled = true
			sun.directional_shadow_max_distance = 150.0
			return sun
		"sky":
			var sky := WorldEnvironment.new()
			sky.environment = _environment()
			return sky
		_:
			return FoliageWorld.new()


static func _environment() -> Environment:
	var material := ProceduralSkyMaterial.new()
	material.sky_top_color = Color(0.28, 0.46, 0.72)
	material.sky_horizon_color = Color(0.72, 0.79, 0.86)
	material.ground_horizon_color = Color(0.62, 0.66, 0.66)
	material.ground_bottom_color = Color(0.25, 0.26, 0.22)
	var environment := Environment.new()
	environment.background_mode = Environment.BG_SKY
	environment.sky = Sky.new()
	environment.sky.sky_material = material
	environment.ambient_light_source = Environment.AMBIENT_SOURCE_SKY
	environment.ambient_light_color = Color(0.75, 0.8, 0.85) # With light from the blue sky alone, the ground below trees would be dark and blue.
	environment.ambient_light_sky_contribution = 0.4
	environment.ambient_light_energy = 1.7
	environment.tonemap_mode = Environment.TONE_MAPPER_FILMIC
	environment.fog_enabled = true
	environment.fog_light_color = Color(0.66, 0.74, 0.82)
	environment.fog_density = 0.0008
	environment.fog_aerial_perspective = 0.4
	return environment
