extends "harness.gd"
## Tests a node's list of layers: edits, the IDs that layers keep during edits, and references between layers.

const AREA := Rect2(-40.0, -40.0, 80.0, 80.0)


## Returns {ID: position} for the layer's instances in AREA.
func standing(scatter: TerrainScatter3D, layer: int) -> Dictionary[int, Vector3]:
	var found: Variant = scatter.query_rect(AREA, scatter.layers[layer] if layer < scatter.layers.size() else [] as Variant)
	var result: Dictionary[int, Vector3] = {}
	for index: int in found.ids.size():
		result[found.ids[index]] = found.positions[index]
	return result


func names(scatter: TerrainScatter3D) -> Array:
	return scatter.layers.map(func(layer: ScatterLayer) -> String: return layer.resource_name)


func ids(scatter: TerrainScatter3D) -> Array:
	return scatter.layers.map(func(layer: ScatterLayer) -> int: return layer.layer_id if layer != null else -1)


func named(layer_name: String, radius := 4.0) -> ScatterLayer:
	var layer := make_layer(radius)
	layer.resource_name = layer_name
	return layer


## Adds the forest preset to the tree, on flat ground, and returns its scatter. No layer fills gaps, because such layers move when an earlier one is
## deleted.
func make_forest_preset() -> TerrainScatter3D:
	var scatter := (load("res://addons/thicket/presets/forest.tscn") as PackedScene).instantiate() as TerrainScatter3D
	for layer in scatter.layers:
		layer.spacing_fills = false
	scatter.ground = ScatterGroundFlat.new()
	root.add_child(scatter)
	scatter.viewers = [scatter.get_path_to(make_viewer())]
	return scatter


func everything(scatter: TerrainScatter3D) -> Dictionary[String, Dictionary]:
	var result: Dictionary[String, Dictionary] = {}
	for index in scatter.layers.size():
		result[scatter.layers[index].resource_name] = standing(scatter, index)
	return result


func test_deleting_a_layer_moves_no_other_instances() -> void:
	for deleted: String in ["Stone", "Spruce"]:
		var scatter := make_forest_preset()
		var before := everything(scatter)
		scatter.layers.remove_at(names(scatter).find(deleted))
		var after := everything(scatter)
		check_equal(after.size(), 7, "layers without " + deleted)
		var kept_count := 0
		var all := 0
		var moved := 0
		for layer_name in after:
			all += before[layer_name].size()
			for id: int in before[layer_name]:
				var stays := after[layer_name].has(id)
				kept_count += int(stays)
				moved += int(stays and after[layer_name][id] != before[layer_name][id])
		check(all > 10_000, "%d instances before" % all)
		check_equal(moved, 0, "instances that moved without " + deleted)
		# Only grass keeps a distance from stones. Without spruces, there are more birches and bushes, from which other layers keep a distance.
		check(kept_count > (0.99 if deleted == "Stone" else 0.9) * all, "%d of %d stay without %s" % [kept_count, all, deleted])
		scatter.free()


## Previews that the editor's panel sets, which hide or replace layers, have no effect in a game.
func test_a_game_ignores_previews() -> void:
	var scatter := make_scatter([make_layer(4.0), make_layer(6.0)], ScatterGroundFlat.new(), make_viewer())
	await settle(scatter)
	var counts := [scatter.get_shown_count(scatter.layers[0]), scatter.get_shown_count(scatter.layers[1])]
	check(counts[0] > counts[1] and counts[1] > 10, "visible: %s" % [counts])
	check_equal(counts[0] + counts[1], scatter.get_stats()["instances"], "their sum is the number of instances")
	scatter.call(&"_set_preview_hidden", scatter.layers)
	scatter.call(&"_set_preview_stand_in", scatter.layers[0], make_layer(20.0))
	await settle(scatter)
	check_equal([scatter.get_shown_count(scatter.layers[0]), scatter.get_shown_count(scatter.layers[1])], counts, "the previews do not change the counts")
	check_equal(scatter.get_stats()["drawn"], counts[0] + counts[1], "all are drawn")
	check_equal(scatter.get_shown_count("larch"), 0, "count of a missing layer")
	check_error(["get_shown_count", "larch"], "a missing layer")
	scatter.free()


