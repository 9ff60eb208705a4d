@tool
extends Node
## The base class for the editor tests, with functions for checks, waiting, mouse and keys, and screenshots.

const PATIENCE_MSEC := 60000
## The editor's file with the state of a scene's view.
const VIEW_STATE := """[editor_states]

3D={
"viewport_mode": 1,
"viewports": [{
"distance": %s,
"position": Vector3%s,
"x_rotation": %s,
"y_rotation": %s
}]
}
"""

## The plugin that runs this script.
var plugin: EditorPlugin

var _mouse := Vector2.ZERO


func check(condition: bool, message: String) -> bool:
	plugin.checks += 1
	if not condition:
		plugin.failures += 1
		print("FAILED: " + message)
	return condition


func check_equal(got: Variant, expected: Variant, message: String) -> bool:
	var equal: bool = typeof(got) == typeof(expected) and got == expected
	return check(equal, "%s: got %s, expected %s" % [message, got, expected])


## Saves the edited scene. Returns the contents of the files in res:// by name.
func saved_files() -> Dictionary[String, PackedByteArray]:
	check_equal(EditorInterface.save_scene(), OK, "saved")
	var result: Dictionary[String, PackedByteArray] = {}
	for file in files("res://"):
		result[file] = FileAccess.get_file_as_bytes("res://" + file)
	return result


## Checks that saved files are equal. A failure prints both contents.
func check_same(got: Dictionary[String, PackedByteArray], expected: Dictionary[String, PackedByteArray], context: String) -> void:
	check_equal(got.keys(), expected.keys(), context + ": files")
	for file in expected:
		if got.has(file) and got[file] != expected[file]:
			check(false, "%s: %s differs:\n%s\n--- expected\n%s" % [context, file, text_of(got[file]), text_of(expected[file])])


## Returns a file's contents as text, or only their size if they are binary.
func text_of(bytes: PackedByteArray) -> String:
	return "%d bytes" % bytes.size() if bytes.has(0) else bytes.get_string_from_utf8()


func frames(count: int) -> void:
	for index in count:
		await get_tree().process_frame


## Waits until `condition` returns true. After PATIENCE_MSEC, records a failure and returns false.
func until(condition: Callable, message: String) -> bool:
	var deadline := Time.get_ticks_msec() + PATIENCE_MSEC
	while not condition.call():
		if Time.get_ticks_msec() > deadline:
			return check(false, "not within %d ms: %s" % [PATIENCE_MSEC, message])
		await get_tree().process_frame
	return true


## Waits until a scatter has settled.
func settle(scatter: Node3D) -> void:
	await frames(3)
	await until(func() -> bool: return scatter.is_settled(), "settled")


## Saves a scene, and frees its root node.
func save_scene(root: Node, path: String) -> void:
	var packed := PackedScene.new()
	packed.pack(root)
	root.free()
	ResourceSaver.save(packed, path)


## Sets the view with which the editor opens a scene: the distance of the camera from a position, and its rotations about x and y.
func save_view(path: String, distance: float, position: Vector3, rotations: Vector2) -> void:
	DirAccess.make_dir_recursive_absolute("res://.godot/editor")
	var state := FileAccess.open("res://.godot/editor/%s-editstate-%s.cfg" % [path.get_file(), path.md5_text()], FileAccess.WRITE)
	state.store_string(VIEW_STATE % [distance, position, rotations.x, rotations.y])


## Adds a sphere to a scene, as the ground of a planet.
func add_planet(root: Node, radius: float, center: Vector3, segments: int) -> void:
	var planet := MeshInstance3D.new()
	planet.name = "Planet"
	var sphere := SphereMesh.new()
	sphere.radius = radius
	sphere.height = 2.0 * radius
	sphere.radial_segments = segments
	@warning_ignore("integer_division")
	sphere.rings = segments / 2
	planet.mesh = sphere
	planet.position = center
	planet.add_to_group(&"ground", true)
	root.add_child(planet)
	planet.owner = root


## Opens a scene in a tab of the editor and returns its root node.
func open(path: String) -> Node:
	EditorInterface.open_scene_from_path(path)
	await until(func() -> bool:
		var root := EditorInterface.get_edited_scene_root()
		return root != null and root.scene_file_path == path, "%s is open" % path)
	return EditorInterface.get_edited_scene_root()


