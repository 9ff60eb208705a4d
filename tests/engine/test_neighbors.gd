extends "edits_harness.gd"
## Tests layers that refer to each other by name: which layer keeps a distance from which, and how a change affects the others.

## Returns the smallest distance on the map from a layer's instances near the origin to the instances of a second layer.
func gap(scatter: TerrainScatter3D, layer: int, other: int) -> float:
	var minimum := INF
	var others := map_positions(scatter, other)
	for position in map_positions(scatter, layer):
		if position.length() < 50.0:
			minimum = minf(minimum, nearest(position, others))
	return minimum


func test_one_layer_changed() -> void:
	var scatter := make_scatter(make_forest(), Mound.new(), make_viewer())
	var shown := Shown.new(scatter)
	await settle(scatter)
	var oaks := instances(scatter, OAK)
	var ferns := instances(scatter, FERN)
	shown.take()
	scatter.layers[FERN].density = 0.5
	await settle(scatter)
	check(shown.take()[OAK].is_empty(), "a later layer does not affect an earlier one")
	scatter.layers[FERN].density = 1.0
	await settle(scatter)
	check(instances(scatter, FERN) == ferns, "restoring the setting restores the ferns")
	shown.take()
	scatter.layers[OAK].max_scale = 2.0
	await settle(scatter)
	check(shown.take()[FERN].is_empty(), "the appearance of oaks does not affect ferns")
	scatter.layers[OAK].max_scale = 1.0
	scatter.layers[OAK].density = 0.5
	await settle(scatter)
	var changed_oaks := changed_places(oaks, instances(scatter, OAK))
	var changed := changed_places(ferns, instances(scatter, FERN))
	check(changed_oaks.size() > 20 and changed.size() > 50, "%d oaks and %d ferns changed" % [changed_oaks.size(), changed.size()])
	var far := 0
	for position in changed:
		# Oaks beyond the view distance also affect ferns within it.
		var near_edge := maxf(absf(position.x), absf(position.y)) > 60.0
		far += int(not near_edge and nearest(position, changed_oaks) > SPACING + FLOATS)
	check_equal(far, 0, "ferns that changed far from any changed oak")


func test_spacing_across_tiles_and_by_order() -> void:
	var a := named_layer("a", 11, 3.0)
	var b := named_layer("b", 12, 2.0)
	var c := named_layer("c", 13, 1.0)
	a.tile_size = 48.0
	b.tile_size = 20.0
	a.view_distance = 90.0
	b.view_distance = 90.0
	a.spacing = {"b": 2.5}
	b.spacing = {"a": 1.0, "c": 1.25}
	c.spacing = {"a": 1.75}
	b.density = 0.15 # Sparse enough that each layer keeps instances in any order.
	c.density = 0.05
	var alone: Array[Dictionary] = []
	for layer: ScatterLayer in [a, b, c]:
		var scatter := make_scatter([layer], ScatterGroundFlat.new(), make_viewer())
		await settle(scatter)
		alone.push_back(instances(scatter, 0))
		scatter.free()
	for order: Array in [[a, b, c], [c, b, a]]:
		var list: Array[ScatterLayer] = []
		list.assign(order)
		var scatter := make_scatter(list, ScatterGroundFlat.new(), make_viewer())
		await settle(scatter)
		var at := [order.find(a), order.find(b), order.find(c)]
		for index in 3:
			var stands := instances(scatter, at[index])
			check_equal(stands == alone[index], at[index] == 0, "layer %d of %s is complete" % [index, order])
			for id in stands:
				check(alone[index].has(id), "spacing removes instances and adds none")
		check(gap(scatter, at[1], at[0]) >= 2.5 - FLOATS, "the larger of two specified distances applies: %f" % gap(scatter, at[1], at[0]))
		check(gap(scatter, at[2], at[1]) >= 1.25 - FLOATS, "the distance between layers b and c: %f" % gap(scatter, at[2], at[1]))
		check(gap(scatter, at[2], at[0]) >= 1.75 - FLOATS, "the distance between layers a and c: %f" % gap(scatter, at[2], at[0]))
		check(gap(scatter, at[2], at[0]) < 1.8, "no larger distance than required: %f" % gap(scatter, at[2], at[0]))
		check_equal(scatter.get_problems(), PackedStringArray(), "problems")
		scatter.free()


