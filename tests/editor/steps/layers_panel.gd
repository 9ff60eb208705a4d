@tool
extends "res://tests/steps.gd"
## Tests the panel that lists a scatter's layers, with mouse and keys. Starts with an empty scene and adds three species that keep apart, without typing.
## Then tests marks, order, copies, deletion, strokes on several layers, and the saved files after undo and redo.

const LayersPanel := preload("res://addons/thicket/editor/layers/layers_panel.gd")
const SCENE := "res://wood.tscn"
const MODELS: PackedStringArray = ["res://old_oak.res", "res://young_pine.res", "res://fern.tscn"]

var root: Node
var scatter: Node3D


func panel() -> LayersPanel:
	return workspace().dock.panel


func tree() -> Tree:
	return panel().tree


func names() -> PackedStringArray:
	return PackedStringArray(scatter.layers.map(func(layer: Resource) -> String: return layer.resource_name))


func layer(title: String) -> Resource:
	return scatter.layers[names().find(title)]


## Returns the panel's button with this text, or null.
func button(text: String) -> Button:
	for found: Button in panel().find_children("*", "Button", true, false):
		if found.text == text:
			return found
	check(false, "the panel has no button " + text)
	return null


## Undoes and redoes the last step and compares the saved files with those before and after that step.
func check_undo(before: Dictionary, context: String) -> void:
	var after := saved_files()
	check(after != before, context + " changes the saved files")
	await undo()
	await frames(2)
	check_same(saved_files(), before, context + " undone")
	await redo()
	await frames(2)
	check_same(saved_files(), after, context + " redone")


func save_models() -> void:
	var oak := CylinderMesh.new()
	oak.top_radius = 2.0
	oak.bottom_radius = 0.3
	oak.height = 5.0
	var pine := CylinderMesh.new()
	pine.top_radius = 0.0
	pine.bottom_radius = 1.5
	pine.height = 6.0
	for mesh: CylinderMesh in [oak, pine]:
		mesh.radial_segments = 6
		mesh.rings = 0
	ResourceSaver.save(oak, MODELS[0])
	ResourceSaver.save(pine, MODELS[1])
	var fern := MeshInstance3D.new()
	fern.name = "Fern"
	fern.mesh = QuadMesh.new()
	fern.mesh.size = Vector2(1.6, 0.3)
	save_scene(fern, MODELS[2])
	for path in MODELS:
		EditorInterface.get_resource_filesystem().update_file(path)


func make_scene() -> void:
	var new_root := Node3D.new()
	new_root.name = "Wood"
	var ground := MeshInstance3D.new()
	ground.name = "Ground"
	ground.mesh = PlaneMesh.new()
	ground.mesh.size = Vector2(140.0, 140.0)
	new_root.add_child(ground)
	ground.owner = new_root
	save_scene(new_root, SCENE)
	root = await open(SCENE)
	EditorInterface.set_main_screen_editor("3D")
	await frames(3)
	# Save once, because the editor stores numbers with fewer digits than a new scene has. Later saves do not change the files.
	saved_files()


