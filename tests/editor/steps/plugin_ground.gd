@tool
extends "res://tests/steps.gd"
## Tests terrain plugins as ground in the editor, with stand-ins for Terrain3D and HTerrain. The tests sculpt the stand-ins as the plugins' brushes
## do, and free and replace them. The instances must stay on the ground. Then water rises over the same ground.

const SCENE := "res://plugin_ground.tscn"

var scatter: Node3D
var root: Node3D
var shown_tiles: Array[Vector2i] = []


## Returns the script of a stand-in for a terrain plugin, from the copies that run in the editor.
func double(script: String) -> GDScript:
	return load("res://doubles/%s.gd" % script)


func test_prepare() -> void:
	var world := Node3D.new()
	world.name = "World"
	var trees: Node3D = ClassDB.instantiate(&"TerrainScatter3D")
	trees.name = "Trees"
	var layer: Resource = ClassDB.instantiate(&"ScatterLayer")
	layer.set(&"radius", 1.5)
	layer.set(&"tile_size", 16.0)
	layer.set(&"view_distance", 100.0)
	var cone := CylinderMesh.new()
	cone.top_radius = 0.0
	cone.bottom_radius = 0.4
	cone.height = 2.0
	cone.radial_segments = 6
	cone.rings = 1
	cone.material = StandardMaterial3D.new()
	(cone.material as StandardMaterial3D).albedo_color = Color(0.15, 0.5, 0.15)
	layer.set(&"height_offset", 1.0)
	layer.set(&"meshes", [cone] as Array[Mesh])
	trees.set(&"layers", [layer])
	world.add_child(trees)
	trees.owner = world
	var sun := DirectionalLight3D.new()
	sun.rotation_degrees = Vector3(-50.0, 30.0, 0.0)
	world.add_child(sun)
	sun.owner = world
	save_scene(world, SCENE)
	root = await open(SCENE)
	EditorInterface.set_main_screen_editor("3D")
	scatter = root.get_node("Trees")
	scatter.set(&"viewers", [^".."] as Array[NodePath])
	scatter.tile_shown.connect(func(_layer: Resource, tile: Vector2i) -> void: shown_tiles.push_back(tile))
	await frames(3)


## Moves the camera above the ground and takes a screenshot.
func photograph(picture_name: String) -> void:
	camera().global_position = Vector3(35.0, 50.0, 85.0)
	camera().look_at(Vector3(0.0, 0.0, 5.0))
	await frames(2)
	await picture(picture_name)


## Makes a node the scatter's ground in an undoable action, as the inspector does.
func set_ground(path: NodePath) -> void:
	var terrain: Resource = ClassDB.instantiate(&"ScatterGroundNode")
	terrain.set(&"node", path)
	var manager := plugin.get_undo_redo()
	manager.create_action("Set terrain", UndoRedo.MERGE_DISABLE, scatter)
	manager.add_do_property(scatter, &"ground", terrain)
	manager.add_undo_property(scatter, &"ground", scatter.get(&"ground"))
	manager.commit_action()
	await settle(scatter)


## Adds a plugin's node to the scene without an owner, so that it is not saved.
func put(node: Node3D, node_name: String) -> void:
	node.name = node_name
	root.add_child(node)


## Draws the ground as a mesh for the screenshot, because the stand-in does not draw it.
func draw_ground(height_at: Callable) -> void:
	var old := root.get_node_or_null("Drawn")
	if old != null:
		old.free()
	var surface := SurfaceTool.new()
	surface.begin(Mesh.PRIMITIVE_TRIANGLES)
	for row in 63:
		for column in 63:
			for corner: Vector2i in [Vector2i(0, 0), Vector2i(1, 0), Vector2i(0, 1), Vector2i(1, 0), Vector2i(1, 1), Vector2i(0, 1)]:
				var at := Vector3(2.0 * (column + corner.x) - 63.0, 0.0, 2.0 * (row + corner.y) - 63.0)
				at.y = height_at.call(at)
				surface.add_vertex(at)
	surface.generate_normals()
	var drawn := MeshInstance3D.new()
	drawn.name = "Drawn"
	drawn.mesh = surface.commit()
	drawn.material_override = StandardMaterial3D.new()
	(drawn.material_override as StandardMaterial3D).albedo_color = Color(0.5, 0.42, 0.3)
	root.add_child(drawn)


