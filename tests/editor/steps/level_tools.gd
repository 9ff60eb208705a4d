@tool
extends "res://tests/steps.gd"
## Uses the tools on a floor below a bridge, on the bridge, on its underside, and on a wall: all of them act where the mouse points.

## The bottom and the top of the bridge, which is above the floor and 3 m wide along z.
const BRIDGE := Vector2(2.0, 2.3)
## The x of the wall's face, which faces -x.
const WALL := 4.0
## The rotations of the editor's camera about x and y, by view.
const VIEWS := {"above": Vector2(0.5, 0.5), "below": Vector2(-0.5, 0.5)}

var scatter: Node3D


func make_box(root: Node, title: String, size: Vector3, center: Vector3) -> void:
	var instance := MeshInstance3D.new()
	instance.name = title
	var box := BoxMesh.new()
	box.size = size
	instance.mesh = box
	instance.position = center
	instance.add_to_group(&"ground", true)
	root.add_child(instance)
	instance.owner = root


func make_layer(title: String, low: float, high: float) -> Resource:
	var layer: Resource = ClassDB.instantiate(&"ScatterLayer")
	layer.resource_name = title
	layer.radius = 0.5
	layer.tile_size = 16.0
	layer.view_distance = 40.0
	layer.on_surfaces = high > 0.0
	if high > 0.0:
		layer.max_slope_degrees = high
		layer.min_slope_degrees = low
	layer.align_to_normal = 1.0
	var mesh := BoxMesh.new()
	mesh.size = Vector3(0.1, 0.25, 0.1)
	layer.meshes = [mesh]
	return layer


## Makes a scene with a floor, a bridge and a wall. A layer grows on floors, one on walls, one on ceilings, and one on the top of the ground.
func make_scene(path: String, rotations: Vector2) -> void:
	var root := Node3D.new()
	root.name = "House"
	scatter = ClassDB.instantiate(&"TerrainScatter3D")
	scatter.name = "Plants"
	var meshes: Resource = ClassDB.instantiate(&"ScatterGroundMeshes")
	meshes.set(&"group", &"ground")
	scatter.ground = meshes
	scatter.layers = [make_layer("Moss", 0.0, 45.0), make_layer("Ivy", 60.0, 120.0), make_layer("Roots", 135.0, 180.0), make_layer("Grass", 0.0, 0.0)]
	root.add_child(scatter)
	scatter.owner = root
	if rotations.x > 0.0: # From below, the floor would hide the bridge.
		make_box(root, "Floor", Vector3(30.0, 1.0, 30.0), Vector3(0.0, -0.5, 0.0))
	make_box(root, "Bridge", Vector3(6.0, BRIDGE.y - BRIDGE.x, 3.0), Vector3(0.0, 0.5 * (BRIDGE.x + BRIDGE.y), 0.0))
	make_box(root, "Wall", Vector3(1.0, 4.0, 8.0), Vector3(WALL + 0.5, 2.0, 0.0))
	save_scene(root, path)
	save_view(path, 12.0, Vector3(0.0, 1.0, 0.0), rotations)


func enter(view: String) -> void:
	var path := "res://house_%s.tscn" % view
	make_scene(path, VIEWS[view])
	scatter = (await open(path)).get_node("Plants")
	EditorInterface.set_main_screen_editor("3D")
	await select_node(scatter)
	addon().hide_bottom_panel()
	await settle(scatter)
	await frames(5)
	surface().grab_focus()


func turn_on(tool_name: String, layer: int) -> Node:
	var tool: Node = workspace().toolbar.get(tool_name)
	tool.set_on(true)
	workspace().toolbar.choose_layer(layer)
	await frames(3)
	return tool


func rows() -> Array:
	return workspace().toolbar.why.panel.rows.map(func(row: Array) -> String: return row[1])


func has_row(start: String) -> bool:
	return rows().any(func(row: String) -> bool: return row.begins_with(start))


## Pins the explanation of a position, and checks that the instances there match.
func check_explained(at: Vector3, grows: String, context: String) -> void:
	var tool: Node = workspace().toolbar.why
	await click_at(on_screen(at))
	check(tool.pinned.is_finite() and tool.pinned.distance_to(at) < 0.03, "%s: pinned at %s, expected %s" % [context, tool.pinned, at])
	for layer: String in ["Moss", "Ivy", "Roots"]:
		var slope_allowed := not rows().any(func(row: String) -> bool: return row.begins_with("✗ %s: Slope" % layer))
		check_equal(slope_allowed, layer == grows, "%s: %s may grow here: %s" % [context, layer, rows()])


func test_why() -> void:
	await enter("above")
	await turn_on("why", 0)
	await check_explained(Vector3(-1.0, 0.0, 1.0), "Moss", "below the bridge")
	check(has_row("✗ Grass: Grows only on the top of the ground, 2.3 m above."), "the layer on the top: %s" % [rows()])
	await picture("levels_why")
	await check_explained(Vector3(-1.0, BRIDGE.y, 0.5), "Moss", "on the bridge")
	check(not has_row("✗ Grass: Grows only"), "the layer on the top grows on the bridge: %s" % [rows()])
	await check_explained(Vector3(WALL, 1.0, 2.5), "Ivy", "on the wall")
	workspace().toolbar.why.set_on(false)


