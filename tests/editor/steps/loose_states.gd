@tool
extends "res://tests/steps.gd"
## Checks that instances are never saved in a scene. The editor saves states that a script or the inspector has created or changed in a file next to
## the scene. For a new scene, it does so when the scene is saved a second time.

const SCENE := "res://clearing.tscn"
const STATE := "res://clearing_scatter_state.res"

var scatter: Node3D


func make_scene() -> Node3D:
	var root := Node3D.new()
	root.name = "Clearing"
	var new_scatter: Node3D = ClassDB.instantiate(&"TerrainScatter3D")
	new_scatter.name = "Scatter"
	new_scatter.ground = ClassDB.instantiate(&"ScatterGroundFlat")
	var layer: Resource = ClassDB.instantiate(&"ScatterLayer")
	layer.resource_name = "Stones"
	layer.meshes = [BoxMesh.new()]
	layer.view_distance = 40.0
	layer.tile_size = 16.0
	new_scatter.layers = [layer]
	root.add_child(new_scatter)
	new_scatter.owner = root
	return root


## Saves the scene with the keyboard shortcut.
func save_with_keys() -> void:
	await key(KEY_S, KEY_MASK_CTRL)
	await frames(5)


func check_scene(path: String, context: String) -> void:
	var text := FileAccess.get_file_as_string(path)
	check(text.length() > 100 and text.length() < 2500, "%s: the scene is small, %d bytes" % [context, text.length()])
	for word in ["PackedByteArray", "type=\"ScatterState\" id=\"ScatterState", "MultiMesh"]:
		check(not word in text, "%s: it contains no %s" % [context, word])


func add_instances(count: int, first: float) -> void:
	for index in count:
		check(scatter.add_instance(scatter.layers[0], Transform3D(Basis(), Vector3(first + 0.01 * index, 0.0, 1.0))) != 0, "the instance is added")


func test_changes_by_a_script() -> void:
	save_scene(make_scene(), SCENE)
	scatter = (await open(SCENE)).get_node("Scatter")
	EditorInterface.set_main_screen_editor("3D")
	await settle(scatter)
	EditorInterface.save_scene()
	check(not FileAccess.file_exists(STATE), "no file is written without changes")
	add_instances(300, 0.0)
	scatter.remove_instance(scatter.query_nearest(Vector3.ZERO, 10.0).id)
	var digest: int = scatter.state.get_digest()
	EditorInterface.mark_scene_as_unsaved()
	await save_with_keys()
	check_equal(scatter.state.resource_path, STATE, "the state is saved in a file")
	check_scene(SCENE, "a script")
	var loaded := ResourceLoader.load(STATE, "", ResourceLoader.CACHE_MODE_IGNORE)
	check(loaded.get_digest() == digest and loaded.copy_at_runtime, "the file contains all changes, and a game gets a copy")
	var before := FileAccess.get_file_as_bytes(SCENE)
	EditorInterface.mark_scene_as_unsaved()
	await save_with_keys()
	check(FileAccess.get_file_as_bytes(SCENE) == before and files("res://").count("clearing_scatter_state_2.res") == 0, "saving again has no effect")
	add_instances(1, 5.0)
	EditorInterface.mark_scene_as_unsaved()
	await save_with_keys()
	loaded = ResourceLoader.load(STATE, "", ResourceLoader.CACHE_MODE_IGNORE)
	check_equal(loaded.get_added_count(), 301, "later changes are saved in the same file")
	EditorInterface.reload_scene_from_path(SCENE)
	await frames(5)
	scatter = EditorInterface.get_edited_scene_root().get_node("Scatter")
	check_equal(scatter.state.get_added_count(), 301, "all instances exist after reopening")


## Checks that saving moves a state from the scene to a file. The inspector or an older version may have stored such a state.
func test_a_state_in_the_scene() -> void:
	var root := make_scene()
	var state: Resource = ClassDB.instantiate(&"ScatterState")
	root.get_node("Scatter").state = state
	add_child(root)
	root.get_node("Scatter").add_instance(root.get_node("Scatter").layers[0], Transform3D(Basis(), Vector3(0.0, 0.0, 1.0)))
	remove_child(root)
	save_scene(root, "res://older.tscn")
	check("PackedByteArray" in FileAccess.get_file_as_string("res://older.tscn"), "the state is in the scene")
	root = await open("res://older.tscn")
	EditorInterface.mark_scene_as_unsaved()
	await save_with_keys()
	check_scene("res://older.tscn", "older")
	check_equal(root.get_node("Scatter").state.resource_path, "res://older_scatter_state.res", "the state is moved to a file")


## Tests a new scene, which has no path before it is saved. Until then, there is no folder for the state's file.
func test_a_new_scene() -> void:
	if not EditorInterface.has_method(&"add_root_node"): # add_root_node exists since Godot 4.5.
		return
	await key(KEY_N, KEY_MASK_CTRL)
	await until(func() -> bool: return EditorInterface.get_edited_scene_root() == null, "a new tab opens")
	var root := make_scene()
	EditorInterface.call(&"add_root_node", root)
	await frames(3)
	scatter = root.get_node("Scatter")
	await settle(scatter)
	add_instances(40, 0.0)
	EditorInterface.save_scene_as("res://fresh.tscn")
	await until(func() -> bool: return FileAccess.file_exists("res://fresh_scatter_state.res"), "the state is saved in a file")
	check(EditorInterface.get_open_scenes().has("res://fresh.tscn"), "the new scene is saved")
	await frames(10)
	await save_with_keys() # The editor skips unchanged scenes, so this also checks that the new file marked the scene as unsaved.
	check_scene("res://fresh.tscn", "fresh")
	check_equal(scatter.state.get_added_count(), 40, "all instances exist")
