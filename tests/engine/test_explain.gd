extends "rules_harness.gd"
## Tests explain_position: the reasons why an instance exists at a position or not. Explanations must match the instances.


## Returns a scatter on a hillside with a clearing. The layer uses most rules and keeps a distance from the trees.
func make_ruled() -> TerrainScatter3D:
	var trees := make_layer(6.0)
	trees.resource_name = "Trees"
	var layer := make_layer(2.0)
	layer.resource_name = "Ferns"
	layer.progressive_levels = 3
	layer.density = 0.8
	layer.max_slope_degrees = 35.0
	layer.slope_falloff_degrees = 10.0
	layer.min_height = 5.0
	layer.height_falloff = 20.0
	layer.clump_size = 30.0
	layer.clump_coverage = 0.7
	layer.edge_feather = 3.0
	layer.spacing = {"Trees": 1.5}
	var scatter := make_scatter([trees, layer], hillside(), make_viewer(Vector3(-100, 0, 20)))
	var clearing := ScatterRegion3D.new()
	clearing.name = "Clearing"
	clearing.exclude = true
	clearing.shape = ScatterRegion3D.SHAPE_CYLINDER
	clearing.radius = 25.0
	clearing.height = 1000.0
	clearing.position = Vector3(-90, 0, 30)
	scatter.add_child(clearing)
	return scatter


## Returns random positions all over the hillside, most of them far from viewers.
func random_places(count: int) -> PackedVector3Array:
	var random := RandomNumberGenerator.new()
	random.seed = 11
	var points := PackedVector3Array()
	for index in count:
		points.append(Vector3(random.randf_range(-150, 150), random.randf_range(-9, 9), random.randf_range(-150, 150)))
	return points


func product(explanation: ScatterExplanation) -> float:
	var result := 1.0
	for rule in explanation.get_rule_count():
		result *= explanation.get_rule_density(rule)
	return result


func test_explanations_match_the_instances() -> void:
	var scatter := make_ruled()
	await settle(scatter)
	var standing := 0
	var refused := 0
	var wrong := 0
	for point in random_places(1500):
		var both := scatter.explain_position(point)
		for explanation: ScatterExplanation in both:
			var layer := explanation.layer
			var fits := explanation.standing == scatter.has_instance(explanation.id)
			fits = fits and explanation.distance <= layer.radius and explanation.allowed == (explanation.density > 0.0)
			fits = fits and is_equal_approx(product(explanation), explanation.density)
			fits = fits and explanation.standing == (explanation.rank < explanation.point_density)
			fits = fits and (explanation.allowed and explanation.shown) == explanation.refused_by.is_empty()
			fits = fits and is_equal_approx(explanation.position.y, scatter.ground.get_height(point))
			wrong += 0 if fits else 1
			standing += 1 if explanation.standing else 0
			refused += 0 if explanation.allowed else 1
	check_equal(wrong, 0, "explanations that do not match")
	check(standing > 300 and standing < 2700 and refused > 300, "%d exist, %d are rejected" % [standing, refused])


## At a point of the Poisson-disk set, the density exceeds the rank if and only if the instance exists.
func test_explanations_of_points_match_the_instances() -> void:
	var scatter := make_ruled()
	await settle(scatter)
	var shown_count := 0
	for point in random_places(400):
		var id := scatter.explain_position(point, "Ferns")[0].id
		var at := scatter.explain_position(point, "Ferns")[0].point_position
		var explanation := scatter.explain_position(at, "Ferns")[0]
		if not (check_equal(explanation.id, id, "the point itself") and check(explanation.distance < 1e-3, "the position of the point")):
			return
		check_equal(explanation.density > explanation.rank, scatter.has_instance(id), "exists: " + explanation.reason)
		shown_count += 1 if explanation.refused_by.is_empty() else 0
	check(shown_count > 5, "%d are visible" % shown_count)


