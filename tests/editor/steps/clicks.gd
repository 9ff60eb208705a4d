@tool
extends "res://tests/steps.gd"
## Tests actions that could destroy a designer's work, with mouse and keys only, in the editor's window. The brush asks for confirmation before the
## first stroke, reports strokes that it cannot paint, and turns off when the node is deselected. Also adds a region from a menu, resizes it with a
## handle, and drags a radius in the inspector.

const SCENE := "res://yard.tscn"

var root: Node
var scatter: Node3D


func make_layer(title: String, radius: float) -> Resource:
	var layer: Resource = ClassDB.instantiate(&"ScatterLayer")
	layer.resource_name = title
	layer.meshes = [BoxMesh.new()]
	layer.meshes[0].size = Vector3(0.1, 0.3, 0.1)
	layer.radius = radius
	layer.view_distance = 60.0
	layer.tile_size = 16.0
	return layer


func button(text: String, parent: Node) -> Button:
	for found: Button in parent.find_children("*", "Button", true, false):
		if found.text == text and found.is_visible_in_tree() and not found.disabled:
			return found
	check(false, "there is no button " + text)
	return null


## Focuses a dialog's button with Tab and presses it with Enter. Clicks fail in a window that the pointer has not entered.
func press_in(dialog: Window, text: String) -> void:
	for step in 6:
		var focused := dialog.gui_get_focus_owner() as Button
		if focused != null and focused.text == text:
			await key_in(dialog, KEY_ENTER)
			return
		await key_in(dialog, KEY_TAB)
	check(false, "Tab does not reach the button " + text)


## Drags with the left mouse button in the 3D view, between two world positions.
func drag_in_view(from: Vector3, to: Vector3) -> void:
	await mouse_drag(on_screen(from), on_screen(to))


func selected() -> Array[Node]:
	return EditorInterface.get_selection().get_selected_nodes()


func saved() -> PackedByteArray:
	check_equal(EditorInterface.save_scene(), OK, "the scene is saved")
	return FileAccess.get_file_as_bytes(SCENE)


func test_open() -> void:
	var yard := Node3D.new()
	yard.name = "Yard"
	var new_scatter: Node3D = ClassDB.instantiate(&"TerrainScatter3D")
	new_scatter.name = "Scatter"
	new_scatter.ground = ClassDB.instantiate(&"ScatterGroundFlat")
	new_scatter.layers = [make_layer("Grass", 0.5), make_layer("Trees", 2.0)]
	yard.add_child(new_scatter)
	new_scatter.owner = yard
	var lamp := OmniLight3D.new()
	lamp.name = "Lamp"
	lamp.position = Vector3(3.0, 1.0, 0.0)
	yard.add_child(lamp)
	lamp.owner = yard
	save_scene(yard, SCENE)
	root = await open(SCENE)
	scatter = root.get_node("Scatter")
	EditorInterface.set_main_screen_editor("3D")
	await frames(10)
	addon().hide_bottom_panel()
	await mouse_click(row_of("Scatter"))
	check_equal(selected(), [scatter] as Array[Node], "a click in the Scene dock selects the scatter")
	await settle(scatter)
	saved()


## Checks that a click turns the brush on. The first stroke opens a confirmation dialog, and nothing changes until the user answers it.
func test_first_stroke() -> void:
	var before := saved()
	var initial := instances(scatter, 0)
	check(initial.size() > 1000, "%d instances" % initial.size())
	await mouse_click(middle(button("Brush", workspace().toolbar)))
	check(workspace().toolbar.paint.is_on(), "a click turns the brush on")
	workspace().toolbar.paint.set_brush(1.5, 1.0, 1.0)
	var dialog: ConfirmationDialog = workspace().toolbar.paint.first_stroke
	for answer: String in ["Cancel", "Only here", "Not here"]:
		await mouse_click(middle(button("Paint", workspace().toolbar)))
		await mouse_click(on_screen(Vector3(0.5, 0.0, 0.5)))
		if not check(dialog.visible, "the first stroke opens a dialog, answer %s" % answer):
			return
		await settle(scatter)
		check(instances(scatter, 0) == initial, "no instance is removed before the answer")
		if answer == "Cancel":
			await picture("clicks_first_stroke", dialog)
		await press_in(dialog, answer)
		check(not dialog.visible, answer + " closes the dialog")
		await settle(scatter)
		var left := instances(scatter, 0)
		var near := left.values().filter(func(at: Vector3) -> bool: return Vector2(at.x, at.z).distance_to(Vector2(0.5, 0.5)) < 1.0).size()
		match answer:
			"Cancel":
				check(left == initial, "the instances are unchanged")
			"Only here":
				check(near > 3 and left.size() < 60, "%d remain, %d of them where it was painted" % [left.size(), near])
			"Not here":
				check(near == 0 and left.size() > initial.size() / 2, "%d remain, %d of them where it was painted" % [left.size(), near])
				await until(workspace().toolbar.paint.mask_overlay.is_shown, "the mask is visible")
				await picture("clicks_mask")
		if answer != "Cancel":
			await undo()
			await settle(scatter)
			check(instances(scatter, 0) == initial, "undo restores the instances")
			check(not FileAccess.file_exists("res://yard_grass_mask.res"), "undo deletes the mask's file, too")
	check(saved() == before, "the scene is unchanged, byte for byte")


