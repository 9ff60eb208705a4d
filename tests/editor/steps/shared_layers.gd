@tool
extends "res://tests/steps.gd"
## Tests a duplicated scatter, which shares its layers, seed and masks with the original. The panel must report this and make them unique in one step.
## Also checks that a change that would show far more instances needs a confirmation.

const SCENE := "res://glade.tscn"
const LAYER_FILE := "res://shared_moss.tres"

var root: Node
var scatter: Node3D
var other: Node3D


func panel() -> Control:
	return workspace().dock.panel


func make_layer(title: String, radius: float, view: float) -> Resource:
	var layer: Resource = ClassDB.instantiate(&"ScatterLayer")
	layer.resource_name = title
	layer.meshes = [BoxMesh.new()]
	layer.radius = radius
	layer.view_distance = view
	layer.tile_size = 32.0
	return layer


## Opens a scene with grass, with trees that keep a distance from the layer named "Grass", and with moss, a layer in a file.
func make_scene() -> void:
	var new_root := Node3D.new()
	new_root.name = "Glade"
	var new: Node3D = ClassDB.instantiate(&"TerrainScatter3D")
	new.name = "Scatter"
	new.ground = ClassDB.instantiate(&"ScatterGroundFlat")
	var moss := make_layer("Moss", 6.0, 60.0)
	ResourceSaver.save(moss, LAYER_FILE)
	var layers: Array = new.layers.duplicate()
	layers.append_array([make_layer("Grass", 2.0, 60.0), make_layer("Trees", 5.0, 60.0), load(LAYER_FILE)])
	layers[1].spacing = {"Grass": 0.5}
	new.layers = layers
	new_root.add_child(new)
	new.owner = new_root
	save_scene(new_root, SCENE)
	root = await open(SCENE)
	scatter = root.get_node("Scatter")
	select(scatter)
	EditorInterface.set_main_screen_editor("3D")
	await settle(scatter)


func select(node: Node) -> void:
	EditorInterface.get_selection().clear()
	EditorInterface.get_selection().add_node(node)
	EditorInterface.edit_node(node)
	await wait_for_panel()


## Waits for the plugin's next update of the panel's notes.
func wait_for_panel() -> void:
	await get_tree().create_timer(1.5).timeout


## Duplicates the scatter as Ctrl+D in the Scene dock does, so the copy shares the scene's resources.
func duplicate_scatter() -> void:
	var undo_redo := plugin.get_undo_redo()
	other = scatter.duplicate()
	undo_redo.create_action("Duplicate Node(s)", UndoRedo.MERGE_DISABLE, root)
	undo_redo.add_do_method(root, &"add_child", other, true)
	undo_redo.add_do_property(other, &"owner", root)
	undo_redo.add_do_reference(other)
	undo_redo.add_undo_method(root, &"remove_child", other)
	undo_redo.commit_action()


func test_a_duplicate_is_reported() -> void:
	await make_scene()
	var paint: Node = workspace().toolbar.paint
	paint.set_on(true)
	paint.set_brush(8.0, 1.0, 1.0)
	paint.choose_mode(1)
	workspace().toolbar.choose_layer(0)
	await stroke([Vector3.ZERO])
	paint.set_on(false)
	check(FileAccess.file_exists("res://glade_grass_mask.res"), "the mask is in a file")
	saved_files()
	var edits: RefCounted = workspace().toolbar.hand.edits
	check(edits.begin(scatter, SCENE), "hand-placed instances are saved in a file: " + edits.problem)
	check(edits.add(scatter.layers[0], Transform3D(Basis(), Vector3(1.0, 0.0, 2.0)), 0) != 0, "an instance is planted")
	edits.commit("Plant")
	scatter.remove_instance(scatter.query_rect(Rect2(20.0, 20.0, 10.0, 10.0), scatter.layers[0]).ids[0])
	saved_files()
	check(not panel().notes._sharing.visible, "a single scatter does not share resources")
	duplicate_scatter()
	await wait_for_panel()
	await select(other)
	check(panel().notes._sharing.is_visible_in_tree(), "the panel reports shared resources")
	var report: String = panel().notes._shared.describe(other.name)
	check_equal(report, "Scatter2 shares its layers, its state and its seed with Scatter: both show the same instances.", "the text of the report")
	check(panel().notes.note_on(other.layers[2]).contains("shared_moss.tres"), "a layer in a file has a note in its row only")
	await picture("panel_shared")


