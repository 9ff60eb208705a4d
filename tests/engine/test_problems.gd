extends "harness.gd"
## Tests that nothing fails silently: every reason why a node shows no instances is printed once and listed among its problems.

## A ground whose methods can fail in different ways.
class FailingGround extends ScatterGround:
	var heights: Variant = true ## True returns a valid result, false causes a script error, and any other value is returned as it is.
	var normals: Variant = true
	var weights: Variant = true
	var threaded := false

	func _answer(value: Variant, good: Variant) -> Variant:
		if value is bool and not value:
			return value.no_such_method()
		return good if value is bool else value

	@warning_ignore("untyped_declaration")
	func _get_heights(positions: PackedVector2Array):
		var good := PackedFloat32Array()
		good.resize(positions.size())
		if heights is String and heights == "words":
			return range(positions.size()).map(func(index: int) -> String: return str(index))
		return _answer(heights, good)

	@warning_ignore("untyped_declaration")
	func _get_normals(positions: PackedVector2Array):
		var good := PackedVector3Array()
		good.resize(positions.size())
		good.fill(Vector3.UP)
		return _answer(normals, good)

	@warning_ignore("untyped_declaration")
	func _get_weights(positions: PackedVector2Array, _textures: PackedInt32Array):
		var good := PackedFloat32Array()
		good.resize(positions.size())
		good.fill(1.0)
		return _answer(weights, good)

	func _is_thread_safe() -> bool:
		return threaded


const REMEDY := "Fix the method, then call TerrainScatter3D.regenerate()."


## Returns the library's errors, without those that the engine prints for script errors.
func take_own_errors() -> PackedStringArray:
	var own: PackedStringArray
	for message in errors.take():
		if not "no_such_method" in message:
			own.push_back(message)
	return own


func check_has(text: String, words: Array, context: String) -> void:
	for word: String in words:
		check(word in text, "%s: expected '%s' in '%s'" % [context, word, text])


func test_a_ground_script_that_fails() -> void:
	var heights := ["ScatterGround", "_get_heights()", "PackedFloat32Array with a height in meters for each position",
			REMEDY]
	var cases := [
		["heights", null, heights + ["returned null", "script error"]],
		["heights", false, heights + ["returned null", "script error"]],
		["heights", PackedFloat32Array(), heights + ["returned an empty array"]],
		["heights", PackedFloat32Array([1.0]), heights + ["returned 1 elements for "]],
		["heights", "abc", heights + ["returned \"abc\""]],
		["heights", "words", heights + ["elements of the wrong type"]],
		["heights", PackedVector3Array(), heights + ["elements of the wrong type"]],
		["normals", null, ["_get_normals()", "returned null", "PackedVector3Array with a normal for each position", REMEDY]],
		["normals", false, ["_get_normals()", "returned null", REMEDY]],
		["weights", [1], ["_get_weights()", "returned 1 elements for ", "a weight from 0 to 1", REMEDY]],
	]
	for threaded: bool in [false, true]:
		for case: Array in cases:
			var context := "%s = %s, threaded %s" % [case[0], case[1], threaded]
			var ground := FailingGround.new()
			ground.threaded = threaded
			ground.set(case[0], case[1])
			var layer := make_layer()
			layer.align_to_normal = 1.0
			layer.ground_textures = PackedInt32Array([0])
			var second := layer.duplicate() as ScatterLayer
			var scatter := make_scatter([layer, second], ground, make_viewer())
			await settle(scatter)
			await frames(20)
			var own := take_own_errors()
			check_equal(own.size(), 2, "%s: one error per layer, got %s" % [context, own])
			check_has("".join(own), case[2], context)
			var problems := scatter.get_problems()
			if check_equal(problems.size(), 1, "%s: problems, got %s" % [context, problems]):
				check_has(problems[0], case[2], context)
			ground.set(case[0], true)
			scatter.regenerate()
			await settle(scatter)
			check_no_error(context + ", works again")
			check_equal(scatter.get_problems(), PackedStringArray(), context + ", works again")
			check(scatter.get_stats()["instances"] > 1000, context + ", shows instances again")
			await clean()


## The message names the script's file if it has one.
func test_a_failing_script_is_named() -> void:
	var file := FileAccess.open("user://failing_ground.gd", FileAccess.WRITE)
	file.store_string("extends ScatterGround\nfunc _get_heights(_positions):\n\treturn 5\n")
	file.close()
	var ground: ScatterGround = (load("user://failing_ground.gd") as GDScript).new()
	var scatter := make_scatter([make_layer()], ground, make_viewer())
	await settle(scatter)
	check_error(["user://failing_ground.gd", "_get_heights() returned \"5\""], "a script in a file")
	check_has("".join(scatter.get_problems()), ["Script user://failing_ground.gd of ScatterGround"], "its problem")


