@tool
extends "res://tests/steps.gd"
## Performs a designer's first hour in the demo scene: adds a scatter and a layer, makes a stroke, undoes, redoes, saves and reopens. Then uses a
## preset and a region, and bakes.

const SCENE := "res://demo.tscn"
const MASK := "res://demo_posts_mask.res"
const BAKED := "res://baked"
## World x and z of the ground position at which the editor's saved camera looks.
const LOOKED_AT := Vector2(40.0, -30.0)

var scatter: Node3D
var ground: Resource
var before := {}
var painted := {}
var before_digests := {}
var painted_digests := {}


func on_ground(x: float, z: float) -> Vector3:
	return Vector3(x, ground.get_height(Vector3(x, 0.0, z)), z)


## Shows or hides the demo's forest and shadows, which take seconds per frame with software rendering.
func set_costly(shown: bool) -> void:
	EditorInterface.get_edited_scene_root().get_node("Scatter").visible = shown
	EditorInterface.get_edited_scene_root().get_node("Sun").shadow_enabled = shown


func save_and_reopen() -> void:
	set_costly(true)
	check_equal(EditorInterface.save_scene(), OK, "the scene is saved")
	scatter = null
	ground = null
	EditorInterface.get_selection().clear()
	EditorInterface.reload_scene_from_path(SCENE)
	await frames(5)
	set_costly(false)
	scatter = EditorInterface.get_edited_scene_root().get_node("Posts")
	ground = scatter.ground
	select(scatter)
	await settle(scatter)


func select(node: Node) -> void:
	EditorInterface.get_selection().clear()
	EditorInterface.get_selection().add_node(node)
	EditorInterface.edit_node(node)


## Adds a node and a layer as actions of the editor's undo history.
func test_add() -> void:
	var root := await open(SCENE)
	ground = root.get_node("Scatter").ground
	set_costly(false)
	var undo_redo := plugin.get_undo_redo()
	scatter = ClassDB.instantiate(&"TerrainScatter3D")
	scatter.name = "Posts"
	scatter.ground = ground
	undo_redo.create_action("Add Node", UndoRedo.MERGE_DISABLE, root)
	undo_redo.add_do_method(root, &"add_child", scatter, true)
	undo_redo.add_do_property(scatter, &"owner", root)
	undo_redo.add_do_reference(scatter)
	undo_redo.add_undo_method(root, &"remove_child", scatter)
	undo_redo.commit_action()
	select(scatter)
	await frames(3)
	EditorInterface.set_main_screen_editor("3D")
	check(workspace().toolbar.visible, "the toolbar is visible for a scatter")
	check(not workspace().toolbar.paint.is_on(), "the brush is off without layers")
	var layer: Resource = ClassDB.instantiate(&"ScatterLayer")
	layer.resource_name = "Posts"
	layer.radius = 1.5
	layer.tile_size = 32.0
	layer.view_distance = 80.0
	layer.height_offset = 1.0
	var post := CylinderMesh.new()
	post.top_radius = 0.0
	post.bottom_radius = 0.5
	post.radial_segments = 8
	post.rings = 0
	layer.meshes = [post] as Array[Mesh]
	var layers: Array = scatter.layers.duplicate()
	layers.append(layer)
	undo_redo.create_action("Add Layer", UndoRedo.MERGE_DISABLE, scatter)
	undo_redo.add_do_property(scatter, &"layers", layers)
	undo_redo.add_undo_property(scatter, &"layers", [])
	undo_redo.commit_action()
	await settle(scatter)
	await picture("added")
	# Reopen the scene, because the editor saves numbers with fewer digits. After that, saving does not change the numbers.
	await save_and_reopen()
	before = instances(scatter, 0)
	before_digests = digests(scatter, 0)
	check(before.size() > 1000, "instances around the editor's camera: %d" % before.size())


