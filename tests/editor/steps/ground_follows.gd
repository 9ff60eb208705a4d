@tool
extends "res://tests/steps.gd"
## Checks that a click makes the selection the ground, and that undo and redo restore every byte. Also checks that the ground tracks moving nodes in
## the editor.

const SCENE := "res://meadow.tscn"
const HILL := "res://hill.tscn"
const MEADOW := 40.0

var scatter: Node3D
var meadow: MeshInstance3D
var rock: MeshInstance3D
var floor_body: StaticBody3D
var hill: Node3D


func buttons() -> Control:
	return workspace().ground_buttons


func button(text: String) -> Button:
	for found: Button in buttons().find_children("*", "Button", true, false):
		if found.text == text:
			return found
	check(false, "there is no button %s" % text)
	return null


## Clicks a button with the left mouse button, by sending events to its window.
func click(text: String) -> void:
	var on := button(text)
	check(on.is_visible_in_tree() and not on.disabled, "%s can be clicked" % text)
	var at := on.get_global_rect().get_center()
	for pressed: bool in [true, false]:
		var event := InputEventMouseButton.new()
		event.button_index = MOUSE_BUTTON_LEFT
		event.position = at
		event.global_position = at
		event.pressed = pressed
		on.get_viewport().push_input(event)
		await frames(2)


func select(nodes: Array[Node]) -> void:
	EditorInterface.get_selection().clear()
	for node in nodes:
		EditorInterface.get_selection().add_node(node)
	await frames(3)


func saved() -> String:
	check_equal(EditorInterface.save_scene(), OK, "the scene is saved")
	return FileAccess.get_file_as_string(SCENE)


func add(parent: Node, node: Node, node_name: String, root := parent) -> void:
	node.name = node_name
	parent.add_child(node)
	node.owner = root


func plane(size: float) -> MeshInstance3D:
	var instance := MeshInstance3D.new()
	instance.mesh = PlaneMesh.new()
	(instance.mesh as PlaneMesh).size = Vector2(size, size)
	instance.mesh.surface_set_material(0, StandardMaterial3D.new())
	(instance.mesh.surface_get_material(0) as StandardMaterial3D).albedo_color = Color(0.45, 0.4, 0.3)
	return instance


## Creates a scene without node groups, like most users' scenes: meshes, a body and an imported hill.
func test_prepare() -> void:
	var made_hill := Node3D.new()
	made_hill.name = "Hill"
	add(made_hill, plane(12.0), "Top")
	(made_hill.get_node("Top") as Node3D).position.y = 3.0
	save_scene(made_hill, HILL)
	var root := Node3D.new()
	root.name = "World"
	add(root, plane(MEADOW), "Meadow")
	add(root, plane(8.0), "Rock")
	(root.get_node("Rock") as Node3D).position = Vector3(8.0, 2.0, 4.0)
	var body := StaticBody3D.new()
	add(root, body, "Floor")
	var collision := CollisionShape3D.new()
	collision.shape = BoxShape3D.new()
	(collision.shape as BoxShape3D).size = Vector3(MEADOW, 2.0, MEADOW)
	add(body, collision, "Shape", root)
	body.collision_layer = 4
	body.position.y = -6.0
	add(root, (load(HILL) as PackedScene).instantiate(), "Hill")
	(root.get_node("Hill") as Node3D).position = Vector3(-10.0, 0.0, -8.0)
	var new_scatter: Node3D = ClassDB.instantiate(&"TerrainScatter3D")
	var layer: Resource = ClassDB.instantiate(&"ScatterLayer")
	layer.set(&"radius", 1.0)
	layer.set(&"tile_size", 16.0)
	layer.set(&"view_distance", 100.0)
	var post := CylinderMesh.new()
	post.top_radius = 0.0
	post.bottom_radius = 0.25
	post.height = 1.0
	post.radial_segments = 6
	post.rings = 1
	post.material = StandardMaterial3D.new()
	(post.material as StandardMaterial3D).albedo_color = Color(0.2, 0.6, 0.15)
	layer.set(&"height_offset", 0.5)
	layer.set(&"meshes", [post] as Array[Mesh])
	new_scatter.set(&"layers", [layer])
	add(root, new_scatter, "Meadow Flowers")
	var sun := DirectionalLight3D.new()
	sun.rotation_degrees = Vector3(-50.0, 30.0, 0.0)
	add(root, sun, "Sun")
	save_scene(root, SCENE)
	var opened := await open(SCENE)
	EditorInterface.set_main_screen_editor("3D")
	scatter = opened.get_node("Meadow Flowers")
	meadow = opened.get_node("Meadow")
	rock = opened.get_node("Rock")
	floor_body = opened.get_node("Floor")
	hill = opened.get_node("Hill")
	scatter.set(&"viewers", [scatter.get_path_to(meadow)] as Array[NodePath])
	await frames(5)


