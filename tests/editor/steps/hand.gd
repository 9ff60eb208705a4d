@tool
extends "res://tests/steps.gd"
## Plants, selects, moves, rotates, scales and deletes single instances with mouse and keys. Undo and redo restore every byte. The
## instances are saved with the scene, in a separate file.

const SCENE := "res://field.tscn"
const STATE := "res://field_rocks_state.res"

var scatter: Node3D
var hand: Node


## Saves a scene with a flat field and a ramp. Rocks are only placed by hand, and posts are generated.
func make_scene(path: String) -> void:
	var root := Node3D.new()
	root.name = "Field"
	scatter = ClassDB.instantiate(&"TerrainScatter3D")
	scatter.name = "Rocks"
	var ground: Resource = ClassDB.instantiate(&"ScatterGroundMeshes")
	ground.set(&"group", &"ground")
	scatter.set(&"ground", ground)
	var layers: Array = []
	for name: String in ["Rock", "Post"]:
		var layer: Resource = ClassDB.instantiate(&"ScatterLayer")
		layer.resource_name = name
		layer.set(&"view_distance", 30.0)
		layer.set(&"tile_size", 16.0)
		layer.set(&"radius", 1.5)
		var mesh := BoxMesh.new()
		mesh.size = Vector3(0.3, 0.4, 0.5) if name == "Rock" else Vector3(0.1, 0.5, 0.1)
		layer.set(&"meshes", [mesh])
		layer.set(&"instance_radius", 0.25)
		layer.set(&"instance_height", 0.4)
		layer.set(&"density", 0.0 if name == "Rock" else 1.0)
		layers.append(layer)
	scatter.set(&"layers", layers)
	root.add_child(scatter)
	scatter.owner = root
	for part in 2:
		var body := MeshInstance3D.new()
		body.name = ["Ground", "Ramp"][part]
		body.mesh = BoxMesh.new()
		(body.mesh as BoxMesh).size = [Vector3(60.0, 1.0, 60.0), Vector3(3.0, 0.5, 3.0)][part]
		body.position = [Vector3(0.0, -0.5, 0.0), Vector3(-2.5, 0.0, -1.0)][part]
		body.rotation.z = [0.0, -0.4][part]
		body.add_to_group(&"ground", true)
		root.add_child(body)
		body.owner = root
	save_scene(root, path)


func bytes(path: String) -> PackedByteArray:
	return FileAccess.get_file_as_bytes(path) if FileAccess.file_exists(path) else PackedByteArray()


func placed() -> PackedInt64Array:
	return scatter.get(&"state").get_added() if scatter.get(&"state") != null else PackedInt64Array()


func transform_of(id: int) -> Transform3D:
	var instance: RefCounted = scatter.get_instance(id)
	return instance.transform if instance != null else Transform3D()


func version() -> int:
	return history(scatter).get_version()


func test_prepare() -> void:
	make_scene(SCENE)
	scatter = (await open(SCENE)).get_node("Rocks")
	EditorInterface.set_main_screen_editor("3D")
	await select_node(scatter)
	await settle(scatter)
	# The editor adds data when it first saves a file. Later saves do not change the file.
	EditorInterface.save_scene()
	hand = await turn_on_hand()


## Checks that a click plants an instance in one undo step. The first instance creates the file.
func test_plant() -> void:
	var scene := bytes(SCENE)
	var before := version()
	var at := Vector3(0.6, 0.0, 0.4)
	await click_at(on_screen(at))
	check_equal(hand.problem, "", "planting reports no problem")
	if not check(placed().size() == 1, "one instance: %s" % placed()):
		return
	check_equal(version(), before + 1, "planting is one undo step")
	check(FileAccess.file_exists(STATE), "the state is saved in a file: %s" % files("res://"))
	check_equal(scatter.get(&"state").resource_path, STATE, "the scatter refers to the file")
	var placed_at := transform_of(placed()[0])
	check(placed_at.origin.distance_to(at) < 0.02 and placed_at.basis.is_equal_approx(Basis()), "the instance is at the clicked position: %s" % placed_at)
	check_equal(hand.selected, placed()[0], "it is selected")
	await picture("hand_planted")
	var id := placed()[0]
	await undo()
	check(scatter.get(&"state") == null and not FileAccess.file_exists(STATE), "undo removes the state and its file")
	check(not scatter.has_instance(id), "the instance is gone")
	hand.refresh()
	check_equal(hand.selected, 0, "it is no longer selected")
	EditorInterface.save_scene()
	check(bytes(SCENE) == scene, "the scene is unchanged, byte for byte")
	await redo()
	check(placed() == PackedInt64Array([id]) and transform_of(id) == placed_at, "redo restores the instance bit for bit, with the same ID")
	EditorInterface.save_scene()
	check(FileAccess.file_exists(STATE), "the state's file is saved with the scene")
	var text := FileAccess.get_file_as_string(SCENE)
	check(STATE in text and not "PackedByteArray" in text, "the scene refers to the file and contains no instances")
	var saved := ResourceLoader.load(STATE, "", ResourceLoader.CACHE_MODE_IGNORE)
	check(saved.get_added() == PackedInt64Array([id]) and saved.copy_at_runtime, "the file contains the instance")


