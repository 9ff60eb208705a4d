@tool
extends "res://tests/steps.gd"
## The base class for the tutorial tests, with scenes that have a ground, buttons, and screenshots for the pages. Before these tests, tutorial_tree.gd
## must have written res://pack/oak.glb.

const Hills := preload("res://tests/hills.gd")
const LayersPanel := preload("res://addons/thicket/editor/layers/layers_panel.gd")
const OAK := "res://pack/oak.glb"
const SIZE := Vector2i(1280, 800)
## The window size, in pixels, for screenshots of the view with all its tools.
const WIDE := Vector2i(1720, 1060)
## The width of a page's screenshots in pixels.
const WIDTH := 960

var root: Node
var scatter: Node3D


func panel() -> LayersPanel:
	return workspace().dock.panel


func button(text: String) -> Button:
	for found: Button in panel().find_children("*", "Button", true, false):
		if found.text == text:
			return found
	check(false, "the panel has a button " + text)
	return null


func middle(control: Control) -> Vector2:
	return control.get_global_transform_with_canvas() * (control.size * 0.5)


func layer(title: String) -> Resource:
	for found: Resource in scatter.layers:
		if found.resource_name == title:
			return found
	check(false, "there is a layer " + title)
	return null


func on_ground(x: float, z: float) -> Vector3:
	return Vector3(x, scatter.ground.get_height(Vector3(x, 0.0, z)), z)


func select(node: Node) -> void:
	EditorInterface.get_selection().clear()
	EditorInterface.get_selection().add_node(node)
	EditorInterface.edit_node(node)
	await frames(3)


## Waits for the plugin's next update. It updates only a few times per second.
func wait_for_panel() -> void:
	await get_tree().create_timer(0.6).timeout


## Saves the ground mesh, unless it exists already.
func make_ground() -> void:
	if ResourceLoader.exists("res://ground.res"):
		return
	ResourceSaver.save(Hills.mesh(), "res://ground.res")


## Opens a new scene with the ground. The camera looks at `place` from `away` meters, rotated `down` and `around` in radians.
func open_new(path: String, point: Vector3, away: float, down: float, around: float) -> void:
	make_ground()
	var world := Node3D.new()
	world.name = "World"
	var ground := MeshInstance3D.new()
	ground.name = "Ground"
	ground.mesh = load("res://ground.res")
	world.add_child(ground)
	ground.owner = world
	save_scene(world, path)
	await open_at(path, point, away, down, around)


func open_at(path: String, point: Vector3, away: float, down: float, around: float) -> void:
	save_view(path, away, point, Vector2(down, around))
	root = await open(path)
	EditorInterface.set_main_screen_editor("3D")
	get_window().size = SIZE
	await frames(3)


## Takes a screenshot for a page, either of the whole editor or of the 3D view with its toolbar.
func page_picture(title: String, of_view := false) -> void:
	await picture(title)
	var file := "res://pictures_of_tests/%s.png" % title
	var image := Image.load_from_file(ProjectSettings.globalize_path(file))
	if of_view:
		image = image.get_region(Rect2i(EditorInterface.get_editor_main_screen().get_global_rect()))
	image.resize(WIDTH, WIDTH * image.get_height() / image.get_width(), Image.INTERPOLATE_LANCZOS)
	image.save_png(file)


## Hides the selected node's handles, so that a drag selects instead of moving the node.
func hide_handles() -> void:
	surface().grab_focus()
	await key(KEY_V)


## Performs steps 3 and 4 of the first tutorial.
func add_scatter() -> void:
	addon().make_bottom_panel_item_visible(panel())
	await frames(3)
	await mouse_click(middle(button("New Scatter")))
	scatter = root.get_node_or_null("Scatter")
	check(scatter != null, "New Scatter creates a node")
	await wait_for_panel()
	check(button("Use as Ground...").is_visible_in_tree(), "the panel offers to set a ground")
	await mouse_click(middle(button("Use as Ground...")))
	var dialogs := get_tree().root.find_children("*", "SceneTreeDialog", true, false).filter(func(dialog: Window) -> bool: return dialog.visible)
	if check_equal(dialogs.size(), 1, "a dialog with the nodes"):
		dialogs[0].emit_signal(&"selected", root.get_node("Ground").get_path())
		dialogs[0].hide()
		await frames(2)
	check(scatter.ground != null and scatter.get_problems().size() <= 1, "it has a ground: %s" % scatter.get_problems())
	await select(scatter)


func import_as(path: String, parameters: Dictionary) -> void:
	var settings := ConfigFile.new()
	check_equal(settings.load(path + ".import"), OK, "%s was imported" % path)
	for parameter: String in parameters:
		settings.set_value("params", parameter, parameters[parameter])
	settings.save(path + ".import")
	RenderingServer.render_loop_enabled = true # The import draws a thumbnail of a scene.
	EditorInterface.get_resource_filesystem().reimport_files([path])
	await frames(5)
	RenderingServer.render_loop_enabled = false


func menu_of_regions(section: String, item: String) -> int:
	var popup: PopupMenu = workspace().toolbar.regions.get_popup()
	var inside := false
	for index in popup.item_count:
		if popup.is_item_separator(index):
			inside = popup.get_item_text(index) == section
		elif inside and popup.get_item_text(index) == item:
			return popup.get_item_id(index)
	check(false, "%s has %s" % [section, item])
	return -1


## Counts the instances of the layers `names` within a circle on the map.
func count_in(at: Vector2, radius: float, names: PackedStringArray) -> int:
	var result := 0
	for title in names:
		for point: Vector3 in instances(scatter, scatter.layers.find(layer(title))).values():
			result += int(Vector2(point.x, point.z).distance_to(at) < radius)
	return result