## If ground works at first and fails later, a recheck finds the failure.
func test_a_script_that_fails_later() -> void:
	var ground := FailingGround.new()
	var scatter := make_scatter([make_layer()], ground, make_viewer())
	await settle(scatter)
	check_equal(scatter.get_problems(), PackedStringArray(), "problems of ground that works")
	ground.heights = null
	await until(func() -> bool: return scatter.get_problems().size() == 1, "a problem of ground that fails")
	check_error(["_get_heights()", "returned null"], "an error of the re-check")
	check(scatter.get_stats()["instances"] > 1000, "all instances stay")
	ground.heights = true
	scatter.regenerate()
	await settle(scatter)
	check_equal(scatter.get_problems(), PackedStringArray(), "problems of ground that works again")


func test_a_ground_node_whose_method_fails() -> void:
	var node := Node3D.new()
	var script := GDScript.new()
	script.source_code = "extends Node3D\nfunc get_height(_position):\n\treturn 'none'\n"
	script.reload()
	node.set_script(script)
	root.add_child(node)
	var ground := ScatterGroundNode.new()
	var scatter := make_scatter([make_layer()], ground, make_viewer())
	ground.node = scatter.get_path_to(node)
	await settle(scatter)
	check_error(["ScatterGroundNode.node"], "a wrong result")
	var problems := scatter.get_problems()
	check_equal(problems.size(), 1, "problems, got %s" % [problems])
	check_has("".join(problems), ["layer 0", "height method of ScatterGroundNode.node has the wrong type", "Return a float"], "its problem")


func make_grass(radius: float) -> ScatterLayer:
	var grass := make_layer(radius)
	grass.resource_name = "Grass"
	grass.view_distance = 128.0
	return grass


func test_very_many_instances() -> void:
	var grass := make_grass(0.1)
	var scatter := make_scatter([grass], ScatterGroundFlat.new(), make_viewer())
	scatter.frame_budget_usec = 1
	await frames(2)
	var problems := scatter.get_problems()
	if check_equal(problems.size(), 1, "problems of 4.8 million instances, got %s" % [problems]):
		var words := ["Layer 0 (\"Grass\")", "ScatterLayer.radius and view_distance", "about 4.8 million instances"]
		check_has(problems[0], words + ["MB. Increase radius, or lower view_distance or density"], "many instances")
		check_has(problems[0], ["%.2f per square meter" % grass.get_point_density()], "many instances")
	grass.use_colors = true
	await frames(2)
	var area := PI * 128.0 * 128.0 + 4.0 * 128.0 * 32.0 + 32.0 * 32.0
	var megabytes := ceili(grass.get_point_density() * area * (16 * 4 + 20) * 1e-6)
	check_has("".join(scatter.get_problems()), ["about %d MB" % megabytes], "memory of colors, too")
	grass.density = 0.25
	await frames(2)
	check_equal(scatter.get_problems(), PackedStringArray(), "problems of a quarter of them")


## Dense grass, thinned with distance, is the add-on's main use and must not cause a warning.
func test_dense_grass_is_not_a_problem() -> void:
	var grass := make_grass(0.2)
	grass.thin_density = 0.2
	grass.thin_end = 128.0
	var scatter := make_scatter([grass], ScatterGroundFlat.new(), make_viewer())
	scatter.frame_budget_usec = 1
	await frames(2)
	check_equal(scatter.get_problems(), PackedStringArray(), "problems of dense grass")


## Once all tiles are visible, the problem depends on their actual number of instances instead of an estimate.
func test_rules_that_leave_few_of_many_points() -> void:
	var grass := make_layer(0.12)
	grass.view_distance = 100.0
	grass.min_height = 1.0
	var scatter := make_scatter([grass], ScatterGroundFlat.new(), make_viewer())
	await frames(2)
	check_equal(scatter.get_problems().size(), 1, "problems before tiles exist")
	await settle(scatter)
	check_equal(scatter.get_stats()["instances"], 0, "number of instances")
	await frames(1)
	check_equal(scatter.get_problems(), PackedStringArray(), "problems of a layer without instances")


func test_settings_that_place_or_color_nothing() -> void:
	var colorless := ScatterValueSource.new()
	colorless.gradient = Gradient.new()
	colorless.gradient.offsets = []
	colorless.gradient.colors = []
	var layer := make_layer()
	layer.use_colors = true
	layer.max_scale = 2.0
	var scatter := make_scatter([layer], ScatterGroundFlat.new(), make_viewer())
	for case: Array in [
		["scale_curve", Curve.new(), "ScatterLayer.scale_curve has no points, so it is not used. Add points, or clear it."],
		["color_value", colorless, "ScatterLayer.color_value has a gradient without points: all instances are black. Add points"],
	]:
		var good: Variant = layer.get(case[0])
		layer.set(case[0], case[1])
		var problems := scatter.get_problems()
		check_equal(problems.size(), 1, "%s: problems, got %s" % [case[0], problems])
		check_has("".join(problems), [case[2]], case[0])
		layer.set(case[0], good)
		check_equal(scatter.get_problems(), PackedStringArray(), "%s reset" % case[0])
