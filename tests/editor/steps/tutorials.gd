@tool
extends "res://tests/tutorial_scenes.gd"
## Follows the tutorials' steps as a reader would and takes the screenshots for their pages. Also tests the window that shows the pages, and
## the links to them in the editor's help.

const FOLDER := "res://addons/thicket/tutorials/"


func test_first_forest() -> void:
	await open_new("res://wood.tscn", Vector3(0.0, 3.0, 0.0), 62.0, 0.3, 0.6)
	await add_scatter()
	for item: String in ["Forest", "Meadow", "Scree"]:
		var popup := panel()._add.get_popup()
		check(range(popup.item_count).any(func(index: int) -> bool: return popup.get_item_text(index) == item), "Add Layer offers " + item)
	panel()._on_add(panel().Add.FIRST_PRESET)
	await settle(scatter)
	await wait_for_panel()
	check_equal(scatter.layers.size(), 8, "layers of the preset: six kinds of plants, stones and deadwood")
	for each: Resource in scatter.layers:
		check(scatter.get_shown_count(each) > 10, "%d instances of %s" % [scatter.get_shown_count(each), each.resource_name])
	var before: int = scatter.get_shown_count(scatter.layers[0])
	layer("Spruce").max_slope_degrees = 12.0
	await settle(scatter)
	check(scatter.get_shown_count(scatter.layers[0]) < before, "a rule leaves fewer instances: %d of %d" % [scatter.get_shown_count(scatter.layers[0]), before])
	layer("Spruce").max_slope_degrees = 35.0
	panel().choose([layer("Spruce")] as Array[ScatterLayer])
	EditorInterface.inspect_object(layer("Spruce"), "", true)
	await settle(scatter)
	await wait_for_panel()
	check(scatter.get_problems().is_empty(), "no problems: %s" % scatter.get_problems())
	await until(func() -> bool: return not workspace()._new_layers.is_watching(), "all new layers were checked")
	check_equal(toast_text(), "", "a preset alone shows no message about little room")
	await hide_handles()
	await page_picture("tutorial_first_forest")
	check_equal(EditorInterface.save_scene(), OK, "saved")


func test_your_own_tree() -> void:
	# The editor would set these options itself, some time after the first use of the texture in 3D.
	await import_as("res://pack/oak.png", {"mipmaps/generate": true, "detect_3d/compress_to": 0})
	await import_as(OAK, {}) # Importing it again creates a thumbnail for the list.
	await open_new("res://own.tscn", Vector3(0.0, 3.0, 0.0), 80.0, 0.3, 0.6)
	await add_scatter()
	await drag_files([OAK], middle(panel().tree))
	await settle(scatter)
	var oak := layer("Oak")
	if oak == null:
		return
	check(oak.radius > 6.0 and oak.radius < 14.0, "the trees are as far apart as their crowns are wide: %s m" % oak.radius)
	var model: Resource = ClassDB.instantiate(&"ScatterModel")
	model.scene = load(OAK)
	check_equal(model.lods.size(), 3, "LODs of the imported model")
	check_equal(oak.collision_shape, ClassDB.class_get_integer_constant(&"ScatterLayer", &"COLLISION_MODEL"), "the layer uses the model's collision shape")
	var materials: Array = oak.get_materials()
	var files := materials.map(func(material: Material) -> String: return material.resource_path.get_file())
	files.sort()
	check_equal(files, ["own_oak_bark.tres", "own_oak_leaves.tres"], "files of the foliage materials on all LODs")
	for material: ShaderMaterial in materials:
		material.set_shader_parameter(&"albedo", Color.WHITE)
		material.set_shader_parameter(&"albedo_texture", load("res://pack/oak.png"))
		material.set_shader_parameter(&"alpha_scissor", 0.5)
	oak.min_scale = 0.8
	oak.max_scale = 1.2
	oak.height_offset = -0.1
	var wind: Node3D = load("res://addons/thicket/shaders/foliage_world.gd").new()
	wind.name = "ScatterFoliageWorld"
	root.add_child(wind)
	wind.owner = root
	await settle(scatter)
	EditorInterface.inspect_object(oak, "", true)
	await wait_for_panel()
	check(scatter.get_shown_count(scatter.layers[0]) > 100 and scatter.get_problems().is_empty(), "a wood: %s" % scatter.get_problems())
	await hide_handles()
	await page_picture("tutorial_your_own_tree")
	check_equal(EditorInterface.save_scene(), OK, "saved")