func test_layers_get_ids_when_they_are_added() -> void:
	var pinned := make_layer()
	pinned.layer_id = 1
	var scatter := TerrainScatter3D.new()
	scatter.layers = [make_layer(), null, make_layer(), pinned, make_layer()]
	check_equal(ids(scatter), [0, -1, 2, 1, 4], "a layer gets its index as its ID if that ID is free")
	var last := scatter.layers[4]
	scatter.layers = [pinned, make_layer(), last]
	check_equal(ids(scatter), [1, 0, 4], "otherwise, it gets the lowest free ID, and the other layers keep theirs")
	scatter.layers = [last, scatter.layers[1], pinned]
	check_equal(ids(scatter), [4, 0, 1], "reordered layers keep their IDs")
	last.layer_id = -1
	check_equal(last.layer_id, 2, "a reset ID becomes the lowest free ID")
	check(not "layer_id" in "".join(scatter.get_problems()), "no ID is used twice")
	last.layer_id = 1
	check("layer_id" in "".join(scatter.get_problems()), "an ID that is used twice is reported")
	var other := TerrainScatter3D.new()
	other.layers = [pinned, scatter.layers[1]]
	check_equal(ids(other), [1, 0], "a layer that two nodes share keeps its ID")
	check_equal(ids(scatter), [1, 0, 1], "it keeps its ID in both nodes")
	other.free()
	scatter.free()


## The editor's undo history keeps a removed node outside the tree. The node must not change layers that other nodes share.
func test_a_node_outside_of_the_tree_assigns_no_ids() -> void:
	var layer := make_layer(2.0)
	var scatter := make_scatter([make_layer(2.0), layer], ScatterGroundFlat.new(), make_viewer())
	await frames(2)
	check_equal(layer.layer_id, 1, "in the tree, the node assigns an ID")
	root.remove_child(scatter)
	layer.layer_id = -1
	await frames(2)
	check_equal(layer.layer_id, -1, "outside of the tree, it does not")
	root.add_child(scatter)
	await frames(2)
	layer.radius = 3.0
	check_equal(layer.layer_id, 1, "back in the tree, it assigns an ID again")
	scatter.queue_free()


func test_ids_are_saved_with_the_scene() -> void:
	var scatter := TerrainScatter3D.new()
	scatter.layers = [named("a"), named("b"), named("c")]
	scatter.layers.remove_at(0)
	var scene := PackedScene.new()
	scene.pack(scatter)
	var path := "user://layer_ids.tscn"
	check_equal(ResourceSaver.save(scene, path), OK, "the scene is saved")
	scatter.free()
	var again := (ResourceLoader.load(path, "", ResourceLoader.CACHE_MODE_IGNORE) as PackedScene).instantiate() as TerrainScatter3D
	check_equal([names(again), ids(again)], [["b", "c"], [1, 2]], "the opened scene has the same layers and IDs")
	again.free()
	DirAccess.remove_absolute(path)


func test_changes_to_the_array_take_effect_immediately() -> void:
	var scatter := make_scatter([], ScatterGroundFlat.new(), make_viewer())
	await frames(2)
	scatter.layers.append(named("oak"))
	check(not scatter.is_settled(), "the change unsettles the node")
	check(standing(scatter, 0).size() > 100, "an immediate query finds %d" % standing(scatter, 0).size())
	check_equal(scatter.layers[0].layer_id, 0, "the layer has an ID")
	await settle(scatter)
	check(scatter.get_shown_tiles(scatter.layers[0]).size() > 4, "the tiles of the new layer are visible")
	scatter.layers.append(named("fern", 2.0))
	await settle(scatter)
	check(scatter.get_shown_tiles(scatter.layers[1]).size() > 4, "the change is detected without a query")
	var before := standing(scatter, 0)
	scatter.layers[1].density = 0.5
	check(not scatter.is_settled(), "changes to an appended layer are detected")
	await settle(scatter)
	scatter.layers.reverse()
	check(standing(scatter, 1) == before, "the oaks are the same at a new index")
	var gone := scatter.layers[0]
	scatter.layers.remove_at(0)
	check(standing(scatter, 0) == before, "the oaks are the same without other layers")
	await settle(scatter)
	gone.density = 1.0
	check(scatter.is_settled(), "changes to a removed layer are ignored")
	scatter.layers.clear()
	check(standing(scatter, 0).is_empty(), "no instances without layers")
	check_error(["layers"], "a query without layers")
	await settle(scatter)
	check(shown_tiles(scatter, 0).is_empty(), "no visible tiles")