## Checks that an erasing stroke is one undo step and has no effect beyond its radius.
func test_stroke() -> void:
	workspace().toolbar.paint.set_on(true)
	workspace().toolbar.paint.set_brush(6.0, 1.0, 0.8)
	workspace().toolbar.paint.choose_mode(1)
	workspace().toolbar.choose_layer(0)
	var version := history(scatter).get_version()
	var points := PackedVector3Array()
	for step in 9:
		points.append(on_ground(LOOKED_AT.x - 16.0 + 4.0 * step, LOOKED_AT.y))
	await stroke(points)
	await settle(scatter)
	await picture("brush")
	check_equal(history(scatter).get_version(), version + 1, "the stroke is one undo step")
	painted = instances(scatter, 0)
	painted_digests = digests(scatter, 0)
	check(painted_digests != before_digests, "the stroke changes the digests")
	check(painted.size() < before.size() - 50, "erased: %d of %d remain" % [painted.size(), before.size()])
	var farthest := 0.0
	for id: int in before:
		if not painted.has(id):
			var at := Vector2(before[id].x, before[id].z)
			var nearest := at.clamp(LOOKED_AT - Vector2(16.0, 0.0), LOOKED_AT + Vector2(16.0, 0.0))
			farthest = maxf(farthest, at.distance_to(nearest))
		else:
			check(painted[id] == before[id], "remaining instances do not move")
	check(farthest > 4.0 and farthest < 6.0 + 2.0, "erased up to %.2f m from the stroke" % farthest)
	check(painted.keys().all(func(id: int) -> bool: return before.has(id)), "no new instances")
	check(FileAccess.file_exists(MASK), "the mask is saved in a file")


func test_undo_redo() -> void:
	history(scatter).undo()
	await settle(scatter)
	check(instances(scatter, 0) == before, "undo restores the instances")
	check(digests(scatter, 0) == before_digests, "undo restores the digests")
	check(scatter.layers[0].mask == null, "undo removes the mask")
	check(not FileAccess.file_exists(MASK), "undo deletes the mask's file")
	history(scatter).redo()
	await settle(scatter)
	check(instances(scatter, 0) == painted, "redo removes the same instances again")
	check(digests(scatter, 0) == painted_digests, "redo restores the digests")


## Checks that saving and reopening keeps the instances, although the scene contains only settings.
func test_save_and_reopen() -> void:
	await save_and_reopen()
	check(instances(scatter, 0) == painted, "the reopened scene has the same instances")
	check(digests(scatter, 0) == painted_digests, "the reopened scene has the same digests")
	var text := FileAccess.get_file_as_string(SCENE)
	check(text.length() < 100_000, "the scene is small: %d bytes" % text.length())
	check(MASK.get_file() in text, "the scene refers to the mask's file")
	for word in ["PackedByteArray", "MultiMesh", "buffer ="]:
		check(not word in text, "the scene contains only settings, no %s" % word)
	var mask := ResourceLoader.load(MASK, "", ResourceLoader.CACHE_MODE_IGNORE)
	check(mask.sample(LOOKED_AT) < 0.01 and mask.sample(LOOKED_AT + Vector2(0.0, 20.0)) == 1.0, "the stroke is in the file")


## Checks that painting a layer without a mask keeps instances only in the painted area, and that smoothing blurs the edge of that area. Undo restores
## everything.
func test_paint_and_smooth() -> void:
	var layer: Resource = scatter.layers[0].duplicate()
	layer.resource_name = "Stakes"
	layer.mask = null
	var old: Array = scatter.layers
	var both := old.duplicate()
	both.append(layer)
	scatter.layers = both
	workspace().toolbar.update_layers()
	workspace().toolbar.choose_layer(1)
	workspace().toolbar.paint.set_brush(8.0, 1.0, 1.0)
	await settle(scatter)
	var full := instances(scatter, 1)
	var at := Vector2(LOOKED_AT.x, LOOKED_AT.y + 10.0)
	workspace().toolbar.paint.set_on(true)
	workspace().toolbar.paint.choose_mode(2)
	await stroke([on_ground(at.x, at.y)])
	check(layer.mask == null, "smoothing a layer without a mask creates no mask")
	await ask_first(layer, at, full)
	workspace().toolbar.paint.first_stroke.get_ok_button().pressed.emit()
	await settle(scatter)
	var instances_before := instances(scatter, 1)
	check(instances_before.size() > 30 and instances_before.size() < 120, "%d of %d remain where it is painted" % [instances_before.size(), full.size()])
	for id: int in instances_before:
		check(Vector2(instances_before[id].x, instances_before[id].z).distance_to(at) < 9.0 and instances_before[id] == full[id], "a remaining instance is under the brush and has not moved")
	check(layer.mask.resource_path.begins_with("res://demo_stakes_mask"), "the mask has a file: %s" % layer.mask.resource_path)
	workspace().toolbar.paint.choose_mode(2)
	var rim := at + Vector2(8.0, 0.0)
	var sharp: float = layer.mask.sample(rim - Vector2(2.0, 0.0)) - layer.mask.sample(rim + Vector2(2.0, 0.0))
	await stroke([on_ground(rim.x, rim.y), on_ground(rim.x, rim.y + 0.5), on_ground(rim.x, rim.y + 6.0)])
	var smooth: float = layer.mask.sample(rim - Vector2(2.0, 0.0)) - layer.mask.sample(rim + Vector2(2.0, 0.0))
	check(sharp > 0.95 and smooth < 0.6, "the rim was %f, and is %f after smoothing" % [sharp, smooth])
	history(scatter).undo()
	check(layer.mask.sample(rim - Vector2(2.0, 0.0)) > 0.95, "smoothing is undone")
	history(scatter).undo()
	await settle(scatter)
	check(instances(scatter, 1) == full, "painting is undone")
	scatter.layers = old
	workspace().toolbar.update_layers()


