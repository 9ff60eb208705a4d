@tool
extends "res://tests/steps.gd"
## Tests the add-on in an editor without its library: the plugin must not disturb the editor. This script names none of the library's types, because
## the editor compiles it without the library.

const SCENE := "res://scene.tscn"


func test_the_editor_is_usable() -> void:
	check(not ClassDB.class_exists(&"TerrainScatter3D"), "the library is not loaded")
	check(addon() != null and workspace() == null, "the plugin is enabled and has no tools")
	var root := Node3D.new()
	root.name = "Scene"
	var world := ScatterFoliageWorld.new()
	world.name = "World"
	root.add_child(world)
	world.owner = root
	var packed := PackedScene.new()
	check_equal(packed.pack(root), OK, "packed")
	root.free()
	check_equal(ResourceSaver.save(packed, SCENE), OK, "saved")
	var opened := await open(SCENE)
	check(opened.get_node("World") is ScatterFoliageWorld, "a node of the add-on for games keeps its class")
	var child := MeshInstance3D.new()
	opened.add_child(child)
	child.owner = opened
	EditorInterface.edit_node(child)
	EditorInterface.mark_scene_as_unsaved()
	await frames(30)
	check_equal(EditorInterface.save_scene(), OK, "a scene is edited and saved")