func test_proximity() -> void:
	var scatter := make_scatter(make_forest(), ScatterGroundFlat.new(), make_viewer())
	var fern := scatter.layers[FERN]
	fern.spacing = {}
	fern.edge_feather = 0.0
	fern.proximity_layer = "oak"
	fern.proximity_distance = 4.0
	scatter.layers[OAK].density = 0.2
	scatter.layers[OAK].view_distance = 90.0
	await settle(scatter)
	var oaks := map_positions(scatter, OAK)
	var counts := [0, 0]
	for position in map_positions(scatter, FERN):
		var distance := nearest(position, oaks)
		check(distance < 4.0 + FLOATS or position.length() > 60.0, "a fern without an oak, %f m away" % distance)
		counts[int(distance > 2.0)] += 1
	# The inner area is a third of the outer area. A linear density averages 3/4 in the inner area and 1/3 in the outer one.
	check(counts[0] > 50 and counts[1] > 50, "ferns near and farther away: %s" % [counts])
	check(3 * counts[0] > counts[1], "ferns thin out with the distance: %s" % [counts])
	scatter.layers = [fern, scatter.layers[OAK]]
	check("before" in "".join(scatter.get_problems()), "a warning for proximity to a later layer")
	await settle(scatter)
	check(map_positions(scatter, 0).size() > 1000, "proximity to a later layer has no effect")


func test_names() -> void:
	var scatter := make_scatter(make_forest(), ScatterGroundFlat.new(), make_viewer())
	await settle(scatter)
	check_equal(scatter.get_problems(), PackedStringArray(), "problems of a valid forest")
	var spaced := digests(scatter, FERN)
	scatter.layers[FERN].spacing = {"Föhre": SPACING}
	check("\"Föhre\"" in "".join(scatter.get_problems()), "the problem contains the name that no layer has, including its non-ASCII letters")
	scatter.layers[OAK].resource_name = "elm"
	scatter.layers[FERN].spacing = {"oak": SPACING}
	await settle(scatter)
	check(digests(scatter, FERN) != spaced, "ferns change if spacing refers to no layer")
	scatter.layers[OAK].resource_name = "oak"
	await settle(scatter)
	check(digests(scatter, FERN) == spaced, "ferns are the same once the oaks have their name again")
	scatter.layers[FERN].resource_name = "oak"
	check("the name of an earlier layer" in "".join(scatter.get_problems()), "two layers with the same name")
	await settle(scatter)
	check(digests(scatter, FERN) == spaced, "of two layers with the same name, the first one is used")
	scatter.layers[FERN].resource_name = "fern"
	scatter.layers = [null, scatter.layers[FERN]]
	await settle(scatter)
	check(digests(scatter, FERN) != spaced, "ferns change if the layer is missing")


func test_rejected_layers_keep_their_last_valid_state() -> void:
	var scatter := make_scatter(make_forest(), ScatterGroundFlat.new(), make_viewer())
	await settle(scatter)
	var before := [digests(scatter, OAK), digests(scatter, FERN)]
	scatter.layers[OAK].min_slope_degrees = 50.0
	scatter.layers[OAK].max_slope_degrees = 40.0
	await settle(scatter)
	check_error(["layers[0]", "max_slope_degrees", "40"], "a minimum above its maximum")
	var mask := scatter.layers[FERN].mask
	var area := mask.paint(Vector2(10, 10), 4.0, 1.0, 1.0, ScatterMask.MODE_ERASE)
	await settle(scatter)
	check_no_error("the error is reported once")
	check(digests(scatter, OAK) == before[OAK], "the oaks are unchanged")
	check(digests(scatter, FERN) != before[FERN], "ferns can be edited")
	check(gap(scatter, FERN, OAK) >= SPACING - FLOATS, "ferns keep their distance from the last valid oaks")
	mask.paint(area.get_center(), 20.0, 1.0, 1.0, ScatterMask.MODE_PAINT)
	await settle(scatter)
	check(digests(scatter, FERN) == before[FERN], "ferns are the same after the edit is undone")
	scatter.layers[OAK].max_slope_degrees = 90.0
	scatter.layers[OAK].min_slope_degrees = 0.0
	scatter.layers[OAK].radius = 0.5
	scatter.layers[FERN].spacing = {"oak": 1000.0}
	scatter.layers[FERN].tile_size = 50.0
	await settle(scatter)
	check_error(["layers[1]", "spacing", "points"], "oaks within a thousand meters of each tile")
	check(digests(scatter, FERN) == before[FERN], "the ferns are unchanged")
	scatter.layers[OAK].radius = 4.0
	scatter.layers[FERN].spacing = {"oak": SPACING}
	scatter.layers[FERN].tile_size = 32.0
	await settle(scatter)
	check_no_error("valid settings")
	check([digests(scatter, OAK), digests(scatter, FERN)] == before, "both layers keep their instances")