## Checks the dialog that opens when a layer without a mask is painted. Nothing changes before the dialog is answered, or if it is dismissed. "Not
## here" erases.
func ask_first(layer: Resource, at: Vector2, full: Dictionary) -> void:
	var dialog: ConfirmationDialog = workspace().toolbar.paint.first_stroke
	for answer: String in ["dismiss", "erase", "paint"]:
		workspace().toolbar.paint.choose_mode(0)
		await stroke([on_ground(at.x, at.y)])
		check(dialog.visible and layer.mask == null, "the first stroke opens a dialog, answer %s" % answer)
		check("%d visible instances" % full.size() in dialog.dialog_text, "the number of instances that would be removed: %s" % dialog.dialog_text)
		if answer == "dismiss":
			await picture("first_stroke", dialog)
			dialog.get_cancel_button().pressed.emit()
			await settle(scatter)
			check(layer.mask == null and instances(scatter, 1) == full, "nothing has changed after dismissing it")
		elif answer == "erase":
			dialog.custom_action.emit(&"erase")
			await settle(scatter)
			var left := instances(scatter, 1)
			check(left.size() < full.size() - 30 and left.size() > full.size() / 2, "%d of %d remain" % [left.size(), full.size()])
			check_equal(workspace().toolbar.paint.brush.mode, 1, "the brush stays on erase")
			await until(workspace().toolbar.paint.mask_overlay.is_shown, "the mask is visible while the brush is on")
			await picture("mask")
			var file: String = layer.mask.resource_path
			check(FileAccess.file_exists(file), "the mask is saved in a file")
			history(scatter).undo()
			check(layer.mask == null and not FileAccess.file_exists(file), "undo removes the mask and its file")
			history(scatter).redo()
			check(layer.mask != null and FileAccess.file_exists(file), "redo restores the mask and its file")
			check(ResourceLoader.load(file, "", ResourceLoader.CACHE_MODE_IGNORE).sample(at) < 0.01, "the file contains the stroke")
			history(scatter).undo()
			check(layer.mask == null and not FileAccess.file_exists(file), "undo removes the mask and its file")
			await settle(scatter)