func test_references_to_a_renamed_layer_are_updated() -> void:
	var oak := named("oak")
	var fern := named("fern", 2.0)
	var moss := named("moss", 1.0)
	fern.spacing = {"oak": 3.0, "moss": 1.0}
	fern.proximity_layer = "oak"
	moss.spacing = {"fern": 0.5}
	var scatter := make_scatter([oak, fern, moss], ScatterGroundFlat.new(), make_viewer())
	await settle(scatter)
	var shown_digests := digests(scatter, 1)
	var shown_count: Array[int] = [0]
	scatter.tile_shown.connect(func(_layer: ScatterLayer, _tile: Vector2i) -> void: shown_count[0] += 1)
	oak.resource_name = "elm"
	check_equal(fern.spacing.keys(), ["elm", "moss"], "spacing is updated, in its order")
	check_equal(fern.spacing.values(), [3.0, 1.0], "spacing keeps its distances")
	check_equal(fern.proximity_layer, "elm", "proximity is updated")
	check_equal(scatter.get_problems(), PackedStringArray(), "no problems")
	await settle(scatter)
	check(shown_count[0] == 0 and digests(scatter, 1) == shown_digests, "no tile is regenerated")
	oak.resource_name = "oak"
	check_equal(fern.spacing.keys(), ["oak", "moss"], "references are updated when the name changes back, as undo does")
	for typed: String in ["oa", "o", "", "f", "fe", "fer", "fern", "fern ", "fern t", "fern tree"]:
		oak.resource_name = typed
	check_equal(fern.spacing.keys(), ["fern tree", "moss"], "typed letter by letter, with an empty name and the name of a second layer in between")
	check_equal(moss.spacing.keys(), ["fern"], "references to the second layer stay")
	oak.resource_name = "fern"
	check_equal(fern.spacing.keys(), ["fern tree", "moss"], "references are not updated to a name that is already used")
	check("the name of an earlier layer" in "".join(scatter.get_problems()), "the used name is reported")
	oak.resource_name = "oak"
	check_equal(fern.spacing.keys(), ["oak", "moss"], "references are updated once the name is unique")
	moss.resource_name = "oak"
	check_equal(fern.spacing.keys(), ["oak", "moss"], "references stay while two layers have the name")
	oak.resource_name = "elm"
	check_equal(fern.spacing, {"oak": 3.0}, "the references now mean the other layer, which has the old name, with the larger distance")


## References to a layer and to its name have the same effect.
func test_spacing_and_proximity_by_any_reference() -> void:
	for layer_name: String in ["oak", ""]:
		var oak := named(layer_name)
		var fern := named("fern", 2.0)
		var scatter := make_scatter([oak, fern], ScatterGroundFlat.new(), make_viewer())
		var free := standing(scatter, 1)
		var spaced := {}
		var near := {}
		for reference: Variant in [oak, "oak", &"oak"]:
			if layer_name.is_empty() and (reference is String or reference is StringName):
				continue
			fern.spacing = {reference: 3.0}
			var key: Variant = fern.spacing.keys()[0]
			check_equal(key, "oak" if layer_name else reference, "the stored reference of %s" % [reference])
			var stand := standing(scatter, 1)
			check(stand.size() < free.size() and stand.size() > 10, "spacing by %s: %d of %d" % [reference, stand.size(), free.size()])
			check(spaced.is_empty() or stand == spaced, "the same for %s" % [reference])
			spaced = stand
			fern.spacing = {}
			fern.proximity_layer = reference
			stand = standing(scatter, 1)
			check(stand.size() < free.size() and stand.size() > 10, "proximity by %s: %d" % [reference, stand.size()])
			check(near.is_empty() or stand == near, "the same for %s" % [reference])
			near = stand
			check_equal(scatter.get_problems(), PackedStringArray(), "problems of %s" % [reference])
			fern.proximity_layer = null
			check_equal(fern.proximity_layer, "", "no proximity layer")
			check(standing(scatter, 1) == free, "without proximity, all instances return")
		fern.spacing = {oak: 3.0}
		oak.resource_name = "elm"
		check_equal(fern.spacing, {"elm": 3.0}, "references to a layer use its name once it has one")
		scatter.free()