func test_each_rule_can_reject() -> void:
	var noise := FastNoiseLite.new()
	var black := ImageTexture.create_from_image(Image.create_empty(4, 4, false, Image.FORMAT_L8))
	var mask := ScatterMask.new()
	mask.background = 0.0
	var nothing := make_line(Vector2(0, 0), Vector2(100, 0))
	var cases := {
		"slope": [{"max_slope_degrees": 10.0}, ["Slope is", "°", "0° to 10°"]],
		"height": [{"min_height": 300.0}, ["Height is", "at least 300 m"]],
		"density": [{"density": 0.0}, ["density is 0"]],
		"noise": [{"noise": noise, "noise_curve": nothing}, ["noise permits no instances"]],
		"mask_texture": [{"mask_texture": black}, ["mask texture permits no instances"]],
		"mask": [{"mask": mask}, ["mask permits no instances"]],
		"clumps": [{"clump_size": 20.0, "clump_coverage": 0.0}, ["clumps"]],
		"density_over_height": [{"density_over_height": nothing}, ["Density over height is 0 at"]],
		"density_expression": [{"density_expression": "0 * height"}, ["The density expression 0 * height is 0 here."]],
		"density_over_slope": [{"density_over_slope": nothing}, ["Density over slope is 0 at"]],
		"spacing": [{"spacing": {"Trees": 8.0}}, ["The nearest instance of Trees is", "m away; the spacing requires 8 m"]],
		"proximity": [{"proximity_layer": "Trees", "proximity_distance": 0.01}, ["No instance of Trees within 0.01 m"]],
	}
	var trees := make_layer(4.0)
	trees.resource_name = "Trees"
	var scatter := make_scatter([trees, make_layer(2.0)], hillside(), make_viewer(Vector3(80, 0, 20)))
	await settle(scatter)
	for rule: String in cases:
		var layer := make_layer(2.0)
		for property: StringName in cases[rule][0]:
			layer.set(property, cases[rule][0][property])
		scatter.layers = [trees, layer]
		var explanation := scatter.explain_position(Vector3(80, 0, 20), layer)[0]
		check_equal(explanation.refused_by, StringName(rule), "the rejecting rule: " + explanation.reason)
		for words: String in cases[rule][1]:
			check(words in explanation.reason, "%s: '%s' in '%s'" % [rule, words, explanation.reason])
		var names: Array = range(explanation.get_rule_count()).map(explanation.get_rule_name)
		var index := names.find(StringName(rule))
		check(index >= 0 and explanation.get_rule_density(index) == 0.0, "%s is among %s" % [rule, names])
		check_equal([explanation.allowed, explanation.density], [false, 0.0], "no instance is allowed because of " + rule)
	var steep := make_layer(2.0)
	steep.max_slope_degrees = 10.0
	scatter.layers = [steep]
	var slope := scatter.explain_position(Vector3(80, 0, 20))[0]
	check_equal([slope.get_rule_min(1), slope.get_rule_max(1)], [0.0, 10.0], "the required range")
	var normal := scatter.ground.get_normal(Vector3(80, 0, 20))
	check(absf(slope.get_rule_value(1) - rad_to_deg(normal.angle_to(Vector3.UP))) < 0.1, "the slope")