## Starts with an empty scene and adds three species that keep apart, with the mouse only.
func test_first_minute() -> void:
	save_models()
	await make_scene()
	addon().make_bottom_panel_item_visible(panel())
	await frames(3)
	check(panel().welcome.is_visible_in_tree(), "without a scatter the panel explains what to do")
	await mouse_click(middle(button("New Scatter")))
	scatter = root.get_node_or_null("Scatter")
	if not check(scatter != null, "one click creates a scatter"):
		return
	check_equal(EditorInterface.get_selection().get_selected_nodes(), [scatter] as Array[Node], "the new scatter is selected")
	await wait_for_panel()
	check(panel().notes._ground.is_visible_in_tree(), "the panel reports that there is no ground")
	await picture("panel_empty")
	EditorInterface.edit_node(root.get_node("Ground"))
	EditorInterface.get_selection().clear()
	EditorInterface.get_selection().add_node(root.get_node("Ground"))
	await wait_for_panel()
	await mouse_click(middle(workspace().ground_buttons._use))
	check(scatter.ground != null and scatter.ground.is_class("ScatterGroundMeshes"), "a click makes the selected mesh the ground")
	EditorInterface.get_selection().clear()
	EditorInterface.get_selection().add_node(scatter)
	EditorInterface.edit_node(scatter)
	await wait_for_panel()
	check(not panel().notes._ground.visible, "the panel no longer reports a missing ground")
	await drag_files(MODELS, middle(tree()))
	check_equal(names(), PackedStringArray(["Old Oak", "Young Pine", "Fern"]), "a layer for each file, the widest first")
	check_equal(tree().chosen_layers(), scatter.layers, "all of them are selected")
	check_equal(workspace().toolbar.chosen, scatter.layers, "the tools use the selected layers")
	check(not button("Delete").disabled and not button("Duplicate").disabled, "they can be deleted and duplicated")
	await settle(scatter)
	await wait_for_panel()
	await mouse_click(middle(button("Not Here")))
	check(not panel().notes._gray.visible, "the note that the scene has no camera is dismissed")
	var crowded := RegEx.create_from_string("Young Pine: [5-9]\\d % of its points are too close to other layers")
	await until(func() -> bool: return crowded.search(toast_text()) != null, "a layer with little room is reported")
	for index in 3:
		var count: int = scatter.get_shown_count(scatter.layers[index])
		check(count > 100, "%s: %d instances" % [names()[index], count])
		check_equal(tree().row_of(scatter.layers[index]).get_text(1), grouped(count), "its row shows the count")
	await until(func() -> bool:
		RenderingServer.force_draw() # Thumbnails are drawn only when a frame is drawn.
		return scatter.layers.all(tree().has_picture), "a thumbnail of each layer")
	for each: Resource in scatter.layers:
		check(tree().row_of(each).get_icon(0) != null, each.resource_name + " has a thumbnail in its row")
	await picture("panel_layers")
	check_apart("Old Oak", "Young Pine", 0.5 * (layer("Old Oak").radius + layer("Young Pine").radius))
	check_apart("Old Oak", "Fern", 0.2 * layer("Old Oak").radius)
	check_apart("Young Pine", "Fern", 0.2 * layer("Young Pine").radius)
	check_equal(EditorInterface.get_inspector().get_edited_object().layers, scatter.layers, "the inspector edits all of them")
	check(workspace().toolbar.visible, "the tools stay visible")


func grouped(number: int) -> String:
	return load("res://addons/thicket/number_text.gd").grouped(number)


## Checks that the instances of two layers near the origin keep this distance, in meters, but are not much farther apart.
func check_apart(one: String, other: String, meters: float) -> void:
	var min_distance := 1e9
	var around := Rect2(-30.0, -30.0, 60.0, 60.0)
	var others := instances(scatter, names().find(other)).values()
	for at: Vector3 in instances(scatter, names().find(one)).values():
		if around.has_point(Vector2(at.x, at.z)):
			for there: Vector3 in others:
				min_distance = minf(min_distance, Vector2(at.x - there.x, at.z - there.z).length())
	check(min_distance >= meters - 0.01 and min_distance < meters + 1.0, "%s and %s are %.2f m apart, expected %.2f" % [one, other, min_distance, meters])


## Waits for the plugin's next update. It updates only a few times per second.
func wait_for_panel() -> void:
	await get_tree().create_timer(0.6).timeout


func test_choosing() -> void:
	await mouse_click(await name_at(layer("Young Pine")))
	await frames(2)
	check_equal(workspace().toolbar.chosen, [layer("Young Pine")] as Array[ScatterLayer], "a click selects the layer for the tools")
	check_equal(workspace().toolbar.paint.layer, layer("Young Pine"), "the brush uses it, too")
	check_equal(EditorInterface.get_inspector().get_edited_object(), layer("Young Pine"), "the inspector shows it")
	check(is_instance_valid(workspace()._scatter) and panel()._scatter == scatter, "the scatter is still being edited")
	workspace().toolbar.choose_layer(2)
	await frames(2)
	check_equal(tree().chosen_layers(), [layer("Fern")] as Array[ScatterLayer], "the panel is updated with the toolbar's selection")
	await mouse_click(await name_at(layer("Old Oak")), MOUSE_BUTTON_LEFT, KEY_MASK_CTRL)
	await frames(2)
	check_equal(workspace().toolbar.chosen, [layer("Old Oak"), layer("Fern")] as Array[ScatterLayer], "a click with Ctrl adds a layer to the selection")