## Selects only this node, as a click in the scene tree does.
func select_node(node: Node) -> void:
	EditorInterface.get_selection().clear()
	EditorInterface.get_selection().add_node(node)
	EditorInterface.edit_node(node)
	await frames(3)


## Returns the add-on's plugin, or null.
func addon() -> EditorPlugin:
	for found in get_tree().root.find_children("*", "EditorPlugin", true, false):
		if found.get_script() != null and found.get_script().resource_path == "res://addons/thicket/plugin.gd":
			return found
	return null


## Returns the plugin's workspace with its tools, panel and dialogs, or null if the extension library is not loaded.
func workspace() -> RefCounted:
	return addon().workspace


## Turns on the hand tool for the first layer of the selected TerrainScatter3D, without variation, and returns the tool.
func turn_on_hand() -> Node:
	var hand: Node = workspace().toolbar.hand
	surface().grab_focus()
	hand.set_on(true)
	workspace().toolbar.choose_layer(0)
	hand.planting.choose(false, false, false, false) # No snapping, no alignment, no random rotation or size.
	hand.refresh()
	# Wait for the layout, because the tool adds a row to the toolbar.
	await frames(3)
	return hand


func camera() -> Camera3D:
	return EditorInterface.get_editor_viewport_3d(0).get_camera_3d()


## Returns the center of a control in window coordinates.
func middle(control: Control) -> Vector2:
	return control.get_global_transform_with_canvas() * (control.size * 0.5)


## Returns the position of a node's row in the Scene dock, in window coordinates.
func row_of(title: String) -> Vector2:
	for editor: Control in EditorInterface.get_base_control().find_children("*", "SceneTreeEditor", true, false):
		var tree := editor.find_children("*", "Tree", true, false)[0] as Tree
		var item := tree.get_root() if tree.is_visible_in_tree() else null
		while item != null:
			if item.get_text(0) == title:
				var rect := tree.get_item_area_rect(item, 0)
				return tree.get_global_transform_with_canvas() * (rect.position + rect.size * Vector2(0.4, 0.5))
			item = item.get_next_in_tree()
	check(false, "the Scene dock has a row " + title)
	return Vector2.ZERO


## Scrolls a layer's row in the panel into view and returns the position of the layer's name, in window coordinates. [param section] is the
## fraction of the row's height.
func name_at(layer: Resource, section := 0.5) -> Vector2:
	return await _cell_at(layer, 0, Vector2(0.3, section))


## Returns the center of a mark in a layer's row, as `name_at` does. [param index] is 0 for color, 1 for lock and 2 for eye.
func mark_at(layer: Resource, index: int) -> Vector2:
	return await _cell_at(layer, 2, Vector2(0.5, 0.5), index)


func _cell_at(layer: Resource, column: int, part: Vector2, button := -1) -> Vector2:
	# The row may be missing for a while, because the panel rebuilds its rows after a change.
	await until(func() -> bool: return _visible_cell(layer, column, part, button) != Vector2.INF, "the row of %s is in view" % layer.resource_name)
	return _visible_cell(layer, column, part, button)


func _visible_cell(layer: Resource, column: int, part: Vector2, button: int) -> Vector2:
	var tree: Tree = workspace().dock.panel.tree
	var row: TreeItem = tree.row_of(layer)
	if row == null or not tree.is_visible_in_tree():
		return Vector2.INF
	tree.scroll_to_item(row)
	var rect := tree.get_item_area_rect(row, column, button)
	var at := rect.position + rect.size * part
	return tree.get_global_transform_with_canvas() * at if Rect2(Vector2.ZERO, tree.size).has_point(at) else Vector2.INF


## Returns the undo history of the scene that a node belongs to.
func history(node: Node) -> UndoRedo:
	var manager := plugin.get_undo_redo()
	return manager.get_history_undo_redo(manager.get_object_history_id(node))


## Makes a stroke with the left button over world positions, by sending the 3D view's events to the plugin.
func stroke(points: PackedVector3Array, with_control := false) -> void:
	for index in points.size():
		var at := camera().unproject_position(points[index])
		if index == 0:
			_send(_button(at, true, with_control))
		var motion := InputEventMouseMotion.new()
		motion.position = at
		motion.button_mask = MOUSE_BUTTON_MASK_LEFT
		_send(motion)
		await get_tree().process_frame
	_send(_button(camera().unproject_position(points[points.size() - 1]), false, with_control))