func test_paint_and_shapes() -> void:
	await open_at("res://wood.tscn", Vector3(0.0, 3.0, 0.0), 62.0, 0.3, 0.6)
	var wood := FileAccess.get_file_as_string("res://wood.tscn")
	var park := FileAccess.open("res://park.tscn", FileAccess.WRITE)
	park.store_string(RegEx.create_from_string(" uid=\"uid://\\w+\"").sub(wood, "")) # Removes the first uid, which belongs to the scene.
	park.close()
	await open_at("res://park.tscn", Vector3(0.0, 0.0, 2.0), 72.0, 1.05, 0.6)
	get_window().size = WIDE
	addon().hide_bottom_panel()
	scatter = root.get_node("Scatter")
	for title: String in ["Spruce", "Birch"]: # Makes the wood denser, for a better screenshot.
		layer(title).clump_size = 0.0
		layer(title).density = 1.0
	await select(scatter)
	await hide_handles()
	await settle(scatter)
	await add_regions()
	await paint_first_stroke()
	await erase_a_lane()
	await page_picture("tutorial_paint_and_shapes", true)
	await explain_clearing()
	await page_picture("tutorial_why", true)
	workspace().toolbar.why.set_on(false)
	check_equal(EditorInterface.save_scene(), OK, "saved")
	get_window().size = SIZE


func add_regions() -> void:
	var regions: Node = workspace().toolbar.regions
	regions._on_chosen(menu_of_regions("Exclude Layers", "Cylinder"))
	await frames(3)
	var clearing: Node3D = scatter.get_node("WithoutCylinder")
	clearing.radius = 9.0
	clearing.falloff = 1.5
	clearing.ignore_height = true
	clearing.position = on_ground(-16.0, -10.0)
	await settle(scatter)
	check_equal(count_in(Vector2(-16.0, -10.0), 7.0, ["Spruce", "Birch"]), 0, "the clearing")
	await select(scatter)
	surface().grab_focus()
	regions._on_chosen(menu_of_regions("Exclude Layers", "Path"))
	await frames(3)
	for point: Vector2 in [Vector2(-30, 26), Vector2(-8, 14), Vector2(12, 12), Vector2(24, -6)]:
		await click_at(on_screen(on_ground(point.x, point.y)))
	await key(KEY_ENTER)
	await frames(3)
	check_equal((scatter.get_node("WithoutPath/Path3D") as Path3D).curve.point_count, 4, "a path")
	scatter.get_node("WithoutPath").width = 6.0
	await select(scatter)
	surface().grab_focus()
	regions._on_chosen(menu_of_regions("Exclude Layers", "Polygon"))
	await frames(3)
	for corner: Vector2 in [Vector2(-2, -8), Vector2(8, -10), Vector2(10, 0), Vector2(-1, 2)]:
		await click_at(on_screen(on_ground(corner.x, corner.y)))
	await key(KEY_ENTER)
	await frames(3)
	check(scatter.has_node("WithoutPolygon"), "a polygon")
	await select(scatter)
	await settle(scatter)
	check_equal(count_in(Vector2(4.0, -4.0), 2.5, ["Spruce", "Birch"]), 0, "trees in the clearing")


## Paints ferns with "Only here" and then undoes it.
func paint_first_stroke() -> void:
	var toolbar: Node = workspace().toolbar
	toolbar.paint.set_on(true)
	toolbar.choose_layers([layer("Fern")] as Array[ScatterLayer])
	toolbar.paint.set_brush(5.0, 1.0, 0.6)
	toolbar.paint.choose_mode(0)
	await frames(3)
	var points := PackedVector3Array()
	for step in 6:
		points.append(on_ground(-14.0 + 3.0 * step, 24.0))
	await stroke(points)
	await frames(2)
	var question: ConfirmationDialog = toolbar.paint.first_stroke
	check(question.visible and question.get_ok_button().text == "Only here", "it asks: %s" % question.dialog_text)
	question.confirmed.emit()
	question.hide()
	await stroke(points)
	await settle(scatter)
	check(layer("Fern").mask != null and count_in(Vector2(40.0, 40.0), 15.0, ["Fern"]) == 0, "no ferns grow outside the painted area")
	check(count_in(Vector2(points[2].x, points[2].z), 4.0, ["Fern"]) > 3, "ferns grow on the painted area")
	while history(scatter).has_undo() and layer("Fern").mask != null:
		history(scatter).undo()
	await settle(scatter)
	check(count_in(Vector2(40.0, 40.0), 15.0, ["Fern"]) > 3, "undone")


