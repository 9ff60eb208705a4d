extends "harness.gd"
## Tests the demo's gameplay scene: the tree that the player looks at, obstacles, and trees that stay felled. Run the two tests in two
## processes, so that the second knows only the file that the first saved: `-- test_felled_and_saved file=PATH`, then `--
## test_felled_after_a_restart file=PATH`.

const EYES := 1.72
## The distance in meters between the player and the trunk's axis.
const AWAY := 6.0

var game: Node3D
var world: TerrainScatter3D
var player: CharacterBody3D


func load_game() -> void:
	game = (load("res://gameplay.tscn") as PackedScene).instantiate()
	root.add_child(game)
	world = game.world
	player = game.player
	await settle(world)


func press(key: Key) -> void:
	hold(key, true)
	hold(key, false)


func hold(key: Key, pressed: bool) -> void:
	var event := InputEventKey.new()
	event.keycode = key
	event.physical_keycode = key
	event.pressed = pressed
	Input.parse_input_event(event)


func physics_frames(count: int) -> void:
	for frame in count:
		await physics_frame


## Places the player in front of a tree, looking at its trunk.
func stand_before(trunk: Vector3) -> void:
	player.global_position = trunk + Vector3(-AWAY, 0.0, 0.0)
	player.global_position.y = world.ground.get_height(player.global_position)
	var toward: Vector3 = (trunk + Vector3.UP * 1.5 - player.eyes.global_position).normalized()
	player.global_rotation.y = atan2(-toward.x, -toward.z)
	player.eyes.rotation.x = asin(toward.y)
	await physics_frames(3)
	await settle(world)
	await physics_frames(3)


## Returns the ID of the instance that a physics ray from the player's eyes to a position hits, or 0.
func touched(point: Vector3) -> int:
	var ray := PhysicsRayQueryParameters3D.create(player.eyes.global_position, point, 1)
	var hit := world.get_world_3d().direct_space_state.intersect_ray(ray)
	if hit.is_empty():
		return 0
	check(hit.collider == world, "the collider is the scatter")
	return world.get_body_instance(hit.rid)


## Returns whether a visible tile contains an instance.
func drawn(layer: String, id: int) -> bool:
	for tile: Vector2i in world.get_shown_tiles(layer):
		for ids: PackedInt64Array in tile_ids(world, layer, tile):
			if ids.has(id):
				return true
	return false


func file_name() -> String:
	for argument in arguments:
		if argument.begins_with("file="):
			return argument.trim_prefix("file=")
	return "user://test_demo_gameplay.txt"


func test_felled_and_saved() -> void:
	await load_game()
	check_equal(world.get_problems(), PackedStringArray(), "warnings of the scene")
	var oak := world.query_nearest(player.global_position, 60.0, "Oak")
	check(oak != null, "an oak is near")
	var trunk: Vector3 = oak.transform.origin
	await stand_before(trunk)
	check_equal(looked_id(), oak.id, "the player looks at the oak")
	check(game.get_node("Highlight").visible, "the oak is highlighted")
	check_equal(touched(trunk + Vector3.UP * 1.5), oak.id, "the oak has a body")
	await walk_into(trunk)
	await fell(oak)
	press(KEY_F5)
	await frames(2)
	var file := FileAccess.open(file_name(), FileAccess.WRITE)
	check(file != null and file.store_var({"id": oak.id, "transform": oak.transform}), "the notes are written")


func walk_into(trunk: Vector3) -> void:
	var before := player.global_position
	hold(KEY_W, true)
	await create_timer(2.8).timeout
	hold(KEY_W, false)
	await physics_frames(2)
	var left := trunk.x - player.global_position.x
	check(player.global_position.distance_to(before) > 2.0, "the player walks")
	check(left > 0.6, "the trunk stops the player %.2f m before its middle" % left)
	await stand_before(trunk)


func fell(oak: ScatterInstance) -> void:
	var scene := world.get_scene(oak.id)
	check(scene != null, "near the player, the oak is a scene")
	press(KEY_F)
	await frames(2)
	check_equal(game.falling, [scene] as Array[Node3D], "that scene falls")
	await check_felled(oak.id, oak.transform)
	check(scene.angle > 0.0, "it tilts")
	await until(func() -> bool: return scene.lies, "it lies on the ground in the end")
	check(scene.angle > 0.9, "at %f radians" % scene.angle)


## Returns the ID of the tree that the player looks at, or 0.
func looked_id() -> int:
	return player.looked_at.id if player.looked_at != null else 0


## Checks that no query finds a tree anymore, and that a stump has replaced it.
func check_felled(id: int, stood: Transform3D) -> void:
	await physics_frames(2)
	check(not world.has_instance(id), "the tree no longer exists")
	check(looked_id() != id, "the player does not look at it")
	check(not drawn("Oak", id), "it is not drawn")
	check(touched(stood.origin + Vector3.UP * 1.5) != id, "it has no body")
	check(world.get_scene(id) == null, "it has no scene")
	var around := Rect2(stood.origin.x - 1.0, stood.origin.z - 1.0, 2.0, 2.0)
	check_equal(world.query_rect(around, world.TREES).ids, PackedInt64Array(), "no tree in the rectangle")
	var stumps := world.query_rect(around, "Stump")
	if check_equal(stumps.ids.size(), 1, "stumps") and stumps.ids.size() == 1:
		check(stumps.positions[0].distance_to(stood.origin) < 0.01, "the stump is where the tree was")
		await settle(world)
		check(drawn("Stump", stumps.ids[0]), "the stump is drawn")


func test_felled_after_a_restart() -> void:
	var file := FileAccess.open(file_name(), FileAccess.READ)
	var notes: Dictionary = file.get_var()
	var stood: Transform3D = notes.transform
	await load_game()
	await stand_before(stood.origin)
	check_equal(looked_id(), notes.id, "before loading, the oak exists")
	press(KEY_F9)
	await frames(2)
	await check_felled(notes.id, stood)
	# Move so far that all surrounding tiles are removed, and then back.
	player.global_position += Vector3(-3000.0, 0.0, 0.0)
	await settle(world)
	check(not drawn("Oak", notes.id), "nothing is drawn there")
	await stand_before(stood.origin)
	await check_felled(notes.id, stood)
	DirAccess.remove_absolute("user://gameplay.state")
