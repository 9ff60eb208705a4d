@tool
extends "res://tests/steps.gd"
## Checks that one click bakes a layer's impostors into files next to the scene and adds them as the last LOD, with undo. If the scene has no path for
## files, the button shows a message.

const SCENE := "res://wood.tscn"


func test_one_click() -> void:
	var root := Node3D.new()
	root.name = "Wood"
	var scatter: Node3D = ClassDB.instantiate(&"TerrainScatter3D")
	scatter.name = "Scatter"
	root.add_child(scatter)
	scatter.owner = root
	var layer: Resource = ClassDB.instantiate(&"ScatterLayer")
	layer.resource_name = "Old Oaks"
	layer.set(&"meshes", [BoxMesh.new()] as Array[Mesh])
	scatter.set(&"layers", [layer])
	save_scene(root, SCENE)
	scatter = (await open(SCENE)).get_node("Scatter")
	layer = scatter.get(&"layers")[0]
	var version := history(scatter).get_version()
	EditorInterface.edit_resource(layer)
	await frames(5)
	var found := EditorInterface.get_inspector().find_children("*", "VBoxContainer", true, false).filter(
			func(box: Node) -> bool: return box.has_method(&"press"))
	if not check(found.size() == 1, "the inspector has %d buttons" % found.size()):
		return
	var button: Node = found[0]
	check(not button.is_processing() and history(scatter).get_version() == version, "nothing happens before it is pressed")
	button.job.impostor.frames = 3
	button.job.impostor.frame_size = 16
	button.press()
	check(button.is_processing(), "the button starts the bake: " + button.job.problem)
	var job: RefCounted = button.job
	await until(func() -> bool: return job.progress == 1.0 or not job.problem.is_empty(), "the bake is finished")
	check_equal(job.problem, "", "the bake reports no problem")
	check_equal(job.files, PackedStringArray(["res://wood_old_oaks_impostor_0.res"]), "the impostor is saved next to the scene")
	var lods: Array = layer.call(&"get_mesh_lods", 0)
	check_equal(lods.size(), 2, "the impostor is added as an LOD")
	check_equal(lods[1].get(&"mesh").resource_path, "res://wood_old_oaks_impostor_0.res", "the layer refers to the file")
	var manager := plugin.get_undo_redo()
	manager.get_history_undo_redo(manager.get_object_history_id(layer)).undo()
	check(layer.get(&"meshes")[0] is BoxMesh, "undo restores the mesh")


func test_a_layer_without_a_file() -> void:
	var root := EditorInterface.get_edited_scene_root()
	root.scene_file_path = ""
	var button: Node = load("res://addons/thicket/editor/inspector/impostor_button.gd").new(ClassDB.instantiate(&"ScatterLayer"))
	plugin.add_child(button)
	button.press()
	check(not button.is_processing(), "no bake starts")
	root.scene_file_path = SCENE
	button.press()
	check(not button.is_processing() and "no mesh" in button.job.problem, button.job.problem)
	button.free()