func erase_a_lane() -> void:
	var toolbar: Node = workspace().toolbar
	toolbar.choose_layers([layer("Spruce"), layer("Birch")] as Array[ScatterLayer])
	toolbar.paint.choose_mode(1)
	await frames(3)
	var points := PackedVector3Array()
	for step in 9:
		points.append(on_ground(-34.0 + 4.0 * step, 6.0 - 1.2 * step + 6.0 * sin(0.6 * step)))
	await stroke(points)
	await settle(scatter)
	check_equal(count_in(Vector2(points[4].x, points[4].z), 3.0, ["Spruce", "Birch"]), 0, "trees on the painted lane")
	check_equal(count_in(Vector2(-16.0, -10.0), 7.0, ["Spruce", "Birch"]), 0, "trees in the clearing after painting the lane")
	await wait_for_panel()


## Uses the tool that explains why no spruce grows in the clearing.
func explain_clearing() -> void:
	var why: Node = workspace().toolbar.why
	why.set_on(true)
	workspace().toolbar.choose_layers([layer("Spruce")] as Array[ScatterLayer])
	why.choose_colors(1)
	await wait_for_panel()
	var at := on_screen(on_ground(-16.0, -10.0))
	await move_mouse(at)
	await click_at(at)
	await until(func() -> bool: return why.overlay.is_complete() and why.panel.rows.size() > 6, "the reasons")
	check(why.panel.rows.any(func(row: Array) -> bool: return "WithoutCylinder" in str(row[1])), "%s" % [why.panel.rows])
	addon().update_overlays()


func texts_of(node: Node) -> Array[Node]:
	return node.find_children("*", "RichTextLabel", true, false)


func tutorial_text() -> RichTextLabel:
	return texts_of(workspace().tutorials)[0]


## Checks that the window shows every page completely: its text without markup, its images, and links to other pages.
func test_the_window() -> void:
	var tutorials: Window = workspace().tutorials
	for page: String in tutorials.PAGES:
		tutorials.open(page)
		await frames(2)
		var shown := tutorial_text().get_parsed_text()
		var written := FileAccess.get_file_as_string(FOLDER + page)
		check(shown.begins_with(tutorials.Text.title(written) + "\n"), "%s begins with its title" % page)
		check(not shown.contains("**") and not shown.contains("](") and not shown.contains("```"), "%s shows no Markdown" % page)
		check(not shown.contains("[lb]") and not shown.contains("[/"), "%s shows no BBCode" % page)
		for line: String in written.split("\n"):
			if line.begins_with("\t") and line.length() > 20:
				check(shown.contains(line.strip_edges()), "%s shows its code: %s" % [page, line])
	var menus := get_tree().root.find_children("*", "PopupMenu", true, false).filter(func(menu: PopupMenu) -> bool:
		return range(menu.item_count).any(func(index: int) -> bool: return menu.get_item_text(index) == "Thicket"))
	check_equal(menus.size(), 1, "menus with the submenu Thicket")
	tutorials.page = ""
	workspace().help.id_pressed.emit(0)
	check(tutorials.visible, "the first item of the menu opens the window")
	check_equal(tutorials.page, "first_forest.md", "the first page")
	tutorial_text().meta_clicked.emit("your_own_tree.md")
	check_equal(tutorials.page, "your_own_tree.md", "a link leads to another page")
	tutorials.open("first_forest.md")
	await wait_for_panel()
	await picture("tutorial_window", tutorials)
	tutorials.hide()


