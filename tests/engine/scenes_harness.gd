extends "harness.gd"
## Base class for the tests of scenes that replace meshes. Provides a garden, a log of shown and hidden scenes, and checks that
## each instance is visible exactly once.

const DISTANCE := 20.0
## Scenes appear within this distance. It exceeds DISTANCE to allow for small moves between distance checks.
const ENTER := 1.025 * DISTANCE
const LEAVE := 1.125 * DISTANCE

## The root node of the scenes. Counts the calls to its methods and runs hooks in them.
class Plant extends Node3D:
	static var made := 0
	# The hooks by method: _init, _ready, _scatter_shown or _scatter_hidden.
	static var hooks: Dictionary[StringName, Callable] = {}

	var id := 0
	var layer: ScatterLayer
	var data: Variant
	var times_shown := 0
	var times_hidden := 0
	var ready_at: Transform3D

	func _init() -> void:
		made += 1
		_run_hook(&"_init")

	func _ready() -> void:
		ready_at = global_transform
		_run_hook(&"_ready")

	func _scatter_shown(p_id: int, p_layer: ScatterLayer, p_data: Variant) -> void:
		id = p_id
		layer = p_layer
		data = p_data
		times_shown += 1
		_run_hook(&"_scatter_shown")

	func _scatter_hidden() -> void:
		times_hidden += 1
		_run_hook(&"_scatter_hidden")

	func _run_hook(place: StringName) -> void:
		if hooks.has(place):
			hooks[place].call(self)


var shown: Dictionary[int, int] = {}  # How often a scene was shown, by instance ID.
var hidden: Dictionary[int, int] = {}  # How often a scene was hidden, by instance ID.
var standing_scenes: Dictionary[int, Node3D] = {}
var viewer: Node3D


func clean() -> void:
	Plant.hooks.clear()
	await super()


func pack(node: Node) -> PackedScene:
	var scene := PackedScene.new()
	scene.pack(node)
	node.free()
	return scene


func make_plants(radius := 2.0) -> ScatterLayer:
	var layer := make_layer(radius)
	layer.resource_name = "Plants"
	layer.min_scale = 0.5
	layer.max_scale = 2.0
	layer.scene = pack(Plant.new())
	layer.scene_distance = DISTANCE
	return layer


func make_garden(layers: Array[ScatterLayer], at := Vector3.ZERO) -> TerrainScatter3D:
	Plant.made = 0
	shown.clear()
	hidden.clear()
	standing_scenes.clear()
	viewer = make_viewer(at)
	var scatter := make_scatter(layers, ScatterGroundFlat.new(), viewer)
	scatter.scene_shown.connect(func(id: int, scene: Node3D) -> void:
		shown[id] = shown.get(id, 0) + 1
		check(not standing_scenes.has(id), "no second scene for %d" % id)
		standing_scenes[id] = scene)
	scatter.scene_hidden.connect(func(id: int, scene: Node3D) -> void:
		hidden[id] = hidden.get(id, 0) + 1
		check(standing_scenes.get(id) == scene, "the scene that was shown is hidden")
		standing_scenes.erase(id))
	return scatter


## Returns the IDs of the instances drawn in the visible tiles, as a set.
func drawn(scatter: TerrainScatter3D, layer := 0) -> Dictionary[int, bool]:
	var ids: Dictionary[int, bool] = {}
	for tile in shown_tiles(scatter, layer):
		var buffers: Array = tile_buffers(scatter, layer, tile)
		var parts: Array = tile_ids(scatter, layer, tile)
		for part in parts.size():
			check_equal((buffers[part] as PackedFloat32Array).size(), 12 * (parts[part] as PackedInt64Array).size(),
					"floats in the buffer")
			for id in parts[part] as PackedInt64Array:
				check(not ids.has(id), "%d is drawn once" % id)
				ids[id] = true
	return ids


## Returns the scenes in the tree by instance ID.
func scenes_of(scatter: TerrainScatter3D) -> Dictionary[int, Node3D]:
	var found: Dictionary[int, Node3D] = {}
	for child in scatter.get_children(true):
		if child is Plant and not child.is_queued_for_deletion():
			found[child.id] = child
	return found


## Returns the IDs of all instances that are drawn or have a scene.
func everything_of(scatter: TerrainScatter3D) -> Dictionary[int, bool]:
	var ids := drawn(scatter)
	for id in scenes_of(scatter):
		ids[id] = true
	return ids


## Checks that each instance of `ids` is either drawn or has a scene, and that no instance is both.
func check_once(scatter: TerrainScatter3D, ids: Dictionary, context: String) -> void:
	var picture := drawn(scatter)
	var scenes := scenes_of(scatter)
	for id in ids:
		if picture.has(id) == scenes.has(id):
			check(false, "%s: %d is %s" % [context, id, "visible twice" if scenes.has(id) else "missing"])
			return
	for id in scenes:
		if picture.has(id) or scatter.get_scene(id) != scenes[id]:
			check(false, "%s: %d is drawn although it has a scene" % [context, id])
			return
	check(true, context)