## Returns two species of trees with the same radius. The second one keeps a distance from the first.
func make_species(fills: bool) -> Array[ScatterLayer]:
	var oaks := named_layer("oak", 31, 4.0)
	oaks.density = 0.5
	var birches := named_layer("birch", 32, 4.0)
	birches.spacing = {"oak": 4.0}
	birches.spacing_fills = fills
	for layer: ScatterLayer in [oaks, birches]:
		layer.tile_size = 32.0
		layer.view_distance = 80.0
	return [oaks, birches]


func test_filled_species_are_as_dense_as_one() -> void:
	var scatter := make_scatter(make_species(false), Mound.new(), make_viewer())
	await settle(scatter)
	var thinned := instances(scatter, 1)
	var oaks := instances(scatter, 0)
	scatter.layers[1].spacing_fills = true
	await settle(scatter)
	var filled := instances(scatter, 1)
	check(filled.size() > 1.6 * thinned.size(), "%d birches fill, %d do not" % [filled.size(), thinned.size()])
	check(gap(scatter, 1, 0) >= 4.0 - FLOATS, "distance to oaks: %f" % gap(scatter, 1, 0))
	check_equal(instances(scatter, 0) == oaks, true, "spacing_fills leaves the oaks unchanged")
	check_equal(scatter.get_problems(), PackedStringArray(), "problems")
	scatter.layers[1].spacing_fills = false
	await settle(scatter)
	check_equal(instances(scatter, 1) == thinned, true, "without filling, the birches are as before")


## Removals by a game must move no other instance. Otherwise, trees would jump when one is felled.
func test_filled_species_stay_when_a_game_fells_trees() -> void:
	var scatter := make_scatter(make_species(true), Mound.new(), make_viewer())
	await settle(scatter)
	var birches := instances(scatter, 1)
	var felled := 0
	for id: int in instances(scatter, 0).keys().slice(0, 40):
		felled += int(scatter.remove_instance(id))
	check_equal(felled, 40, "felled oaks")
	await settle(scatter)
	check_equal(instances(scatter, 1) == birches, true, "the birches are unchanged")
	var found := scatter.query_rect(Rect2(-30, -30, 60, 60), [scatter.layers[1]]).ids
	check(found.size() > 50, "queries find birches: %d" % found.size())
	for id in found:
		check(birches.has(id), "a query finds only visible birches")


func test_filled_species_are_explained() -> void:
	var scatter := make_scatter(make_species(true), Mound.new(), make_viewer())
	await settle(scatter)
	var random := RandomNumberGenerator.new()
	random.seed = 3
	var standing := 0
	var kept_away := 0
	for index in 400:
		var point := Vector3(random.randf_range(-40, 40), 0.0, random.randf_range(-40, 40))
		var birch: ScatterExplanation = scatter.explain_position(point, [scatter.layers[1]])[0]
		check_equal(birch.standing, scatter.has_instance(birch.id), "the explanation matches the instance at %s" % point)
		standing += int(birch.standing)
		kept_away += int(birch.refused_by == "spacing")
		check(birch.allowed == (birch.refused_by != "spacing"), "only spacing excludes a position: %s" % birch.reason)
	check(standing > 50 and kept_away > 50, "%d positions have a birch, %d are too near to an oak" % [standing, kept_away])


func test_problems_of_layers_that_cannot_fill() -> void:
	var species := make_species(true)
	species[0].spacing_fills = true
	var scatter := make_scatter(species, Mound.new(), make_viewer())
	await settle(scatter)
	check("Layer 0: spacing_fills has no effect: there is no spacing between this layer and an earlier one in the list. Add an entry to spacing." in scatter.get_problems(),
			"a layer without an earlier layer cannot fill: %s" % scatter.get_problems())
	species[0].spacing_fills = false
	species[1].on_surfaces = true
	var problems := "\n".join(scatter.get_problems())
	check("spacing_fills has no effect while on_surfaces is on" in problems, "a layer on surfaces cannot fill: %s" % problems)
	species[1].on_surfaces = false
	species[0].on_surfaces = true
	problems = "\n".join(scatter.get_problems())
	check('spacing_fills has no effect around "oak", which is on_surfaces' in problems, "the gaps around a layer on surfaces cannot be filled: %s" % problems)
	species[0].on_surfaces = false
	check_equal(scatter.get_problems(), PackedStringArray(), "no problems are left")