## Checks the addresses that the menu opens, and the report for reports of problems.
func test_the_menu() -> void:
	var menu: PopupMenu = workspace().help
	var names := range(menu.item_count).map(func(index: int) -> String: return menu.get_item_text(index))
	check_equal(names, ["Tutorials...", "Documentation", "What's New", "", "Report a Problem", "Copy System Report"], "items")
	var plugin := ConfigFile.new()
	plugin.load("res://addons/thicket/plugin.cfg")
	check_equal(menu.address(1), plugin.get_value("thicket", "documentation"), "the documentation")
	check_equal(menu.address(2), plugin.get_value("thicket", "documentation") + "/changelog.html", "what's new")
	check_equal(menu.address(3), plugin.get_value("thicket", "repository") + "/issues", "the form for reports")
	var report: String = menu.system_report()
	for part: String in ["Thicket: " + plugin.get_value("plugin", "version"), "Godot: 4.", "System: ", "Processor: ", "Renderer: gl_compatibility, "]:
		check(report.contains(part), "the report contains %s: %s" % [part, report])


## Checks the buttons that the panel shows while no scatter is selected, and the example that one of them opens.
func test_the_example() -> void:
	EditorInterface.get_selection().clear()
	await open_new("res://empty.tscn", Vector3.ZERO, 40.0, 0.3, 0.6)
	workspace().edit(null)
	addon().make_bottom_panel_item_visible(panel())
	await wait_for_panel()
	var welcome: Control = panel().welcome
	check(welcome.visible, "the buttons are visible without a scatter")
	await picture("welcome")
	var buttons := welcome.find_children("*", "Button", true, false)
	check_equal(buttons.map(func(button: Button) -> String: return button.text), ["Open the Example", "First Forest", "Documentation"], "buttons")
	buttons[1].pressed.emit()
	check_equal(workspace().tutorials.page, "first_forest.md", "the second button opens the first tutorial")
	check(workspace().tutorials.visible, "the tutorial window is visible")
	workspace().tutorials.hide()
	buttons[0].pressed.emit()
	if not await until(func() -> bool: return EditorInterface.get_edited_scene_root() != null and EditorInterface.get_edited_scene_root().name == &"Example", "the example is open"):
		return
	var example := EditorInterface.get_edited_scene_root()
	check_equal(example.scene_file_path, "res://thicket_example.tscn", "the copy of the user")
	var forest: Node = example.get_node(^"Forest")
	check_equal(forest.scene_file_path, "", "the layers belong to the copy")
	EditorInterface.get_selection().add_node(forest)
	await settle(forest)
	await wait_for_panel()
	check(not welcome.visible, "the buttons are hidden while a scatter is selected")
	check(forest.get_problems().is_empty(), "no problems: %s" % forest.get_problems())
	for each: Resource in forest.layers:
		check(forest.get_shown_count(each) > 10, "%d instances of %s" % [forest.get_shown_count(each), each.resource_name])
	await picture("example")


## Returns the text label of the open help page, or null.
func help() -> RichTextLabel:
	var pages := EditorInterface.get_script_editor().find_children("*", "EditorHelp", true, false)
	return texts_of(pages[0])[0] if not pages.is_empty() else null


## Checks that a click on a link in the class reference opens the tutorial page. The editor's help alone would not open it.
func test_links_in_the_help() -> void:
	EditorInterface.get_script_editor().goto_help("class_name:TerrainScatter3D")
	EditorInterface.set_main_screen_editor("Script")
	if not await until(func() -> bool: return help() != null and help().get_parsed_text().contains("Paint and shapes"), "the help has the links"):
		return
	var text := help()
	await wait_for_panel()
	var words := text.get_parsed_text()
	var line := text.get_character_line(words.find("Paint and shapes"))
	var scroll := text.get_line_offset(line) - 0.4 * text.size.y
	text.get_v_scroll_bar().value = scroll
	await frames(4)
	var at := Vector2(text.get_theme_stylebox(&"normal").content_margin_left + 60.0,
			text.get_line_offset(line) - text.get_v_scroll_bar().value + 14.0)
	await picture("tutorial_help")
	workspace().tutorials.page = ""
	await mouse_click(text.get_global_transform_with_canvas() * at)
	check_equal(workspace().tutorials.page, "paint_and_shapes.md", "a click opens the page")
	check(workspace().tutorials.visible, "the tutorial window is visible")
	workspace().tutorials.hide()
	EditorInterface.set_main_screen_editor("3D")