func test_make_unique() -> void:
	var before := saved_files()
	panel().notes.ask_to_make_unique()
	check(panel().notes.dialog.visible and panel().notes.dialog._files.visible, "a dialog asks which resources to copy")
	await picture("make_unique", panel().notes.dialog)
	panel().notes.dialog.get_ok_button().pressed.emit()
	panel().notes.dialog.hide()
	await wait_for_panel()
	check(not panel().notes._sharing.visible, "no unintended sharing remains")
	for index in 2:
		check(other.layers[index] != scatter.layers[index], "layer %d is not shared" % index)
		check_equal(other.layers[index].resource_name, scatter.layers[index].resource_name, "the copy's name")
		check_equal(other.layers[index].layer_id, scatter.layers[index].layer_id, "the copy's layer_id")
	check_equal(other.layers[2], scatter.layers[2], "a layer in a file stays shared")
	check(other.seed != scatter.seed, "the copy has a new seed")
	check_equal(other.layers[0].mask.resource_path, "res://glade_grass_mask_2.res", "the mask has a new file")
	check(other.layers[0].mask.sample(Vector2.ZERO) == 0.0, "the new mask has the same pixels")
	check_equal(other.state.resource_path, "res://glade_scatter_2_state.res", "the state has a new file")
	check_equal([other.state.get_added_count(), other.state.get_removed_count()], [1, 0], "hand-placed instances stay with any seed, removals do not")
	check_equal([scatter.state.get_added_count(), scatter.state.get_removed_count()], [1, 1], "the original keeps its placed and removed instances")
	scatter.layers[1].radius = 9.0
	check(other.layers[1].radius == 5.0, "a change to the original does not affect the copy")
	scatter.layers[1].radius = 5.0
	var after := saved_files()
	check(after.has("glade_grass_mask_2.res") and not before.has("glade_grass_mask_2.res"), "saving adds the new mask's file")
	await undo()
	check_equal(other.layers, scatter.layers, "undo shares the layers again")
	check_equal(other.state, scatter.state, "the state, too")
	check_same(saved_files(), before, "undone")
	await redo()
	check_same(saved_files(), after, "redone")
	await undo()
	await undo()
	check(not other.is_inside_tree(), "undo also removes the duplicate")


## Checks that a layer that is saved in its own file may be shared without a report.
func test_shared_files_are_intended() -> void:
	other = ClassDB.instantiate(&"TerrainScatter3D")
	var layers: Array = other.layers.duplicate()
	layers.append(load(LAYER_FILE))
	other.layers = layers
	root.add_child(other)
	await select(other)
	check(not panel().notes._sharing.visible, "a layer in a file may be used twice")
	await select(scatter)
	other.free()


## Checks that a change that would show far more instances, and more than 50,000, needs a confirmation. Until then, the layer has the new value, but the
## view does not change.
func test_far_more() -> void:
	var grass: Resource = scatter.layers[0]
	var bar: Control = workspace().dock.bar
	var steps: RefCounted = workspace().dock.steps
	await settle(scatter)
	await wait_for_panel()
	var before: int = scatter.get_shown_count(scatter.layers[0])
	var ids := instances(scatter, 0)
	check(before > 1000 and not bar.visible, "%d are visible" % before)
	var undo_redo := plugin.get_undo_redo()
	undo_redo.create_action("Set radius", UndoRedo.MERGE_DISABLE, grass)
	undo_redo.add_do_property(grass, &"radius", 0.2)
	undo_redo.add_undo_property(grass, &"radius", 2.0)
	undo_redo.commit_action()
	check(bar.visible, "a question is shown")
	await settle(scatter)
	await wait_for_panel()
	check(instances(scatter, 0) == ids, "the view does not change")
	check_equal(grass.radius, 0.2, "the layer has the new value")
	check(steps.limited_of(scatter, grass).estimate() > 90.0 * before, "about a hundred times as many are reported")
	await picture("preview_asked")
	check(EditorInterface.save_scene() == OK and FileAccess.get_file_as_string(SCENE).contains("radius = 0.2"), "the new value is saved")
	await undo()
	await settle(scatter)
	check_equal(grass.radius, 2.0, "undone")
	check(not bar.visible and instances(scatter, 0) == ids, "the question is hidden")
	await redo()
	check(bar.visible, "redo shows the question again")
	await mouse_click(bar._keep.get_global_transform_with_canvas() * (bar._keep.size * 0.5))
	await wait_for_panel()
	check(bar.visible and not bar._keep.visible and scatter.get_shown_count(scatter.layers[0]) == before, "Keep leaves the old instances visible")
	grass.radius = 0.5
	await wait_for_panel()
	check(bar.visible, "a smaller change still needs a confirmation")
	await mouse_click(bar._show.get_global_transform_with_canvas() * (bar._show.size * 0.5))
	var counts: Array[int] = []
	await until(func() -> bool:
		var count: int = scatter.get_shown_count(scatter.layers[0])
		if scatter.is_settled() and (counts.is_empty() or counts[-1] != count):
			counts.append(count)
		return not bar.visible, "all are shown")
	await settle(scatter)
	check(scatter.get_shown_count(scatter.layers[0]) > 14 * before, "all instances are visible in the end: %d, before the change %d" % [scatter.get_shown_count(scatter.layers[0]), before])
	check(counts.any(func(count: int) -> bool: return count > 2 * before and count < 6 * before), "instances appear step by step: %s" % [counts])


## Checks that the user can stop the display of more instances, and that a change that shows only slightly more instances needs no confirmation.
func test_stop() -> void:
	var trees: Resource = scatter.layers[1]
	var bar: Control = workspace().dock.bar
	trees.spacing = {}
	await settle(scatter)
	await wait_for_panel()
	var before: int = scatter.get_shown_count(scatter.layers[1])
	trees.radius = 4.0
	check(not bar.visible, "slightly more instances need no confirmation")
	await settle(scatter)
	await wait_for_panel()
	trees.radius = 0.25
	check(bar.visible, "far more instances need a confirmation")
	bar._show.pressed.emit()
	bar._keep.pressed.emit()
	await settle(scatter)
	await wait_for_panel()
	var shown_count: int = scatter.get_shown_count(scatter.layers[1])
	check(shown_count > before and shown_count < 20 * before and bar.visible, "stopped at %d" % shown_count)
	check_equal(trees.radius, 0.25, "the value stays")
	workspace().dock.steps.clear()
	check(not bar.visible, "without the plugin, the layer is shown unchanged")
	trees.radius = 5.0
	await settle(scatter)
