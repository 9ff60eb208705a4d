@tool
extends "res://tests/steps.gd"
## Tests the tool that explains why an instance exists at a position or not: hovering, pinning, and the colors on the ground.

const SCENE := "res://demo.tscn"

var scatter: Node3D


func make_layer(layer_name: String, radius: float, size: Vector3) -> Resource:
	var mesh := BoxMesh.new()
	mesh.size = size
	var layer: Resource = ClassDB.instantiate(&"ScatterLayer")
	layer.resource_name = layer_name
	layer.radius = radius
	layer.view_distance = 70.0
	layer.tile_size = 40.0
	layer.meshes = [mesh]
	return layer


## Makes three layers on the demo's ground, with trees only on gentle slopes. Hides the demo's forest, which software rendering draws slowly.
func make_scatter() -> void:
	var root := await open(SCENE)
	root.get_node(^"Scatter").visible = false
	root.get_node(^"Sun").shadow_enabled = false
	var new_scatter: Node3D = ClassDB.instantiate(&"TerrainScatter3D")
	new_scatter.name = "Hills"
	new_scatter.ground = root.get_node(^"Scatter").ground
	var trees := make_layer("Trees", 6.0, Vector3(0.6, 5.0, 0.6))
	trees.max_slope_degrees = 18.0
	trees.slope_falloff_degrees = 6.0
	var stones := make_layer("Stones", 3.0, Vector3(1.2, 0.8, 1.0))
	stones.min_slope_degrees = 14.0
	var grass := make_layer("Grass", 2.0, Vector3(0.15, 0.6, 0.15))
	grass.density = 0.5
	grass.progressive_levels = 3
	grass.clump_size = 14.0
	grass.clump_coverage = 0.5
	grass.spacing = {"Trees": 2.0}
	new_scatter.layers = [trees, stones, grass]
	root.add_child(new_scatter)
	new_scatter.owner = root
	scatter = new_scatter


func tool() -> Control:
	return workspace().toolbar.why


## Moves the mouse to a pixel position in the 3D view by pushing an event to the window.
func hover(at: Vector2) -> void:
	var motion := InputEventMouseMotion.new()
	motion.position = view_origin() + at
	motion.global_position = motion.position
	get_tree().root.push_input(motion, true)
	await frames(2)


func click(at: Vector2) -> void:
	for pressed: bool in [true, false]:
		var button := _button(view_origin() + at, pressed, false)
		button.global_position = button.position
		get_tree().root.push_input(button, true)
		await frames(1)


func view_origin() -> Vector2:
	return (EditorInterface.get_editor_viewport_3d(0).get_parent() as Control).get_global_rect().position


func rows() -> Array:
	return tool().panel.rows.map(func(row: Array) -> String: return row[1])


func test_hover() -> void:
	await make_scatter()
	EditorInterface.set_main_screen_editor("3D")
	await select_node(scatter)
	addon().hide_bottom_panel() # Enlarges the 3D view.
	await settle(scatter)
	tool().set_on(true)
	workspace().toolbar.choose_layer(0)
	check(tool().visible, "the tool shows its settings")
	var size := EditorInterface.get_editor_viewport_3d(0).get_visible_rect().size
	var answers := {}
	for step in 12:
		await hover(Vector2(size.x * (0.2 + 0.05 * step), size.y * 0.6))
		if not await until(func() -> bool: return rows().size() > 2, "an explanation at step %d" % step):
			return
		await get_tree().create_timer(0.1).timeout
		var at: Vector3 = tool()._cursor.on_ground
		for explanation: RefCounted in scatter.explain_position(at):
			var sign := "✓" if explanation.refused_by.is_empty() else "✗"
			var line := "%s %s: %s" % [sign, explanation.layer_name, explanation.reason]
			check(line in rows(), "'%s' is among %s" % [line, rows()])
			answers["%s %s" % [sign, explanation.layer_name]] = true
	check(answers.size() >= 4, "different positions have different explanations: %s" % [answers.keys()])
	check(rows().any(func(row: String) -> bool: return "Slope is" in row), "the rules of the selected layer are listed: %s" % [rows()])
	await picture("why")


func test_pin() -> void:
	var size := EditorInterface.get_editor_viewport_3d(0).get_visible_rect().size
	var at := Vector2(size.x * 0.45, size.y * 0.55)
	await hover(at)
	await click(at)
	check(tool().pinned.is_finite(), "a click pins the explanation")
	var pinned := rows()
	await hover(Vector2(size.x * 0.8, size.y * 0.8))
	await get_tree().create_timer(0.2).timeout
	check_equal(rows(), pinned, "it stays when the mouse leaves")
	check(EditorInterface.get_selection().get_selected_nodes() == [scatter], "the selection stays")
	scatter.layers[0].max_slope_degrees = 0.01
	await until(func() -> bool: return rows().any(func(row: String) -> bool: return "0° to 0.01°" in row), "it is updated with the settings")
	scatter.layers[0].max_slope_degrees = 18.0
	await settle(scatter)
	await picture("why_pinned")
	await click(at)
	check(not tool().pinned.is_finite(), "a click on the pin releases it")


func test_colors() -> void:
	for kind in [1, 2, 3]:
		tool().choose_colors(kind)
		await until(func() -> bool: return tool().overlay.is_shown() and tool().overlay.is_complete(), "colors of kind %d" % kind)
		addon().update_overlays()
		await picture(["", "why_density", "why_slope", "why_rank"][kind])
	tool().choose_colors(1)
	await until(tool().overlay.is_complete, "densities again")
	var version: int = tool()._version
	scatter.layers[0].density = 0.3
	await until(func() -> bool: return tool()._version > version and tool().overlay.is_complete(), "colors are updated with the settings")
	workspace().toolbar.choose_layer(2)
	tool().refresh()
	check(not tool().overlay.is_complete(), "colors are updated with the selected layer")
	tool().choose_colors(0)
	check(not tool().overlay.is_shown(), "no colors")
	tool().choose_colors(2)
	tool().set_on(false)
	check(not tool().overlay.is_shown() and tool().panel.rows.is_empty(), "colors and rows disappear with the tool")


## Checks that, without ground or layers, the tool shows what is missing and prints nothing.
func test_nothing_to_explain() -> void:
	var terrain: Resource = scatter.ground
	var layers: Array = scatter.layers
	tool().set_on(true)
	tool().choose_colors(1)
	scatter.ground = null
	await hover(Vector2(300, 300))
	await until(func() -> bool: return rows().any(func(row: String) -> bool: return "set the ground of Hills" in row), "no ground")
	scatter.ground = terrain
	scatter.layers = []
	workspace().toolbar.update_layers()
	await hover(Vector2(310, 400))
	await until(func() -> bool: return rows().any(func(row: String) -> bool: return "add a layer to Hills" in row), "no layers")
	scatter.layers = layers
	workspace().toolbar.update_layers()
	tool().set_on(false)
