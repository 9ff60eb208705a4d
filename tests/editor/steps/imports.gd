@tool
extends "res://tests/steps.gd"
## Imports instances from a node in the scene and from a table, each in one undo step. The editor stores them in a file next to the
## scene, which itself contains none of them.

const SCENE := "res://wood.tscn"
const STATE := "res://wood_scatter_state.res"
const COUNT := 500

var _scene_before := ""


func _make_scene() -> Node3D:
	var root := Node3D.new()
	root.name = "Wood"
	var scatter: Node3D = ClassDB.instantiate(&"TerrainScatter3D")
	scatter.name = "Scatter"
	scatter.set(&"ground", ClassDB.instantiate(&"ScatterGroundFlat"))
	root.add_child(scatter)
	scatter.owner = root
	var old := MultiMeshInstance3D.new()
	old.name = "Old Trees"
	old.multimesh = MultiMesh.new()
	old.multimesh.transform_format = MultiMesh.TRANSFORM_3D
	old.multimesh.mesh = CylinderMesh.new()
	old.multimesh.instance_count = COUNT
	var floats := PackedFloat32Array()
	for index in COUNT:
		floats.append_array([1, 0, 0, index % 25 * 3.3, 0, 1, 0, 0.1 * index, 0, 0, 1, index / 25 * 3.7])
	old.multimesh.buffer = floats
	root.add_child(old)
	old.owner = root
	save_scene(root, SCENE)
	var opened := await open(SCENE)
	EditorInterface.save_scene() # Saves the scene in the editor's format.
	_scene_before = FileAccess.get_file_as_string(SCENE)
	return opened.get_node(^"Scatter")


func _standing(scatter: Node3D) -> PackedFloat32Array:
	return scatter.query_rect(Rect2(-1000, -1000, 2000, 2000)).transforms


func test_a_node() -> void:
	var scatter: Node3D = await _make_scene()
	var old: MultiMeshInstance3D = scatter.get_parent().get_node(^"Old Trees")
	addon()._edit(scatter)
	workspace().toolbar.import_requested.emit()
	var dialog: ConfirmationDialog = workspace().imports
	check(dialog.visible, "the button opens the dialog")
	dialog.choose_node(old)
	check("%d instances" % COUNT in dialog.message(), dialog.message())
	await picture("import", dialog)
	dialog.start()
	check_equal(dialog.imported, COUNT, "imported: " + dialog.message())
	check(not dialog.visible, "the dialog is closed")
	check_equal(scatter.get(&"layers").size(), 1, "one layer is added for the mesh")
	var layer: Resource = scatter.get(&"layers")[0]
	check(layer.get(&"meshes") == [old.multimesh.mesh], "the layer uses this mesh")
	var sorted := _sorted(_standing(scatter))
	check_equal(sorted, _sorted(old.multimesh.buffer), "the transforms are exact to the float")
	check(scatter.get(&"state") != null and scatter.get(&"state").resource_path == STATE, "the state is saved in %s" % STATE)
	history(scatter).undo()
	check(scatter.get(&"layers").is_empty() and scatter.get(&"state") == null, "undo removes the layer and the state")
	check(not FileAccess.file_exists(STATE), "undo deletes the state's file")
	EditorInterface.save_scene()
	check_equal(FileAccess.get_file_as_string(SCENE), _scene_before, "the scene is unchanged, byte for byte")
	history(scatter).redo()
	check_equal(_sorted(_standing(scatter)), sorted, "redo restores the instances")
	EditorInterface.save_scene()
	check(FileAccess.file_exists(STATE), "the state is saved in a file")
	var saved: Resource = ResourceLoader.load(STATE, "", ResourceLoader.CACHE_MODE_IGNORE)
	check(saved != null and saved.get_added_count() == COUNT, "the file contains all instances")
	var text := FileAccess.get_file_as_string(SCENE)
	check("wood_scatter_state.res" in text and text.length() < _scene_before.length() + 2000, "the scene contains no instances")


func test_a_table() -> void:
	var scatter: Node3D = EditorInterface.get_edited_scene_root().get_node(^"Scatter")
	var dialog: ConfirmationDialog = workspace().imports
	var file := FileAccess.open("res://rocks.csv", FileAccess.WRITE)
	file.store_string("x,y,z,scale\n-10,2,-30,1.5\n-11,b,-30,2\n")
	file.close()
	workspace().toolbar.import_requested.emit()
	dialog.choose_table("res://rocks.csv")
	check("line 3" in dialog.message() and "'b'" in dialog.message() and dialog.get_ok_button().disabled, dialog.message())
	dialog.start()
	check_equal(dialog.imported, 0, "an error in one line imports nothing")
	file = FileAccess.open("res://rocks.csv", FileAccess.WRITE)
	file.store_string("x,y,z,scale\n-10,2,-30,1.5\n-11,0,-30,2\n")
	file.close()
	dialog.choose_table("res://rocks.csv")
	check("choose the layer" in dialog.message() and dialog.get_ok_button().disabled, dialog.message())
	dialog.choose_layer(0)
	check(not dialog.get_ok_button().disabled, dialog.message())
	dialog.start()
	check_equal(dialog.imported, 2, "imported: " + dialog.message())
	check_equal(scatter.get(&"state").get_added_count(), COUNT + 2, "the instances are added to the same state")
	check_equal(scatter.get(&"layers").size(), 1, "no layer is added")
	history(scatter).undo()
	check_equal(scatter.get(&"state").get_added_count(), COUNT, "the import is one undo step")
	history(scatter).redo()
	check_equal(scatter.get(&"state").get_added_count(), COUNT + 2, "redo adds the instances again")


## Returns the transforms in sorted order, 12 floats each.
func _sorted(floats: PackedFloat32Array) -> Array:
	var result := []
	for at in range(0, floats.size(), 12):
		result.append(Array(floats.slice(at, at + 12)))
	result.sort()
	return result