## Checks that a stroke that cannot be painted shows the reason and consumes the mouse button. Selecting another node turns the brush off.
func test_a_stroke_that_cannot_be_painted() -> void:
	workspace().toolbar.paint.set_on(true)
	await frames(2)
	var press := _button(Vector2(300.0, 200.0), true, false)
	var stop := EditorPlugin.AFTER_GUI_INPUT_STOP
	scatter.ground = null
	check_equal(addon()._forward_3d_gui_input(camera(), press), stop, "the button press is consumed without a ground")
	check("ground" in workspace().toolbar.paint.problem, "the reason: '%s'" % workspace().toolbar.paint.problem)
	await picture("no_terrain")
	scatter.ground = ground
	var layers: Array = scatter.layers
	scatter.layers = []
	workspace().toolbar.update_layers()
	check_equal(addon()._forward_3d_gui_input(camera(), press), stop, "the button press is consumed without a layer")
	check("layer" in workspace().toolbar.paint.problem, "the reason: '%s'" % workspace().toolbar.paint.problem)
	scatter.layers = layers
	workspace().toolbar.update_layers()
	check_equal(addon()._forward_3d_gui_input(camera(), _button(Vector2(300.0, -20000.0), true, false)), stop, "a button press on the sky is consumed")
	check("ground" in workspace().toolbar.paint.problem, "the reason: '%s'" % workspace().toolbar.paint.problem)
	check(EditorInterface.get_selection().get_selected_nodes() == [scatter], "the selection stays")
	select(EditorInterface.get_edited_scene_root())
	await frames(2)
	check(not workspace().toolbar.paint.is_on(), "deselecting turns the brush off")
	select(scatter)
	await frames(2)
	check(not workspace().toolbar.paint.is_on(), "it stays off when the scatter is selected again")


## Checks that a preset adds its layers in one step. When it is added again, the new layers have unique names, and their rules refer to each other.
func test_presets() -> void:
	var version := history(scatter).get_version()
	workspace().toolbar.preset_chosen.emit("forest")
	workspace().toolbar.preset_chosen.emit("forest")
	check_equal(history(scatter).get_version(), version + 2, "each preset is one undo step")
	var names := PackedStringArray(scatter.layers.map(func(layer: Resource) -> String: return layer.resource_name))
	check(names.has("Spruce") and names.has("Spruce 2") and names.size() == 17, "names: %s" % names)
	var bush: Resource = scatter.layers[names.find("Bush 2")]
	check_equal(bush.spacing.keys().slice(0, 3), ["Spruce 2", "Oak 2", "Birch 2"], "rules refer to the new layers")
	check(bush.spacing.has("Spruce") and bush.spacing.has("Posts"), "new layers keep their distance from existing ones: %s" % bush.spacing)
	check(scatter.layers[names.find("Bush")] != bush and bush.resource_path.is_empty(), "the layer is a copy without a file")
	check(bush.meshes[0].resource_path.begins_with("res://addons/thicket/presets/plants/"), "the copies share their models")
	check(scatter.get_problems().is_empty(), "no problems: %s" % scatter.get_problems())
	history(scatter).undo()
	for layer: Resource in scatter.layers:
		layer.view_distance = minf(layer.view_distance, 60.0)
	await settle(scatter)
	await picture("preset")
	history(scatter).undo()
	check_equal(scatter.layers.size(), 1, "undo removes the preset's layers")
	var flat: Resource = ClassDB.instantiate(&"ScatterGroundFlat")
	scatter.ground = flat
	workspace().toolbar.preset_chosen.emit("scree")
	check(workspace()._new_layers.is_watching(), "new layers are watched until they are visible")
	await settle(scatter)
	await until(func() -> bool: return not workspace()._new_layers.is_watching(), "layers without instances are reported")
	await picture("missing")
	history(scatter).undo()
	scatter.ground = ground
	for preset in ["meadow", "pine_wood", "shore", "scree", "desert"]:
		workspace().toolbar.preset_chosen.emit(preset)
		check(scatter.layers.size() > 4 and scatter.get_problems().is_empty(), "%s: %s" % [preset, scatter.get_problems()])
		history(scatter).undo()


## Checks that regions of all shapes are drawn, and that their handles resize them.
func test_gizmos() -> void:
	await run_part(preload("res://tests/region_handles.gd").new(), &"drag_all")


