@tool
extends "res://tests/steps.gd"
## Checks that baking a NavigationRegion3D with the editor's button excludes every trunk, wherever the camera is.

const SCENE := "res://grove.tscn"
const SIDE := 40.0

var region: NavigationRegion3D
var scatter: Node3D


func add(node: Node, title: String, parent: Node, owner_of_all: Node) -> Node:
	node.name = title
	parent.add_child(node)
	node.owner = owner_of_all
	return node


func test_open() -> void:
	var grove := Node3D.new()
	grove.name = "Grove"
	var made := add(NavigationRegion3D.new(), "Region", grove, grove) as NavigationRegion3D
	made.navigation_mesh = NavigationMesh.new()
	made.navigation_mesh.geometry_parsed_geometry_type = NavigationMesh.PARSED_GEOMETRY_MESH_INSTANCES
	var ground := add(MeshInstance3D.new(), "Ground", made, grove) as MeshInstance3D
	ground.mesh = PlaneMesh.new()
	(ground.mesh as PlaneMesh).size = Vector2(SIDE, SIDE)
	var trees: Node3D = ClassDB.instantiate(&"TerrainScatter3D")
	add(trees, "Scatter", made, grove)
	trees.ground = ClassDB.instantiate(&"ScatterGroundFlat")
	var layer: Resource = ClassDB.instantiate(&"ScatterLayer")
	layer.resource_name = "Trees"
	layer.radius = 4.0
	layer.view_distance = 3.0
	layer.tile_size = 8.0
	layer.meshes = [CylinderMesh.new()]
	layer.meshes[0].top_radius = 0.0
	layer.meshes[0].height = 8.0
	layer.collision_shape = 2 # COLLISION_CYLINDER.
	trees.layers = [layer]
	save_scene(grove, SCENE)
	var root := await open(SCENE)
	region = root.get_node("Region")
	scatter = root.get_node("Region/Scatter")
	EditorInterface.set_main_screen_editor("3D")
	EditorInterface.get_selection().clear()
	EditorInterface.get_selection().add_node(region)
	EditorInterface.edit_node(region)
	await settle(scatter)
	await frames(5)


func test_the_button() -> void:
	var found: int = scatter.query_rect(Rect2(-SIDE / 2.0, -SIDE / 2.0, SIDE, SIDE)).size()
	check(found > 50 and scatter.get_stats().instances < found, "%d instances, of which %d are loaded" % [found, scatter.get_stats().instances])
	var bake: Button
	for button: Button in EditorInterface.get_base_control().find_children("*", "Button", true, false):
		if button.is_visible_in_tree() and button.text.begins_with("Bake Navigation"):
			bake = button
	if not check(bake != null, "the engine's bake button is visible"):
		return
	await mouse_click(bake.get_global_transform_with_canvas() * (bake.size * 0.5))
	await until(func() -> bool: return region.navigation_mesh.get_polygon_count() > 10, "the navigation mesh is baked")
	var all: RefCounted = scatter.query_rect(Rect2(-SIDE / 2.0, -SIDE / 2.0, SIDE, SIDE))
	for index in all.size():
		check(not is_walkable(all.get_position(index)), "the trunk at %s is not walkable" % all.get_position(index))
	check(walkable_share() > 0.4, "most of the ground is walkable: %.2f" % walkable_share())
	scatter.layers[0].view_distance = 60.0
	camera().global_position = Vector3(0.0, 30.0, 26.0)
	camera().look_at(Vector3.ZERO)
	await settle(scatter)
	await picture("navigation")


func is_walkable(at: Vector3) -> bool:
	var vertices := region.navigation_mesh.get_vertices()
	for index in region.navigation_mesh.get_polygon_count():
		var outline := PackedVector2Array()
		for corner in region.navigation_mesh.get_polygon(index):
			outline.append(Vector2(vertices[corner].x, vertices[corner].z))
		if Geometry2D.is_point_in_polygon(Vector2(at.x, at.z), outline):
			return true
	return false


func walkable_share() -> float:
	var walkable := 0
	for x in 20:
		for z in 20:
			walkable += int(is_walkable(Vector3(2.0 * x - 19.0, 0.0, 2.0 * z - 19.0)))
	return walkable / 400.0
