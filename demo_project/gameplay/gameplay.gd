extends Node3D
## A small game: walk, look at a tree, fell it, save, load. A save contains the game's changes to the world, so felled trees stay felled.
##
## Arguments after [code]--[/code]: [code]--screenshots[/code] or [code]--screenshots=FOLDER[/code] plays a fixed
## sequence of key presses and mouse movements, writes screenshots like the demo's other scenes, and quits.

const Tour := preload("res://gameplay/tour.gd")
const TREE := preload("res://gameplay/tree.tscn")
const SAVED := "user://gameplay.state"
const HIGHLIGHT := preload("res://shaders/highlight.gdshader")
## The angle in radians between the direction in which a tree falls and the direction away from the player, measured to the left.
const ASIDE := 0.8
## For the small and the large map: the distance in meters from the center to the edges, and the width in pixels.
const MAP_REACHES: Array[float] = [50.0, 120.0]
const MAP_SIZES: Array[float] = [260.0, 640.0]

## Trees that are falling or lying on the ground.
var falling: Array[Node3D] = []

@onready var world: TerrainScatter3D = $World
@onready var player: CharacterBody3D = $Player
@onready var minimap: Control = $Hud/Minimap
@onready var _highlight: MeshInstance3D = $Highlight
@onready var _target_text: Label = $Hud/Looking
@onready var _message: Label = $Hud/Panel/Rows/Said
@onready var _help: Label = $Hud/Panel/Rows/Help


func _ready() -> void:
	world.scene_shown.connect(_on_scene_shown)
	_enlarge_map(false)
	for argument in OS.get_cmdline_user_args():
		# If the tour has restarted the game, the existing tour continues.
		if argument.begins_with("--screenshots") and not get_tree().root.has_node(^"Tour"):
			Tour.begin(get_tree(), argument.trim_prefix("--screenshots").trim_prefix("="))


func _process(_delta: float) -> void:
	var tree: ScatterInstance = player.looked_at
	_highlight.visible = tree != null
	_target_text.visible = tree != null
	if tree == null:
		return
	var mesh: Mesh = tree.layer.meshes[tree.mesh]
	if _highlight.mesh != mesh:
		_highlight.mesh = mesh
		_highlight.material_override = _glow_of(mesh)
	# The scatter sets the wind time only on its own materials, through the RenderingServer.
	var time: Variant = RenderingServer.material_get_param(mesh.surface_get_material(0).get_rid(), &"wind_time")
	RenderingServer.material_set_param(_highlight.material_override.get_rid(), &"wind_time", time)
	_highlight.global_transform = tree.transform
	var height := mesh.get_aabb().end.y * tree.transform.basis.get_scale().y
	_target_text.text = "%s, %.1f m tall, %.1f m away\nid %d\nF   fell" % [
		tree.layer.resource_name, height, tree.distance, tree.id]


func _unhandled_key_input(event: InputEvent) -> void:
	var key := event as InputEventKey
	if key == null or not key.pressed or key.echo:
		return
	match key.keycode:
		KEY_F:
			fell()
		KEY_F5:
			save()
		KEY_F9:
			load_saved()
		KEY_M:
			_enlarge_map(minimap.reach == MAP_REACHES[0])
		KEY_H:
			_help.visible = not _help.visible
		KEY_ESCAPE:
			player.capture(false)


## Fells the tree that the player looks at. Its scene then falls. A tree that is too far away to have a scene gets one.
func fell() -> void:
	var tree: ScatterInstance = player.looked_at
	if tree == null:
		return
	var scene := world.take_scene(tree.id)
	if not world.fell(tree.id):
		return
	if scene == null:
		scene = TREE.instantiate()
		add_child(scene)
	else:
		scene.reparent(self)
	scene.global_transform = tree.transform
	scene.show_as(tree.layer.meshes[tree.mesh])
	var direction := (scene.global_position - player.global_position) * Vector3(1.0, 0.0, 1.0)
	scene.fall(direction.normalized().rotated(Vector3.UP, ASIDE), world.ground)
	falling.append(scene)
	scene.tree_exited.connect(func() -> void: falling.erase(scene))
	player.looked_at = null
	_show_message("felled %d" % tree.id)


## Saves only the game's changes.
func save() -> void:
	var error := world.state.save_to_file(SAVED)
	_show_message("saved" if error == OK else "not saved: " + error_string(error))


## Restores the world from the last save.
func load_saved() -> void:
	if not FileAccess.file_exists(SAVED):
		_show_message("nothing to load")
		return
	var error := world.state.load_from_file(SAVED)
	_show_message("loaded" if error == OK else "not loaded: " + error_string(error))


func _show_message(text: String) -> void:
	_message.text = "%s\n%d felled, %d stumps" % [text, world.state.get_removed_count(), world.state.get_added_count()]


func _on_scene_shown(id: int, scene: Node3D) -> void:
	var tree := world.get_instance(id)
	scene.call(&"show_as", tree.layer.meshes[tree.mesh])


func _enlarge_map(is_large: bool) -> void:
	minimap.reach = MAP_REACHES[int(is_large)]
	var view_size := get_viewport().get_visible_rect().size
	var map_size := minf(MAP_SIZES[int(is_large)], view_size.y - 32.0)
	minimap.set_deferred(&"size", Vector2(map_size, map_size))
	minimap.set_deferred(&"position", Vector2(view_size.x - map_size - 16.0, 16.0))


## Returns the glow material, with the texture and the wind parameters of a tree's material.
static func _glow_of(mesh: Mesh) -> ShaderMaterial:
	var glow := mesh.surface_get_material(0).duplicate() as ShaderMaterial
	glow.shader = HIGHLIGHT
	return glow
