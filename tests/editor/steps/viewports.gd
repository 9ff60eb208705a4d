@tool
extends "res://tests/steps.gd"
## Tests the editor's 3D viewports: the orthogonal views along the axes, and a second viewport with another view. Also checks that the Scene dock
## marks a moved node.

const SCENE := "res://yard.tscn"
const VIEW_DISTANCE := 60.0
const SECOND := 2 ## The index of the second visible viewport. With two viewports, Godot shows the first and the third.

var scatter: Node3D


func viewport(index: int) -> SubViewport:
	return EditorInterface.get_editor_viewport_3d(index)


## Chooses a menu item by its text, in any menu under `parent`.
func choose(parent: Node, text: String) -> void:
	for menu: PopupMenu in parent.find_children("*", "PopupMenu", true, false):
		for index in menu.item_count:
			if menu.get_item_text(index) == text:
				menu.id_pressed.emit(menu.get_item_id(index))
				await frames(30) # The view takes several frames to rotate.
				return
	check(false, "there is a menu item " + text)


func view_control(index: int) -> Control:
	return viewport(index).get_parent().get_parent() as Control


## Assigns each visible tile to the nearest point. Returns the mean position of each point's tiles, or (0, 0) without tiles.
func shown_around(points: Array[Vector2]) -> Array[Vector2]:
	var sums: Array[Vector2] = []
	var counts: Array[int] = []
	for point in points:
		sums.append(Vector2.ZERO)
		counts.append(0)
	for tile: Vector2i in scatter.get_shown_tiles(scatter.layers[0]):
		var at := (Vector2(tile) + Vector2.ONE * 0.5) * 16.0
		var nearest := 0
		for index in points.size():
			nearest = index if at.distance_to(points[index]) < at.distance_to(points[nearest]) else nearest
		sums[nearest] += at
		counts[nearest] += 1
	var middles: Array[Vector2] = []
	for index in points.size():
		middles.append(sums[index] / maxf(counts[index], 1.0))
	return middles


## Returns the fraction of a viewport's pixels that are red.
func red(index: int) -> float:
	viewport(index).render_target_update_mode = SubViewport.UPDATE_ALWAYS
	await frames(2)
	for drawn in 2:
		RenderingServer.force_draw()
		await frames(1)
	var image := viewport(index).get_texture().get_image()
	image.resize(160, 120, Image.INTERPOLATE_NEAREST)
	var count := 0
	for x in 160:
		for y in 120:
			var pixel := image.get_pixel(x, y)
			count += int(pixel.r > 0.25 and pixel.g < 0.7 * pixel.r and pixel.b < 0.7 * pixel.r)
	return count / (160.0 * 120.0)


func test_open() -> void:
	var yard := Node3D.new()
	yard.name = "Yard"
	var new_scatter: Node3D = ClassDB.instantiate(&"TerrainScatter3D")
	new_scatter.name = "Scatter"
	new_scatter.ground = ClassDB.instantiate(&"ScatterGroundFlat")
	var material: Material = (load("res://addons/thicket/shaders/foliage.tres") as Material).duplicate()
	(material as ShaderMaterial).set_shader_parameter(&"albedo", Color.RED)
	var mesh := BoxMesh.new()
	mesh.size = Vector3.ONE * 1.5
	mesh.material = material
	var layer: Resource = ClassDB.instantiate(&"ScatterLayer")
	layer.radius = 2.0
	layer.tile_size = 16.0
	layer.view_distance = VIEW_DISTANCE
	layer.meshes = [mesh]
	new_scatter.layers = [layer]
	yard.add_child(new_scatter)
	new_scatter.owner = yard
	save_scene(yard, SCENE)
	scatter = (await open(SCENE)).get_node("Scatter")
	EditorInterface.set_main_screen_editor("3D")
	await frames(10)
	addon().hide_bottom_panel()
	await settle(scatter)
	check(await red(0) > 0.02, "the first view shows foliage")
	await picture("viewport_perspective")


func test_views_along_the_axes() -> void:
	for view: String in ["Top View", "Front View", "Right View"]:
		await choose(view_control(0), view)
		var camera := camera()
		check_equal(camera.projection, Camera3D.PROJECTION_ORTHOGONAL, "%s is orthogonal" % view)
		check(camera.global_position.length() > 1000.0, "%s: the camera is far away, at %s" % [view, camera.global_position])
		await settle(scatter)
		var middle := shown_around([Vector2.ZERO])[0]
		check(middle.length() < 20.0, "%s: the tiles surround %s" % [view, middle])
		var share: float = await red(0)
		check(share > 0.01, "%s shows foliage: fraction of red pixels %.3f" % [view, share])
		await picture("viewport_%s" % view.to_snake_case())


func test_every_visible_viewport_has_tiles() -> void:
	await choose(view_control(0), "Perspective")
	await choose(EditorInterface.get_editor_main_screen(), "2 Viewports")
	check(view_control(SECOND).is_visible_in_tree(), "there is a second viewport")
	var cameras: Array[Vector2] = []
	var first := viewport(0).get_camera_3d().global_position
	cameras.append(Vector2(first.x, first.z))
	var second := view_control(SECOND)
	var far := Node3D.new()
	far.name = "Far"
	far.position = Vector3(400.0, 0.0, 300.0)
	scatter.get_parent().add_child(far)
	EditorInterface.get_selection().clear()
	EditorInterface.get_selection().add_node(far)
	await frames(5)
	await choose(second, "Focus Selection")
	await settle(scatter)
	var at := viewport(SECOND).get_camera_3d().global_position
	check(Vector2(at.x, at.z).distance_to(Vector2(400.0, 300.0)) < 50.0, "the second view shows the node: from %s" % at)
	var middles := shown_around([cameras[0], Vector2(at.x, at.z)])
	check(middles[0].distance_to(cameras[0]) < 20.0, "tiles around the first view: %s, the camera is at %s" % [middles[0], cameras[0]])
	check(middles[1].distance_to(Vector2(at.x, at.z)) < 20.0, "tiles around the second view: %s, the camera is at %s" % [middles[1], at])
	check(await red(0) > 0.02 and await red(SECOND) > 0.02, "both show foliage")
	await picture("two_viewports")
	await choose(EditorInterface.get_editor_main_screen(), "1 Viewport")
	await settle(scatter)
	middles = shown_around([cameras[0], Vector2(at.x, at.z)])
	check_equal(middles[1], Vector2.ZERO, "a hidden viewport has no tiles")


func test_a_moved_node_is_marked() -> void:
	var marked: Array[Node] = []
	get_tree().node_configuration_warning_changed.connect(func(node: Node) -> void: marked.append(node))
	var parent := scatter.get_parent() as Node3D
	for node: Node3D in [scatter, parent]:
		for moved: bool in [true, false]:
			marked.clear()
			node.position.x = 5.0 if moved else 0.0
			await frames(3)
			check(scatter in marked, "%s moved %s: the Scene dock updates its warnings" % [node.name, moved])
			check_equal("global_transform" in "".join(scatter.get_problems()), moved, "%s moved" % node.name)
