@tool
extends "res://tests/steps.gd"
## Tests regions that are added with a button or outlined with clicks, and handles that snap and keep the opposite face in place. Also tests a bake
## whose rectangle is drawn in the view, and which replaces the scatter there. Each of these actions is one undo step.

const SCENE := "res://park.tscn"
const BAKED := "res://baked"

var root: Node
var scatter: Node3D


func make_scene() -> void:
	var park := Node3D.new()
	park.name = "Park"
	scatter = ClassDB.instantiate(&"TerrainScatter3D")
	scatter.name = "Posts"
	scatter.position = Vector3(3.0, 1.0, -2.0)
	scatter.set(&"ground", ClassDB.instantiate(&"ScatterGroundFlat"))
	var layers: Array = []
	for name: String in ["Post", "Twig"]:
		var layer: Resource = ClassDB.instantiate(&"ScatterLayer")
		layer.resource_name = name
		layer.set(&"view_distance", 40.0)
		layer.set(&"tile_size", 16.0)
		layer.set(&"radius", 0.8)
		var mesh := BoxMesh.new()
		mesh.size = Vector3(0.1, 0.5, 0.1)
		layer.set(&"meshes", [mesh])
		layers.append(layer)
	scatter.set(&"layers", layers)
	park.add_child(scatter)
	scatter.owner = park
	save_scene(park, SCENE)


func scene_bytes() -> PackedByteArray:
	EditorInterface.save_scene()
	return FileAccess.get_file_as_bytes(SCENE)


func regions() -> Array[Node]:
	return scatter.find_children("*", "ScatterRegion3D", true, false)


func test_buttons() -> void:
	make_scene()
	root = await open(SCENE)
	scatter = root.get_node("Posts")
	EditorInterface.set_main_screen_editor("3D")
	await select_node(scatter)
	await settle(scatter)
	var before := scene_bytes()
	var menu: Node = workspace().toolbar.regions
	var middle := camera().global_position - camera().global_basis.z * (camera().global_position.y / camera().global_basis.z.y)
	for shape: int in [0, 1, 2]:
		for exclude: bool in [true, false]:
			var steps := history(scatter).get_version()
			menu._on_chosen(shape + (0 if exclude else 5))
			await frames(2)
			check_equal(history(scatter).get_version(), steps + 1, "shape %d is one step" % shape)
			var region: Node3D = regions()[0] if regions().size() == 1 else null
			if not check(region != null and region.shape == shape and region.exclude == exclude, "the button adds a region of shape %d" % shape):
				return
			check(region.global_position.distance_to(middle) < 0.1, "the region is in the middle of the view: %s" % region.global_position)
			check(workspace().toolbar.visible and workspace().dock.panel.tree.row_of(scatter.layers[0]) != null, "the tools and the panel stay")
			check(region.owner == root and EditorInterface.get_selection().get_selected_nodes() == [region], "the region belongs to the scene and is selected")
			var problems: PackedStringArray = scatter.get_problems() # Moving the scatter away from the origin causes one problem.
			check(problems.size() == 1 and "global_transform" in problems[0], "no other problems: %s" % problems)
			await undo()
			check(regions().is_empty(), "undone")
			await redo()
			check(regions().size() == 1 and regions()[0].owner == root, "redone")
			if shape == 4:
				check(regions()[0].get_node("Path3D").owner == root, "the region's Path3D belongs to the scene")
			await undo()
			await select_node(scatter)
	check(scene_bytes() == before, "the scene is unchanged, byte for byte")


## Checks that three clicks and Enter create a path: a smooth strip through the clicked positions, in one undo step.
func test_a_path_by_clicks() -> void:
	await settle(scatter)
	var before := scene_bytes()
	var tool: Node = workspace().toolbar.region_drawing
	var points: Array[Vector3] = [Vector3(-1.5, 0, -1), Vector3(0, 0, 0.8), Vector3(1.5, 0, -0.5)]
	surface().grab_focus()
	workspace().toolbar.regions._on_chosen(4)
	await click_at(on_screen(points[0]))
	await key(KEY_ENTER)
	check(tool.is_on() and "two points" in tool.problem, "one point is not a path: %s" % tool.problem)
	for point in points.slice(1):
		await click_at(on_screen(point))
	await picture("path")
	await key(KEY_ENTER)
	await frames(2)
	if not check(regions().size() == 1 and not tool.is_on(), "Enter adds a region and turns the tool off"):
		return
	var region: Node3D = regions()[0]
	var path: Path3D = region.get_node("Path3D")
	check_equal(path.curve.point_count, 3, "its path")
	for index in 3:
		var at := path.global_transform * path.curve.get_point_position(index)
		check(at.distance_to(points[index]) < 0.05, "point %d at %s" % [index, at])
	region.width = 0.5
	await settle(scatter)
	check(not instances(scatter, 0).values().any(func(at: Vector3) -> bool:
		return path.curve.get_closest_point(path.global_transform.affine_inverse() * at).distance_to(path.global_transform.affine_inverse() * at) < 0.2),
			"no instances are on the path")
	region.width = tool.WIDTH
	await picture("path_done")
	workspace().toolbar.hand.button.button_pressed = true
	await frames(3)
	check_equal(EditorInterface.get_selection().get_selected_nodes(), [scatter] as Array[Node], "a tool selects the scatter")
	check(workspace().toolbar.hand.is_on(), "the tool is on")
	workspace().toolbar.hand.set_on(false)
	await undo()
	await settle(scatter)
	check(scene_bytes() == before, "undo restores the saved scene, byte for byte")
	await select_node(scatter)