func test_the_share_of_each_mesh_is_explained() -> void:
	var layer := make_layer(2.0)
	var oak := BoxMesh.new()
	oak.resource_name = "Oak"
	layer.meshes = [oak, SphereMesh.new()]
	layer.mesh_weights = [3.0]
	layer.mesh_density_expressions = ["clamp(x / 40, 0, 1)"]
	var scatter := make_scatter([layer], ScatterGroundFlat.new(), make_viewer(Vector3(20, 0, 0)))
	await settle(scatter)
	var chosen := [0, 0]
	for position: Vector3 in [Vector3(10, 0, 3), Vector3(20, 0, -8), Vector3(2, 0, 8), Vector3(30, 0, 0), Vector3(-20, 0, 0), Vector3(3, 0, 1), Vector3(4, 0, 20)]:
		var explanation := scatter.explain_position(position)[0]
		check_equal(explanation.get_mesh_count(), 2, "the number of meshes")
		var density := clampf(explanation.point_position.x / 40.0, 0.0, 1.0)
		check(absf(explanation.get_mesh_density(0) - density) < 1e-5, "the value of the expression")
		check_equal(explanation.get_mesh_density(1), 1.0, "a mesh without an expression")
		check(absf(explanation.get_mesh_probability(0) - 3.0 * density / (3.0 * density + 1.0)) < 1e-5, "the probability")
		var instance := scatter.query_sphere(explanation.point_position, 0.1)
		check_equal(instance.meshes[0], explanation.mesh, "the mesh of the instance")
		chosen[explanation.mesh] += 1
		var sentence := explanation.get_mesh_sentence(0)
		check(sentence.begins_with("Oak" + (" (this instance)" if explanation.mesh == 0 else "") + ": weight 3 × ") and sentence.ends_with(" %."), sentence)
		check(explanation.get_mesh_sentence(1).begins_with("Entry 1"), explanation.get_mesh_sentence(1))
	check(chosen[0] > 0 and chosen[1] > 0, "both meshes are chosen: %s" % [chosen])
	var last := scatter.explain_position(Vector3.ZERO)[0]
	check_equal(last.get_mesh_sentence(2), "", "a missing mesh")
	check_error(["ScatterExplanation.get_mesh_sentence", "index", "between 0 and 1"], "a missing mesh")
	check_equal(last.get_mesh_density(-1), 0.0, "the expression of a missing mesh")
	check_error(["ScatterExplanation.get_mesh_density", "got -1"], "a negative index")
	var empty := ScatterExplanation.new()
	check_equal(empty.get_mesh_density(0), 0.0, "the expression without a choice of meshes")
	check_error(["ScatterExplanation.get_mesh_density", "index 0", "empty", "get_mesh_count()"], "an index into an empty list")
	check_equal(last.get_mesh_probability(7), 0.0, "the probability of a missing mesh")
	check_error(["ScatterExplanation.get_mesh_probability", "got 7"], "an index of 7")
	layer.mesh_density_expressions = ["0", "0"]
	await settle(scatter)
	check("all weights are 0 here, so the plain weight gives 75 %" in scatter.explain_position(Vector3.ZERO)[0].get_mesh_sentence(0), "the plain weights")
	var root := Node3D.new()
	var pine := MeshInstance3D.new()
	pine.name = "Pine"
	pine.mesh = BoxMesh.new()
	root.add_child(pine)
	pine.owner = root
	var scene := PackedScene.new()
	scene.pack(root)
	root.free()
	check_equal(ResourceSaver.save(scene, "user://old_firs.tscn"), OK, "the scene is saved")
	scene.take_over_path("user://old_firs.tscn")
	var part := ScatterModel.new()
	part.scene_part = "Pine"
	part.scene = scene
	layer.meshes = [scene, part]
	await settle(scatter)
	var with_scenes := scatter.explain_position(Vector3.ZERO)[0]
	check(with_scenes.get_mesh_sentence(0).begins_with("old_firs"), "the name of a file: " + with_scenes.get_mesh_sentence(0))
	check(with_scenes.get_mesh_sentence(1).begins_with("Pine"), "the name of a part: " + with_scenes.get_mesh_sentence(1))
	DirAccess.remove_absolute("user://old_firs.tscn")
	layer.meshes = [oak]
	await settle(scatter)
	check_equal(scatter.explain_position(Vector3.ZERO)[0].get_mesh_count(), 0, "a single mesh needs no explanation")


func test_regions_and_holes_are_named() -> void:
	var scatter := make_ruled()
	await settle(scatter)
	var inside := scatter.explain_position(Vector3(-90, 0, 30), "Trees")[0]
	check_equal([inside.refused_by, "Clearing excludes" in inside.reason], [&"regions", true], inside.reason)
	var clearing: ScatterRegion3D = scatter.get_child(0)
	clearing.exclude = false
	var outside := scatter.explain_position(Vector3(-60, 0, -60), "Trees")[0]
	check_equal([outside.refused_by, "Outside all regions" in outside.reason], [&"regions", true], outside.reason)
	var beyond := scatter.explain_position(Vector3(900, 0, 0), ["Trees"])[0]
	check_equal([beyond.refused_by, beyond.reason], [&"ground", "There is no ground here."], "beyond the terrain")