## Moves, rotates and scales an instance with the mouse and then with keys. The ID must not change, and undo must revert each step byte for byte.
func test_move_rotate_scale() -> void:
	var id := placed()[0]
	var state := bytes(STATE)
	var scene := bytes(SCENE)
	var start := transform_of(id)
	await key(KEY_ESCAPE)
	check_equal(hand.selected, 0, "Escape deselects the instance")
	check_equal(EditorInterface.get_selection().get_selected_nodes(), [scatter], "the scatter stays selected")
	await move_mouse(on_screen(Vector3(1.2, 0.0, 0.9)))
	check(hand._ghost.is_shown(), "a preview of the next instance is visible where no instance exists")
	await picture("hand_ghost")
	await move_mouse(on_screen(start.origin + Vector3.UP * 0.2))
	await click_at(on_screen(start.origin + Vector3.UP * 0.2))
	check_equal(hand.selected, id, "a click on it selects it")
	check_equal(placed().size(), 1, "no instance is planted")
	var steps := version()
	var grab := start.origin + Vector3.UP * 0.1
	await drag_mouse(on_screen(start.origin), on_screen(start.origin + Vector3(-1.0, 0.0, 0.5)))
	var moved := transform_of(id)
	check(moved.origin.distance_to(start.origin + Vector3(-1.0, 0.0, 0.5)) < 0.05, "moved to %s" % moved.origin)
	check(moved.basis == start.basis, "it is not rotated")
	await drag_mouse(on_screen(moved.origin), on_screen(Vector3(-0.86, 0.0, 0.93)), true)
	check(transform_of(id).origin.is_equal_approx(Vector3(-1.0, 0.0, 1.0)), "it snaps to the grid while Ctrl is pressed: %s" % transform_of(id).origin)
	moved = transform_of(id)
	await picture("hand_selected")
	var frame: RefCounted = hand._frame
	var knob: Vector3 = frame.handle_position(1)
	var around := moved.origin + (knob - moved.origin).rotated(Vector3.UP, PI * 0.5)
	await drag_mouse(on_screen(knob), on_screen(around))
	var turned := transform_of(id)
	check(turned.origin == moved.origin, "rotating keeps the position")
	check(turned.basis.z.distance_to(Vector3.RIGHT) < 0.05, "rotated: %s" % turned.basis)
	var top: Vector3 = hand._frame.handle_position(2)
	var middle := on_screen(turned.origin)
	await drag_mouse(on_screen(top), middle + (on_screen(top) - middle) * 2.0)
	check(absf(transform_of(id).basis.y.length() - 2.0) < 0.05, "it is scaled to twice its size: %s" % transform_of(id).basis.get_scale())
	await key(KEY_R)
	check(absf(transform_of(id).basis.z.angle_to(turned.basis.z) - deg_to_rad(15.0)) < 1e-3, "R rotates by one step")
	await key(KEY_R, KEY_MASK_SHIFT)
	await key(KEY_BRACKETRIGHT)
	await key(KEY_BRACKETLEFT)
	check(transform_of(id).basis.y.length() < 2.05, "keys revert the scale and the rotation")
	check_equal(placed(), PackedInt64Array([id]), "it is still the same instance")
	check_equal(version(), steps + 8, "the changes are eight undo steps")
	var last := transform_of(id)
	EditorInterface.save_scene()
	check(bytes(STATE) != state, "the file of the state is saved")
	for step in 8:
		await undo()
	check(transform_of(id) == start, "undo restores the transform bit for bit")
	EditorInterface.save_scene()
	check(bytes(STATE) == state, "the file is unchanged, byte for byte")
	check(bytes(SCENE) == scene, "the scene is unchanged, byte for byte")
	for step in 8:
		await redo()
	check(transform_of(id) == last, "redo restores the last transform bit for bit")


