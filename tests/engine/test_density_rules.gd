extends "planet_harness.gd"
## Tests rules that scripts implement (ScatterRule): in tiles, queries, explanations and digests, on surfaces, models and planets. Covers threads,
## bounds, invalid results, and callbacks that change or free the node.

const SceneDigest := preload("res://addons/thicket/baking/scene_digest.gd")

const RECT := Rect2(-60.0, -60.0, 120.0, 120.0)
const REMEDY := "Fix the method, then call TerrainScatter3D.regenerate()."

## A density that is `west` for x below 0 and `east` elsewhere, unless `answer` or `bounds` replaces it. Records all calls.
class Halves extends ScatterRule:
	var west := 0.25
	@export var east := 0.75:
		set(value):
			east = value
			emit_changed()
	var threaded := false
	var answer := Callable() ## Called with the positions, normals, slopes and weights. Returns any result.
	var bounds := Callable() ## Called with the box. Returns any result.
	var threads: Dictionary[int, bool] = {}
	var asked := PackedVector3Array()
	var slopes_asked := PackedFloat32Array()
	var weights_asked := PackedFloat32Array()
	var mutex := Mutex.new()

	@warning_ignore("untyped_declaration")
	func _get_densities(positions: PackedVector3Array, normals: PackedVector3Array, slopes: PackedFloat32Array,
			texture_weights: PackedFloat32Array):
		mutex.lock()
		threads[OS.get_thread_caller_id()] = true
		asked.append_array(positions)
		slopes_asked.append_array(slopes)
		weights_asked.append_array(texture_weights)
		mutex.unlock()
		if answer.is_valid():
			return answer.call(positions, normals, slopes, texture_weights)
		var densities := PackedFloat32Array()
		for position in positions:
			densities.append(west if position.x < 0.0 else east)
		return densities

	@warning_ignore("untyped_declaration")
	func _get_density_bounds(box: AABB):
		return bounds.call(box) if bounds.is_valid() else Vector2(0.0, 1.0)

	func _is_thread_safe() -> bool:
		return threaded


func make_rule(threaded := false) -> Halves:
	var rule := Halves.new()
	rule.resource_name = "Halves"
	rule.threaded = threaded
	return rule


func make_ruled(rule: ScatterRule, layer := make_layer()) -> ScatterLayer:
	layer.density_rules = [rule]
	return layer


func hills() -> ScatterGroundNoise:
	var ground := ScatterGroundNoise.new()
	ground.noise = FastNoiseLite.new()
	ground.amplitude = 12.0
	return ground


## Returns {ID: position} for all instances of a layer.
func places(scatter: TerrainScatter3D, layer := 0) -> Dictionary[int, Vector3]:
	var result: Dictionary[int, Vector3] = {}
	var all := instances(scatter, layer)
	for id in all:
		result[id] = all[id].origin.snapped(Vector3.ONE * 0.01)
	return result


func sorted_ids(ids: PackedInt64Array) -> PackedInt64Array:
	var copy := ids.duplicate()
	copy.sort()
	return copy


## Returns the library's errors, without those that the engine prints for script errors.
func take_own_errors() -> PackedStringArray:
	var own: PackedStringArray
	for message in errors.take():
		if not "no_such_method" in message:
			own.push_back(message)
	return own


func cause_script_error() -> Variant:
	var number: Variant = 0
	return number.no_such_method()