## Checks that a stroke that cannot be painted shows the reason. The brush still handles the drag, so the editor makes no box selection.
func test_a_stroke_that_cannot_be_painted() -> void:
	var ground: Resource = scatter.ground
	var layers: Array = scatter.layers
	for missing: String in ["ground", "layer"]:
		scatter.ground = ground if missing == "layer" else null
		scatter.layers = layers if missing == "ground" else []
		workspace().toolbar.update_layers()
		await drag_in_view(Vector3(-2.0, 0.0, -2.0), Vector3(4.5, 0.0, 2.0))
		check(missing in workspace().toolbar.paint.problem, "the problem names the missing %s: '%s'" % [missing, workspace().toolbar.paint.problem])
		check_equal(selected(), [scatter] as Array[Node], "the selection stays without a " + missing)
		await mouse_to(on_screen(Vector3(0.5, 0.0, 0.5)), 0)
		addon().update_overlays()
		await picture("clicks_no_" + missing)
	scatter.ground = ground
	scatter.layers = layers
	workspace().toolbar.update_layers()
	await settle(scatter)
	check(not workspace().toolbar.paint.first_stroke.visible, "no dialog opens")
	# With the brush off, the same drag selects the nodes in the box.
	await mouse_click(middle(button("Brush", workspace().toolbar)))
	check(not workspace().toolbar.paint.is_on(), "a click turns the brush off")
	await drag_in_view(Vector3(-2.0, 0.0, -2.0), Vector3(4.5, 0.0, 2.0))
	check(not selected() == ([scatter] as Array[Node]), "without the brush, the editor handles the drag: %s" % [selected()])
	await mouse_click(row_of("Scatter"))
	await settle(scatter)


## Checks that selecting another node turns the brush off, and that the editor then handles clicks in the view again.
func test_deselecting_turns_the_brush_off() -> void:
	await mouse_click(middle(button("Brush", workspace().toolbar)))
	check(workspace().toolbar.paint.is_on(), "the brush is on")
	await mouse_click(row_of("Lamp"))
	check(not workspace().toolbar.paint.is_on(), "selecting another node turns it off")
	await mouse_click(row_of("Scatter"))
	await settle(scatter)
	check(not workspace().toolbar.paint.is_on(), "it stays off when the scatter is selected again")
	await mouse_click(on_screen(Vector3(0.5, 0.0, 0.5)))
	check(not workspace().toolbar.paint.first_stroke.visible and scatter.layers[0].mask == null, "a click paints nothing")
	await mouse_click(row_of("Scatter"))
	await settle(scatter)


## Checks that a stroke on two selected layers, from pressing the mouse button to releasing it, is one undo step.
func test_a_stroke_on_two_layers() -> void:
	workspace().toolbar.choose_layers([scatter.layers[0], scatter.layers[1]] as Array[ScatterLayer])
	var before := saved()
	await mouse_click(middle(button("Brush", workspace().toolbar)))
	await mouse_click(middle(button("Erase", workspace().toolbar)))
	var version := history(scatter).get_version()
	await drag_in_view(Vector3(-2.0, 0.0, 0.0), Vector3(2.0, 0.0, 0.5))
	check_equal(history(scatter).get_version(), version + 1, "the stroke is one undo step")
	for layer: Resource in scatter.layers:
		check(layer.mask != null and layer.mask.sample(Vector2(-2.0, 0.0)) < 0.1 and layer.mask.sample(Vector2(2.0, 0.5)) < 0.1,
				layer.resource_name + " is painted from end to end")
	await settle(scatter)
	await until(workspace().toolbar.paint.mask_overlay.is_shown, "the mask is visible")
	for index in 2:
		check(instances(scatter, index).values().all(func(at: Vector3) -> bool: return absf(at.x) > 2.0 or absf(at.z - 0.25) > 0.8),
				scatter.layers[index].resource_name + " is removed along the stroke")
	await picture("clicks_stroke")
	await undo()
	check(saved() == before, "undo restores the scene, byte for byte")
	await redo()
	await undo()
	await mouse_click(middle(button("Brush", workspace().toolbar)))


