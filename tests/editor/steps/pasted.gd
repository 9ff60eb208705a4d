@tool
extends "res://tests/steps.gd"
## Copies a scatter in one scene and pastes it into another, with mouse and keys. The panel reports the shared resources and makes them
## unique in one step.

const FROM := "res://orchard.tscn"
const TO := "res://garden.tscn"
const MOSS := "res://moss.tres"

var original: Node3D
var pasted: Node3D


func panel() -> Control:
	return workspace().dock.panel


## Waits for the plugin to check shared resources. It does so less often than its other updates.
func wait_for_panel() -> void:
	await get_tree().create_timer(2.0).timeout


func select(node: Node) -> void:
	EditorInterface.get_selection().clear()
	EditorInterface.get_selection().add_node(node)
	EditorInterface.edit_node(node)
	await wait_for_panel()


func make_layer(title: String, radius: float) -> Resource:
	var layer: Resource = ClassDB.instantiate(&"ScatterLayer")
	layer.resource_name = title
	layer.meshes = [BoxMesh.new()]
	layer.radius = radius
	layer.view_distance = 40.0
	layer.tile_size = 16.0
	return layer


func test_paste() -> void:
	ResourceSaver.save(make_layer("Moss", 3.0), MOSS)
	var orchard := Node3D.new()
	orchard.name = "Orchard"
	var new_scatter: Node3D = ClassDB.instantiate(&"TerrainScatter3D")
	new_scatter.name = "Trees"
	new_scatter.ground = ClassDB.instantiate(&"ScatterGroundFlat")
	new_scatter.layers = [make_layer("Apple", 3.0), make_layer("Grass", 1.0), load(MOSS)]
	new_scatter.layers[1].spacing = {"Apple": 0.5}
	orchard.add_child(new_scatter)
	new_scatter.owner = orchard
	save_scene(orchard, FROM)
	var root := Node3D.new()
	root.name = "Garden"
	save_scene(root, TO)
	original = (await open(FROM)).get_node("Trees")
	EditorInterface.set_main_screen_editor("3D")
	await select(original)
	await settle(original)
	var brush: RefCounted = workspace().toolbar.paint.brush
	brush.radius = 4.0
	check_equal(brush.begin(original, [original.layers[0], original.layers[1]] as Array[ScatterLayer], FROM, 1, Vector3.ZERO), "", "painted")
	brush.finish(plugin.get_undo_redo())
	var edits: RefCounted = workspace().toolbar.hand.edits
	check(edits.begin(original, FROM), edits.problem)
	edits.add(original.layers[0], Transform3D(Basis(), Vector3(1.0, 0.0, 2.0)), 0)
	edits.commit("Plant")
	saved_files()
	await mouse_click(row_of("Trees"))
	await key(KEY_C, KEY_MASK_CTRL)
	var garden := await open(TO)
	await frames(10)
	await mouse_click(row_of("Garden"))
	await key(KEY_V, KEY_MASK_CTRL)
	pasted = garden.get_node_or_null("Trees")
	if not check(pasted != null, "pasted"):
		return
	await select(pasted)
	await settle(pasted)
	check(panel().notes._sharing.is_visible_in_tree(), "the panel reports shared resources")
	check_equal(panel().notes._shared.describe(pasted.name), "Trees shares its layers, its painted masks, its state and its seed with"
			+ " Trees of orchard.tscn: both show the same instances.", "text of the report")
	check(panel().notes.note_on(pasted.layers[2]).contains("moss.tres"), "a layer in a file has a note in its row only")
	await picture("pasted")


func test_make_unique() -> void:
	var before := saved_files()
	var kept := state_of(original)
	panel().notes.ask_to_make_unique()
	panel().notes.dialog.get_ok_button().pressed.emit()
	panel().notes.dialog.hide()
	await wait_for_panel()
	check(not panel().notes._sharing.visible, "no unintended sharing remains")
	for index in 2:
		check(not pasted.layers[index] in original.layers, "layer %d is not shared" % index)
	check_equal(pasted.layers[0].mask.resource_path, "res://garden_apple_mask.res", "the mask is next to its scene")
	check_equal(pasted.state.resource_path, "res://garden_trees_state.res", "the state, too")
	check_equal(pasted.layers[2], original.layers[2], "a layer in a file stays shared")
	var after := saved_files()
	var text := FileAccess.get_file_as_string(TO)
	check(not "orchard" in text and "garden_grass_mask.res" in text, "the scene refers to its own files")
	await undo()
	check_same(saved_files(), before, "undone")
	await redo()
	check_same(saved_files(), after, "redone")
	pasted.layers[0].radius = 5.0
	check_equal(state_of(original), kept, "the original is unchanged")
	await undo()
	saved_files()


func state_of(scatter: Node3D) -> Array:
	return [scatter.seed, scatter.state.get_digest(), scatter.layers[0].radius, scatter.layers[0].mask.resource_path]


## Checks that, after both scenes are reopened, the layers are separate, but the files of masks and states are still shared.
func test_reopening() -> void:
	if not EditorInterface.has_method(&"close_scene"): # close_scene exists since Godot 4.5.
		return
	pasted = null
	original = null
	for path: String in [FROM, TO]:
		await open(path)
		await wait_for_panel() # Wait until the editor has finished opening the scene.
		EditorInterface.call(&"close_scene")
		await wait_for_panel()
	pasted = (await open(TO)).get_node("Trees")
	await select(pasted)
	check(panel().notes._sharing.is_visible_in_tree(), "reported again")
	check_equal(panel().notes._shared.describe(pasted.name), "Trees shares its painted masks and its state with orchard.tscn.", "text of the report")
	var mask: Resource = pasted.layers[0].mask
	var path := mask.resource_path
	check_equal(DirAccess.rename_absolute(path, "res://old_paint.res"), OK, "the mask's file is renamed")
	mask.take_over_path("res://old_paint.res")
	await wait_for_panel()
	check(panel().notes._shared.masks.has("res://old_paint.res"), "the renamed mask is still known to belong to the other scene: %s" % [panel().notes._shared.masks])
	DirAccess.rename_absolute("res://old_paint.res", path)
	mask.take_over_path(path)
	for layer: Resource in pasted.layers:
		layer.mask = null
	await wait_for_panel()
	check_equal(panel().notes._shared.describe(pasted.name), "Trees shares its state with orchard.tscn.", "a shared state alone is also reported")
	check(panel().notes._sharing.visible, "the panel shows the report")