func test_a_rule_equals_an_expression_in_tiles_of_any_size() -> void:
	var expected: PackedInt64Array = []
	for threaded: Variant in [null, false, true]:
		for tile_size: float in [32.0, 13.0]:
			var layer := make_layer()
			layer.layer_id = 3
			layer.tile_size = tile_size
			layer.max_slope_degrees = 30.0
			layer.edge_feather = 2.0
			if threaded == null:
				layer.density_expression = "0.25 + 0.5 * (x >= 0)"
			else:
				make_ruled(make_rule(threaded), layer)
			var scatter := make_scatter([layer], hills(), make_viewer())
			await settle(scatter)
			var shown := PackedInt64Array()
			var all := instances(scatter, 0)
			for id in all:
				if RECT.grow(-20.0).has_point(on_map(all[id])):
					shown.append(id)
			shown.sort()
			var context := "threaded %s, tiles of %.0f m" % [threaded, tile_size]
			expected = shown if expected.is_empty() else expected
			check_equal(shown, expected, "shown instances, " + context)
			var found := sorted_ids(scatter.query_rect(RECT.grow(-20.0)).ids)
			check_equal(found, expected, "queried instances, " + context)
			var built := scatter.build_rect(layer, RECT.grow(-20.0))
			check_equal(sorted_ids(built.get_ids(0)), expected, "one rectangle, " + context)
			var far := scatter.request_rect(Rect2(500, 500, 40, 40))
			await until(func() -> bool: return far.is_completed(), "a request, " + context)
			check_equal(sorted_ids(far.get_result().ids), sorted_ids(scatter.build_rect(layer, Rect2(500, 500, 40, 40)).get_ids(0)), "a request, " + context)
			scatter.free()
	check(expected.size() > 200, "%d instances" % expected.size())


func test_densities_of_several_rules_are_multiplied() -> void:
	var layer := make_layer()
	layer.density_rules = [make_rule(true), null, ScatterRule.new(), make_rule()]
	var scatter := make_scatter([layer], ScatterGroundFlat.new(), make_viewer())
	check_equal(scatter.get_density_map(layer, Rect2(-10, 0, 20, 1), Vector2i(2, 1)), PackedFloat32Array([0.0625, 0.5625]), "the product")
	var problems := "\n".join(scatter.get_problems())
	check("ScatterLayer.density_rules: an entry is empty. Assign a ScatterRule, or remove the entry." in problems, problems)
	check("ScatterLayer.density_rules: a ScatterRule has no effect: extend it with a script" in problems, problems)
	check(layer.density_rules.is_read_only(), "the array is read-only")
	var many: Array[ScatterRule] = []
	many.resize(17)
	layer.density_rules = many
	check_error(["ScatterLayer.density_rules", "at most 16 (entries), got 17"], "17 rules")
	check_equal(layer.density_rules.size(), 4, "the last valid rules are kept")


func test_threads() -> void:
	for threaded: bool in [false, true]:
		var rule := make_rule(threaded)
		var layer := make_ruled(rule)
		layer.view_distance = 150.0
		var scatter := make_scatter([layer], ScatterGroundFlat.new(), make_viewer())
		await settle(scatter)
		check(rule.asked.size() > 1000, "%d positions" % rule.asked.size())
		check_equal(rule.threads.has(OS.get_main_thread_id()), not threaded, "calls on the main thread if threaded is %s" % threaded)
		check_equal(rule.threads.keys() == [OS.get_main_thread_id()], not threaded, "threads %s, threaded %s" % [rule.threads.keys(), threaded])
		var snapshot := scatter.make_snapshot()
		var far := snapshot.query_rect(Rect2(900, 900, 30, 30)).size()
		check_equal(far > 0, threaded, "a snapshot generates tiles if threaded is %s" % threaded)
		if not threaded:
			check_error(["ScatterSnapshot.query_rect", "ScatterLayer.density_rules", "main thread", "_is_thread_safe()", "request_rect()"], "a snapshot")
		scatter.free()


func test_bounds_skip_the_calls() -> void:
	for threaded: bool in [false, true]:
		var rule := make_rule(threaded)
		rule.west = 0.0
		rule.bounds = func(box: AABB) -> Vector2: return Vector2(0.0, 0.0 if box.end.x <= 0.0 else 1.0)
		var scatter := make_scatter([make_ruled(rule)], ScatterGroundFlat.new(), make_viewer())
		await settle(scatter)
		var with_bounds := places(scatter)
		check(Array(rule.asked).all(func(at: Vector3) -> bool: return at.x >= 0.0), "no calls in closed tiles, threaded %s" % threaded)
		check(rule.asked.size() > 300 and with_bounds.size() > 200, "%d positions, %d instances" % [rule.asked.size(), with_bounds.size()])
		rule.bounds = Callable()
		rule.emit_changed()
		await settle(scatter)
		check(Array(rule.asked).any(func(at: Vector3) -> bool: return at.x < 0.0), "calls everywhere without bounds, threaded %s" % threaded)
		check(places(scatter) == with_bounds, "the same instances without bounds, threaded %s" % threaded)
		scatter.free()


