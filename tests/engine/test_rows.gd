extends "harness.gd"
## Tests ScatterRows: instances in rows along the paths of a group or over the areas in them, and their reactions to changes.

const GROUP := &"roads"


func make_path(points: PackedVector3Array, path_name := "Road") -> Path3D:
	var path := Path3D.new()
	path.name = path_name
	path.curve = Curve3D.new()
	for point in points:
		path.curve.add_point(point)
	path.add_to_group(GROUP)
	return path


func make_rows(step := 4.0, offsets: PackedFloat32Array = [0.0]) -> ScatterRows:
	var rows := ScatterRows.new()
	rows.path_group = GROUP
	rows.step = step
	rows.offsets = offsets
	return rows


func make_rows_layer(rows: ScatterRows) -> ScatterLayer:
	var layer := make_layer()
	layer.rows = rows
	return layer


func make_avenue(rows := make_rows(), others: Array[ScatterLayer] = []) -> TerrainScatter3D:
	var layers: Array[ScatterLayer] = [make_rows_layer(rows)]
	layers.append_array(others)
	return make_scatter(layers, ScatterGroundFlat.new(), make_viewer())


func positions_of(scatter: TerrainScatter3D, layer := 0) -> PackedVector2Array:
	var found: PackedVector2Array
	for at: Transform3D in instances(scatter, layer).values():
		found.push_back(on_map(at))
	found.sort()
	return found


## Returns whether two sorted lists of positions are the same except for rounding.
func equals(found: PackedVector2Array, expected: PackedVector2Array) -> bool:
	expected.sort()
	var same := found.size() == expected.size()
	for index in mini(found.size(), expected.size()):
		same = same and found[index].distance_to(expected[index]) < 0.001
	return same


func test_an_avenue() -> void:
	root.add_child(make_path([Vector3(-20, 3, 1), Vector3(20, -5, 1)]))
	var scatter := make_avenue(make_rows(4.0, [-5.0, 6.0]))
	await settle(scatter)
	var expected: PackedVector2Array
	for step in 11:
		# The path runs toward positive x, so its right side is positive z.
		expected.append_array([Vector2(-20 + 4 * step, 1 - 5), Vector2(-20 + 4 * step, 1 + 6)])
	check(equals(positions_of(scatter), expected), "two rows of 11 trees beside the path, got %s" % positions_of(scatter))
	for at: Transform3D in instances(scatter, 0).values():
		check((-at.basis.z).normalized().is_equal_approx(Vector3.RIGHT), "each instance faces along the path")
		check(is_zero_approx(at.origin.y), "and is on the ground")
	var rows := scatter.layers[0].rows
	rows.yaw_degrees = 90.0
	await settle(scatter)
	for at: Transform3D in instances(scatter, 0).values():
		check((-at.basis.z).normalized().is_equal_approx(Vector3.FORWARD), "yaw_degrees turns it to the left")
	rows.align_to_rows = false
	await settle(scatter)
	var yaws: Dictionary[int, bool]
	for at: Transform3D in instances(scatter, 0).values():
		yaws[roundi(rad_to_deg(at.basis.get_euler().y))] = true
	check(yaws.size() > 10, "without align_to_rows, the yaw is random")


func test_a_field() -> void:
	var path := make_path([Vector3(-1, 0, -1), Vector3(19, 0, -1), Vector3(19, 0, 9), Vector3(-1, 0, 9)])
	path.position = Vector3(-30.5, 0, 2.5)
	root.add_child(path)
	var rows := make_rows(2.0)
	rows.fill_area = true
	rows.row_distance = 4.0
	var scatter := make_avenue(rows)
	await settle(scatter)
	# A row passes through the origin of the path.
	var expected: PackedVector2Array
	for step in 10:
		for row in 3:
			expected.push_back(Vector2(-30.5 + 2 * step, 2.5 + 4 * row))
	check(equals(positions_of(scatter), expected), "three rows inside the outline, got %s" % positions_of(scatter))
	rows.row_angle_degrees = 90.0
	await settle(scatter)
	check_equal(positions_of(scatter).size(), 5 * 5, "rows across the field")
	rows.row_angle_degrees = 0.0
	path.rotation.y = -PI / 2.0
	await settle(scatter)
	check_equal(positions_of(scatter).size(), expected.size(), "the rows rotate with the path")