## Checks that, with several layers selected, the inspector shows the values of the first layer and changes all of them.
func test_a_value_of_several_layers() -> void:
	await mouse_click(await name_at(layer("Young Pine")), MOUSE_BUTTON_LEFT, KEY_MASK_CTRL)
	await frames(5)
	var inspector := EditorInterface.get_inspector()
	check(scatter.layers.all(inspector.get_edited_object().layers.has), "three layers: %s" % [inspector.get_edited_object().layers])
	var editors: Dictionary[String, EditorProperty] = {}
	for editor: EditorProperty in inspector.find_children("*", "EditorProperty", true, false):
		editors[editor.get_edited_property()] = editor
	check(editors.has("density") and editors.has("max_scale"), "the inspector shows the properties of the layers: %s" % [editors.keys()])
	for own: String in ["meshes", "seed", "spacing", "resource_name"]:
		check(not editors.has(own), "the inspector does not show " + own)
	var before := saved_files()
	var old: Array = scatter.layers.map(func(each: Resource) -> float: return each.max_scale)
	for value: float in [1.7, 1.75]: # Changes the value as dragging the slider does.
		editors["max_scale"].emit_changed("max_scale", value, "", value < 1.75)
		await frames(5) # The inspector must keep the editor that is being dragged.
	for each: Resource in scatter.layers:
		check_equal(each.max_scale, 1.75, each.resource_name + " has the new value")
	await check_undo(before, "a value of three layers")
	await undo()
	await frames(2)
	check_equal(scatter.layers.map(func(each: Resource) -> float: return each.max_scale), old, "undo restores the value of each layer")
	for control: Button in EditorInterface.get_inspector().find_children("*", "Button", true, false):
		if control.text == "Grass":
			control.pressed.emit()
	await frames(2)
	check(scatter.layers.all(func(each: Resource) -> bool: return each.density == 1.0), "the button applies a kind to all layers")
	await undo()


func test_marks() -> void:
	var before := saved_files()
	await mouse_click(await name_at(layer("Fern")))
	await mouse_click(await mark_at(layer("Fern"), 2))
	await settle(scatter)
	check(workspace().dock.marks.is_hidden(layer("Fern")), "a click on the eye hides the layer")
	var drawn: int = scatter.get_stats().drawn
	check_equal(drawn, scatter.get_shown_count(scatter.layers[0]) + scatter.get_shown_count(scatter.layers[1]), "its instances are not drawn")
	check(scatter.get_shown_count(scatter.layers[2]) > 100, "its instances still exist")
	await wait_for_panel()
	check_equal(tree().row_of(layer("Fern")).get_text(1), "hidden in the editor", "the row reports that the layer is hidden only in the editor")
	await mouse_click(await mark_at(layer("Young Pine"), 1))
	check(workspace().dock.marks.is_locked(layer("Young Pine")), "a click on the lock locks the layer")
	panel()._colored = [layer("Old Oak")]
	panel()._on_color(5)
	await wait_for_panel()
	await picture("panel_marks")
	check_same(saved_files(), before, "marks are not saved in the scene")
	await undo()
	await undo()
	await undo()
	check(not workspace().dock.marks.is_hidden(layer("Fern")), "undo shows the layer again")
	await redo()
	await redo()
	check(workspace().dock.marks.is_locked(layer("Young Pine")), "redo locks the layer")
	var state: Dictionary = addon()._get_state()
	workspace().dock.marks.put(layer("Fern"), &"hidden", null)
	workspace().dock.marks.put(layer("Young Pine"), &"locked", null)
	addon()._set_state(state)
	check(workspace().dock.marks.is_hidden(layer("Fern")), "the editor restores which layer is hidden")
	check(workspace().dock.marks.is_locked(layer("Young Pine")), "the editor restores which layer is locked")
	workspace().dock.marks.put(layer("Fern"), &"hidden", null)
	workspace().dock.marks.put(layer("Young Pine"), &"locked", null)
	await settle(scatter)
	check_equal(scatter.get_stats().drawn, scatter.get_stats().instances, "everything is drawn again")


func test_order() -> void:
	var before := saved_files()
	var ids: Array = scatter.layers.map(func(each: Resource) -> int: return each.layer_id)
	await mouse_drag(await name_at(layer("Fern")), await name_at(layer("Old Oak"), 0.1))
	check_equal(names(), PackedStringArray(["Fern", "Old Oak", "Young Pine"]), "the dragged layer is the first")
	check_equal(scatter.layers.map(func(each: Resource) -> int: return each.layer_id), [ids[2], ids[0], ids[1]], "layers keep their IDs")
	await check_undo(before, "the order")
	await undo()
	check_equal(names(), PackedStringArray(["Old Oak", "Young Pine", "Fern"]), "undo restores the order")