## A stroke below the bridge paints there. The ring is on the floor, not on the bridge.
func test_brush() -> void:
	var tool := await turn_on("paint", 0)
	tool.choose_mode(1)
	tool.set_brush(1.0, 1.0, 1.0)
	var at := Vector3(-1.0, 0.0, 1.0)
	await move_mouse(on_screen(at))
	check(tool._cursor.is_among_levels(), "the bridge is above the brush")
	await picture("levels_brush")
	await click_at(on_screen(at))
	check_equal(tool.problem, "", "no problem")
	var mask: Resource = scatter.layers[0].mask
	if check(mask != null, "painted"):
		check(mask.sample(Vector2(at.x, at.z)) < 0.01 and mask.sample(Vector2(at.x, at.z - 3.0)) > 0.99, "painted where the mouse was")
	await undo()
	await move_mouse(on_screen(Vector3(WALL, 1.0, 2.5)))
	check(tool._cursor.is_on_wall(), "on the wall")
	await picture("levels_brush_wall")
	await move_mouse(on_screen(Vector3(-6.0, 0.0, 0.0)))
	check(not tool._cursor.is_among_levels(), "nothing is above the floor there")
	tool.choose_mode(0)
	tool.set_on(false)


func test_hand() -> void:
	var tool := await turn_on_hand()
	scatter.layers[0].density = 0.0
	await settle(scatter)
	for point: Vector3 in [Vector3(-1.0, 0.0, 1.0), Vector3(-1.0, BRIDGE.y, 0.5), Vector3(WALL, 1.0, 2.5)]:
		await click_at(on_screen(point), false, true)
		var planted: RefCounted = scatter.get_instance(tool.selected)
		check(planted != null and planted.transform.origin.distance_to(point) < 0.03, "planted at %s" % [planted.transform.origin if planted else tool.problem])
		await undo()
	tool.planting.choose(true, true, false, false)
	tool.planting.set_steps(0.5, 15.0)
	await click_at(on_screen(Vector3(-1.1, 0.0, 0.9)), false, true)
	var snapped: RefCounted = scatter.get_instance(tool.selected)
	check(snapped != null and snapped.transform.origin.distance_to(Vector3(-1.0, 0.0, 1.0)) < 0.001, "snapped on the floor: %s" % [snapped.transform.origin if snapped else tool.problem])
	await key(KEY_ESCAPE)
	tool.planting.choose(false, false, false, false)
	var start: Transform3D = snapped.transform
	await drag_mouse(on_screen(start.origin), on_screen(start.origin + Vector3(-1.0, 0.0, 0.2)))
	var moved: Transform3D = scatter.get_instance(tool.selected).transform
	check(moved.origin.distance_to(start.origin + Vector3(-1.0, 0.0, 0.2)) < 0.1 and absf(moved.origin.y) < 0.001, "moved on the floor: %s" % moved.origin)
	scatter.layers[0].density = 1.0
	tool.set_on(false)


## A polygon whose corners are clicked below the bridge gets these corners.
func test_region() -> void:
	await select_node(scatter)
	surface().grab_focus()
	workspace().toolbar.regions._on_chosen(3)
	var tool: Node = workspace().toolbar.region_drawing
	var corners: Array[Vector3] = [Vector3(-1.5, 0.0, 0.6), Vector3(0.5, 0.0, 0.6), Vector3(0.5, 0.0, 2.5), Vector3(-1.5, 0.0, 2.5)]
	for corner in corners:
		await click_at(on_screen(corner))
	check_equal(tool.corners.size(), 4, "four corners")
	for index in tool.corners.size():
		check(tool.corners[index].distance_to(corners[index]) < 0.03, "corner %d at %s" % [index, tool.corners[index]])
	await picture("levels_polygon")
	await key(KEY_ESCAPE)
	await select_node(scatter)


func test_underside() -> void:
	await enter("below")
	await turn_on("why", 2)
	await check_explained(Vector3(0.0, BRIDGE.x, 0.0), "Roots", "below the bridge")
	check(has_row("✗ Grass: Grows only on the top of the ground, 0.3 m above."), "the layer on the top: %s" % [rows()])
	await picture("levels_underside")
	workspace().toolbar.why.set_on(false)
	var tool := await turn_on("paint", 2)
	tool.choose_mode(1)
	tool.set_brush(2.0, 1.0, 1.0)
	var at := Vector3(0.5, BRIDGE.x, 0.3)
	await move_mouse(on_screen(at))
	await picture("levels_brush_underside")
	await click_at(on_screen(at))
	await settle(scatter)
	var left := instances(scatter, 2).values()
	check_equal(tool.problem, "", "no problem on the underside")
	check(not left.any(func(root: Vector3) -> bool: return root.distance_to(at) < 0.6), "no roots are left there")
	check(left.size() > 5, "roots are left elsewhere: %d" % left.size())
	tool.choose_mode(0)
	tool.set_on(false)
