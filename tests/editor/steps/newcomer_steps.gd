@tool
extends "res://tests/steps.gd"
## The steps of README.md, as a newcomer follows them: from an empty project with the add-on's folder, a tree and a ground of the newcomer's own to a
## forest that can be played. Uses only mouse and keys, and counts them. The editor must run with --single-window, so that menus and dialogs are in its
## window.

const TREE := "res://oak.glb"
const GROUND := "res://hills.glb"
const SCENE := "res://node_3d.tscn"
const SIZE := Vector2i(1280, 720)
## Files of the tests that a newcomer's project does not have.
const HIDDEN: PackedStringArray = ["tests", "zz_read_last.gd"]

var root: Node
var scatter: Node3D
var clicks := 0
var drags := 0
var key_presses := 0


func click(at: Vector2) -> void:
	clicks += 1
	await mouse_click(at)


func drop(file: String, at: Vector2) -> void:
	drags += 1
	await drag_files([file], at)


func press_key(code: Key, keys := 0) -> void:
	key_presses += 1
	await key(code, keys)


## Called when the window shows the result of a step of the page.
func step_done(_title: String) -> void:
	pass


## Hides the files of the tests in the FileSystem dock.
func hide_test_files() -> void:
	for tree: Tree in EditorInterface.get_file_system_dock().find_children("*", "Tree", true, false):
		var item := tree.get_root()
		while item != null:
			item.visible = not HIDDEN.has(item.get_text(0))
			item = item.get_next_in_tree()


## Returns the position of a part of a control in the editor's main window. The control may be in an embedded window.
func spot(control: Control, part := Vector2(0.5, 0.5)) -> Vector2:
	return in_main(control, control.size * part)


func in_main(control: Control, local: Vector2) -> Vector2:
	var at := control.get_global_transform_with_canvas() * local
	return at if control.get_window() == get_window() else at + Vector2(control.get_window().position)


func button(text: String) -> Button:
	for found: Button in get_tree().root.find_children("*", "Button", true, false):
		if found.text == text and found.is_visible_in_tree() and not found.disabled and found.get_window().visible:
			return found
	check(false, "there is no button " + text)
	return null


## Returns the visible window of a class.
func dialog(kind: String) -> Window:
	for found: Window in get_tree().root.find_children("*", kind, true, false):
		if found.visible:
			return found
	check(false, "there is no dialog " + kind)
	return null


## Returns the position of a tab at the bottom of the editor.
func bottom_tab(title: String) -> Vector2:
	return tab_of(EditorInterface.get_base_control().find_children("*", "EditorBottomPanel", true, false)[0] as TabContainer, title)


func tab_of(container: TabContainer, title: String) -> Vector2:
	var tabs := container.get_tab_bar()
	for tab in tabs.tab_count:
		if tabs.get_tab_title(tab) == title:
			return in_main(tabs, tabs.get_tab_rect(tab).get_center())
	check(false, "there is a tab " + title)
	return Vector2.ZERO


## Clicks on an item of a popup menu, after finding its position with the mouse.
func choose(popup: PopupMenu, text: String) -> void:
	var local := Vector2(20.0, 2.0)
	while local.y < popup.size.y:
		await mouse_to(Vector2(popup.position) + local, 0)
		if popup.get_focused_item() >= 0 and popup.get_item_text(popup.get_focused_item()).begins_with(text):
			await click(Vector2(popup.position) + local + Vector2(0.0, 6.0))
			return
		local.y += 3.0
	check(false, "the menu has the item " + text)


## Opens a menu of the editor's menu bar. The mouse searches for its title, and one click opens it.
func open_menu(title: String) -> PopupMenu:
	var bar := EditorInterface.get_base_control().find_children("*", "MenuBar", true, false)[0] as MenuBar
	var popup := bar.get_node(title) as PopupMenu
	var at := spot(bar, Vector2(0.0, 0.5)) + Vector2(8.0, 0.0)
	while at.x < spot(bar, Vector2.ONE).x and not popup.visible:
		await mouse_click(at)
		if popup.visible:
			break
		await key(KEY_ESCAPE)
		at.x += 12.0
	clicks += 1
	check(popup.visible, "the menu %s opens" % title)
	return popup