func test_use_the_selected_mesh() -> void:
	await select([])
	check(not buttons().visible, "no buttons without a selection")
	await select([opened_sun()])
	check(not buttons().visible, "no buttons for a light")
	var before := saved()
	await select([meadow])
	check(buttons().visible, "a mesh can become ground for the only scatter")
	await click("Use as Ground")
	var terrain: Resource = scatter.get(&"ground")
	if not check(terrain != null and terrain.is_class("ScatterGroundMeshes"), "the scatter has a ground"):
		return
	check_equal(terrain.get(&"group"), &"meadow_flowers_ground", "the ground uses a group named after the scatter")
	await select([scatter])
	await settle(scatter)
	var stand := instances(scatter, 0)
	check(stand.size() > 700, "%d instances on the meadow" % stand.size())
	var after := saved()
	check(after != before and "groups=[\"meadow_flowers_ground\"]" in after, "the group is saved")
	await look_from(Vector3(0.0, 14.0, 34.0))
	await picture("ground_meadow")
	await undo()
	check(scatter.get(&"ground") == null and not meadow.is_in_group("meadow_flowers_ground"), "undo removes the ground and the group")
	check_equal(saved(), before, "the scene is restored, byte for byte")
	await redo()
	check_equal(saved(), after, "redo restores the scene, byte for byte")
	await settle(scatter)
	check_equal(instances(scatter, 0), stand, "redo restores the instances")


func opened_sun() -> Node:
	return EditorInterface.get_edited_scene_root().get_node("Sun")


func test_more_meshes_join_with_the_scatter_selected() -> void:
	var before := saved()
	await select([scatter, rock, hill])
	check(buttons().visible, "the buttons are visible if the scatter is also selected")
	await click("Use as Ground")
	check(rock.is_in_group("meadow_flowers_ground"), "the rock joins the group")
	check(hill.get_node("Top").is_in_group("meadow_flowers_ground"), "the mesh in the hill's scene joins, too")
	await select([scatter])
	await settle(scatter)
	var heights := instances(scatter, 0).values().map(func(at: Vector3) -> float: return snappedf(at.y, 0.01))
	check(heights.count(2.5) > 30, "%d instances on the rock" % heights.count(2.5))
	check(heights.count(3.5) > 80, "%d instances on the hill" % heights.count(3.5))
	var after := saved()
	check("[editable path=\"Hill\"]" in after, "the hill's nodes are editable here")
	await picture("ground_joined")
	await undo()
	check_equal(saved(), before, "undo restores the scene, byte for byte")
	await redo()
	check_equal(saved(), after, "redo restores the scene, byte for byte")
	await select([rock])
	var version := history(scatter).get_version()
	await click("Use as Ground")
	check_equal(history(scatter).get_version(), version, "a mesh that is ground already does not change")
	await settle(scatter)


## Moves a mesh as the gizmo does: in several steps that end as one action.
func test_a_moved_mesh_is_detected() -> void:
	var manager := plugin.get_undo_redo()
	for step in 8:
		rock.position.x = 8.0 - 2.0 * step
		await frames(2)
	manager.create_action("Transform")
	manager.add_do_property(rock, &"position", Vector3(-8.0, 2.0, 6.0))
	manager.add_undo_property(rock, &"position", Vector3(8.0, 2.0, 4.0))
	manager.commit_action()
	await settle(scatter)
	check_on_rock("moved")
	await picture("ground_moved")
	await undo()
	await settle(scatter)
	check_on_rock("moved back")


func check_on_rock(context: String) -> void:
	var on_rock := instances(scatter, 0).values().filter(func(at: Vector3) -> bool: return absf(at.y - 2.5) < 0.01)
	check(on_rock.size() > 30, "%s: %d on the rock" % [context, on_rock.size()])
	check(on_rock.all(func(at: Vector3) -> bool:
			return absf(at.x - rock.position.x) < 4.01 and absf(at.z - rock.position.z) < 4.01), context + ": no instance floats in the air")