func test_changes_of_paths() -> void:
	var path := make_path([Vector3(-20, 0, -6), Vector3(20, 0, -6)])
	var other := make_path([Vector3(-20, 0, 12), Vector3(20, 0, 12)], "Other")
	root.add_child(path)
	root.add_child(other)
	var scatter := make_avenue()
	await settle(scatter)
	var before := instances(scatter, 0)
	check_equal(before.size(), 22, "instances of both paths")
	path.position.z = -3.0
	await settle(scatter)
	var moved := instances(scatter, 0)
	check_equal(moved.size(), 22, "a moved path keeps its instances")
	for id in before:
		var shift := Vector3(0, 0, -3) if before[id].origin.z < 0.0 else Vector3.ZERO
		check(moved.has(id) and moved[id].origin.is_equal_approx(before[id].origin + shift), "and their IDs, while the others stay")
	path.curve.set_point_position(1, Vector3(32, 0, -6))
	await settle(scatter)
	var longer := instances(scatter, 0)
	check_equal(longer.size(), 25, "a longer path has more instances")
	for id in moved:
		check(longer.has(id) and longer[id].is_equal_approx(moved[id]), "and keeps the existing ones")
	other.name = "Renamed"
	await settle(scatter)
	var renamed := instances(scatter, 0)
	check_equal(renamed.size(), 25, "a renamed path keeps its number of instances")
	check(renamed != longer, "and gets new IDs")
	other.remove_from_group(GROUP)
	await settle(scatter)
	check_equal(instances(scatter, 0).size(), 14, "a path that leaves the group loses its instances")
	path.free()
	await settle(scatter)
	check_equal(instances(scatter, 0).size(), 0, "a freed path has none")
	check("contains no Path3D" in " ".join(scatter.get_problems()), "the node warns about the empty group")
	other.add_to_group(GROUP)
	await settle(scatter)
	check_equal(instances(scatter, 0).size(), 11, "a path that joins the group gets instances")
	scatter.layers[0].rows = null
	await settle(scatter)
	check(instances(scatter, 0).size() > 100, "without rows, the instances are spread evenly")


func test_only_tiles_near_a_changed_path_are_rebuilt() -> void:
	var path := make_path([Vector3(-50, 0, -50), Vector3(-40, 0, -50)])
	root.add_child(path)
	root.add_child(make_path([Vector3(-50, 0, 50), Vector3(50, 0, 50)], "Other"))
	var scatter := make_avenue()
	scatter.layers[0].tile_size = 16.0
	await settle(scatter)
	var generated: Array[Vector2i] = []
	scatter.tile_shown.connect(func(_layer: ScatterLayer, tile: Vector2i) -> void: generated.push_back(tile))
	path.position.x = 5.0
	await settle(scatter)
	check(not generated.is_empty(), "the tiles of the moved path are rebuilt")
	for tile in generated:
		check(tile.y < 0, "tile %s near the other path is not" % tile)


