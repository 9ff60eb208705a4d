extends "terrain3d_harness.gd"
## Tests Terrain3D's ground: the library copies its heights, holes, normals and textures instead of querying single positions.

func test_heights_holes_and_normals() -> void:
	for spacing: float in [1.0, 2.5, 0.5]:
		var node := make_terrain3d(spacing)
		for post: Vector2 in [Vector2(5.0, 7.0), Vector2(-20.0, 3.0), Vector2(-1.0, -1.0)]:
			node.data.set_control(Vector3(post.x + 0.5, 0.0, post.y + 0.5) * spacing, HOLE)
		var scatter := make_on(node)
		var random := RandomNumberGenerator.new()
		random.seed = 5
		var wrong := 0
		var holes := 0
		for i in 3000:
			var at := Vector3(random.randf_range(-68.0, 68.0), 0.0, random.randf_range(-68.0, 68.0)) * spacing
			if i % 3 == 0:
				at = Vector3(random.randf_range(2.0, 8.0), 0.0, random.randf_range(4.0, 10.0)) * spacing
			var height := scatter.ground.get_height(at)
			if node.data.is_open(at):
				holes += int(node.data.region_at(at) != null)
				wrong += int(not is_nan(height))
			elif is_nan(node.data.height_at(at)):
				wrong += int(not is_nan(height))
			else:
				wrong += int(not (absf(height - node.data.height_at(at)) < 1e-4))
				var normal := node.data.get_normal(at)
				if normal.is_finite():
					wrong += int(not (scatter.ground.get_normal(at).distance_to(normal) < 1e-3))
		check_equal(wrong, 0, "positions that differ, at a spacing of %s m" % spacing)
		check(holes > 50, "%d samples in holes" % holes)
		scatter.free()
		node.free()


func test_limits_have_no_effect_on_a_copy() -> void:
	var node := make_terrain3d()
	var scatter := make_on(node)
	var terrain := scatter.ground as ScatterGroundNode
	await settle(scatter)
	var before := digests(scatter, 0)
	check_equal(scatter.get_problems().size(), 0, "no problems")
	terrain.bounds = Rect2(-4.0, -4.0, 8.0, 8.0)
	check("bounds and no_ground_height have no effect" in "\n".join(scatter.get_problems()), "a warning for bounds")
	await settle(scatter)
	check_equal(digests(scatter, 0), before, "the ground is the same")
	terrain.bounds = Rect2()
	check_equal(scatter.get_problems().size(), 0, "no problems without bounds")
	terrain.no_ground_enabled = true
	check("bounds and no_ground_height have no effect" in "\n".join(scatter.get_problems()), "a warning for no_ground_enabled")
	scatter.free()
	node.free()


func test_the_copy_makes_no_calls_for_single_positions() -> void:
	for thread_safe: bool in [false, true]:
		var node := make_terrain3d()
		var scatter := make_on(node, thread_safe)
		await settle(scatter)
		check_ground(scatter, node, "thread_safe %s" % thread_safe)
		check_equal(node.data.point_calls, 0, "calls for single positions")
		var terrain: ScatterGroundNode = scatter.ground
		for word: String in ["Terrain3D", "4 regions", "64 x 64"]:
			check(word in terrain.recognized, "'%s' in '%s'" % [word, terrain.recognized])
		check_equal(scatter.get_problems().size(), 0, "no problems: %s" % [scatter.get_problems()])
		scatter.free()
		node.free()