func _button(at: Vector2, pressed: bool, with_control: bool) -> InputEventMouseButton:
	var button := InputEventMouseButton.new()
	button.button_index = MOUSE_BUTTON_LEFT
	button.position = at
	button.pressed = pressed
	button.ctrl_pressed = with_control
	return button


func _send(event: InputEvent) -> void:
	addon()._forward_3d_gui_input(camera(), event)


## Clicks at a position in the window, as a real mouse would, so that the editor's whole GUI handles the events.
func mouse_click(at: Vector2, index := MOUSE_BUTTON_LEFT, keys := 0) -> void:
	await _point(at)
	await mouse_to(at, 0)
	await _press(at, index, true, keys)
	await _press(at, index, false, keys)
	await frames(2)


## Moves the system's pointer, because some controls query its position. Waits until the editor has received this motion. Otherwise, it
## could arrive between a press and a release, or end a drag.
func _point(at: Vector2) -> void:
	Input.warp_mouse(at)
	await get_tree().create_timer(0.15).timeout


## Drags with the left button from one position in the window to another.
func mouse_drag(from: Vector2, to: Vector2) -> void:
	await _point(from)
	await mouse_to(from, 0)
	await _press(from, MOUSE_BUTTON_LEFT, true, 0)
	for step in 6:
		Input.warp_mouse(from.lerp(to, (step + 1) / 6.0))
		await mouse_to(from.lerp(to, (step + 1) / 6.0), MOUSE_BUTTON_MASK_LEFT)
	await _press(to, MOUSE_BUTTON_LEFT, false, 0)
	await frames(3)


## Drags files from the FileSystem dock to a position in the window.
func drag_files(paths: PackedStringArray, to: Vector2) -> void:
	var dock := EditorInterface.get_file_system_dock()
	var from := drag_origin(paths)
	await _point(to) # Done before the drag: a drop uses the system's pointer, and a later motion of the pointer would end the drag.
	await mouse_to(from, MOUSE_BUTTON_MASK_LEFT)
	var preview := Label.new()
	preview.text = ", ".join(paths)
	dock.force_drag({"type": "files", "files": paths}, preview)
	for step in 6:
		await mouse_to(from.lerp(to, (step + 1) / 6.0), MOUSE_BUTTON_MASK_LEFT)
	await _press(to, MOUSE_BUTTON_LEFT, false, 0)
	await frames(3)


## Returns the position in the window at which a drag of files begins.
func drag_origin(_paths: PackedStringArray) -> Vector2:
	var dock := EditorInterface.get_file_system_dock()
	return dock.get_global_transform_with_canvas() * (dock.size * 0.5)


func mouse_to(at: Vector2, buttons: int) -> void:
	var motion := InputEventMouseMotion.new()
	motion.position = at
	motion.global_position = at
	motion.relative = at - _mouse
	motion.velocity = motion.relative # Menus ignore motions without a velocity.
	_mouse = at
	motion.button_mask = buttons
	get_window().push_input(motion)
	await get_tree().process_frame


## Returns the control of the 3D view that receives mouse and key events.
func surface() -> Control:
	var container := camera().get_viewport().get_parent()
	for sibling: Node in container.get_parent().get_children():
		if sibling is Control and sibling != container and (sibling as Control).focus_mode == Control.FOCUS_ALL:
			return sibling
	return null


## Converts a world position to coordinates in the editor's window.
func on_screen(point: Vector3) -> Vector2:
	return surface().get_global_transform() * camera().unproject_position(point)


## Moves the mouse to a position in the window by pushing a motion event. `held` is the mask of pressed buttons.
func move_mouse(at: Vector2, held := 0, control := false, shift := false) -> void:
	var motion := InputEventMouseMotion.new()
	motion.position = at
	motion.global_position = at
	motion.button_mask = held
	motion.ctrl_pressed = control
	motion.shift_pressed = shift
	get_window().push_input(motion)
	await get_tree().process_frame


## Presses and releases a key in the main window.
func key(code: Key, keys := 0) -> void:
	for pressed: bool in [true, false]:
		var event := InputEventKey.new()
		event.keycode = code
		event.physical_keycode = code
		event.pressed = pressed
		event.ctrl_pressed = keys & KEY_MASK_CTRL
		event.shift_pressed = keys & KEY_MASK_SHIFT
		get_window().push_input(event)
		await get_tree().process_frame
	await frames(2)