## Only some paths of a large group are checked in each frame, but no change is lost.
func test_many_paths() -> void:
	var paths: Array[Path3D] = []
	for index in 200:
		var z := 0.4 * index - 40.0
		var path := make_path([Vector3(-4, 0, z), Vector3(4, 0, z)], "Road%d" % index)
		root.add_child(path)
		paths.append(path)
	var scatter := make_avenue()
	await settle(scatter)
	var before := positions_of(scatter)
	check_equal(before.size(), 600, "three instances along each path")
	paths[150].curve.set_point_position(1, paths[150].curve.get_point_position(1) + Vector3(4, 0, 0))
	await until(func() -> bool: return positions_of(scatter).size() > 600, "a longer path")
	check_equal(positions_of(scatter).size(), 601, "one more instance")
	for path in paths:
		path.position.x += 1.0
	await frames(5)
	await settle(scatter)
	paths[10].position.x += 100.0
	paths[10].remove_from_group(GROUP)
	await until(func() -> bool: return positions_of(scatter).size() == 598, "a path fewer")
	var moved := Array(positions_of(scatter)).filter(func(at: Vector2) -> bool: return absf(at.x - 5.0) < 0.01 or absf(at.x - 1.0) < 0.01 or absf(at.x + 3.0) < 0.01)
	check_equal(moved.size(), 597, "all other paths have moved")


func test_gaps_at_crossings() -> void:
	root.add_child(make_path([Vector3(-20, 0, 0.5), Vector3(20, 0, 0.5)]))
	root.add_child(make_path([Vector3(0.5, 0, -20), Vector3(0.5, 0, 20)], "Other"))
	var rows := make_rows(1.0)
	rows.crossing_gap = 7.0
	var scatter := make_avenue(rows)
	await settle(scatter)
	var nearest := INF
	for at in positions_of(scatter):
		nearest = minf(nearest, at.distance_to(Vector2(0.5, 0.5)))
	check(nearest >= 7.0 and nearest < 8.5, "the crossing is free within 7 m, got %f m" % nearest)


func test_queries_and_removals() -> void:
	root.add_child(make_path([Vector3(-20, 0, 3), Vector3(20, 0, 3)]))
	var scatter := make_avenue()
	scatter.state = ScatterState.new()
	await settle(scatter)
	var all := instances(scatter, 0)
	for id in all:
		check(scatter.get_instance(id).transform.is_equal_approx(all[id]), "get_instance(%d)" % id)
	var first: int = all.keys()[0]
	check(not scatter.has_instance(first + 1000), "no instance has an ID of a place that no row has")
	check_equal(scatter.query_sphere(Vector3(0, 0, 3), 5.0).size(), 3, "instances in a sphere")
	var felled: int = scatter.query_sphere(Vector3(0, 0, 3), 1.0).get_id(0)
	check(scatter.remove_instance(felled), "an instance is removed")
	await settle(scatter)
	check(not instances(scatter, 0).has(felled), "and is not displayed any more")
	check_equal(instances(scatter, 0).size(), all.size() - 1, "while the others are")
	var bytes := scatter.state.to_bytes()
	var copy := ScatterState.new()
	check_equal(copy.from_bytes(bytes), OK, "the state is saved and loaded")
	scatter.state = copy
	await settle(scatter)
	check(not instances(scatter, 0).has(felled), "a loaded state contains the removal")
	check(scatter.restore_instance(felled), "the instance is restored")
	await settle(scatter)
	check(instances(scatter, 0) == all, "and displayed again")


func test_tiles_built_on_request() -> void:
	root.add_child(make_path([Vector3(-50, 0, -43), Vector3(20, 0, 7), Vector3(50, 0, 9)]))
	var rows := make_rows(1.5, [-2.0, 2.0])
	rows.jitter_along = 0.5
	rows.jitter_across = 0.7
	var scatter := make_avenue(rows)
	scatter.layers[0].tile_size = 32.0
	await settle(scatter)
	var all := instances(scatter, 0)
	var built := scatter.build_rect(scatter.layers[0], Rect2(-60, -60, 120, 120))
	var ids := PackedInt64Array(all.keys())
	ids.sort()
	var built_ids := built.get_ids(0)
	built_ids.sort()
	check_equal(built_ids, ids, "a large rectangle has the instances of all tiles")