## Checks that all instances are on the current ground, with their origins 1 m above it.
func check_ground(height_at: Callable, context: String) -> void:
	var stand := instances(scatter, 0)
	var off := stand.values().filter(func(at: Vector3) -> bool: return not (absf(height_at.call(at) + 1.0 - at.y) < 0.02))
	check(stand.size() > 1500, "%s: %d instances" % [context, stand.size()])
	check_equal(off.size(), 0, "%s: instances off the ground" % context)


## Raises a hill in steps, as a brush does while the mouse moves. Checks that at most a third of the tiles were regenerated.
func sculpt(raise: Callable, height_at: Callable, context: String) -> void:
	var all: int = scatter.get_shown_tiles(scatter.layers[0]).size()
	shown_tiles.clear()
	for step in 4:
		raise.call(3.0 * (step + 1))
		await frames(2)
	await settle(scatter)
	check_ground(height_at, context)
	var tiles := {}
	for tile in shown_tiles:
		tiles[tile] = true
	check(not tiles.is_empty() and tiles.size() <= all / 3, "%s: %d of %d tiles were regenerated" % [context, tiles.size(), all])
	draw_ground(height_at)
	await photograph(context)


func test_terrain3d() -> void:
	var node: Node3D = double("terrain3d_harness").make_terrain3d()
	put(node, "Terrain3D")
	var height_at: Callable = node.data.height_at
	await set_ground(^"../Terrain3D")
	check("Terrain3D" in scatter.ground.get(&"recognized"), "recognized: %s" % scatter.ground.get(&"recognized"))
	check_ground(height_at, "at first")
	check_equal(node.data.point_calls, 0, "calls for single positions")
	await sculpt(func(height: float) -> void:
		for x in range(-6, 7):
			for z in range(-6, 7):
				node.data.set_height(Vector3(10.5 + x, 0.0, 10.5 + z), height)
		node.data.height_maps_changed.emit()
		node.data.maps_edited.emit(AABB(Vector3(4.0, -50.0, 4.0), Vector3(14.0, 100.0, 14.0))), height_at, "ground_terrain3d")
	check(instances(scatter, 0).values().any(func(at: Vector3) -> bool: return absf(at.y - 13.0) < 0.02), "some instances are on the new hill")
	node.free()
	await until(func() -> bool: return "Terrain3D" in "\n".join(scatter.get_problems()), "a freed node is reported")
	var other: Node3D = double("terrain3d_harness").make_terrain3d()
	put(other, "Terrain3D")
	await until(func() -> bool: return scatter.get_problems().is_empty(), "a new node with the same name is found")
	await settle(scatter)
	check_ground(other.data.height_at, "after the node was replaced")


func test_hterrain() -> void:
	var node: Node3D = double("hterrain_harness").make_hterrain()
	put(node, "HTerrain")
	await set_ground(^"../HTerrain")
	check("HTerrain" in scatter.ground.get(&"recognized"), "recognized: %s" % scatter.ground.get(&"recognized"))
	check_ground(node.ground_at, "at first")
	check_equal(node.get_data().point_calls, 0, "calls for single positions")
	await sculpt(func(height: float) -> void:
		for column in range(20, 27):
			for row in range(20, 27):
				node.get_data().set_post(column, row, height)
		node.get_data().notify_region_change(Rect2i(20, 20, 7, 7), 0), node.ground_at, "ground_hterrain")


func buttons() -> Control:
	return workspace().ground_buttons


## Selects nodes and presses a button above the 3D view.
func use_button(text: String, nodes: Array[Node]) -> void:
	EditorInterface.get_selection().clear()
	for node in nodes:
		EditorInterface.get_selection().add_node(node)
	await frames(3)
	check(buttons().visible, "%s: the buttons are visible" % text)
	for found: Button in buttons().find_children("*", "Button", true, false):
		if found.text == text:
			check(found.is_visible_in_tree(), "%s can be pressed" % text)
			found.pressed.emit()
	await frames(3)
	EditorInterface.get_selection().clear()
	await frames(3)
	await settle(scatter)