## Presses and releases a key in a window, as system events.
func key_in(window: Window, code: Key) -> void:
	for pressed: bool in [true, false]:
		var event := InputEventKey.new()
		event.keycode = code
		event.physical_keycode = code
		event.pressed = pressed
		await send_to(window, event)


func send_to(window: Window, event: InputEventFromWindow) -> void:
	event.window_id = window.get_window_id()
	Input.parse_input_event(event)
	Input.flush_buffered_events()
	await frames(2)


## Undoes with the keyboard shortcut.
func undo() -> void:
	await key(KEY_Z, KEY_MASK_CTRL)


func redo() -> void:
	await key(KEY_Z, KEY_MASK_CTRL | KEY_MASK_SHIFT)


func _press(at: Vector2, index: MouseButton, pressed: bool, keys: int) -> void:
	var event := InputEventMouseButton.new()
	event.position = at
	event.global_position = at
	event.button_index = index
	event.pressed = pressed
	event.button_mask = MOUSE_BUTTON_MASK_LEFT if pressed else 0
	event.ctrl_pressed = keys & KEY_MASK_CTRL
	get_window().push_input(event)
	await get_tree().process_frame


## Presses or releases the left button at a position in the window.
func press(at: Vector2, pressed: bool, control := false, shift := false, double := false) -> void:
	var event := _button(at, pressed, control)
	event.global_position = at
	event.shift_pressed = shift
	event.double_click = double
	event.button_mask = MOUSE_BUTTON_MASK_LEFT if pressed else 0
	get_window().push_input(event)
	await get_tree().process_frame


func click_at(at: Vector2, control := false, shift := false, double := false) -> void:
	await move_mouse(at, 0, control, shift)
	await press(at, true, control, shift, double)
	await press(at, false, control, shift)


## Drags with the left button from one position in the window to another.
func drag_mouse(from: Vector2, to: Vector2, control := false, release := true) -> void:
	await move_mouse(from, 0, control)
	await press(from, true, control)
	for step in 4:
		await move_mouse(from.lerp(to, (step + 1) / 4.0), MOUSE_BUTTON_MASK_LEFT, control)
	if release:
		await press(to, false, control)


## Returns {tile: digest} for a layer's visible tiles.
func digests(scatter: Node3D, layer: int) -> Dictionary:
	var result := {}
	for tile: Vector2i in scatter.get_shown_tiles(scatter.layers[layer]):
		result[tile] = scatter.get_tile(scatter.layers[layer], tile).get_digest()
	return result


## Returns {ID: world position} for a layer's visible instances.
func instances(scatter: Node3D, layer: int) -> Dictionary:
	var result := {}
	for tile: Vector2i in scatter.get_shown_tiles(scatter.layers[layer]):
		var displayed_tile: RefCounted = scatter.get_tile(scatter.layers[layer], tile)
		for mesh: int in displayed_tile.get_mesh_count():
			var buffer: PackedFloat32Array = displayed_tile.get_buffer(mesh)
			var ids: PackedInt64Array = displayed_tile.get_ids(mesh)
			var stride := buffer.size() / maxi(1, ids.size())
			for index: int in ids.size():
				var at := index * stride
				var position := Vector3(buffer[at + 3], buffer[at + 7], buffer[at + 11])
				result[ids[index]] = displayed_tile.get_origin() + position
	return result


## Saves a screenshot of the editor's main window, or of another window, in build/editor. Has no effect without a display.
func picture(picture_name: String, window := get_window()) -> void:
	if DisplayServer.get_name() == "headless":
		return
	await frames(4)
	# The editor only draws after changes, so waiting for the next drawn frame might never end.
	for pass_index in 2:
		RenderingServer.force_draw()
		await get_tree().process_frame
	window.get_texture().get_image().save_png("res://pictures_of_tests/%s.png" % picture_name)


## Returns the names of the files in a folder.
func files(folder: String) -> PackedStringArray:
	return DirAccess.get_files_at(folder) if DirAccess.dir_exists_absolute(folder) else PackedStringArray()


## Returns the text of all of the editor's toasts.
func toast_text() -> String:
	var words := PackedStringArray()
	for label: Label in EditorInterface.get_editor_toaster().find_children("*", "Label", true, false):
		words.append(label.text)
	return " ".join(words)