## Checks that a drag canceled with Escape has no effect, and that the Delete key deletes the instance, not the node.
func test_cancel_and_delete() -> void:
	var id := placed()[0]
	await key(KEY_ESCAPE)
	var placed_at := transform_of(id)
	var steps := version()
	await drag_mouse(on_screen(placed_at.origin), on_screen(placed_at.origin + Vector3(0.8, 0.0, 0.0)), false, false)
	check(transform_of(id) != placed_at, "it moves with the mouse")
	await key(KEY_ESCAPE)
	check(transform_of(id) == placed_at and version() == steps, "Escape restores the transform and adds no undo step")
	await press(on_screen(placed_at.origin), false)
	await key(KEY_DELETE)
	check(scatter.is_inside_tree() and placed().size() == 1, "Delete without a selection deletes nothing")
	await click_at(on_screen(placed_at.origin))
	check_equal(hand.selected, id, "a click selects the instance again")
	await key(KEY_DELETE)
	check(scatter.is_inside_tree() and placed().is_empty(), "the instance is deleted, the node stays")
	await undo()
	check(transform_of(id) == placed_at, "undo restores the deleted instance")


## Checks that a generated instance can be moved and deleted like a hand-placed one. Undo restores it with its original ID.
func test_generated_instances() -> void:
	workspace().toolbar.choose_layer(1)
	await settle(scatter)
	hand.refresh()
	var near: RefCounted = scatter.query_nearest(Vector3(0.5, 0.0, 0.5), 3.0, scatter.layers[1])
	var id: int = near.id
	var placed_at: Transform3D = near.transform
	await click_at(on_screen(placed_at.origin + Vector3.UP * 0.1))
	check_equal(hand.selected, id, "a click selects the generated instance")
	await key(KEY_ESCAPE)
	await drag_mouse(on_screen(placed_at.origin), on_screen(placed_at.origin + Vector3(0.5, 0.0, 0.0)))
	check(not scatter.has_instance(id) and hand.selected < 0, "the moved instance has a new ID")
	check(transform_of(hand.selected).origin.distance_to(placed_at.origin + Vector3(0.5, 0.0, 0.0)) < 0.05, "it is at the dragged position")
	check(transform_of(hand.selected).basis == placed_at.basis, "it keeps its rotation")
	await undo()
	check(scatter.has_instance(id) and transform_of(id) == placed_at, "undo restores the generated instance")
	await click_at(on_screen(placed_at.origin + Vector3.UP * 0.1))
	await key(KEY_DELETE)
	check(not scatter.has_instance(id), "the generated instance is deleted")
	await settle(scatter)
	check(not instances(scatter, 1).has(id), "it is not drawn")
	check_equal(scatter.build_rect(scatter.layers[1], Rect2(placed_at.origin.x - 0.01, placed_at.origin.z - 0.01, 0.02, 0.02)).is_empty(), true, "nor is it baked")
	await undo()
	await settle(scatter)
	check(instances(scatter, 1).has(id), "undo restores the deleted instance")
	await redo()
	workspace().toolbar.choose_layer(0)
	hand.refresh()


## Plants on a ramp with Align, and on the grid. Changing the radius must not affect hand-placed instances.
func test_on_a_ramp() -> void:
	hand.planting.choose(false, true, false, false)
	var at := Vector3(-2.5, 0.0, -1.0)
	at.y = scatter.ground.get_height(at)
	await click_at(on_screen(at))
	var id: int = hand.selected
	check(id < 0 and transform_of(id).origin.distance_to(at) < 0.05, "the instance is on the ramp at %s: %s" % [at, transform_of(id).origin])
	check(transform_of(id).basis.y.distance_to(scatter.ground.get_normal(at)) < 0.01, "it is aligned to the ramp")
	check(at.y > 0.1, "the position is on the ramp, above the flat ground")
	await picture("hand_ramp")
	hand.planting.choose(true, false, false, false)
	hand.planting.set_steps(0.25, 30.0)
	await click_at(on_screen(Vector3(1.31, 0.0, -0.42)))
	var on_grid := transform_of(hand.selected).origin
	check(on_grid.distance_to(Vector3(1.25, 0.0, -0.5)) < 1e-4, "the instance is on the grid: %s" % on_grid)
	var all := placed()
	scatter.layers[0].radius = 2.5
	await settle(scatter)
	check(placed() == all and scatter.has_instance(id), "a new radius keeps planted instances")
	check(scatter.get_problems().is_empty(), "the new radius causes no problem: %s" % scatter.get_problems())