## Adds an excluding region from the menu and drags one of its faces by the handle.
func test_a_region() -> void:
	await settle(scatter)
	var before := saved()
	var initial := instances(scatter, 0)
	var menu: MenuButton = workspace().toolbar.regions
	await mouse_click(middle(menu))
	var popup := menu.get_popup()
	check(popup.visible, "the menu opens")
	await picture("clicks_regions", popup)
	# The first item is a heading, followed by "Box".
	popup.set_focused_item(1)
	check_equal(popup.get_item_text(1), "Box", "the menu lists the box")
	await key_in(popup, KEY_ENTER)
	var regions := scatter.find_children("*", "ScatterRegion3D", true, false)
	if not check(regions.size() == 1 and regions[0].exclude, "one excluding region is added"):
		return
	var region := regions[0] as Node3D
	check_equal(selected(), [region] as Array[Node], "the region is selected")
	await frames(10)
	await settle(scatter)
	check(instances(scatter, 0).size() < initial.size(), "instances in the region are removed: %d of %d remain" % [instances(scatter, 0).size(), initial.size()])
	var size: Vector3 = region.size
	var across := region.to_global(Vector3(-0.5 * size.x, 0.0, 0.0))
	var handle := region.to_global(Vector3(0.5 * size.x, 0.0, 0.0))
	var version := history(scatter).get_version()
	# A handle must be drawn once before the mouse can hit it.
	await picture("clicks_region")
	await drag_in_view(handle, handle + Vector3(0.6, 0.0, 0.0))
	check_equal(history(scatter).get_version(), version + 1, "dragging the handle is one undo step")
	check(absf(region.size.x - size.x - 0.6) < 0.15 and region.size.y == size.y, "wider by the dragged distance: %s, was %s" % [region.size, size])
	check(region.to_global(Vector3(-0.5 * region.size.x, 0.0, 0.0)).distance_to(across) < 1e-3, "the opposite face stays")
	check_equal(selected(), [region] as Array[Node], "the region stays selected")
	await picture("clicks_handle")
	await undo()
	check(region.size == size, "undo restores the size: %s" % region.size)
	await undo()
	check(saved() == before, "undo of both steps restores the scene, byte for byte")
	await mouse_click(row_of("Scatter"))


## Drags the radius of two layers in the inspector. A drag multiplies the radius, so both radii shrink by the same factor. Before the editor generates
## far more instances than are visible, it asks for confirmation.
func test_a_radius_is_dragged() -> void:
	var factors: Array[float] = []
	for radius: float in [0.5, 8.0]:
		var layer: Resource = scatter.layers[0]
		layer.radius = radius
		await settle(scatter)
		EditorInterface.inspect_object(layer, "", true)
		await frames(6)
		var slider: EditorSpinSlider
		for editor: EditorProperty in EditorInterface.get_inspector().find_children("*", "EditorProperty", true, false):
			if editor.get_edited_property() == &"radius":
				slider = editor.find_children("*", "EditorSpinSlider", true, false)[0]
		if not check(slider != null and slider.exp_edit, "the inspector shows an exponential slider for the radius"):
			return
		await _point(middle(slider))
		await mouse_to(middle(slider), 0)
		await frames(3)
		var grabber := slider.find_children("*", "TextureRect", true, false)[0] as Control
		check(grabber.visible, "the slider shows its grabber while the mouse is over it")
		var at := grabber.get_global_rect().get_center()
		await mouse_drag(at, at + Vector2(-8.0, 0.0))
		await frames(3)
		factors.append(layer.radius / radius)
		await settle(scatter)
		if radius == 8.0:
			await picture("clicks_radius")
		check(layer.radius < radius and layer.radius > 0.05, "the radius shrinks to %.3f from %.3f" % [layer.radius, radius])
		await undo()
		check_equal(layer.radius, radius, "undo restores the radius")
	check(absf(factors[0] / factors[1] - 1.0) < 0.1, "both radii shrink by the same factor: %s" % [factors])
	scatter.layers[0].radius = 0.5


## Checks that a toast names the layers and the reason if the rules of a preset permit nothing on flat ground.
func test_a_preset_without_instances() -> void:
	await settle(scatter)
	var menu: MenuButton
	for found: MenuButton in workspace().toolbar.find_children("*", "MenuButton", true, false):
		menu = found if found.text == "Presets" else menu
	await mouse_click(middle(menu))
	check(menu.get_popup().visible, "the menu opens")
	var index := 0
	while menu.get_popup().get_item_text(index) != "Add Scree":
		index += 1
	menu.get_popup().set_focused_item(index)
	await key_in(menu.get_popup(), KEY_ENTER)
	check(scatter.layers.size() > 4, "the preset adds its layers: %d" % scatter.layers.size())
	await settle(scatter)
	await until(func() -> bool: return not toast_text().is_empty(), "a toast appears")
	check("No instances are visible here." in toast_text() and "Slope is 0°" in toast_text(), "the toast names the layers and the reason: " + toast_text())
	await get_tree().create_timer(1.0).timeout # Wait until the toast has faded in.
	await picture("clicks_scree")
	await undo()
	check_equal(scatter.layers.size(), 2, "undo removes the preset's layers")