## Checks that, if only the scatter is selected, the button opens a dialog with the scene tree.
func test_pick_in_the_tree() -> void:
	await undo()
	await undo()
	check(scatter.get(&"ground") == null, "undo has removed the ground")
	await select([scatter])
	check(not button("Refresh Ground").visible, "the refresh button is hidden without a ground")
	await click("Use as Ground")
	var dialogs := EditorInterface.get_base_control().get_window().find_children("*", "SceneTreeDialog", true, false).filter(
			func(dialog: Window) -> bool: return dialog.visible)
	if not check_equal(dialogs.size(), 1, "a dialog with the scene tree opens"):
		return
	await picture("ground_pick", dialogs[0])
	var tree: Tree = dialogs[0].find_children("*", "Tree", true, false)[0]
	for item in [item_of(tree.get_root(), "Hill"), item_of(tree.get_root(), "Meadow")]:
		check(item != null and item.is_selectable(0), "imported scenes and meshes can be picked")
	dialogs[0].hide()
	dialogs[0].emit_signal(&"selected", hill.get_path())
	await frames(3)
	check(hill.get_node("Top").is_in_group("meadow_flowers_ground") and scatter.get(&"ground") != null, "the meshes of the imported scene are the ground")
	await undo()
	await select([scatter])
	await click("Use as Ground")
	dialogs[0].hide()
	dialogs[0].emit_signal(&"selected", meadow.get_path())
	await frames(3)
	check(meadow.is_in_group("meadow_flowers_ground") and scatter.get(&"ground") != null, "the picked node is the ground")
	await undo()


func test_use_a_body() -> void:
	check(scatter.get(&"ground") == null, "undo has removed the ground")
	var before := saved()
	await select([scatter, floor_body])
	await click("Use as Ground")
	var terrain: Resource = scatter.get(&"ground")
	if not check(terrain != null and terrain.is_class("ScatterGroundColliders"), "the scatter gets a ground of colliders"):
		return
	check_equal(terrain.get(&"collision_mask"), 4, "its rays use the body's layer")
	await select([scatter])
	await settle(scatter)
	check(instances(scatter, 0).size() > 700, "%d instances on the floor" % instances(scatter, 0).size())
	check(instances(scatter, 0).values().all(func(at: Vector3) -> bool: return absf(at.y + 4.5) < 0.01), "all instances are at the height of the floor")
	floor_body.position.y = -3.0
	await settle(scatter)
	check(instances(scatter, 0).values().all(func(at: Vector3) -> bool: return absf(at.y + 1.5) < 0.01), "a moved body is detected")
	var made := [0]
	scatter.tile_shown.connect(func(_layer: Resource, _tile: Vector2i) -> void: made[0] += 1)
	await click("Refresh Ground")
	await settle(scatter)
	check_equal(made[0], scatter.get_shown_tiles(scatter.layers[0]).size(), "the button casts all rays again")
	await picture("ground_body")
	floor_body.position.y = -6.0
	await undo()
	check_equal(saved(), before, "undo restores the scene, byte for byte")


## Returns a GridMap of [param side] x [param side] cells of 2 m, with their upper faces at height 1.
func grid(side: int) -> GridMap:
	var grid_map := GridMap.new()
	grid_map.mesh_library = MeshLibrary.new()
	grid_map.mesh_library.create_item(0)
	var block := BoxMesh.new()
	block.size = Vector3(2.0, 2.0, 2.0)
	block.material = StandardMaterial3D.new()
	grid_map.mesh_library.set_item_mesh(0, block)
	grid_map.cell_size = Vector3(2.0, 2.0, 2.0)
	grid_map.cell_center_y = false
	for x in side:
		for z in side:
			grid_map.set_cell_item(Vector3i(x, 0, z), 0)
	return grid_map