func test_use_terrains_as_ground() -> void:
	var before: Resource = scatter.get(&"ground")
	var plugins := double("plugins_harness")
	var grid: Node3D = plugins.MTerrainDouble.new()
	put(grid, "MTerrain")
	var brush: Node3D = plugins.TerraBrushDouble.new()
	brush.add_zone(Vector2i.ZERO)
	put(brush, "TerraBrush")
	for node: Node3D in [grid, brush]:
		await use_button("Use as Ground", [scatter, node])
		var terrain: Resource = scatter.get(&"ground")
		check(terrain.is_class("ScatterGroundNode") and terrain.get(&"node") == NodePath("../" + str(node.name)), "%s is the ground" % node.name)
		check(instances(scatter, 0).size() > 500, "%d instances on %s" % [instances(scatter, 0).size(), node.name])
		check_equal(scatter.get_problems().size(), 0, "%s: problems: %s" % [node.name, scatter.get_problems()])
		await use_button("Use as Ground", [scatter, node])
		check(scatter.get(&"ground") == terrain, "pressing the button again keeps the ground of %s" % node.name)
		await undo()
		check(scatter.get(&"ground") == before, "%s: undone" % node.name)
		await settle(scatter)
	grid.free()
	brush.free()


func test_use_voxels_as_ground() -> void:
	var before: Resource = scatter.get(&"ground")
	var voxels: Node3D = double("plugins_harness").VoxelTerrainDouble.new()
	voxels.position = Vector3(-32.0, -8.0, -32.0)
	voxels.collision_layer = 8
	put(voxels, "Voxels")
	voxels.generate_collisions = false
	await use_button("Use as Ground", [scatter, voxels])
	check(scatter.get(&"ground") == before, "voxels without bodies are not ground")
	voxels.generate_collisions = true
	for x in 4:
		for z in 4:
			voxels.mesh_block(Vector3i(x, 0, z), 8.0)
	await use_button("Use as Ground", [scatter, voxels])
	var terrain: Resource = scatter.get(&"ground")
	check(terrain.is_class("ScatterGroundColliders"), "the ground samples colliders")
	check_equal(terrain.get(&"collision_mask"), 8, "its rays hit the bodies of the blocks")
	await until(func() -> bool: return instances(scatter, 0).size() > 500, "instances appear on the blocks")
	check(instances(scatter, 0).values().all(func(at: Vector3) -> bool: return absf(at.y - 1.0) < 0.01), "all instances are on top of the blocks")
	await undo()
	check(scatter.get(&"ground") == before, "undone")
	await settle(scatter)
	voxels.free()


## Enables water as the inspector does. Instances under water must disappear, and Ctrl+Z must restore them.
func test_water_rises() -> void:
	var before := instances(scatter, 0)
	var manager := plugin.get_undo_redo()
	manager.create_action("Set water", UndoRedo.MERGE_DISABLE, scatter)
	for property: StringName in [&"water_enabled", &"water_level"]:
		manager.add_do_property(scatter, property, true if property == &"water_enabled" else 4.0)
		manager.add_undo_property(scatter, property, scatter.get(property))
	manager.commit_action()
	await settle(scatter)
	var dry := instances(scatter, 0)
	check(dry.size() > 200 and dry.size() < before.size() - 200, "%d of %d instances remain" % [dry.size(), before.size()])
	check(dry.values().all(func(at: Vector3) -> bool: return at.y - 1.0 > 3.99), "all of them are above the water")
	for id: int in dry:
		if dry[id] != before[id]:
			check(false, "the remaining instances have not moved")
			break
	var lake := MeshInstance3D.new()
	lake.mesh = PlaneMesh.new()
	(lake.mesh as PlaneMesh).size = Vector2(126.0, 126.0)
	lake.material_override = StandardMaterial3D.new()
	(lake.material_override as StandardMaterial3D).albedo_color = Color(0.2, 0.4, 0.7)
	lake.position.y = 4.0
	root.add_child(lake)
	await photograph("water")
	lake.free()
	EditorInterface.get_selection().clear()
	await undo()
	await settle(scatter)
	check_equal(instances(scatter, 0), before, "as before")