## Checks that reordering layers keeps all references. Deleting a layer must remove the references to it, and undo must restore them.
func test_references() -> void:
	layer("Fern").spacing = {"Old Oak": 0.8, "Young Pine": 0.6}
	layer("Fern").proximity_layer = "Young Pine"
	var before := saved_files()
	await mouse_drag(await name_at(layer("Young Pine")), await name_at(layer("Old Oak"), 0.1))
	check_equal([layer("Fern").spacing.keys(), layer("Fern").proximity_layer], [["Old Oak", "Young Pine"], "Young Pine"], "the references stay after reordering")
	await check_undo(before, "a reference")
	await undo()
	await mouse_click(await name_at(layer("Young Pine")))
	await mouse_click(middle(button("Delete")))
	check_equal(names(), PackedStringArray(["Old Oak", "Fern"]), "the selected layer is deleted")
	check_equal([layer("Fern").spacing.keys(), layer("Fern").proximity_layer], [["Old Oak"], ""], "the references are removed")
	await check_undo(before, "deletion")
	await undo()
	layer("Fern").spacing = {"Old Oak": 0.8, "Young Pine": 0.6}
	layer("Fern").proximity_layer = ""


func test_copies() -> void:
	var before := saved_files()
	await mouse_click(await name_at(layer("Old Oak")))
	await key(KEY_D, KEY_MASK_CTRL)
	check_equal(names(), PackedStringArray(["Old Oak", "Old Oak 2", "Young Pine", "Fern"]), "the copy is inserted after the original")
	await settle(scatter)
	check(layer("Old Oak 2").layer_id != layer("Old Oak").layer_id, "the copy has a new ID")
	check_equal(layer("Old Oak 2").meshes, layer("Old Oak").meshes, "the copy has the same mesh")
	await check_undo(before, "a copy")
	var node_name := String(scatter.name)
	await mouse_click(await name_at(layer("Old Oak 2")))
	await key(KEY_F2)
	await frames(3)
	var edits: Array = tree().find_children("*", "LineEdit", true, false).filter(func(edit: LineEdit) -> bool: return edit.is_visible_in_tree())
	check(edits.size() == 1 and String(scatter.name) == node_name, "F2 edits the name of the row")
	await key(KEY_ESCAPE)
	panel()._on_renamed(layer("Old Oak 2"), "Beech")
	await frames(3)
	check_equal(names()[1], "Beech", "the layer is renamed")
	panel()._on_renamed(layer("Beech"), "Fern")
	check_equal(names()[1], "Fern 2", "a name that is already used gets a number")
	await mouse_click(await name_at(layer("Fern 2")))
	await key(KEY_DELETE)
	check_equal(names(), PackedStringArray(["Old Oak", "Young Pine", "Fern"]), "the Delete key deletes the layer")
	check_equal(EditorInterface.get_inspector().get_edited_object(), layer("Young Pine"), "the inspector shows the next layer")
	for step in 4:
		await undo()
	check_same(saved_files(), before, "all steps are undone")


## Checks that a stroke on two layers is one undo step and does not change a locked layer.
func test_stroke_on_several_layers() -> void:
	var before := saved_files()
	await mouse_click(await name_at(layer("Old Oak")))
	await mouse_click(await name_at(layer("Young Pine")), MOUSE_BUTTON_LEFT, KEY_MASK_CTRL)
	await mouse_click(await name_at(layer("Fern")), MOUSE_BUTTON_LEFT, KEY_MASK_CTRL)
	workspace().dock.marks.put(layer("Fern"), &"locked", true)
	var paint: Node = workspace().toolbar.paint
	paint.set_on(true)
	paint.choose_mode(1)
	paint.set_brush(8.0, 1.0, 1.0)
	var version := history(scatter).get_version()
	await stroke([Vector3(-4.0, 0.0, 0.0), Vector3(4.0, 0.0, 0.0)])
	check_equal(paint.problem, "", "the stroke is painted")
	check_equal(history(scatter).get_version(), version + 1, "the stroke is one undo step")
	check(layer("Old Oak").mask != null and layer("Young Pine").mask != null, "both layers get a mask")
	check(layer("Fern").mask == null, "the locked layer gets no mask")
	check(layer("Old Oak").mask.sample(Vector2.ZERO) == 0.0 and layer("Young Pine").mask.sample(Vector2.ZERO) == 0.0, "the stroke erases both layers at its center")
	await settle(scatter)
	await check_undo(before, "a stroke")
	await undo()
	check_same(saved_files(), before, "undo restores the saved files")
	await mouse_click(await name_at(layer("Fern")))
	await stroke([Vector3.ZERO])
	check(paint.problem.contains("locked"), "a locked layer is reported: " + paint.problem)
	workspace().dock.marks.put(layer("Fern"), &"locked", null)
	paint.set_on(false)