func test_the_copy_has_the_same_instances_as_queries_by_point() -> void:
	var node := make_terrain3d()
	for row in 40:
		for column in 40:
			var control := control_of(3, 7, (row * 37 + column * 11) % 256) if column % 3 else AUTO
			node.data.set_control(Vector3(column - 19.5, 0.0, row - 19.5), control)
	node.material.parameters["auto_slope"] = 1.5
	root.add_child(node)
	for textures: Array in [[], [0], [1], [3], [7, 1], [20]]:
		var found: Array[Dictionary] = []
		for bulk: bool in [true, false]:
			var queried := QueriedNode.new()
			queried.of = node
			var layer := make_layer(1.0)
			layer.view_distance = 24.0
			layer.max_slope_degrees = 60.0
			layer.layer_id = 2
			layer.ground_textures = PackedInt32Array(textures)
			var scatter := make_on(node if bulk else queried, false, layer)
			await settle(scatter)
			found.push_back(by_id(scatter))
			scatter.free()
			queried.free()
		var differ := 0
		for id: int in found[0]:
			differ += int(not found[1].has(id) or found[1][id].distance_to(found[0][id]) > 0.01)
		check(differ <= 2, "%s: %d of %d instances differ" % [textures, differ, found[0].size()])
		check(absi(found[0].size() - found[1].size()) <= 2, "%s: the numbers of instances are about equal: %d, %d" % [textures, found[0].size(), found[1].size()])
		check_equal(found[0].is_empty(), textures == [20], "%s: instances" % [textures])


func test_without_the_auto_shader() -> void:
	var node := make_terrain3d()
	node.material.auto = false
	var layer := make_layer()
	layer.ground_textures = PackedInt32Array([1])
	for row in 128:
		for column in 128:
			node.data.regions[Vector2i(floori((column - 64) / 64.0), floori((row - 64) / 64.0))].maps[CONTROL].set_pixel(
					column % 64, row % 64, Color(as_float(AUTO), 0.0, 0.0))
	var scatter := make_on(node, false, layer)
	await settle(scatter)
	check_equal(all_transforms(scatter).size(), 0, "without the auto shader, all ground has texture 0")
	node.material.auto = true
	node.material_changed.emit()
	await settle(scatter)
	check(all_transforms(scatter).size() > 100, "with the auto shader, level ground has texture 1")


## Without a renderer, as on a server, the auto shader must produce the same instances.
func test_the_auto_shader_without_a_renderer() -> void:
	var found: Array[Dictionary] = []
	for with_renderer: bool in [true, false]:
		var node := make_terrain3d()
		node.material.parameters = {"auto_slope": 3.0, "auto_height_reduction": 0.5, "auto_base_texture": 5, "auto_overlay_texture": 6}
		node.material.with_renderer = with_renderer
		for at in node.data.regions:
			node.data.regions[at].maps[CONTROL].fill(Color(as_float(AUTO), 0.0, 0.0))
		var layer := make_layer()
		layer.layer_id = 2
		layer.ground_textures = PackedInt32Array([6])
		var scatter := make_on(node, false, layer)
		await settle(scatter)
		found.push_back(by_id(scatter))
		scatter.free()
		node.free()
	check(found[0].size() > 100, "%d instances" % found[0].size())
	check_equal(found[1], found[0], "the instances are the same without a renderer")


func test_empty() -> void:
	var node := Terrain3DDouble.new()
	var scatter := make_on(node)
	await settle(scatter)
	check_equal(scatter.get_stats()["instances"], 0, "instances without a region")
	check("no regions" in "\n".join(scatter.get_problems()), "reported: %s" % [scatter.get_problems()])
	check_no_error("an empty terrain")
	var region := Terrain3DRegionDouble.new()
	fill_region(region)
	node.data.add_region(region)
	await settle(scatter)
	check_ground(scatter, node, "after its first region was added")
	check_equal(scatter.get_problems().size(), 0, "no problems")


func test_invalid_maps_are_reported_and_not_used() -> void:
	var small := Image.create_empty(32, 32, false, Image.FORMAT_RF)
	var gray := Image.create_empty(64, 64, false, Image.FORMAT_L8)
	var wrong: Dictionary[String, Image] = {"height map of a region": small, "format": gray, "no height map": null}
	for words: String in wrong:
		var node := make_terrain3d()
		var scatter := make_on(node)
		await settle(scatter)
		var region := Terrain3DRegionDouble.new(Vector2i(9, 9))
		region.maps[HEIGHT] = wrong[words]
		node.data.add_region(region)
		await settle(scatter)
		var problems := "\n".join(scatter.get_problems())
		check(words in problems and "position by position" in problems, "%s: %s" % [words, problems])
		check("position by position" in (scatter.ground as ScatterGroundNode).recognized, "the node's description mentions the slower queries")
		check_ground(scatter, node, words)
		check(node.data.point_calls > 500, "it is queried point by point")
		node.data.remove_region(region)
		await settle(scatter)
		check_equal(scatter.get_problems().size(), 0, "%s: valid again: %s" % [words, scatter.get_problems()])
		node.data.point_calls = 0
		scatter.regenerate()
		await settle(scatter)
		check_ground(scatter, node, words + ": valid again")
		check_equal(node.data.point_calls, 0, "calls for single positions")
		check_no_error(words)
		scatter.free()
		node.free()