func test_other_layers_keep_their_distance() -> void:
	root.add_child(make_path([Vector3(-30, 0, 0), Vector3(30, 0, 0)]))
	for fills: bool in [false, true]:
		var bushes := make_layer(1.0)
		bushes.resource_name = "bushes"
		var scatter := make_avenue(make_rows(3.0), [bushes])
		scatter.layers[0].resource_name = "avenue"
		bushes.spacing = {"avenue": 2.5}
		bushes.spacing_fills = fills
		await settle(scatter)
		var trees := positions_of(scatter)
		check(trees.size() > 15, "an avenue")
		var nearest := INF
		for bush in positions_of(scatter, 1):
			for tree in trees:
				nearest = minf(nearest, bush.distance_to(tree))
		check(nearest >= 2.499 and nearest < 3.0, "bushes keep 2.5 m, spacing_fills %s, got %f" % [fills, nearest])
		scatter.free()


func test_rules_apply_to_rows() -> void:
	root.add_child(make_path([Vector3(-40, 0, 0), Vector3(40, 0, 0)]))
	var scatter := make_avenue(make_rows(0.5))
	await settle(scatter)
	var all := instances(scatter, 0)
	scatter.layers[0].density = 0.5
	await settle(scatter)
	var half := instances(scatter, 0)
	check(half.size() > 50 and half.size() < 110, "half of %d instances remain, got %d" % [all.size(), half.size()])
	for id in half:
		check(all.get(id) == half[id], "a lower density only removes instances")
	var region := ScatterRegion3D.new()
	region.shape = ScatterRegion3D.SHAPE_SPHERE
	region.exclude = true
	region.radius = 10.0
	scatter.add_child(region)
	await settle(scatter)
	for at in positions_of(scatter):
		check(at.length() >= 10.0, "a region removes instances of rows")


func test_explanations() -> void:
	root.add_child(make_path([Vector3(-20, 0, 0), Vector3(20, 0, 0)]))
	var scatter := make_avenue()
	await settle(scatter)
	var here := scatter.explain_position(Vector3(0.2, 0, 0))[0]
	check(here.standing and here.id in instances(scatter, 0), "the instance of a row is explained")
	var away := scatter.explain_position(Vector3(0, 0, 40))[0]
	check(not away.standing and "no row" in away.reason, "far from rows: " + away.reason)


func test_a_recentered_scene_rebuilds_nothing() -> void:
	var path := make_path([Vector3(-20.3, 0, 1.7), Vector3(1.1, 0, 2.9), Vector3(20, 0, -5)])
	root.add_child(path)
	var scatter := make_avenue(make_rows(2.0, [-3.0, 3.0]))
	var viewer: Node3D = scatter.get_node(scatter.viewers[0])
	await settle(scatter)
	var before := instances(scatter, 0)
	var stats := scatter.get_stats()
	var shift := Vector3(1000.3, 0, -77.7)
	path.position -= shift
	viewer.position -= shift
	scatter.world_offset = shift
	await settle(scatter)
	check_equal(scatter.get_stats()["tiles_made"], stats["tiles_made"], "tiles generated for a recentered scene")
	var after := instances(scatter, 0)
	check_equal(after.size(), before.size(), "instances")
	for id in before:
		check(after[id].origin.distance_to(before[id].origin - shift) < 0.01, "an instance moves with its scene")


func test_rows_move_with_local_coords() -> void:
	var body := Node3D.new()
	root.add_child(body)
	body.add_child(make_path([Vector3(-20, 0, 3), Vector3(20, 0, 3)]))
	var scatter := make_avenue()
	scatter.local_coords = true
	scatter.reparent(body)
	var viewer := make_viewer()
	viewer.reparent(body)
	scatter.viewers = [scatter.get_path_to(viewer)]
	await settle(scatter)
	var before := instances(scatter, 0)
	var stats := scatter.get_stats()
	check_equal(before.size(), 11, "a row on a moving ground")
	body.position = Vector3(3, 0, 5)
	await settle(scatter)
	check_equal(scatter.get_stats()["tiles_made"], stats["tiles_made"], "tiles generated while the ground moves")