func test_a_polygon_by_clicks() -> void:
	await settle(scatter)
	var before := scene_bytes()
	var full := instances(scatter, 0)
	var tool: Node = workspace().toolbar.region_drawing
	var corners: Array[Vector3] = [Vector3(-1, 0, -1), Vector3(1.5, 0, -0.8), Vector3(1.2, 0, 1), Vector3(-0.8, 0, 1.2)]
	surface().grab_focus()
	var steps := history(scatter).get_version()
	workspace().toolbar.regions._on_chosen(3)
	check(tool.is_on(), "the tool is on")
	await click_at(on_screen(corners[0]))
	await key(KEY_ENTER)
	check(tool.is_on() and "three corners" in tool.problem, "one corner is not a region: %s" % tool.problem)
	await click_at(on_screen(Vector3(0.4, 0.0, 0.4)))
	await key(KEY_BACKSPACE)
	check_equal(tool.corners.size(), 1, "backspace removes a corner")
	for corner in corners.slice(1):
		await click_at(on_screen(corner))
	check_equal(tool.corners.size(), 4, "four corners")
	await picture("polygon")
	check(regions().is_empty() and history(scatter).get_version() == steps, "the scene has not changed yet")
	await key(KEY_ENTER)
	await frames(2)
	check_equal(history(scatter).get_version(), steps + 1, "one step")
	if not check(regions().size() == 1 and not tool.is_on(), "a region, and the tool is off"):
		return
	var region: Node3D = regions()[0]
	for index in 4:
		var at: Vector3 = region.global_transform * Vector3(region.polygon[index].x, 0.0, region.polygon[index].y)
		check(at.distance_to(corners[index]) < 0.05, "corner %d at %s" % [index, at])
	await settle(scatter)
	var left := instances(scatter, 0)
	check(left.size() < full.size() and not left.values().any(func(at: Vector3) -> bool: return at.length() < 0.7), "no instances are in the polygon")
	await picture("polygon_done")
	await undo()
	await settle(scatter)
	check(instances(scatter, 0) == full and scene_bytes() == before, "undo restores the instances and the saved scene")
	await select_node(scatter)
	# A double-click, or a click on the first corner, closes the polygon. Escape cancels it.
	for way: String in ["double", "first", "escape"]:
		surface().grab_focus()
		workspace().toolbar.regions._on_chosen(8)
		for corner in corners:
			await click_at(on_screen(corner))
		if way == "double":
			await click_at(on_screen(corners[3]), false, false, true)
		elif way == "first":
			await click_at(on_screen(corners[0]))
		else:
			await key(KEY_ESCAPE)
		await frames(2)
		check_equal(regions().size(), 0 if way == "escape" else 1, way)
		check(not tool.is_on(), "the tool is off after: %s" % way)
		if way != "escape":
			check(not regions()[0].exclude, "the region includes instead of excluding")
			await undo()
		await select_node(scatter)


## Drags a region's handle to a position in the space that the region has at the start of the drag.
func drag_handle(region: Node3D, handle: int, to: Vector3) -> void:
	var gizmo := region.get_gizmos()[0] as EditorNode3DGizmo
	var gizmos := gizmo.get_plugin()
	gizmos._begin_handle_action(gizmo, handle, false)
	var restore: Variant = gizmos._get_handle_value(gizmo, handle, false)
	var point := region.to_global(to)
	for step: float in [0.5, 1.0]:
		gizmos._set_handle(gizmo, handle, false, camera(), camera().unproject_position(point))
	gizmos._commit_handle(gizmo, handle, false, restore, false)


func hold(keycode: Key, pressed: bool) -> void:
	var event := InputEventKey.new()
	event.keycode = keycode
	event.physical_keycode = keycode
	event.pressed = pressed
	Input.parse_input_event(event)
	Input.flush_buffered_events()