func test_arguments() -> void:
	var rule := make_rule()
	rule.answer = func(positions: PackedVector3Array, normals: PackedVector3Array, slopes: PackedFloat32Array, weights: PackedFloat32Array) -> PackedFloat32Array:
		check(normals.size() == positions.size() and slopes.size() == positions.size() and weights.size() == positions.size(), "equal sizes")
		var densities := PackedFloat32Array()
		for i in positions.size():
			check(absf(rad_to_deg(normals[i].angle_to(Vector3.UP)) - slopes[i]) < 0.05, "slope %f of normal %s" % [slopes[i], normals[i]])
			densities.append(0.5)
		return densities
	var scatter := make_scatter([make_ruled(rule)], hills(), make_viewer())
	await settle(scatter)
	for index in range(0, rule.asked.size(), 50):
		var at := rule.asked[index]
		check(absf(scatter.ground.get_height(at) - at.y) < 0.001, "on the ground: %s" % at)
	check(Array(rule.weights_asked).all(func(weight: float) -> bool: return weight == 1.0), "a layer without textures")
	check(Array(rule.slopes_asked).any(func(slope: float) -> bool: return slope > 5.0), "some slopes")


## Returns the results of a layer with a rule and of one with the equal expression, each as a list of IDs.
func by_rule_and_expression(make: Callable) -> Array[PackedInt64Array]:
	var results: Array[PackedInt64Array] = []
	for kind: int in 3:
		var scatter: TerrainScatter3D = make.call()
		var layer: ScatterLayer = scatter.layers[-1]
		if kind == 0:
			layer.density_expression = "0.25 + 0.5 * (x >= 0)"
		else:
			make_ruled(make_rule(kind == 2), layer)
		await settle(scatter)
		var all := PackedInt64Array(instances(scatter, scatter.layers.size() - 1).keys())
		results.append(sorted_ids(all))
		scatter.free()
		await clean()
	return results


func check_equal_results(make: Callable, context: String) -> void:
	var results: Array[PackedInt64Array] = await by_rule_and_expression(make)
	check(results[0].size() > 100, "%s: %d instances" % [context, results[0].size()])
	check(results[1] == results[0], "%s: on the main thread %d, expected %d" % [context, results[1].size(), results[0].size()])
	check(results[2] == results[0], "%s: on threads %d, expected %d" % [context, results[2].size(), results[0].size()])


func test_surfaces_planets_models_and_fills() -> void:
	await check_equal_results(func() -> TerrainScatter3D:
		put_planet(200.0)
		viewer = make_viewer(direction(30.0) * 202.0)
		return make_scatter([make_grower(4.0)], make_ground(200.0), viewer), "a planet")
	await check_equal_results(func() -> TerrainScatter3D:
		var layer := make_grower(1.5)
		layer.edge_feather = 3.0
		layer.max_slope_degrees = 20.0
		put_planet(60.0)
		viewer = make_viewer(Vector3(0, 62, 0))
		return make_scatter([layer], make_ground(0.0), viewer), "a surface with an edge")
	await check_equal_results(func() -> TerrainScatter3D:
		var stones := make_layer(6.0)
		stones.resource_name = "Stones"
		stones.meshes = [SphereMesh.new()]
		var moss := make_layer(0.25)
		moss.on_surfaces = true
		moss.surface_layers = ["Stones"]
		moss.max_slope_degrees = 180.0
		moss.view_distance = 30.0
		return make_scatter([stones, moss], ScatterGroundFlat.new(), make_viewer()), "models")
	await check_equal_results(func() -> TerrainScatter3D:
		var trees := make_ruled(make_rule(), make_layer(6.0))
		trees.resource_name = "Trees"
		var ferns := make_layer(1.0)
		ferns.spacing = {"Trees": 3.0}
		ferns.spacing_fills = true
		return make_scatter([trees, ferns], ScatterGroundFlat.new(), make_viewer()), "a layer that fills gaps around a ruled one")