## Checks that water is drawn as a plane while the scatter is selected, and that a handle changes its level.
func test_water() -> void:
	select(scatter)
	await settle(scatter)
	var level: float = ground.get_height(Vector3(LOOKED_AT.x, 0.0, LOOKED_AT.y)) - 6.0
	scatter.water_level = level
	scatter.water_enabled = true
	await settle(scatter)
	await frames(30)
	await picture("water")
	for gizmo: EditorNode3DGizmo in scatter.get_gizmos():
		var gizmos := gizmo.get_plugin()
		if gizmos.call(&"_get_gizmo_name") != "TerrainScatter3D Water":
			continue
		var middle: Vector2 = gizmos._area().get_center()
		var camera := EditorInterface.get_editor_viewport_3d(0).get_camera_3d()
		check_equal(gizmos._get_handle_value(gizmo, 0, false), level, "the handle has the water level's value")
		gizmos._set_handle(gizmo, 0, false, camera, camera.unproject_position(Vector3(middle.x, level + 3.0, middle.y)))
		gizmos._commit_handle(gizmo, 0, false, level, false)
		check(absf(scatter.water_level - level - 3.0) < 0.05, "dragged by 3 m: %f" % (scatter.water_level - level))
		history(scatter).undo()
		check_equal(scatter.water_level, level, "undo restores the water level")
		scatter.water_enabled = false
		return
	check(false, "the water has no gizmo")


## Checks that properties that refer to layers offer a list of layers.
func test_choosing_layers() -> void:
	await run_part(preload("res://tests/layer_choices.gd").new(), &"choose")


## Checks that meshes and scenes dropped on the inspector become layers, or meshes of the inspected layer.
func test_drops() -> void:
	await run_part(preload("res://tests/mesh_drops.gd").new(), &"drop")


## Runs a method of another script with this plugin and scatter.
func run_part(part: Node, method: StringName) -> void:
	part.set(&"plugin", plugin)
	part.set(&"scatter", scatter)
	add_child(part)
	select(scatter)
	await frames(2)
	@warning_ignore("redundant_await")
	await part.call(method)
	part.queue_free()
	select(scatter)


## Checks that a canceled bake leaves no files, and that a finished bake contains the instances.
func test_bake() -> void:
	select(scatter)
	await frames(2)
	var dialog: Node = workspace().bake
	dialog.choose_folder(BAKED)
	var rect := Rect2(LOOKED_AT - Vector2(50.0, 30.0), Vector2(100.0, 60.0))
	dialog.open(scatter, Vector3(LOOKED_AT.x, 0.0, LOOKED_AT.y))
	await picture("bake", dialog)
	dialog.fill(scatter, rect)
	dialog.start()
	dialog.job.step(0.0)
	check(dialog.job.progress > 0.0 and dialog.job.progress < 1.0, "the bake is in progress: %s" % dialog.job.progress)
	dialog.stop()
	dialog.hide()
	check_equal(files(BAKED), PackedStringArray(), "a canceled bake leaves no files")
	check(not DirAccess.dir_exists_absolute(BAKED.path_join(".bake_unfinished")), "a canceled bake leaves no temporary folder")
	dialog.start()
	await until(func() -> bool: return not dialog.is_processing(), "the bake is finished")
	check_equal(dialog.job.problem, "", "no problem")
	var scene: Node = load(BAKED + "/posts.tscn").instantiate()
	var expected := {}
	for point: Vector3 in instances(scatter, 0).values():
		if rect.has_point(Vector2(point.x, point.z)):
			expected[point.snapped(Vector3.ONE * 0.01)] = true
	var count := 0
	var found := 0
	for child: MultiMeshInstance3D in scene.get_children():
		count += child.multimesh.instance_count
		var buffer := child.multimesh.buffer
		for at in range(0, buffer.size(), 12):
			var point := child.position + Vector3(buffer[at + 3], buffer[at + 7], buffer[at + 11])
			found += int(expected.has(point.snapped(Vector3.ONE * 0.01)))
	check(count == expected.size() and found >= count - 3, "%d baked, %d of them match, %d expected" % [count, found, expected.size()])
	check(FileAccess.get_file_as_string(BAKED + "/posts.tscn").length() < 20_000, "the baked scene is small")
	scene.free()


func test_inspector_and_help() -> void:
	EditorInterface.edit_node(scatter)
	EditorInterface.edit_resource(scatter.layers[0])
	await frames(5)
	for section in EditorInterface.get_inspector().find_children("*", "EditorInspectorSection", true, false):
		section.call(&"unfold")
	await picture("inspector")
	EditorInterface.set_main_screen_editor("Script")
	EditorInterface.get_script_editor().goto_help("class_name:ScatterLayer")
	await frames(30)
	await picture("help")
