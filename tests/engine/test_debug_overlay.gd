extends "harness.gd"
## Tests the debug overlay with statistics of a game's scatters.

const FILE := "res://addons/thicket/debug_overlay.gd"


func press(key: Key) -> void:
	for pressed: bool in [true, false]:
		var event := InputEventKey.new()
		event.keycode = key
		event.pressed = pressed
		Input.parse_input_event(event)
	Input.flush_buffered_events()
	await frames(2)


func test_it_shows_figures_after_its_key_is_pressed() -> void:
	var camera := Camera3D.new()
	root.add_child(camera)
	camera.look_at_from_position(Vector3(0.0, 10.0, 0.0), Vector3(0.0, 0.0, -12.0))
	camera.make_current()
	var layer := make_layer(3.0)
	layer.resource_name = "Larches"
	var scatter := make_scatter([layer], ScatterGroundFlat.new(), camera)
	scatter.name = "Wood"
	var overlay: CanvasLayer = (load(FILE) as GDScript).new()
	root.add_child(overlay)
	await settle(scatter)
	check(not overlay.visible and not overlay.is_processing() and overlay.lines.is_empty(), "hidden and idle at first")
	await press(KEY_F3)
	check(overlay.visible, "visible")
	var text := "\n".join(overlay.lines)
	var shown_count := scatter.get_shown_count(layer)
	check(shown_count > 500 and text.contains("Wood: ") and text.contains("0 tiles pending") and text.contains("Larches"), text)
	check(text.replace(",", "").contains("%d instances in %d tiles" % [shown_count, scatter.get_stats()["tiles"]]), text)
	check(text.contains("in view: ") and not text.contains("in view: 0 instances"), text)
	var why: Array = overlay.get(&"_explanation").rows
	check(why.any(func(row: Array) -> bool: return row[1].contains("Larches")), "why: %s" % [why])
	camera.look_at_from_position(Vector3(0.0, 10.0, 0.0), Vector3(0.0, 20.0, -12.0))
	overlay.update()
	check(overlay.get(&"_explanation").rows.is_empty(), "nothing is explained in the sky: %s" % [overlay.get(&"_explanation").rows])
	scatter.visible = false
	overlay.update()
	check("\n".join(overlay.lines).contains(", hidden"), "a hidden scatter")
	await press(KEY_F3)
	check(not overlay.visible and not overlay.is_processing(), "hidden again")
	overlay.toggle_key = KEY_NONE
	await press(KEY_NONE)
	check(not overlay.visible, "no key")
	scatter.free()
	overlay.update()
	check_equal(overlay.lines.size(), 1, "a game without scatters")
	check(overlay.get(&"_explanation").rows.is_empty(), "nothing to explain")


## The overlay explains the ground at the center of the screen also on the underside of a planet.
func test_it_explains_the_underside_of_a_planet() -> void:
	var planet := MeshInstance3D.new()
	var sphere := SphereMesh.new()
	sphere.radius = 50.0
	sphere.height = 100.0
	planet.mesh = sphere
	planet.add_to_group(&"ground")
	root.add_child(planet)
	var ground := ScatterGroundMeshes.new()
	ground.group = &"ground"
	ground.planet_radius = 50.0
	var layer := make_layer(2.0)
	layer.resource_name = "Larches"
	layer.on_surfaces = true
	layer.tile_size = 16.0
	layer.view_distance = 60.0
	var camera := Camera3D.new()
	root.add_child(camera)
	camera.look_at_from_position(Vector3(0.0, -60.0, 0.0), Vector3(1.0, 0.0, 0.0), Vector3.RIGHT)
	camera.make_current()
	var scatter := make_scatter([layer], ground, camera)
	await settle(scatter)
	var overlay: CanvasLayer = (load(FILE) as GDScript).new()
	root.add_child(overlay)
	overlay.update()
	var why: Array = overlay.get(&"_explanation").rows
	check(why.any(func(row: Array) -> bool: return row[1].contains("Larches")), "why: %s" % [why])
	check(not why.any(func(row: Array) -> bool: return row[1].contains("no ground")), "it is on the ground: %s" % [why])
	overlay.free()
	planet.free()