func test_a_changed_rule_regenerates_its_layer() -> void:
	var rule := make_rule()
	var layer := make_ruled(rule)
	var scatter := make_scatter([layer, make_layer(3.0)], ScatterGroundFlat.new(), make_viewer())
	await settle(scatter)
	var before := places(scatter)
	var other := digests(scatter, 1)
	rule.east = 0.5
	await settle(scatter)
	var after := places(scatter)
	check(after.size() < before.size() and after.size() > before.size() / 2, "%d, then %d instances" % [before.size(), after.size()])
	check_equal(digests(scatter, 1), other, "the other layer")
	rule.west = 0.0 # Emits no signal.
	await settle(scatter)
	check(places(scatter) == after, "a change without a signal")
	scatter.regenerate()
	await settle(scatter)
	check(places(scatter).values().all(func(at: Vector3) -> bool: return at.x >= 0.0), "regenerate() calls the rule again")
	layer.density_rules = []
	rule.east = 0.0
	await settle(scatter)
	check(places(scatter).size() > before.size(), "a removed rule has no effect")


func test_rules_are_explained() -> void:
	var layer := make_ruled(make_rule())
	var scatter := make_scatter([layer], ScatterGroundFlat.new(), make_viewer())
	await settle(scatter)
	var explanation := scatter.explain_position(Vector3(10, 0, 10), layer)[0]
	var names: Array = range(explanation.get_rule_count()).map(explanation.get_rule_name)
	var index := names.find(&"density_rules")
	if check(index >= 0, "the rule is among %s" % [names]):
		check_equal(explanation.get_rule_density(index), 0.75, "its density")
		check_equal(explanation.get_rule_sentence(index), "The density rule Halves permits 75 % of the instances here.", "its sentence")
	check_equal(explanation.density, 0.75, "the density")
	var matches := 0
	for step in 200:
		var place := Vector3(-50.0 + 0.5 * step, 0.0, 0.3 * step)
		var each := scatter.explain_position(place, layer)[0]
		matches += int(each.standing == scatter.has_instance(each.id))
		check_equal(each.density, 0.25 if place.x < 0.0 else 0.75, "the density at %s" % place)
	check_equal(matches, 200, "explanations match the instances")
	(layer.density_rules[0] as Halves).east = 0.0
	layer.density_rules[0].resource_name = ""
	layer.density_rules[0].emit_changed()
	explanation = scatter.explain_position(Vector3(10, 0, 10), layer)[0]
	check_equal([explanation.refused_by, explanation.reason], [&"density_rules", "The density rule ScatterRule permits no instances here."], "the reason")


