@tool
extends "res://tests/steps.gd"
## A scatter that is copied in one scene and pasted into another, with mouse and keys: what it shares with the original is told, and made
## unique in one step.

const FROM := "res://orchard.tscn"
const TO := "res://garden.tscn"
const MOSS := "res://moss.tres"

var original: Node3D
var pasted: Node3D


func panel() -> Control:
	return workspace().dock.panel


## The plugin looks some times a second, and for what is shared less often.
func look() -> void:
	await get_tree().create_timer(2.0).timeout


func select(node: Node) -> void:
	EditorInterface.get_selection().clear()
	EditorInterface.get_selection().add_node(node)
	EditorInterface.edit_node(node)
	await look()


func make_layer(title: String, radius: float) -> Resource:
	var layer: Resource = ClassDB.instantiate(&"ScatterLayer")
	layer.resource_name = title
	layer.meshes = [BoxMesh.new()]
	layer.radius = radius
	layer.view_distance = 40.0
	layer.tile_size = 16.0
	return layer


func save_scene_of(root: Node, path: String) -> void:
	var packed := PackedScene.new()
	packed.pack(root)
	root.free()
	ResourceSaver.save(packed, path)


func test_paste() -> void:
	ResourceSaver.save(make_layer("Moss", 3.0), MOSS)
	var orchard := Node3D.new()
	orchard.name = "Orchard"
	var made: Node3D = ClassDB.instantiate(&"TerrainScatter3D")
	made.name = "Trees"
	made.ground = ClassDB.instantiate(&"ScatterGroundFlat")
	made.layers = [make_layer("Apple", 3.0), make_layer("Grass", 1.0), load(MOSS)]
	made.layers[1].spacing = {"Apple": 0.5}
	orchard.add_child(made)
	made.owner = orchard
	save_scene_of(orchard, FROM)
	var root := Node3D.new()
	root.name = "Garden"
	save_scene_of(root, TO)
	original = (await open(FROM)).get_node("Trees")
	EditorInterface.set_main_screen_editor("3D")
	await select(original)
	await settle(original)
	var brush: RefCounted = workspace().toolbar.paint.brush
	brush.radius = 4.0
	check_equal(brush.begin(original, [original.layers[0], original.layers[1]] as Array[ScatterLayer], FROM, 1, Vector2.ZERO), "", "painted")
	brush.finish(plugin.get_undo_redo())
	var edits: RefCounted = workspace().toolbar.hand.edits
	check(edits.begin(original, FROM), edits.problem)
	edits.add(0, Transform3D(Basis(), Vector3(1.0, 0.0, 2.0)), 0)
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
	check(panel().notes._sharing.is_visible_in_tree(), "the panel tells what is shared")
	check_equal(panel().notes._shared.tell(pasted.name), "Trees shares its layers, what is painted, its state and its seed with"
			+ " Trees of orchard.tscn: both show the same instances.", "told")
	check(panel().notes.note_on(pasted.layers[2]).contains("moss.tres"), "of a layer that is a file in its row alone")
	await picture("pasted")


func test_make_unique() -> void:
	var before := saved_files()
	var kept := state_of(original)
	panel().notes.ask_to_make_unique()
	panel().notes.dialog.get_ok_button().pressed.emit()
	panel().notes.dialog.hide()
	await look()
	check(not panel().notes._sharing.visible, "nothing is shared any more that was not meant")
	for index in 2:
		check(not pasted.layers[index] in original.layers, "layer %d is its own" % index)
	check_equal(pasted.layers[0].mask.resource_path, "res://garden_apple_mask.res", "a mask beside its scene")
	check_equal(pasted.state.resource_path, "res://garden_trees_state.res", "and what was made by hand")
	check_equal(pasted.layers[2], original.layers[2], "what is a file stays shared")
	var after := saved_files()
	var text := FileAccess.get_file_as_string(TO)
	check(not "orchard" in text and "garden_grass_mask.res" in text, "the scene refers to its own files")
	await undo()
	check_same(saved_files(), before, "undone")
	await redo()
	check_same(saved_files(), after, "redone")
	pasted.layers[0].radius = 5.0
	check_equal(state_of(original), kept, "the original is as it was")
	await undo()
	saved_files()


func state_of(scatter: Node3D) -> Array:
	return [scatter.seed, scatter.state.get_digest(), scatter.layers[0].radius, scatter.layers[0].mask.resource_path]


## With the other scene closed the layers are two; what lies in its files is shared all the same.
func test_opened_again() -> void:
	if not EditorInterface.has_method(&"close_scene"): # Since 4.5.
		return
	pasted = null
	original = null
	for path: String in [FROM, TO]:
		await open(path)
		await look() # The editor goes on with a scene that has just been opened.
		EditorInterface.call(&"close_scene")
		await look()
	pasted = (await open(TO)).get_node("Trees")
	await select(pasted)
	check(panel().notes._sharing.is_visible_in_tree(), "told again")
	check_equal(panel().notes._shared.tell(pasted.name), "Trees shares what is painted and its state with orchard.tscn.", "told")
	for layer: Resource in pasted.layers:
		layer.mask = null
	await look()
	check_equal(panel().notes._shared.tell(pasted.name), "Trees shares its state with orchard.tscn.", "a state alone is told, too")
	check(panel().notes._sharing.visible, "in the panel")