func test_removals_and_visibility_are_explained() -> void:
	var layer := make_layer(2.0)
	var viewer := make_viewer()
	var scatter := make_scatter([layer], ScatterGroundFlat.new(), viewer)
	scatter.state = ScatterState.new()
	await settle(scatter)
	var there := scatter.explain_position(Vector3(3, 0, 3))[0]
	check_equal([there.refused_by, there.standing, there.shown], [&"", true, true], there.reason)
	check("Placed" in there.reason and "m away" in there.reason, there.reason)
	var here := scatter.explain_position(there.point_position)[0]
	check_equal(here.reason, "Placed here.", "the reason at the point")
	scatter.remove_instance(there.id)
	var gone := scatter.explain_position(Vector3(3, 0, 3))[0]
	check_equal([gone.refused_by, gone.standing, gone.allowed], [&"state", false, true], gone.reason)
	scatter.add_instance(scatter.layers[0], Transform3D(Basis(), Vector3(3.2, 0, 3)))
	check("One was placed by hand" in scatter.explain_position(Vector3(3, 0, 3))[0].reason, "a hand-placed instance is mentioned")
	scatter.restore_instance(there.id)
	var far := scatter.explain_position(Vector3(2000, 0, 3))[0]
	check_equal([far.refused_by, far.standing, far.shown], [&"view_distance", true, false], far.reason)
	check("64 m" in far.reason, "the view distance: " + far.reason)
	scatter.quality = 0.0
	await settle(scatter)
	check_equal(scatter.explain_position(Vector3(3, 0, 3))[0].refused_by, &"thinning", "rejected because of quality")
	scatter.quality = 1.0
	await settle(scatter)
	scatter.hide()
	check_equal(scatter.explain_position(Vector3(3, 0, 3))[0].refused_by, &"visible", "rejected because the node is hidden")
	scatter.show()
	layer.meshes = []
	check_equal(scatter.explain_position(Vector3(3, 0, 3))[0].refused_by, &"meshes", "rejected because there is no mesh")
	layer.meshes = [BoxMesh.new()]
	layer.density = 0.5
	await settle(scatter)
	var left_out := 0
	for point in random_places(60):
		var explanation := scatter.explain_position(point * 0.2)[0]
		if explanation.refused_by == &"rank":
			left_out += 1
			check(explanation.rank >= 0.5 and not explanation.standing and "rank" in explanation.reason, explanation.reason)
	check(left_out > 15 and left_out < 45, "the density excludes %d of 60" % left_out)


func test_missing_layers_and_grounds() -> void:
	var layer := make_layer()
	var scatter := make_scatter([layer], ScatterGroundFlat.new(), make_viewer())
	await settle(scatter)
	for bad: Vector3 in [Vector3(NAN, 0, 0), Vector3(0, 0, INF)]:
		check_equal(scatter.explain_position(bad).size(), 0, "explanations for %s" % bad)
		check_error(["explain_position", "position must be finite"], "a position of %s" % bad)
	check_equal(scatter.explain_position(Vector3(0, NAN, 0)).size(), 1, "explanations for a position whose height is NAN")
	check_equal(scatter.explain_position(Vector3.ZERO, "Oaks").size(), 0, "explanations for a missing layer")
	check_error(["explain_position", "Oaks"], "a missing layer")
	var far := scatter.explain_position(Vector3(1e12, 0, 0))[0]
	check("must be between" in far.reason, "beyond the set's cells: " + far.reason)
	scatter.layers = [layer, null]
	check("empty" in scatter.explain_position(Vector3.ZERO)[1].reason, "an empty entry")
	scatter.layers = []
	check_equal(scatter.explain_position(Vector3.ZERO).size(), 0, "explanations without layers")
	scatter.layers = [layer]
	scatter.ground = null
	var groundless := scatter.explain_position(Vector3.ZERO)[0]
	check_equal([groundless.refused_by, "No ground" in groundless.reason], [&"ground", true], groundless.reason)
	scatter.ground = ScatterGroundHeightmap.new()
	check_equal(scatter.explain_position(Vector3.ZERO)[0].refused_by, &"ground", "a ground without heights")
	check_error(["heightmap_path"], "a heightmap without an image or a file")
	var outsider := TerrainScatter3D.new()
	outsider.layers = [layer]
	outsider.ground = ScatterGroundFlat.new()
	var outside := outsider.explain_position(Vector3(3, 0, 3))[0]
	check_equal([outside.standing, outside.refused_by], [true, &"visible"], "outside of the tree: " + outside.reason)
	outsider.free()
	var explanation := ScatterExplanation.new()
	check_equal([explanation.get_rule_count(), explanation.get_rule_sentence(0)], [0, ""], "a new explanation")
	check_error(["get_rule_sentence", "index", 0], "a missing rule")