func test_invalid_results() -> void:
	var densities := ["ScatterRule", "_get_densities() returned", "a PackedFloat32Array with a density from 0 to 1 for each position", REMEDY]
	var bounds := ["ScatterRule", "_get_density_bounds() returned", "a Vector2 with the lowest and the highest density", REMEDY]
	var filled := func(value: float, positions: PackedVector3Array) -> PackedFloat32Array:
		var all := PackedFloat32Array()
		all.resize(positions.size())
		all.fill(value)
		return all
	var cases := [
		["answer", func(p: PackedVector3Array, _n: Variant, _s: Variant, _w: Variant) -> Variant: return filled.call(NAN, p), densities + ["the density nan at ("]],
		["answer", func(p: PackedVector3Array, _n: Variant, _s: Variant, _w: Variant) -> Variant: return filled.call(1.5, p), densities + ["the density 1.5 at ("]],
		["answer", func(p: PackedVector3Array, _n: Variant, _s: Variant, _w: Variant) -> Variant: return filled.call(-0.5, p), densities + ["the density -0.5 at ("]],
		["answer", func(p: PackedVector3Array, _n: Variant, _s: Variant, _w: Variant) -> Variant: return filled.call(INF, p), densities + ["the density inf at ("]],
		["answer", func(_p: Variant, _n: Variant, _s: Variant, _w: Variant) -> Variant: return PackedFloat32Array([1.0]), densities + ["returned 1 elements for "]],
		["answer", func(_p: Variant, _n: Variant, _s: Variant, _w: Variant) -> Variant: return PackedFloat32Array(), densities + ["returned an empty array"]],
		["answer", func(_p: Variant, _n: Variant, _s: Variant, _w: Variant) -> Variant: return "abc", densities + ["returned \"abc\""]],
		["answer", func(_p: Variant, _n: Variant, _s: Variant, _w: Variant) -> Variant: return cause_script_error(), densities + ["returned null", "script error"]],
		["bounds", func(_box: AABB) -> Variant: return Vector2(0.0, NAN), bounds + ["nan"]],
		["bounds", func(_box: AABB) -> Variant: return Vector2(0.75, 0.25), bounds + ["(0.75, 0.25)"]],
		["bounds", func(_box: AABB) -> Variant: return Vector2(0.0, 2.0), bounds + ["(0.0, 2.0)"]],
		["bounds", func(_box: AABB) -> Variant: return 1.0, bounds + ["returned 1.0"]],
		["bounds", func(_box: AABB) -> Variant: return cause_script_error(), bounds + ["returned null", "script error"]],
	]
	for threaded: bool in [false, true]:
		for case: Array in cases:
			var rule := make_rule(threaded)
			rule.set(case[0], case[1])
			var layer := make_ruled(rule)
			var scatter := make_scatter([layer, make_layer(3.0)], ScatterGroundFlat.new(), make_viewer())
			await settle(scatter)
			var context := "%s, threaded %s" % [case[2], threaded]
			var own := take_own_errors()
			if check(own.size() == 1, "one error: %s: %s" % [context, own]):
				for word: String in case[2]:
					check(word in own[0], "'%s' in '%s'" % [word, own[0]])
			check_equal(instances(scatter, 0).size(), 0, "no instances: " + context)
			check(instances(scatter, 1).size() > 100, "the other layer: " + context)
			var problems := scatter.get_problems()
			check(problems.size() == 1 and REMEDY in problems[0], "%s: %s" % [context, problems])
			check(REMEDY in scatter.explain_position(Vector3.ZERO, layer)[0].reason, "an explanation: " + context)
			errors.take()
			check_equal(scatter.build_rect(layer, Rect2(0, 0, 20, 20)).is_empty(), true, "build_rect: " + context)
			own = take_own_errors()
			check(own.size() == 1 and "TerrainScatter3D.build_rect" in own[0] and REMEDY in own[0], "build_rect: %s: %s" % [context, own])
			check(scatter.get_density_map(layer, Rect2(0, 0, 20, 20), Vector2i(2, 2)).is_empty(), "get_density_map: " + context)
			own = take_own_errors()
			check(own.size() == 1 and "TerrainScatter3D.get_density_map" in own[0] and REMEDY in own[0], "get_density_map: %s: %s" % [context, own])
			rule.set(case[0], Callable())
			scatter.regenerate()
			await settle(scatter)
			check(instances(scatter, 0).size() > 100, "fixed: " + context)
			check_equal(scatter.get_problems().size(), 0, "no problems once fixed: " + context)
			check_equal(take_own_errors().size(), 0, "no errors once fixed: " + context)
			scatter.free()