func test_rejected_references() -> void:
	var a := make_layer()
	var b := make_layer()
	var c := make_layer()
	for bad: Variant in [2.5, null, BoxMesh.new(), Vector2.ZERO]:
		a.spacing = {bad: 1.0}
		check_error(["ScatterLayer.spacing", "Pass a ScatterLayer or its name"], "spacing by %s" % [bad])
		if bad != null:
			a.proximity_layer = bad
			check_error(["ScatterLayer.proximity_layer", "Pass a ScatterLayer or its name"], "proximity by %s" % [bad])
	check_equal([a.spacing, a.proximity_layer], [{}, ""], "nothing was stored")
	a.spacing = {b: 1.0}
	b.proximity_layer = c
	c.spacing = {a: 2.0}
	check_error(["ScatterLayer.spacing", "cycle"], "layers without names in a cycle")
	c.proximity_layer = c
	check_error(["ScatterLayer.proximity_layer", "cycle"], "a nameless layer that refers to itself")
	b.resource_name = "b"
	c.spacing = {a: 2.0}
	check_error(["cycle"], "the cycle stays until its reference is stored again")
	a.spacing = a.spacing
	c.spacing = {a: 2.0}
	check_no_error("names cause no cycle")


func test_references_in_a_saved_scene() -> void:
	var scatter := TerrainScatter3D.new()
	var plain := make_layer()
	var fern := named("fern")
	fern.spacing = {plain: 2.0, named("oak"): 1.0, 0: 3.0}
	fern.proximity_layer = plain
	scatter.layers = [plain, fern]
	var scene := PackedScene.new()
	scene.pack(scatter)
	var path := "user://layer_references.tscn"
	check_equal(ResourceSaver.save(scene, path), OK, "the scene is saved")
	scatter.free()
	var again := (ResourceLoader.load(path, "", ResourceLoader.CACHE_MODE_IGNORE) as PackedScene).instantiate() as TerrainScatter3D
	var layers := again.layers
	check_equal(layers[1].spacing, {layers[0]: 2.0, "oak": 1.0, 0: 3.0}, "the loaded spacing")
	check_equal(layers[1].proximity_layer, layers[0], "the loaded proximity layer")
	again.free()
	DirAccess.remove_absolute(path)


## While a changed list regenerates tiles, a layer's count contains only its own instances, regardless of its index in the list.
func test_counts_belong_to_their_layers_while_the_list_changes() -> void:
	var dense := make_layer(3.0)
	var sparse := make_layer(12.0)
	var scatter := make_scatter([dense, sparse], ScatterGroundFlat.new(), make_viewer())
	await settle(scatter)
	var many := scatter.get_shown_count(dense)
	var few := scatter.get_shown_count(sparse)
	check(many > 8 * few and few > 5, "visible: %d and %d" % [many, few])
	var wide := make_layer(40.0)
	for list: Array in [[wide, dense, sparse], [sparse, wide, dense], [sparse, dense]]:
		scatter.layers = Array(list, TYPE_OBJECT, &"ScatterLayer", null)
		var frames := 0
		while frames < 2 or not scatter.is_settled():
			await process_frame
			frames += 1
			check(scatter.get_shown_count(sparse) <= 2 * few, "sparse has %d, not the %d of the dense layer" % [scatter.get_shown_count(sparse), many])
			if wide in list:
				check(scatter.get_shown_count(wide) <= few, "the new layer has %d" % scatter.get_shown_count(wide))
		check_equal([scatter.get_shown_count(dense), scatter.get_shown_count(sparse)], [many, few], "the final counts")
	scatter.free()
