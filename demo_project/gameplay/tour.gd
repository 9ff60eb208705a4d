extends Node
## Plays the game without user input: presses keys and moves the mouse in a fixed sequence, saves screenshots, checks
## the results, and quits. At the first failed check, it stops and exits with code 1. The tour reloads the game's scene,
## so this node is a sibling of the game, not its child.

## The time in seconds after which an unfinished step fails.
const TIMEOUT := 60.0
## The factor by which game time runs faster between screenshots.
const TIME_SCALE := 4.0
## The number of frames to draw before a screenshot, so that shadows settle.
const SETTLING_FRAMES := 2
## The distances in meters from a tree and from a stump at which the player stops.
const TREE_DISTANCE := 7.0
const STUMP_DISTANCE := 3.2

## The folder for the screenshots; empty for none.
var folder := ""

var _failed := false
var _game: Node3D


## Starts a tour of the game in the current scene. Screenshots are written to [param picture_folder], or to a default folder if it is empty. Without a display,
## there are no screenshots.
static func begin(tree: SceneTree, picture_folder: String) -> void:
	var tour := new()
	tour.name = "Tour"
	tour.process_mode = Node.PROCESS_MODE_ALWAYS
	if DisplayServer.get_name() != "headless":
		var default_folder := ProjectSettings.globalize_path("res://").path_join("../build/demo/gameplay").simplify_path()
		tour.folder = picture_folder if picture_folder != "" else default_folder
	tree.root.add_child.call_deferred(tour)


func _ready() -> void:
	get_viewport().msaa_3d = Viewport.MSAA_DISABLED
	get_viewport().scaling_3d_scale = 2.0
	RenderingServer.render_loop_enabled = false
	Engine.time_scale = TIME_SCALE
	if folder != "" and DirAccess.make_dir_recursive_absolute(folder) != OK:
		_check(false, "cannot create the folder %s" % folder)
	_play.call_deferred()


func _play() -> void:
	_game = get_tree().current_scene
	var steps: Array[Callable] = [_arrive, _walk, _look, _fell, _wait_for_the_stump, _fell_more, _map, _save_and_reload]
	for step in steps:
		if not _failed:
			await step.call()
	print("demo: %s" % ("FAILED" if _failed else "done"))
	# Restores the default. Otherwise, a failed run would hang in a loop that draws nothing.
	RenderingServer.render_loop_enabled = true
	get_tree().quit(1 if _failed else 0)


func _arrive() -> void:
	_key(KEY_H)
	await _picture("arrive")


## Walks to the nearest oak.
func _walk() -> void:
	var oak: ScatterInstance = _game.world.query_nearest(_game.player.global_position, 60.0, "Oak")
	if not _check(oak != null, "no oak nearby"):
		return
	await _walk_to(oak, TREE_DISTANCE)


func _look() -> void:
	_check(_game.player.looked_at != null, "the player does not look at a tree")
	await _picture("look")


func _fell() -> void:
	var id: int = _game.player.looked_at.id
	_key(KEY_F)
	await _until(func() -> bool: return not _game.falling.is_empty() and _game.falling[0].angle > 0.75, "the tree falls")
	_check(not _game.world.has_instance(id), "%d still exists" % id)
	await _picture("falling")


func _wait_for_the_stump() -> void:
	await _until(func() -> bool: return _game.falling.is_empty(), "the fallen tree dissolves")
	var stump: ScatterInstance = _game.world.query_nearest(_game.player.global_position, 60.0, "Stump")
	if _check(stump != null, "no stump"):
		await _walk_towards(stump.transform.origin, STUMP_DISTANCE)
		await _look_at(stump.transform.origin + Vector3.UP * 0.6)
		await _picture("stump")


## Fells three more trees, always the nearest one.
func _fell_more() -> void:
	for count in 3:
		var tree: ScatterInstance = _game.world.query_nearest(_game.player.global_position, 60.0, _game.world.TREES)
		if not _check(tree != null, "no more trees"):
			return
		await _walk_to(tree, TREE_DISTANCE)
		_key(KEY_F)
		await _until(func() -> bool: return not _game.world.has_instance(tree.id), "the tree is felled")
	await _until(func() -> bool: return _game.falling.is_empty(), "all fallen trees dissolve")


