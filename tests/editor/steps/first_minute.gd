@tool
extends "res://tests/steps.gd"
## Starts with an empty scene and adds three species that keep distances on a mesh ground, with the mouse only. The test types nothing and replaces no
## click with a script call.

const SCENE := "res://plot.tscn"
const GROUND := "res://hill.tscn"
const MODELS: PackedStringArray = ["res://old_oak.res", "res://young_pine.res", "res://fern.res"]

var root: Node
var _clicks := 0


func panel() -> Control:
	return workspace().dock.panel


func click(at: Vector2) -> void:
	_clicks += 1
	await mouse_click(at)


func button(text: String, parent: Node = EditorInterface.get_base_control()) -> Button:
	for found: Button in parent.find_children("*", "Button", true, false):
		if found.text == text and found.is_visible_in_tree() and not found.disabled:
			return found
	check(false, "there is no button " + text)
	return null


func save_packed(node: Node, path: String) -> void:
	save_scene(node, path)
	EditorInterface.get_resource_filesystem().update_file(path)


## Creates the designer's starting point: a hill from a modeling program, three plants, and an empty scene.
func test_prepare() -> void:
	var widths: Array[float] = [4.0, 3.0, 0.8]
	for index in 3:
		var mesh := CylinderMesh.new()
		mesh.top_radius = 0.0 if index == 1 else 0.5 * widths[index]
		mesh.bottom_radius = 0.5 * widths[index] if index == 1 else 0.1
		mesh.height = [5.0, 6.0, 0.5][index]
		mesh.radial_segments = 6
		mesh.rings = 0
		mesh.material = StandardMaterial3D.new()
		(mesh.material as StandardMaterial3D).albedo_color = [Color(0.4, 0.55, 0.15), Color(0.1, 0.35, 0.2), Color(0.5, 0.7, 0.2)][index]
		ResourceSaver.save(mesh, MODELS[index])
		EditorInterface.get_resource_filesystem().update_file(MODELS[index])
	var hill := Node3D.new()
	hill.name = "Hill"
	var top := MeshInstance3D.new()
	top.name = "Top"
	top.position.y = -9.0
	hill.add_child(top)
	top.owner = hill
	var sphere := SphereMesh.new()
	sphere.is_hemisphere = true
	sphere.radius = 70.0
	sphere.height = 9.0
	sphere.material = StandardMaterial3D.new()
	(sphere.material as StandardMaterial3D).albedo_color = Color(0.4, 0.36, 0.26)
	top.mesh = sphere
	save_packed(hill, GROUND)
	var plot := Node3D.new()
	plot.name = "Plot"
	save_packed(plot, SCENE)
	root = await open(SCENE)
	EditorInterface.set_main_screen_editor("3D")
	await frames(10)