func test_handles_keep_the_opposite_face() -> void:
	var region: Node3D = ClassDB.instantiate(&"ScatterRegion3D")
	region.size = Vector3(2.0, 2.0, 2.0)
	scatter.add_child(region)
	region.owner = root
	region.global_position = Vector3(0.2, 0.0, -0.1)
	region.rotation.y = 0.3
	EditorInterface.get_selection().clear()
	EditorInterface.get_selection().add_node(region)
	await frames(5)
	for handle in 6:
		var axis := handle / 2
		var side := 1.0 - 2.0 * (handle % 2)
		var outwards := Vector3.ZERO
		outwards[axis] = side
		var start := region.transform
		var across := region.to_global(-outwards)
		drag_handle(region, handle, outwards * 1.5)
		check(absf(region.size[axis] - 2.5) < 0.03, "handle %d: %s" % [handle, region.size])
		var stays := region.to_global(-outwards * 0.5 * region.size[axis])
		check(stays.distance_to(across) < 1e-3, "handle %d: the opposite face stays" % handle)
		await undo()
		check(region.size == Vector3(2.0, 2.0, 2.0) and region.transform == start, "handle %d: undone" % handle)
		hold(KEY_ALT, true)
		drag_handle(region, handle, outwards * 1.5)
		hold(KEY_ALT, false)
		check(absf(region.size[axis] - 3.0) < 0.03 and region.transform == start, "with Alt, both faces move: %s" % region.size)
		await undo()
	hold(KEY_CTRL, true)
	await frames(2)
	drag_handle(region, 0, Vector3(1.6, 0.0, 0.0))
	hold(KEY_CTRL, false)
	check_equal(region.size, Vector3(3.0, 2.0, 2.0), "with Ctrl, it snaps to whole meters")
	await undo()
	region.shape = 2
	region.height = 2.0
	await frames(2)
	var bottom := region.to_global(Vector3(0.0, -1.0, 0.0))
	drag_handle(region, 1, Vector3(0.0, 1.4, 0.0))
	check(absf(region.height - 2.4) < 0.03 and region.to_global(Vector3(0.0, -0.5 * region.height, 0.0)).distance_to(bottom) < 1e-3,
			"a cylinder keeps its bottom: %s" % region.height)
	await undo()
	region.free()
	await select_node(scatter)


## Draws the rectangle of a bake in the view. The bake must replace the scatter there, so that no instance exists twice.
func test_bake_and_replace() -> void:
	var by_hand: Node = workspace().toolbar.hand
	var edits: RefCounted = by_hand.edits
	await settle(scatter)
	check(edits.begin(scatter, SCENE), edits.problem)
	var inside: int = edits.add(scatter.layers[0], Transform3D(Basis(), Vector3(0.3, 0.0, 0.3)), 0)
	edits.commit("Plant")
	var before := scene_bytes()
	var state_file := "res://park_posts_state.res"
	var state := FileAccess.get_file_as_bytes(state_file)
	var dialog: Node = workspace().bake
	dialog.choose_folder(BAKED)
	dialog.open(scatter, Vector3.ZERO)
	dialog._draw.pressed.emit()
	await frames(2)
	var tool: Node = workspace().toolbar.rectangle
	check(not dialog.visible and tool.is_on(), "the dialog is hidden")
	surface().grab_focus()
	await drag_mouse(on_screen(Vector3(-1.05, 0.0, -0.97)), on_screen(Vector3(1.1, 0.0, 1.06)), false, false)
	await picture("rectangle")
	await press(on_screen(Vector3(1.1, 0.0, 1.06)), false)
	await frames(2)
	check(dialog.visible and not tool.is_on(), "the dialog is visible again")
	var rect := Rect2(-1.0, -1.0, 2.0, 2.0)
	check_equal(dialog._rect(), rect, "the rectangle")
	dialog.choose_replacing(true)
	dialog._layers.get_child(1).button_pressed = false
	await picture("bake_replace", dialog)
	var posts := instances(scatter, 0)
	var twigs := instances(scatter, 1)
	var expected := posts.values().filter(func(at: Vector3) -> bool: return rect.has_point(Vector2(at.x, at.z)))
	check(expected.any(func(at: Vector3) -> bool: return at.distance_to(Vector3(0.3, 0.0, 0.3)) < 1e-4), "one of the instances is hand-placed")
	var steps := history(scatter).get_version()
	dialog.start()
	await until(func() -> bool: return not dialog.is_processing(), "baked")
	dialog.hide()
	check_equal(dialog.job.problem, "", "no problem")
	check_equal(history(scatter).get_version(), steps + 1, "one step")
	var baked := scatter.get_node_or_null("Posts") as Node3D
	var both := baked != null and baked.owner == root and regions().size() == 1
	if not check(both, "the baked scene and a region: %s" % [scatter.get_children()]):
		return
	var found: Array[Vector3] = []
	for child: MultiMeshInstance3D in baked.get_children():
		for index in child.multimesh.instance_count:
			found.append(child.global_transform * child.multimesh.get_instance_transform(index).origin)
	check_equal(found.size(), expected.size(), "instances in the baked scene")
	for at: Vector3 in expected:
		check(found.any(func(other: Vector3) -> bool: return other.distance_to(at) < 1e-3), "%s is baked" % at)
	await settle(scatter)
	check(not scatter.has_instance(inside), "the hand-placed instance does not exist twice")
	check(instances(scatter, 0).size() == posts.size() - expected.size(), "the baked instances are no longer generated")
	check(instances(scatter, 1) == twigs, "the other layer is unchanged")
	await picture("replaced")
	await undo()
	await settle(scatter)
	check(instances(scatter, 0) == posts, "undone")
	check(scene_bytes() == before and FileAccess.get_file_as_bytes(state_file) == state, "undo restores the scene and the state, byte for byte")
	await redo()
	await settle(scatter)
	check(instances(scatter, 0).size() == posts.size() - expected.size() and scatter.has_node("Posts"), "redone")