func _map() -> void:
	_key(KEY_M)
	await _picture("map")
	_key(KEY_M)


## Saves, restarts the game, and loads. Between the restart and loading, the world must have no changes.
func _save_and_reload() -> void:
	var player_transform: Transform3D = _game.player.global_transform
	var felled: PackedInt64Array = _game.world.state.get_removed()
	var digest: int = _game.world.state.get_digest()
	_check(felled.size() == 4, "expected 4 felled trees, got %d" % felled.size())
	_key(KEY_F5)
	await _frames(2)
	get_tree().reload_current_scene()
	await _frames(3)
	_game = get_tree().current_scene
	_game.player.global_transform = player_transform
	_key(KEY_H)
	_check(_game.world.has_instance(felled[0]), "a felled tree is still missing after a restart")
	_key(KEY_F9)
	await _frames(2)
	for id in felled:
		_check(not _game.world.has_instance(id), "%d exists after loading, although it was felled" % id)
	_check(_game.world.state.get_digest() == digest, "the state differs after loading")
	await _picture("loaded")


## Walks to a tree and looks at it.
func _walk_to(tree: ScatterInstance, distance: float) -> void:
	var root: Vector3 = tree.transform.origin
	await _walk_towards(root, distance)
	await _look_at(root + Vector3.UP * 2.4)
	await _until(func() -> bool: return _game.player.looked_at != null and _game.player.looked_at.id == tree.id, "the player sees the tree")


## Turns to a position and walks until it is within [param distance] meters.
func _walk_towards(point: Vector3, distance: float) -> void:
	await _look_at(point + Vector3.UP * 1.6)
	_hold(KEY_W, true)
	await _until(func() -> bool: return _flat_distance(point) < distance, "the player reaches the position")
	_hold(KEY_W, false)


func _flat_distance(point: Vector3) -> float:
	return ((point - _game.player.global_position) * Vector3(1.0, 0.0, 1.0)).length()


## Moves the mouse so that a position is in the center of the view.
func _look_at(point: Vector3) -> void:
	_game.player.captured = true
	var eyes: Camera3D = _game.player.eyes
	var direction := (point - eyes.global_position).normalized()
	var turn := Vector2(angle_difference(atan2(-direction.x, -direction.z), eyes.global_rotation.y),
			eyes.global_rotation.x - asin(direction.y))
	var motion := InputEventMouseMotion.new()
	motion.relative = turn / _game.player.RADIANS_PER_PIXEL
	Input.parse_input_event(motion)
	await get_tree().physics_frame
	await get_tree().physics_frame


## Presses and releases a key.
func _key(key: Key) -> void:
	_hold(key, true)
	_hold(key, false)


func _hold(key: Key, pressed: bool) -> void:
	var event := InputEventKey.new()
	event.keycode = key
	event.physical_keycode = key
	event.pressed = pressed
	Input.parse_input_event(event)


## Waits until all tiles are visible, then saves a screenshot while the game is paused.
func _picture(picture_name: String) -> void:
	await _frames(3)
	await _until(func() -> bool: return _game.world.is_settled(), "all tiles are visible")
	if _failed:
		return
	var stats: Dictionary = _game.world.get_stats()
	print("demo: %s: %d tiles, %d instances" % [picture_name, stats.tiles, stats.instances])
	if folder == "":
		return
	get_tree().paused = true
	RenderingServer.render_loop_enabled = true
	for frame in SETTLING_FRAMES:
		await RenderingServer.frame_post_draw
	RenderingServer.render_loop_enabled = false
	get_tree().paused = false
	var image := get_viewport().get_texture().get_image()
	var path := folder.path_join("%s.png" % picture_name)
	_check(image != null and not image.is_empty() and image.save_png(path) == OK, "cannot write %s" % path)


func _frames(count: int) -> void:
	for frame in count:
		await get_tree().process_frame


func _until(condition: Callable, description: String) -> void:
	var deadline := Time.get_ticks_msec() + int(TIMEOUT * 1000.0)
	while not _failed and not condition.call():
		_check(Time.get_ticks_msec() < deadline, "not within %.0f s: %s" % [TIMEOUT, description])
		await get_tree().process_frame


func _check(is_true: bool, message: String) -> bool:
	if not is_true:
		_failed = true
		printerr("demo: " + message)
	return is_true
