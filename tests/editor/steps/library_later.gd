@tool
extends "res://tests/steps.gd"
## Installs the library while the editor runs. The plugin must then create its tools, which must still work after a reload. The folder `later`
## contains the library. This script names none of the library's types, because the editor compiles it without the library.
##
## When an extension is loaded, the editor reloads all scripts, and functions that are awaiting never resume. For this reason, the steps run in
## _process.

const SCENE := "res://scene.tscn"
const ADDON := "res://addons/thicket/"

@export_storage var step := 0
@export_storage var deadline := 0


func test_the_library_comes_later() -> void:
	check(addon() != null and workspace() == null, "the plugin has no tools yet")
	var root := Node3D.new()
	root.name = "Scene"
	save_scene(root, SCENE)
	await open(SCENE)
	check_equal(DirAccess.rename_absolute("res://later/bin", ADDON + "bin"), OK, "the library is in its folder")
	check_equal(DirAccess.rename_absolute("res://later/thicket.gdextension", ADDON + "thicket.gdextension"), OK, "the editor can find it")
	deadline = Time.get_ticks_msec() + PATIENCE_MSEC
	step = 1
	EditorInterface.get_resource_filesystem().scan()
	await get_tree().create_timer(2.0 * PATIENCE_MSEC / 1000.0).timeout


func _process(_delta: float) -> void:
	if step == 1 and workspace() != null:
		step = 2
		var scatter: Node3D = ClassDB.instantiate(&"TerrainScatter3D")
		scatter.set(&"layers", [ClassDB.instantiate(&"ScatterLayer")])
		EditorInterface.get_edited_scene_root().add_child(scatter)
		scatter.owner = EditorInterface.get_edited_scene_root()
		EditorInterface.edit_node(scatter)
	elif step == 2 and workspace().toolbar.is_visible_in_tree() and workspace().dock.panel.tree.rows().size() == 1:
		step = 3
		print("library later: the tools exist")
		print("library reloaded: %s" % error_string(GDExtensionManager.reload_extension(ADDON + "thicket.gdextension")))
		var meshes: Array[Resource] = [BoxMesh.new()]
		workspace().dock.panel.add(meshes)
	elif step == 3 and workspace().dock.panel.tree.rows().size() == 2 and workspace().toolbar.chosen.size() == 1:
		step = 4
		print("library reloaded: the panel has added a layer")
		get_tree().quit()
	elif step in [1, 2, 3] and Time.get_ticks_msec() > deadline:
		print("FAILED: library later: step %d" % step)
		step = 5
		get_tree().quit(1)
