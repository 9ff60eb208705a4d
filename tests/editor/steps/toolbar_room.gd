@tool
extends "res://tests/steps.gd"
## Checks that, with any tool, the toolbar fits into a window 1280 pixels wide: it wraps into more lines, and the docks keep their positions.

const SCENE := "res://room.tscn"
const NARROW := Vector2i(1280, 720)
const WIDE := Vector2i(1900, 1000)

var root: Node


func select(node: Node) -> void:
	EditorInterface.get_selection().clear()
	if node != null:
		EditorInterface.get_selection().add_node(node)
		EditorInterface.edit_node(node)
	await frames(8)


func resize(size: Vector2i) -> void:
	get_window().size = size
	await until(func() -> bool: return get_window().size == size, "the window is %d wide" % size.x)
	await frames(8)


## Returns the minimum width of the editor's main screen in pixels.
func minimum_width() -> float:
	return (EditorInterface.get_editor_main_screen() as Control).get_combined_minimum_size().x


## Checks that all visible controls of the toolbar are inside it and do not overlap.
func check_whole(context: String) -> void:
	var bar: Control = workspace().toolbar
	var before := Rect2()
	for control: Control in bar.find_children("*", "Control", true, false):
		if control.is_visible_in_tree() and control.get_parent() == bar:
			check(bar.get_global_rect().grow(1.0).encloses(control.get_global_rect()), "%s: %s is in the toolbar" % [context, control])
			check(not before.intersects(control.get_global_rect().abs()), "%s: %s does not overlap the previous control" % [context, control])
			before = control.get_global_rect()
			before.size = (before.size - Vector2.ONE).max(Vector2.ZERO)
	check(EditorInterface.get_editor_main_screen().get_global_rect().grow(1.0).encloses(bar.get_global_rect()), context + ": the toolbar is inside the view")


func lines() -> int:
	var tops := {}
	for control: Control in workspace().toolbar.get_children().filter(func(child: Node) -> bool: return child is Control and child.visible):
		tops[control.position.y] = true
	return tops.size()


func test_narrow() -> void:
	var room := Node3D.new()
	room.name = "Room"
	for made: Node3D in [ClassDB.instantiate(&"TerrainScatter3D"), MeshInstance3D.new()]:
		made.name = "Scatter" if made.is_class("TerrainScatter3D") else "Mesh"
		room.add_child(made)
		made.owner = room
	var layer: Resource = ClassDB.instantiate(&"ScatterLayer")
	layer.resource_name = "Spruce"
	room.get_node("Scatter").layers = [layer]
	room.get_node("Scatter").ground = ClassDB.instantiate(&"ScatterGroundFlat")
	(room.get_node("Mesh") as MeshInstance3D).mesh = PlaneMesh.new()
	save_scene(room, SCENE)
	root = await open(SCENE)
	EditorInterface.set_main_screen_editor("3D")
	await resize(NARROW)
	await select(null)
	var alone := minimum_width()
	await select(root.get_node("Scatter"))
	for tool: Node in workspace().toolbar.tools:
		tool.set_on(true)
		await frames(8)
		var name: String = tool.button.text
		check(minimum_width() <= alone + 40.0, "%s: the view needs %d pixels, without a scatter %d" % [name, minimum_width(), alone])
		var inspector := EditorInterface.get_inspector().get_global_rect()
		check(Rect2(Vector2.ZERO, NARROW).encloses(inspector), "%s: the inspector is in the window: %s" % [name, inspector])
		check(lines() > 1, name + ": the toolbar has several lines")
		check_whole(name)
	workspace().toolbar.paint.set_on(true)
	await frames(8)
	await picture("toolbar_narrow")
	workspace().toolbar.paint.set_on(false)


func test_wide() -> void:
	await resize(WIDE)
	check(lines() <= 2, "%d lines in a wide window" % lines())
	check_whole("wide")
	await picture("toolbar_wide")


## Checks that selecting or inspecting a scatter, a layer or a region does not move the edges of the 3D view.
func test_the_view_keeps_its_width() -> void:
	var scatter := root.get_node("Scatter")
	var region: Node = ClassDB.instantiate(&"ScatterRegion3D")
	scatter.add_child(region)
	region.owner = root
	await resize(Vector2i(1440, 900))
	await select(root.get_node("Mesh"))
	var edges := surface().get_global_rect()
	for object: Object in [scatter, scatter.layers[0], region]:
		if object is Node:
			await select(object as Node)
		else:
			EditorInterface.inspect_object(object, "", true)
			await frames(8)
		var now := surface().get_global_rect()
		check(now.position.x == edges.position.x and now.size.x == edges.size.x, "%s: %s instead of %s" % [object.get_class(), now, edges])
	region.free()


## Checks that, for other nodes, only the ground buttons are visible, next to the editor's tools.
func test_another_node() -> void:
	var ground: Control = workspace().ground_buttons
	var in_toolbar := ground.get_parent()
	await select(root.get_node("Mesh"))
	check(not workspace().toolbar.visible and ground.is_visible_in_tree(), "the ground's buttons stay for a mesh")
	check(in_toolbar == workspace().toolbar and ground.get_parent() == workspace().toolbar.get_parent(), "the ground's buttons are next to the toolbar")
	check_equal((ground.get_parent().get_parent() as Control).size_flags_horizontal, Control.SIZE_FILL, "the panel of the buttons is as wide as the buttons")
	await select(root.get_node("Scatter"))
	check(ground.get_parent() == in_toolbar and ground.is_visible_in_tree(), "they return to the toolbar")
	await resize(Vector2i(1440, 900))
