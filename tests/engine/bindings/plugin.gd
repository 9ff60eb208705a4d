@tool
extends EditorPlugin
## Runs one of the methods below in the editor, selected by the arguments after `--`, prints "done" and quits.

const EXTENSION := "res://addons/thicket/thicket.gdextension"
const PATIENCE_MSEC := 60000


func _enter_tree() -> void:
	# Waits until the editor has scanned all files and laid out its docks. Until then, it runs threads and nested frames.
	EditorInterface.get_resource_filesystem().sources_changed.connect(_run.unbind(1), CONNECT_ONE_SHOT | CONNECT_DEFERRED)


func _run() -> void:
	await get_tree().process_frame
	for step in OS.get_cmdline_user_args():
		@warning_ignore("redundant_await")
		await call(step)
	print("done")
	get_tree().quit()


## Reloads the library twice. A live node must keep its properties and continue to work.
func reload() -> void:
	var flat: Resource = ClassDB.instantiate("ScatterGroundFlat")
	flat.set("height", 7.0)
	var layer: Resource = ClassDB.instantiate("ScatterLayer")
	layer.set("radius", 3.5)
	layer.set("meshes", [BoxMesh.new()])
	_set_rules(layer)
	var scatter: Node3D = ClassDB.instantiate("TerrainScatter3D")
	scatter.set("seed", 42)
	scatter.set("ground", flat)
	scatter.set("layers", [layer])
	add_child(scatter)
	for round in 3:
		if round > 0:
			GDExtensionManager.reload_extension.call_deferred(EXTENSION)
			await get_tree().process_frame
		await _stream(scatter)
		print("round %d: seed %d, terrain %s at %s, radius %s, %d mesh, rules %s" % [round, scatter.get("seed"),
				scatter.get("ground") == flat, flat.call("get_height", Vector3.ZERO), layer.get("radius"),
				layer.get("meshes").size(), _rules_hold(layer)])
		layer.set("density", 1.0 - 0.1 * round)
	scatter.queue_free()
	await get_tree().process_frame


func _set_rules(layer: Resource) -> void:
	var curve := Curve.new()
	curve.add_point(Vector2(0.0, 0.5))
	layer.set("density_over_height", curve)
	layer.set("noise", FastNoiseLite.new())
	var mask: Resource = ClassDB.instantiate("ScatterMask")
	mask.set("background", 0.5)
	mask.call("paint", Vector2.ZERO, 20.0)
	layer.set("mask", mask)
	layer.set("spacing", {"Oaks": 2.5})


## Returns whether the rules are unchanged and still connected: a curve's change must emit `changed` once, and each dab `area_changed`.
func _rules_hold(layer: Resource) -> bool:
	var signal_counts := [0, 0]
	var on_changed := func() -> void: signal_counts[0] += 1
	var on_area_changed := func(_rect: Rect2) -> void: signal_counts[1] += 1
	layer.changed.connect(on_changed)
	layer.connect("area_changed", on_area_changed)
	var curve: Curve = layer.get("density_over_height")
	curve.emit_changed()
	for mode: int in [1, 0]: # Erases, then paints.
		layer.get("mask").call("paint", Vector2(100, 0), 2.0, 1.0, 0.5, mode)
	layer.changed.disconnect(on_changed)
	layer.disconnect("area_changed", on_area_changed)
	var densities: Array = [Vector2.ZERO, Vector2(100, 0)].map(layer.get("mask").sample)
	return signal_counts == [1, 2] and densities == [1.0, 1.0] and layer.get("spacing") == {"Oaks": 2.5} and curve.point_count == 1


func _stream(scatter: Node3D) -> void:
	var deadline := Time.get_ticks_msec() + PATIENCE_MSEC
	while scatter.call("get_stats")["instances"] == 0 and Time.get_ticks_msec() < deadline:
		await get_tree().process_frame
	print("instances: ", scatter.call("get_stats")["instances"] > 0)


## Prints how many instances the editor draws for several limits. Does so both while tiles are added and after the limit changes.
func preview() -> void:
	var layer: Resource = ClassDB.instantiate("ScatterLayer")
	layer.set("radius", 1.0)
	layer.set("tile_size", 16.0)
	layer.set("meshes", [BoxMesh.new()])
	var scatter: Node3D = ClassDB.instantiate("TerrainScatter3D")
	scatter.set("ground", ClassDB.instantiate("ScatterGroundFlat"))
	scatter.set("layers", [layer])
	scatter.set("frame_budget_usec", 5000)
	scatter.set("preview_instances", 5000)
	add_child(scatter)
	for limit: int in [5000, 800, 0, 20000, 1000000000]:
		scatter.set("preview_instances", limit)
		var deadline := Time.get_ticks_msec() + PATIENCE_MSEC
		var maximum := 0
		var frames := 0
		while frames < 30 and Time.get_ticks_msec() < deadline:
			await get_tree().process_frame
			frames = frames + 1 if scatter.call("is_settled") else 0
			if limit == 5000: # With the later limits, the instances drawn for the previous limit would be included.
				maximum = maxi(maximum, scatter.call("get_stats")["drawn"])
		var stats: Dictionary = scatter.call("get_stats")
		print("preview of %d: %d drawn of %d, at most %d, %d uploads" % [limit, stats["drawn"], stats["instances"], maximum,
				stats["uploads"]])
	scatter.queue_free()
	await get_tree().process_frame


## Prints the editor's help page for each of the library's classes, one line per class. Also prints the classes that the inspector offers for
## a ground.
func help() -> void:
	var picker := EditorResourcePicker.new()
	picker.base_type = "ScatterGround"
	print("grounds: ", ", ".join(picker.get_allowed_types()))
	picker.free()
	for name: String in ClassDB.get_class_list():
		if ClassDB.class_get_api_type(name) == ClassDB.API_EXTENSION:
			print("help %s: %s" % [name, (await _help_page(name)).replace("\n", " ")])


## Returns a help page's text. Retries until it exists: a page stays empty if it was opened before a thread had read the reference.
func _help_page(name: String) -> String:
	var deadline := Time.get_ticks_msec() + PATIENCE_MSEC
	var text := ""
	while Time.get_ticks_msec() < deadline:
		EditorInterface.get_script_editor().goto_help("class_name:" + name)
		for frame in 5:
			await get_tree().process_frame
		for page in EditorInterface.get_script_editor().find_children("*", "EditorHelp", true, false):
			if page.name == name:
				for label: RichTextLabel in page.find_children("*", "RichTextLabel", true, false):
					text = label.get_parsed_text()
					if text.begins_with("Class:") and not "no description for this class" in text:
						return text
	return text


## Opens a scene and prints the warnings that the editor shows for its root.
func warnings() -> void:
	EditorInterface.open_scene_from_path("res://scatter.tscn")
	for frame in 30:
		await get_tree().process_frame
	for tree: Tree in EditorInterface.get_base_control().find_children("*", "Tree", true, false):
		var item := tree.get_root()
		while item:
			for button in item.get_button_count(0):
				print("button of %s: %s" % [item.get_text(0), item.get_button_tooltip_text(0, button).replace("\n", " ")])
			item = item.get_next_in_tree()