func test_wrong_results() -> void:
	var node := make_terrain3d()
	var wrong := WrongTerrain3D.new()
	root.add_child(wrong)
	var scatter := make_on(wrong)
	for answer: Variant in [null, 5, "regions", [null], [node], [Vector2i.ZERO]]:
		wrong.data.answer = answer
		scatter.regenerate()
		await settle(scatter)
		var problems := "\n".join(scatter.get_problems())
		check("like Terrain3D" in problems, "a result of %s: %s" % [answer, problems])
		check_no_error("a result of %s" % [answer])
	check(scatter.get_stats()["instances"] > 500, "its heights are queried by position instead")
	node.free()


class WrongData extends Object:
	var answer: Variant = null

	func get_regions_active() -> Variant:
		return answer

	func get_height(at: Vector3) -> float:
		return 0.1 * at.x


class WrongTerrain3D extends Node3D:
	var data := WrongData.new()
	var vertex_spacing := 1.0

	func _notification(what: int) -> void:
		if what == NOTIFICATION_PREDELETE:
			data.free()


func test_layers_grow_on_all_levels_of_a_terrain_and_a_bridge() -> void:
	var node := make_terrain3d()
	node.data.set_control(Vector3(20.5, 0.0, 7.5), HOLE)
	var layer := make_layer()
	layer.on_surfaces = true
	var scatter := make_on(node, false, layer)
	await settle(scatter)
	check_equal(scatter.get_problems().size(), 0, "problems: %s" % scatter.get_problems())
	var alone := all_transforms(scatter)
	check(alone.size() > 1500, "%d instances" % alone.size())
	check_equal(count_off_mesh(alone, node), 0, "instances off the mesh that is drawn")
	var bridge := MeshInstance3D.new()
	var plane := PlaneMesh.new()
	plane.size = Vector2(30.0, 20.0)
	bridge.mesh = plane
	bridge.position.y = 90.0
	bridge.add_to_group(&"bridge")
	root.add_child(bridge)
	var bridges := ScatterGroundMeshes.new()
	bridges.group = &"bridge"
	var combined := ScatterGroundCombined.new()
	combined.grounds = [bridges, scatter.ground]
	scatter.ground = combined
	await settle(scatter)
	var together := all_transforms(scatter)
	var above := together.filter(func(at: Transform3D) -> bool: return absf(at.origin.y - 90.0) < 1e-3)
	check(above.size() > 60, "%d instances on the bridge" % above.size())
	check_equal(together.size() - above.size(), alone.size(), "the terrain below it keeps its instances")
	layer.on_surfaces = false
	await settle(scatter)
	for at in all_transforms(scatter):
		var below := absf(at.origin.x) < 15.0 and absf(at.origin.z) < 10.0
		if not check(not below or absf(at.origin.y - 90.0) < 1e-3, "the top layer grows on the bridge: %s" % at.origin):
			break


## Returns the number of instances that are not between the heights of the samples around them, or that are in a hole.
func count_off_mesh(standing: Array[Transform3D], node: Terrain3DDouble) -> int:
	var wrong := 0
	for at in standing:
		var corner := Vector3(floorf(at.origin.x), 0.0, floorf(at.origin.z)) + Vector3(1e-3, 0.0, 1e-3)
		var heights: Array[float] = []
		for index in 4:
			heights.push_back(node.data.get_pixel(HEIGHT, corner + Vector3(index % 2, 0.0, floori(index / 2.0))))
		var low: float = heights.min()
		var high: float = heights.max()
		wrong += int(node.data.is_open(corner) or at.origin.y < low - 0.01 or at.origin.y > high + 0.01)
	return wrong