func test_paths_without_a_finite_place() -> void:
	var path := make_path([Vector3(-20, 0, 3), Vector3(20, 0, 3)])
	root.add_child(path)
	var scatter := make_avenue()
	await settle(scatter)
	path.position.x = NAN
	await settle(scatter)
	check_equal(instances(scatter, 0).size(), 0, "a path at NAN has no instances")
	path.position.x = 0.0
	await settle(scatter)
	check_equal(instances(scatter, 0).size(), 11, "they return with the path")
	path.curve = null
	await settle(scatter)
	check_equal(instances(scatter, 0).size(), 0, "a path without a curve has no instances")


func test_bad_input_and_warnings() -> void:
	var rows := make_rows()
	for bad: Array in [["step", 0.0], ["step", NAN], ["offsets", PackedFloat32Array([2e3])], ["jitter_along", -1.0],
			["jitter_across", INF], ["row_distance", 0.0], ["row_angle_degrees", 361.0], ["crossing_gap", -1.0],
			["yaw_degrees", 181.0], ["yaw_jitter_degrees", -1.0]]:
		var before: Variant = rows.get(bad[0])
		rows.set(bad[0], bad[1])
		check_error(["ScatterRows." + bad[0]], "%s = %s" % bad)
		check_equal(rows.get(bad[0]), before, "%s keeps its value" % bad[0])
	rows.step = 0.05
	root.add_child(make_path([Vector3(0, 0, 0), Vector3(5000, 0, 0)]))
	var scatter := make_avenue(rows)
	await settle(scatter)
	check_error(["ScatterLayer.rows.step", "65536"], "a path with too many steps")
	rows.step = 50.0
	await settle(scatter)
	check(instances(scatter, 0).size() > 0, "a larger step works")
	rows.path_group = &""
	await settle(scatter)
	check_equal(instances(scatter, 0).size(), 0, "instances without a group")
	check("ScatterRows.path_group is empty" in " ".join(scatter.get_problems()), "the warning about the group")
	scatter.layers[0].on_surfaces = true
	await settle(scatter)
	check_error(["ScatterLayer.on_surfaces", "clear rows"], "rows on surfaces")
	scatter.layers[0].on_surfaces = false
	rows.path_group = GROUP
	rows.offsets = []
	await settle(scatter)
	check_equal(instances(scatter, 0).size(), 0, "instances without offsets")
	check("ScatterRows.offsets is empty. Add 0" in " ".join(scatter.get_problems()), "the warning about offsets: %s" % scatter.get_problems())
	rows.offsets = [0.0]
	scatter.layers[0].spacing_fills = true
	check("spacing_fills has no effect while rows is set" in " ".join(scatter.get_problems()), "the warning about fills: %s" % scatter.get_problems())


func test_paths_that_leave_their_group() -> void:
	var paths: Array[Path3D] = []
	for index in 3:
		paths.append(make_path([Vector3(-20, 0, 12 * index), Vector3(20, 0, 12 * index)], "Road%d" % index))
		root.add_child(paths[-1])
	var scatter := make_avenue()
	await settle(scatter)
	check_equal(instances(scatter, 0).size(), 33, "all paths")
	# The number of nodes in the group stays the same.
	paths[0].remove_from_group(GROUP)
	var other := make_path([Vector3(-20, 0, 40), Vector3(-10, 0, 40)], "Lane")
	root.add_child(other)
	await settle(scatter)
	check_equal(instances(scatter, 0).size(), 25, "a shorter path in place of the first one")
	other.reparent(paths[1])
	paths[1].queue_free()
	await settle(scatter)
	check_equal(instances(scatter, 0).size(), 11, "only the last path is left")
	var view := SubViewport.new()
	view.own_world_3d = true
	root.add_child(view)
	paths[2].reparent(view, false)
	await settle(scatter)
	check_equal(instances(scatter, 0).size(), 0, "a path in another world has no instances")
	view.queue_free()