func test_use_a_grid_map_and_a_csg_node() -> void:
	check(scatter.get(&"ground") == null, "undo has removed the ground")
	var root := EditorInterface.get_edited_scene_root()
	add(root, grid(8), "Grid")
	add(root, CSGCombiner3D.new(), "Carved")
	var grid_map: GridMap = root.get_node("Grid")
	var csg: CSGShape3D = root.get_node("Carved")
	csg.position = Vector3(-10.0, 4.0, -8.0)
	var block := CSGCylinder3D.new()
	block.radius = 6.0
	block.height = 2.0
	add(csg, block, "Block", root)
	await frames(3)
	var before := saved()
	await select([csg.get_node("Block")])
	check(not buttons().visible, "a part of a CSG node cannot be ground by itself")
	await select([grid_map])
	check(buttons().visible, "a GridMap can be ground")
	await click("Use as Ground")
	var terrain: Resource = scatter.get(&"ground")
	if not check(terrain != null and terrain.is_class("ScatterGroundMeshes"), "the scatter gets a ground of meshes"):
		return
	await select([scatter])
	await settle(scatter)
	var heights := instances(scatter, 0).values().map(func(at: Vector3) -> float: return snappedf(at.y, 0.01))
	check(heights.count(1.5) > 100 and heights.count(1.5) == heights.size(), "%d of %d instances on the GridMap" % [heights.count(1.5), heights.size()])
	await select([csg])
	await click("Use as Ground")
	check(csg.is_in_group(&"meadow_flowers_ground") and grid_map.is_in_group(&"meadow_flowers_ground"), "the CSG node joins the group")
	check(not csg.get_node("Block").is_in_group(&"meadow_flowers_ground"), "its parts do not join the group")
	await select([scatter])
	await settle(scatter)
	heights = instances(scatter, 0).values().map(func(at: Vector3) -> float: return snappedf(at.y, 0.01))
	check(heights.count(5.5) > 60, "%d instances on the CSG node" % heights.count(5.5))
	await picture("ground_grid_and_csg")
	grid_map.set_cell_item(Vector3i(9, 1, 9), 0)
	await until(func() -> bool:
			return instances(scatter, 0).values().any(func(at: Vector3) -> bool: return absf(at.y - 3.5) < 0.01), "a painted cell is detected")
	grid_map.set_cell_item(Vector3i(9, 1, 9), GridMap.INVALID_CELL_ITEM)
	await undo()
	await undo()
	check(scatter.get(&"ground") == null, "undo has removed the ground")
	check_equal(saved(), before, "undo restores the scene, byte for byte")
	grid_map.free()
	csg.free()


func test_meshes_and_bodies_are_added_to_a_ground_of_another_kind() -> void:
	var flat: Resource = ClassDB.instantiate(&"ScatterGroundFlat")
	flat.set(&"height", 0.25)
	scatter.set(&"ground", flat)
	await select([meadow])
	check(button("Add to Ground").visible, "the mesh would replace the flat ground, so it can also be added")
	await select([scatter, rock])
	var before := saved()
	await click("Add to Ground")
	var combined: Resource = scatter.get(&"ground")
	if not check(combined.is_class("ScatterGroundCombined"), "both grounds are combined"):
		return
	check_equal(combined.get(&"grounds").size(), 2, "it combines two grounds")
	check(combined.get(&"grounds")[0] == flat, "the flat ground is kept")
	var after := saved()
	await select([scatter])
	await settle(scatter)
	var heights := instances(scatter, 0).values().map(func(at: Vector3) -> float: return snappedf(at.y, 0.01))
	check(heights.count(2.5) > 30 and heights.count(0.75) > 700, "instances are placed on the rock and next to it")
	await select([hill])
	await click("Add to Ground")
	check_equal(combined.get(&"grounds").size(), 2, "a second mesh joins the group")
	check(hill.get_node("Top").is_in_group("meadow_flowers_ground"), "the second mesh is in the group")
	await select([floor_body])
	await click("Add to Ground")
	check_equal(combined.get(&"grounds").size(), 3, "a body becomes a third ground")
	await undo()
	check_equal(combined.get(&"grounds").size(), 2, "undo removes the third ground")
	await undo()
	check_equal(saved(), after, "undo restores the scene, byte for byte")
	await undo()
	check(scatter.get(&"ground") == flat, "undo restores the flat ground")
	check_equal(saved(), before, "the scene is restored, byte for byte")
	scatter.set(&"ground", null)


## Moves the editor's camera and points it at the middle of the meadow.
func look_from(at: Vector3) -> void:
	camera().global_position = at
	camera().look_at(Vector3.ZERO)
	await frames(2)


func item_of(item: TreeItem, text: String) -> TreeItem:
	if item.get_text(0) == text:
		return item
	for child in item.get_children():
		var found := item_of(child, text)
		if found != null:
			return found
	return null