## Checks that an action that is not possible shows the reason, consumes the mouse button and has no other effect.
func test_actions_that_are_not_possible() -> void:
	hand.planting.choose(false, false, false, false)
	var all := placed()
	var steps := version()
	var ground: Resource = scatter.ground
	var free := on_screen(Vector3(1.3, 0.0, 0.9))
	scatter.ground = null
	await click_at(free)
	check("There is no ground" in hand.problem, "the problem names the missing ground: '%s'" % hand.problem)
	scatter.ground = ground
	var root := EditorInterface.get_edited_scene_root()
	var state: Resource = scatter.state
	scatter.state = null
	root.scene_file_path = ""
	var before := files("res://")
	await click_at(free)
	check("Save the scene" in hand.problem, "the problem asks to save the scene: '%s'" % hand.problem)
	check(files("res://") == before and scatter.state == null, "no file and no state are created")
	root.scene_file_path = SCENE
	scatter.state = state
	await click_at(on_screen(Vector3(0.0, 0.0, 0.0)) - Vector2(0.0, 20000.0))
	check(placed() == all and version() == steps, "no instance is planted")
	check_equal(EditorInterface.get_selection().get_selected_nodes(), [scatter], "the scatter stays selected")


## Saves the scene, and a list of the instances that the game must find.
func test_saved_for_the_game() -> void:
	EditorInterface.save_scene()
	var text := FileAccess.get_file_as_string(SCENE)
	check(text.length() < 6000 and not "PackedByteArray" in text, "the scene is small: %d" % text.length())
	var noted := {}
	for id in placed():
		noted[id] = transform_of(id)
	check_equal(noted.size(), 3, "three hand-placed instances")
	FileAccess.open("res://noted.bin", FileAccess.WRITE).store_var([noted, scatter.state.get_removed(), scatter.state.get_digest()])
	# Instantiate the scene in another scene. The file of that scene must not contain any part of the state.
	var outer := Node3D.new()
	outer.name = "Outer"
	var inner: Node = (load(SCENE) as PackedScene).instantiate(PackedScene.GEN_EDIT_STATE_INSTANCE)
	outer.add_child(inner)
	inner.owner = outer
	outer.set_editable_instance(inner, true)
	save_scene(outer, "res://outer.tscn")
	var opened := await open("res://outer.tscn")
	check_equal(opened.get_node("Field/Rocks").state.get_added().size(), 3, "the instances exist in the outer scene, too")
	EditorInterface.mark_scene_as_unsaved()
	EditorInterface.save_scene()
	text = FileAccess.get_file_as_string("res://outer.tscn")
	var holds := "PackedByteArray" in text or "ScatterState" in text
	check(text.length() < 2000 and not holds, "the outer scene contains none of it:\n" + text)


## Checks that closing a scene without saving it leaves no file.
func test_closed_without_saving() -> void:
	if not EditorInterface.has_method(&"close_scene"): # close_scene exists since Godot 4.5.
		return
	make_scene("res://lost.tscn")
	scatter = (await open("res://lost.tscn")).get_node("Rocks")
	await select_node(scatter)
	await settle(scatter)
	hand.set_on(true)
	workspace().toolbar.choose_layer(0)
	surface().grab_focus()
	await frames(3)
	await click_at(on_screen(Vector3(0.6, 0.0, 0.4)))
	var file := "res://lost_rocks_state.res"
	check(FileAccess.file_exists(file), "an instance is planted and the file exists: %s" % hand.problem)
	EditorInterface.call(&"close_scene")
	await until(func() -> bool: return not FileAccess.file_exists(file), "the file is deleted")