func test_first_minute() -> void:
	await drag_files([GROUND], row_of("Plot"))
	if not check(root.has_node("Hill"), "the hill is dropped into the scene"):
		return
	# This has the same effect as a click on the panel's name. The call is repeated, because the editor may still be opening scenes of the last session.
	await until(func() -> bool:
		addon().make_bottom_panel_item_visible(panel())
		return panel().is_visible_in_tree(), "the panel is visible")
	await frames(10)
	await click(middle(button("New Scatter")))
	var scatter: Node3D = root.get_node_or_null("Scatter")
	if not check(scatter != null, "the button adds a scatter"):
		return
	await click(row_of("Hill"))
	await click(middle(button("Use as Ground")))
	check(scatter.ground != null and scatter.ground.is_class("ScatterGroundMeshes"), "the hill is its ground")
	await click(row_of("Scatter"))
	await get_tree().create_timer(0.6).timeout # The panel updates only a few times per second.
	await drag_files(MODELS, middle(panel().tree))
	check_equal(scatter.layers.size(), 3, "the drop adds three layers")
	check(scatter.layers.all(func(layer: Resource) -> bool: return layer.get(&"on_surfaces")), "they grow on every level of the hill's meshes")
	await settle(scatter)
	check_equal(_clicks, 4, "number of clicks, in addition to two drops")
	check(scatter.get_problems().is_empty(), "no problems: %s" % scatter.get_problems())
	check_species(scatter)
	await get_tree().create_timer(0.6).timeout
	await click(middle(button("Add Camera, Sun, Sky and Wind")))
	await get_tree().create_timer(0.6).timeout
	for kind: String in ["Camera3D", "DirectionalLight3D", "WorldEnvironment", "ScatterFoliageWorld"]:
		check_equal(root.find_children("*", kind, true, false).size(), 1, kind)
	check(panel().find_children("*", "Button", true, false).all(func(found: Button) -> bool:
		return not found.text.begins_with("Add Camera") or not found.is_visible_in_tree()), "the button for missing scene nodes is hidden")
	await picture("first_minute")
	await key(KEY_S, KEY_MASK_CTRL)
	await until(func() -> bool: return "ScatterGroundMeshes" in FileAccess.get_file_as_string(SCENE), "Ctrl+S saves the scene")
	var text := FileAccess.get_file_as_string(SCENE)
	check(text.length() < 5000 and not "MultiMesh" in text, "the scene is small and contains no instances: %d bytes" % text.length())
	var steps := 0
	while root.get_child_count() > 0 and steps < 7:
		await undo()
		steps += 1
	check(steps == 5 and root.get_child_count() == 0, "five undo steps restore the empty scene: %d" % steps)


## Performs the steps of the tutorial "A first forest", again from an empty scene.
func test_a_preset() -> void:
	_clicks = 0
	await drag_files([GROUND], row_of("Plot"))
	await click(middle(button("New Scatter")))
	await click(row_of("Hill"))
	await click(middle(button("Use as Ground")))
	await click(row_of("Scatter"))
	await get_tree().create_timer(0.6).timeout
	var menu := button("Add Layer") as MenuButton
	await click(middle(menu))
	for item in menu.get_popup().item_count:
		if menu.get_popup().get_item_text(item) == "Forest":
			_clicks += 1
			menu.get_popup().set_focused_item(item)
			await key_in(menu.get_popup(), KEY_ENTER)
	var scatter: Node3D = root.get_node("Scatter")
	await settle(scatter)
	await get_tree().create_timer(0.6).timeout
	await click(middle(button("Add Camera, Sun, Sky and Wind")))
	await settle(scatter)
	check_equal(_clicks, 7, "number of clicks, in addition to one drop")
	check(scatter.layers.size() > 3 and scatter.get_problems().is_empty(), "a forest without problems: %s" % scatter.get_problems())
	for layer: Resource in scatter.layers:
		check(scatter.get_shown_count(layer) > 0, "%s: %d instances" % [layer.resource_name, scatter.get_shown_count(layer)])
	await picture("first_preset")


## Checks that all instances are on the hill and keep their distances, both within and between species.
func check_species(scatter: Node3D) -> void:
	var all: Array[PackedVector2Array] = []
	for index in 3:
		var points := PackedVector2Array()
		for at: Vector3 in instances(scatter, index).values():
			check(absf(at.y - scatter.ground.get_height(at)) < 0.3, "%s at %s is on the hill" % [scatter.layers[index].resource_name, at])
			if Vector2(at.x, at.z).length() < 25.0:
				points.append(Vector2(at.x, at.z))
		check(points.size() > 10, "%d of %s near the top" % [points.size(), scatter.layers[index].resource_name])
		all.append(points)
	for one in 3:
		for other in range(one, 3):
			var apart: float = scatter.layers[one].radius if one == other else scatter.layers[other].spacing.get(scatter.layers[one].resource_name, 0.0)
			var nearest := INF
			for a in all[one]:
				for b in all[other]:
					nearest = minf(nearest, a.distance_to(b) if a != b else INF)
			check(apart > 0.3 and nearest >= apart - 0.01, "%d and %d are %.2f m apart, expected %.2f" % [one, other, nearest, apart])