func test_maps_match_the_explanations() -> void:
	var scatter := make_ruled()
	await settle(scatter)
	var rect := Rect2(-150, -30, 90, 70)
	var size := Vector2i(18, 14)
	var density := scatter.get_density_map("Ferns", rect, size)
	var slope := scatter.get_slope_map(rect, size)
	var rank := scatter.get_rank_map("Ferns", rect, size)
	check_equal([density.size(), slope.size(), rank.size()], [252, 252, 252], "sizes")
	var wrong := 0
	var some := 0
	for index in density.size():
		var field := Vector2(index % size.x + 0.5, index / size.x + 0.5)
		var at := rect.position + field * rect.size / Vector2(size)
		var explanation := scatter.explain_position(Vector3(at.x, 0, at.y), "Ferns")[0]
		var normal := scatter.ground.get_normal(Vector3(at.x, 0, at.y))
		var fits := absf(density[index] - explanation.density) < 1e-4 and absf(rank[index] - explanation.rank) < 1e-4
		fits = fits and absf(slope[index] - rad_to_deg(normal.angle_to(Vector3.UP))) < 0.2
		wrong += 0 if fits else 1
		some += 1 if density[index] > 0.0 else 0
	check_equal(wrong, 0, "pixels that differ")
	check(some > 30 and some < 240, "%d pixels have a density" % some)
	check(is_nan(scatter.get_slope_map(Rect2(900, 0, 10, 10), Vector2i(1, 1))[0]), "no slope without ground")
	check_equal(scatter.get_density_map(scatter.layers[0], Rect2(900, 0, 10, 10), Vector2i(1, 1))[0], 0.0, "no density without ground")
	for bad: Array in [[Rect2(0, 0, NAN, 1), Vector2i(2, 2), "rect"], [Rect2(0, 0, -1, 1), Vector2i(2, 2), "rect"],
			[Rect2(0, 0, 1, 1), Vector2i(0, 2), "size"], [Rect2(0, 0, 1, 1), Vector2i(5000, 1), "size"]]:
		check_equal(scatter.get_slope_map(bad[0], bad[1]).size(), 0, "values for %s" % [bad])
		check_error(["get_slope_map", bad[2]], "%s" % [bad])
	check_equal(scatter.get_density_map("Oaks", rect, size).size(), 0, "a missing layer")
	check_error(["get_density_map", "Oaks"], "a missing layer")
	check_equal(scatter.get_rank_map("Ferns", Rect2(0, 0, 1e5, 1e5), size).size(), 0, "too many points")
	check_error(["get_rank_map", "rect requires too many points"], "a large rectangle")


## A ground that frees a node while the main thread queries it.
class FreeingGround extends ScatterGround:
	var victim: Node

	func _get_heights(positions: PackedVector2Array) -> PackedFloat32Array:
		if victim != null:
			victim.free()
			victim = null
		var heights := PackedFloat32Array()
		heights.resize(positions.size())
		return heights


func test_a_ground_that_is_queried_on_the_main_thread() -> void:
	var ground := FreeingGround.new()
	var scatter := make_scatter([make_layer()], ground, make_viewer())
	await settle(scatter)
	var explanation := scatter.explain_position(Vector3(4, 0, 4))[0]
	check_equal([explanation.refused_by, explanation.standing], [&"", true], explanation.reason)
	check_equal(scatter.get_density_map(scatter.layers[0], Rect2(0, 0, 9, 9), Vector2i(3, 3)), PackedFloat32Array([1, 1, 1, 1, 1, 1, 1, 1, 1]), "all pixels")
	for method: String in ["explain_position", "get_density_map", "get_slope_map"]:
		var other := make_scatter([make_layer()], ground, make_viewer())
		await settle(other)
		ground.victim = other
		match method:
			"explain_position": other.explain_position(Vector3.ZERO)
			"get_density_map": other.get_density_map(other.layers[0], Rect2(0, 0, 9, 9), Vector2i(3, 3))
			"get_slope_map": other.get_slope_map(Rect2(0, 0, 9, 9), Vector2i(3, 3))
		ground.victim = null
		check(was_kept_from_being_freed() or not is_instance_valid(other), "%s survives freeing the node" % method)
