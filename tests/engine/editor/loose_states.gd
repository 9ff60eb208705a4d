@tool
extends "res://tests/steps.gd"
## No instance is saved in a scene, whoever placed it: what a script has changed, or a state that the inspector made, goes into a file beside
## the scene; in a scene that had no file, at its second save.

const SCENE := "res://clearing.tscn"
const STATE := "res://clearing_scatter_state.res"

var scatter: Node3D


func make_scene() -> Node3D:
	var root := Node3D.new()
	root.name = "Clearing"
	var made: Node3D = ClassDB.instantiate(&"TerrainScatter3D")
	made.name = "Scatter"
	made.ground = ClassDB.instantiate(&"ScatterGroundFlat")
	var layer: Resource = ClassDB.instantiate(&"ScatterLayer")
	layer.resource_name = "Stones"
	layer.meshes = [BoxMesh.new()]
	layer.view_distance = 40.0
	layer.tile_size = 16.0
	made.layers = [layer]
	root.add_child(made)
	made.owner = root
	return root


func save_packed(root: Node, path: String) -> void:
	var packed := PackedScene.new()
	packed.pack(root)
	root.free()
	ResourceSaver.save(packed, path)


## As the keys do it.
func save_with_keys() -> void:
	await key(KEY_S, KEY_MASK_CTRL)
	await frames(5)


func check_scene(path: String, what: String) -> void:
	var text := FileAccess.get_file_as_string(path)
	check(text.length() > 100 and text.length() < 2500, "%s: a small scene, %d bytes" % [what, text.length()])
	for word in ["PackedByteArray", "type=\"ScatterState\" id=\"ScatterState", "MultiMesh"]:
		check(not word in text, "%s: no %s in it" % [what, word])


func place(count: int, first: float) -> void:
	for index in count:
		check(scatter.add_instance(0, Transform3D(Basis(), Vector3(first + 0.01 * index, 0.0, 1.0))) != 0, "placed")


func test_what_a_script_places() -> void:
	save_packed(make_scene(), SCENE)
	scatter = (await open(SCENE)).get_node("Scatter")
	EditorInterface.set_main_screen_editor("3D")
	await settle(scatter)
	EditorInterface.save_scene()
	check(not FileAccess.file_exists(STATE), "without a change there is no file")
	place(300, 0.0)
	scatter.remove_instance(scatter.query_nearest(Vector3.ZERO, 10.0).id)
	var digest: int = scatter.state.get_digest()
	EditorInterface.mark_scene_as_unsaved()
	await save_with_keys()
	check_equal(scatter.state.resource_path, STATE, "the state has a file")
	check_scene(SCENE, "a script")
	var loaded := ResourceLoader.load(STATE, "", ResourceLoader.CACHE_MODE_IGNORE)
	check(loaded.get_digest() == digest and loaded.copy_at_runtime, "which holds all of it, and no game writes to it")
	var before := FileAccess.get_file_as_bytes(SCENE)
	EditorInterface.mark_scene_as_unsaved()
	await save_with_keys()
	check(FileAccess.get_file_as_bytes(SCENE) == before and files("res://").count("clearing_scatter_state_2.res") == 0, "saved again, the same")
	place(1, 5.0)
	EditorInterface.mark_scene_as_unsaved()
	await save_with_keys()
	loaded = ResourceLoader.load(STATE, "", ResourceLoader.CACHE_MODE_IGNORE)
	check_equal(loaded.get_added_count(), 301, "what follows goes to the same file")
	EditorInterface.reload_scene_from_path(SCENE)
	await frames(5)
	scatter = EditorInterface.get_edited_scene_root().get_node("Scatter")
	check_equal(scatter.state.get_added_count(), 301, "opened again, all stand")


## One that lies in the scene already, as from the inspector or an older scene.
func test_a_state_in_the_scene() -> void:
	var root := make_scene()
	var state: Resource = ClassDB.instantiate(&"ScatterState")
	root.get_node("Scatter").state = state
	add_child(root)
	root.get_node("Scatter").add_instance(0, Transform3D(Basis(), Vector3(0.0, 0.0, 1.0)))
	remove_child(root)
	save_packed(root, "res://older.tscn")
	check("PackedByteArray" in FileAccess.get_file_as_string("res://older.tscn"), "it is in the scene")
	root = await open("res://older.tscn")
	EditorInterface.mark_scene_as_unsaved()
	await save_with_keys()
	check_scene("res://older.tscn", "older")
	check_equal(root.get_node("Scatter").state.resource_path, "res://older_scatter_state.res", "moved out")


## A new scene has no file to be beside of before it is saved.
func test_a_new_scene() -> void:
	if not EditorInterface.has_method(&"add_root_node"): # Since 4.5.
		return
	await key(KEY_N, KEY_MASK_CTRL)
	await until(func() -> bool: return EditorInterface.get_edited_scene_root() == null, "a new tab")
	var root := make_scene()
	EditorInterface.call(&"add_root_node", root)
	await frames(3)
	scatter = root.get_node("Scatter")
	await settle(scatter)
	place(40, 0.0)
	EditorInterface.save_scene_as("res://fresh.tscn")
	await until(func() -> bool: return FileAccess.file_exists("res://fresh_scatter_state.res"), "a file")
	check(EditorInterface.get_open_scenes().has("res://fresh.tscn"), "saved")
	await frames(10)
	await save_with_keys() # Which the editor does for scenes alone that have changed since.
	check_scene("res://fresh.tscn", "fresh")
	check_equal(scatter.state.get_added_count(), 40, "and all stand")