## Runs each action inside the first callback of each call. Nothing may crash, and instances are correct afterward if the node still exists.
func test_callbacks_may_do_anything() -> void:
	var at := Rect2(900, 900, 30, 30)
	var calls: Dictionary[String, Callable] = {
		"a frame": func(_scatter: TerrainScatter3D) -> void: pass,
		"build_rect": func(scatter: TerrainScatter3D) -> void: scatter.build_rect(scatter.layers[0], at),
		"query_rect": func(scatter: TerrainScatter3D) -> void: scatter.query_rect(at),
		"explain_position": func(scatter: TerrainScatter3D) -> void: scatter.explain_position(Vector3(900, 0, 900)),
		"get_density_map": func(scatter: TerrainScatter3D) -> void: scatter.get_density_map(scatter.layers[0], at, Vector2i(3, 3)),
	}
	var actions: Dictionary[String, Callable] = {
		"free": func(scatter: TerrainScatter3D) -> void: scatter.free(),
		"queue_free": func(scatter: TerrainScatter3D) -> void: scatter.queue_free(),
		"leave the tree": func(scatter: TerrainScatter3D) -> void: root.remove_child(scatter),
		"no layers": func(scatter: TerrainScatter3D) -> void: scatter.layers = [],
		"no rules": func(scatter: TerrainScatter3D) -> void: scatter.layers[0].density_rules = [],
		"a new rule": func(scatter: TerrainScatter3D) -> void: scatter.layers[0].density_rules = [make_rule()],
		"a new radius": func(scatter: TerrainScatter3D) -> void: scatter.layers[0].radius = 3.0,
		"no ground": func(scatter: TerrainScatter3D) -> void: scatter.ground = null,
		"regenerate": func(scatter: TerrainScatter3D) -> void: scatter.regenerate(),
		"emit changed": func(scatter: TerrainScatter3D) -> void: scatter.layers[0].density_rules[0].emit_changed(),
		"build": func(scatter: TerrainScatter3D) -> void: scatter.build_rect(scatter.layers[0], at),
	}
	for call_name in calls:
		for action_name in actions:
			for during_bounds: bool in [false, true]:
				var rule := make_rule()
				var scatter := make_scatter([make_ruled(rule)], ScatterGroundFlat.new(), make_viewer())
				if call_name != "a frame":
					await settle(scatter)
				var done := [false]
				var id := scatter.get_instance_id() # A lambda must not capture an object that is freed before the call.
				var act := func() -> void:
					if not done[0]:
						done[0] = true
						actions[action_name].call(instance_from_id(id))
				rule.bounds = func(_box: AABB) -> Vector2:
					if during_bounds:
						act.call()
					return Vector2(0.0, 1.0)
				rule.answer = func(positions: PackedVector3Array, _n: Variant, _s: Variant, _w: Variant) -> PackedFloat32Array:
					if not during_bounds:
						act.call()
					var all := PackedFloat32Array()
					all.resize(positions.size())
					all.fill(0.5)
					return all
				calls[call_name].call(scatter)
				await frames(3)
				was_kept_from_being_freed()
				if is_instance_valid(scatter) and scatter.is_inside_tree():
					await settle(scatter)
				var context := "%s in %s" % [action_name, call_name]
				check(done[0], "the action ran: " + context)
				errors.take()
				if is_instance_valid(scatter):
					scatter.free()


func test_digests_depend_on_rules() -> void:
	var rule := make_rule()
	var layer := make_ruled(rule)
	var scatter := make_scatter([layer], ScatterGroundFlat.new(), make_viewer())
	await settle(scatter)
	var parts := func() -> Array: return SceneDigest.parts_of(scatter, RECT).values()
	var before: Array = parts.call()
	check(parts.call() == before, "the digest is stable")
	rule.east = 0.5
	var changed: Array = parts.call()
	check(changed != before, "a stored property")
	rule.west = 0.5 # Not stored, but a change to the densities.
	rule.emit_changed()
	check(parts.call() != changed, "the densities")
	rule.west = 0.25
	rule.east = 0.75
	check(parts.call() == before, "the original values")
	var script := GDScript.new()
	script.source_code = "extends ScatterRule\n\nfunc _get_densities(p: PackedVector3Array, _n: PackedVector3Array, _s: PackedFloat32Array, _w: PackedFloat32Array) -> PackedFloat32Array:\n\tvar all := PackedFloat32Array()\n\tall.resize(p.size())\n\treturn all\n"
	script.reload()
	var of_script := func() -> Array:
		var scripted := ScatterRule.new()
		scripted.set_script(script)
		layer.density_rules = [scripted]
		return parts.call()
	var first: Array = of_script.call()
	script.source_code += "\n# A change.\n"
	check(of_script.call() != first, "the script")