## Checks that every way to add a layer is one undo step, and that undo restores the files.
func test_adding() -> void:
	var file: Resource = ClassDB.instantiate(&"ScatterLayer")
	file.meshes = [BoxMesh.new()]
	ResourceSaver.save(file, "res://stones.tres")
	var before := saved_files()
	await drag_files([MODELS[1]], await name_at(layer("Old Oak"), 0.1))
	check(names().size() == 4 and names().has("Young Pine 2"), "a file dropped on a row becomes a layer: %s" % [names()])
	var apart: Array = layer("Young Pine 2").spacing.keys()
	check(apart.has("Old Oak") and apart.has("Young Pine"), "the new layer keeps a distance from the others: %s" % [apart])
	await check_undo(before, "a drop")
	await undo()
	panel()._on_file_chosen("res://stones.tres")
	check_equal(scatter.layers[2].resource_path, "res://stones.tres", "a layer in a file comes before a far smaller one")
	check_equal(scatter.layers[2].spacing, {}, "the layer itself does not change")
	panel()._on_file_chosen("res://stones.tres")
	check_equal(scatter.layers.size(), 4, "a file is added only once")
	await undo()
	panel()._on_add(panel().Add.FIRST_PRESET + 1)
	check_equal(names().slice(3), PackedStringArray(["Oak", "Bush", "Flowers", "Grass"]), "the preset adds its layers")
	check(not scatter.layers[3].on_surfaces and scatter.layers[3].progressive_levels == 3, "it grows on the top of the ground")
	await undo()
	panel()._on_add(panel().Add.EMPTY)
	check_equal(names()[2], "Layer", "an empty layer is added")
	await undo()
	check_same(saved_files(), before, "all steps are undone")
	await mouse_click(middle(button("New Scatter")))
	check(root.get_child_count() == 3 and root.get_child(2).ground == scatter.ground, "the second scatter uses the same ground")
	check(root.get_child(2).seed != scatter.seed, "the second scatter has a different seed")
	await check_undo(before, "a scatter")
	await undo()
	EditorInterface.edit_node(scatter)
	await wait_for_panel()


## Checks that a layer of far wider models is inserted before the other layers and takes priority. The editor must report the instances that those
## layers lose.
func test_losses() -> void:
	var giant := CylinderMesh.new()
	giant.top_radius = 5.0
	giant.bottom_radius = 0.75
	giant.height = 12.5
	ResourceSaver.save(giant, "res://giant.res")
	EditorInterface.get_resource_filesystem().update_file("res://giant.res")
	await until(func() -> bool: return EditorInterface.get_resource_filesystem().get_file_type("res://giant.res") == "CylinderMesh", "the editor recognizes the file")
	var oaks: int = scatter.get_shown_count(layer("Old Oak"))
	await drag_files(["res://giant.res"], middle(tree()))
	check_equal(names()[0], "Giant", "the layer with the widest model is first")
	await settle(scatter)
	var left := "Old Oak: %d of %d instances are left among the new layers." % [scatter.get_shown_count(layer("Old Oak")), oaks]
	check(await until(func() -> bool: return left in toast_text(), "losses are reported"), "%s in %s" % [left, toast_text()])
	await undo()


## Checks that the editor saves a layer's marks with its state of the scene, and restores them when the scene is reopened.
func test_marks_are_saved() -> void:
	workspace().dock.marks.put(layer("Fern"), &"hidden", true)
	saved_files()
	scatter = null
	EditorInterface.get_selection().clear()
	EditorInterface.reload_scene_from_path(SCENE)
	await frames(5)
	root = EditorInterface.get_edited_scene_root()
	scatter = root.get_node("Scatter")
	EditorInterface.edit_node(scatter)
	await settle(scatter)
	await wait_for_panel()
	check(workspace().dock.marks.is_hidden(layer("Fern")), "a hidden layer is still hidden")
	check_equal(scatter.get_stats().drawn, scatter.get_shown_count(scatter.layers[0]) + scatter.get_shown_count(scatter.layers[1]), "its instances are hidden in the view")