## Moves the view away from the ground with the mouse wheel.
func scroll_out() -> void:
	await mouse_to(spot(surface()), 0)
	for notch in 8:
		var wheel := InputEventMouseButton.new()
		wheel.button_index = MOUSE_BUTTON_WHEEL_DOWN
		wheel.position = spot(surface())
		wheel.global_position = wheel.position
		wheel.factor = 5.0
		wheel.pressed = true
		get_window().push_input(wheel)
		await get_tree().process_frame
	await get_tree().create_timer(1.0).timeout # The view moves smoothly.


## Enables the plugin in the project settings.
func enable_the_plugin() -> void:
	get_window().size = SIZE
	EditorInterface.set_main_screen_editor("3D")
	await frames(10)
	check(addon() == null, "the plugin is off")
	await choose(await open_menu("Project"), "Project Settings")
	var settings := dialog("ProjectSettingsEditor")
	await click(tab_of(settings.find_children("*", "TabContainer", true, false)[0], "Plugins"))
	var list := settings.find_children("*", "EditorPluginSettings", true, false)[0].find_children("*", "Tree", true, false)[0] as Tree
	var row := list.get_root().get_first_child()
	for column in list.columns:
		if row.get_cell_mode(column) == TreeItem.CELL_MODE_CHECK:
			var rect := list.get_item_area_rect(row, column)
			await click(in_main(list, rect.position + Vector2(14.0, 0.5 * rect.size.y)))
	await until(func() -> bool: return addon() != null and workspace() != null, "the plugin is on")
	await step_done("install")
	await click(spot(button("Close")))
	check(not settings.visible, "the settings are closed")


## Creates a scene with the ground, and saves it.
func open_a_scene() -> void:
	await click(spot(button("3D Scene")))
	root = EditorInterface.get_edited_scene_root()
	await drop(GROUND, row_of("Node3D"))
	check(root.has_node("Hills"), "the ground is in the scene")
	await scroll_out()
	await press_key(KEY_S, KEY_MASK_CTRL)
	await click(spot(button("Save")))
	await until(func() -> bool: return FileAccess.file_exists(SCENE), "the scene is saved")
	await step_done("1")


## Adds a scatter, its ground, the tree, and what the scene lacks for the game.
func create_a_forest() -> void:
	await click(bottom_tab("Scatter"))
	check(workspace().dock.panel.is_visible_in_tree(), "the tab opens the panel")
	await frames(10)
	await click(spot(button("New Scatter")))
	scatter = root.get_node_or_null("Scatter")
	if not check(scatter != null, "the button adds a scatter"):
		return
	await wait_for_panel()
	await step_done("2")
	await click(spot(button("Use as Ground...")))
	await click(row_in(dialog("SceneTreeDialog"), "Hills"))
	await step_done("3")
	await click(spot((dialog("SceneTreeDialog") as ConfirmationDialog).get_ok_button()))
	check(scatter.ground != null, "the hills are the ground")
	await wait_for_panel()
	await drop(TREE, spot(workspace().dock.panel.tree))
	check_equal(scatter.layers.size(), 1, "the drop adds a layer")
	await settle(scatter)
	await wait_for_panel()
	await step_done("4")
	await click(spot(button("Add Camera, Sun, Sky and Wind")))
	await wait_for_panel()
	await step_done("5")


## Waits for the plugin's next update. It updates only a few times per second.
func wait_for_panel() -> void:
	await get_tree().create_timer(0.6).timeout


func row_in(window: Window, title: String) -> Vector2:
	var tree := window.find_children("*", "SceneTreeEditor", true, false)[0].find_children("*", "Tree", true, false)[0] as Tree
	var item := tree.get_root()
	while item != null:
		if item.get_text(0) == title:
			var rect := tree.get_item_area_rect(item, 0)
			return in_main(tree, rect.position + rect.size * Vector2(0.4, 0.5))
		item = item.get_next_in_tree()
	check(false, "the dialog lists " + title)
	return Vector2.ZERO


## Plays the scene.
func play() -> void:
	await press_key(KEY_F6)
	await until(func() -> bool: return EditorInterface.is_playing_scene(), "F6 plays the scene")
	EditorInterface.stop_playing_scene()
