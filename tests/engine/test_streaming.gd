extends "streaming_harness.gd"
## Tests that visible tiles cover the view, appear once, and do not depend on the viewer's path.


func test_the_view_is_covered_and_its_instances_counted() -> void:
	var shown := {}
	var scatter := make_scatter([make_layer()], ScatterGroundFlat.new(), make_viewer(Vector3(5.0, 0.0, -70.0)))
	scatter.tile_shown.connect(func(layer: ScatterLayer, tile: Vector2i) -> void: shown[[layer, tile]] = true)
	await settle(scatter)
	var tiles := scatter.get_shown_tiles(scatter.layers[0])
	check_equal(shown.size(), tiles.size(), "one signal per tile")
	for x in range(-3, 4):
		for y in range(-6, 2):
			var rect := Rect2(x * 32.0, y * 32.0, 32.0, 32.0)
			var nearest := Vector2(5.0, -70.0).clamp(rect.position, rect.end)
			if nearest.distance_to(Vector2(5.0, -70.0)) < 63.9:
				check(Vector2i(x, y) in tiles, "tile %s is visible" % Vector2i(x, y))
	var count := all_transforms(scatter, 0).size()
	check_equal(scatter.get_stats()["instances"], count, "instances in the stats")
	# Random sequential adsorption jams at a coverage of 0.547. A few thousand points are close to that.
	var coverage := count * PI / (tiles.size() * 32.0 * 32.0)
	check(absf(coverage - 0.547) < 0.01, "coverage is %f" % coverage)


func test_tiles_move_with_the_viewer() -> void:
	var hidden := []
	var viewer := make_viewer()
	var scatter := make_scatter([make_layer()], ScatterGroundFlat.new(), viewer)
	scatter.tile_hidden.connect(func(_layer: ScatterLayer, tile: Vector2i) -> void: hidden.push_back(tile))
	await settle(scatter)
	var before := digests(scatter, 0)
	viewer.global_position = Vector3(1000.0, 0.0, 1000.0)
	await settle(scatter)
	await frames(30)
	check_equal(hidden.size(), before.size(), "all old tiles are hidden")
	check(not Vector2i(0, 0) in scatter.get_shown_tiles(scatter.layers[0]), "the old tile is hidden")
	check(Vector2i(31, 31) in scatter.get_shown_tiles(scatter.layers[0]), "the new tile is visible")
	viewer.global_position = Vector3.ZERO
	await settle(scatter)
	check_equal(digests(scatter, 0), before, "the same instances after returning")


func test_removed_layers_and_grounds() -> void:
	var hidden := []
	var layer := make_layer()
	var scatter := make_scatter([layer, make_layer()], ScatterGroundFlat.new(), make_viewer())
	scatter.tile_hidden.connect(func(of_layer: ScatterLayer, _tile: Vector2i) -> void: hidden.push_back(of_layer))
	await settle(scatter)
	var removed := scatter.layers[1]
	var count := scatter.get_shown_tiles(removed).size()
	scatter.layers = [layer]
	await settle(scatter)
	check_equal(hidden.count(removed), count, "signals for the tiles of the removed layer")
	check_equal(hidden.count(layer), 0, "signals for the tiles of the remaining layer")
	check_equal(scatter.get_stats()["tiles"], count, "tiles of one layer")
	scatter.layers = []
	await settle(scatter)
	check_equal(scatter.get_stats()["tiles"], 0, "tiles without layers")
	check_equal(hidden.count(layer), count, "signals for the tiles of the last layer")
	scatter.layers = [layer]
	await settle(scatter)
	check_equal(scatter.get_stats()["tiles"], count, "tiles of the restored layer")
	scatter.ground = null
	await settle(scatter)
	check_equal(scatter.get_stats()["tiles"], 0, "tiles without ground")
	check_equal(hidden.count(layer), 2 * count, "signals for tiles without ground")


func test_the_order_of_tiles_has_no_effect() -> void:
	var direct := make_scatter([make_layer()], Hills.new(), make_viewer(Vector3(300.0, 0.0, 0.0)))
	var viewer := make_viewer(Vector3(300.0, 0.0, 400.0))
	var wandering := make_scatter([make_layer()], Hills.new(), viewer)
	for step in 5:
		await settle(wandering)
		viewer.global_position.z -= 80.0
	await settle(direct)
	await settle(wandering)
	var walked := digests(wandering, 0)
	var straight := digests(direct, 0)
	for tile: Vector2i in straight:
		check_equal(walked.get(tile), straight[tile], "tile %s" % tile)
	check(straight.size() > 10, "more than 10 tiles are compared")


func test_spacing_across_tile_borders() -> void:
	var layer := make_layer(2.0)
	layer.tile_size = 20.0
	layer.progressive_levels = 3
	var scatter := make_scatter([layer], ScatterGroundFlat.new(), make_viewer())
	await settle(scatter)
	var grid := {}
	var closest := INF
	var count := 0
	for transform in all_transforms(scatter, 0):
		var at := Vector2(transform.origin.x, transform.origin.z)
		var cell := Vector2i((at / 2.0).floor())
		for x in range(cell.x - 1, cell.x + 2):
			for y in range(cell.y - 1, cell.y + 2):
				for other: Vector2 in grid.get(Vector2i(x, y), []):
					closest = minf(closest, at.distance_to(other))
		grid.get_or_add(cell, []).push_back(at)
		count += 1
	check(count > 2000, "more than 2000 instances are compared: %d" % count)
	check(closest >= 1.9999, "the closest two are %f apart" % closest)
	check(closest < 2.1, "the closest two are %f apart, so the check sees neighbors" % closest)


func test_script_ground_on_the_main_thread() -> void:
	var layer := make_layer()
	layer.align_to_normal = 1.0
	var scatter := make_scatter([layer], Hills.new(), make_viewer())
	await settle(scatter)
	var worst := 0.0
	var lean := 0.0
	for transform in all_transforms(scatter, 0):
		var at := Vector2(transform.origin.x, transform.origin.z)
		worst = maxf(worst, absf(transform.origin.y - Hills.height(at)))
		var normal := Vector3(-0.5 * cos(at.x * 0.05), 1.0, 0.4 * sin(at.y * 0.08)).normalized()
		lean = maxf(lean, normal.angle_to(transform.basis.y))
	check(worst < 0.01, "an instance is %f m off the ground" % worst)
	check(lean < 0.02, "an instance is %f rad off the normal" % lean)


func test_script_ground_on_workers_is_the_same() -> void:
	var viewer := make_viewer()
	var main := make_scatter([make_layer()], Hills.new(), viewer)
	var threaded := make_scatter([make_layer()], ThreadedHills.new(), viewer)
	await settle(main)
	await settle(threaded)
	check_equal(digests(threaded, 0), digests(main, 0), "digests of the instances")


func test_script_normals_and_holes() -> void:
	var layer := make_layer()
	layer.max_slope_degrees = 46.0
	layer.align_to_normal = 1.0
	var scatter := make_scatter([layer], LeaningHills.new(), make_viewer())
	await settle(scatter)
	var standing := all_transforms(scatter, 0)
	check(standing.size() > 1000, "there are instances on a slope below the limit")
	for transform in standing:
		if Vector2(transform.origin.x, transform.origin.z).length() < 10.0:
			check(false, "an instance is in a hole, at %s" % transform.origin)
	check(standing[0].basis.y.angle_to(Vector3(1.0, 1.0, 0.0)) < 0.01, "tilted along the script's normal")
	layer.max_slope_degrees = 44.0
	await settle(scatter)
	check_equal(scatter.get_stats()["instances"], 0, "instances on a slope above the limit")


func test_rules_and_placement() -> void:
	var layer := make_layer(1.0)
	layer.min_height = 2.0
	layer.max_height = 9.0
	layer.max_slope_degrees = 20.0
	layer.min_scale = 0.5
	layer.max_scale = 1.5
	layer.height_offset = -0.25
	var scatter := make_scatter([layer], Hills.new(), make_viewer())
	await settle(scatter)
	var scales := [INF, 0.0]
	for transform in all_transforms(scatter, 0):
		var at := Vector2(transform.origin.x, transform.origin.z)
		var height := Hills.height(at)
		var slope := rad_to_deg(Vector3(-0.5 * cos(at.x * 0.05), 1.0, 0.4 * sin(at.y * 0.08)).angle_to(Vector3.UP))
		var scale := transform.basis.get_scale()
		scales = [minf(scales[0], scale.x), maxf(scales[1], scale.x)]
		if not (height > 1.99 and height < 9.01 and slope < 20.3):
			check(false, "an instance at height %f, slope %f" % [height, slope])
		if not (absf(transform.origin.y - height + 0.25) < 0.01 and transform.basis.y.normalized().y > 0.9999):
			check(false, "an instance is not upright and 0.25 m below the ground: %s" % transform)
	check(scales[0] >= 0.4999 and scales[0] < 0.51, "the smallest scale is %f" % scales[0])
	check(scales[1] <= 1.5001 and scales[1] > 1.49, "the largest scale is %f" % scales[1])


func test_mesh_weights() -> void:
	var layer := make_layer(1.0)
	layer.meshes = [BoxMesh.new(), null, SphereMesh.new()]
	layer.mesh_weights = PackedFloat32Array([1.0, 2.0])
	var scatter := make_scatter([layer], ScatterGroundFlat.new(), make_viewer())
	await settle(scatter)
	var counts := [0, 0, 0]
	for tile: Vector2i in scatter.get_shown_tiles(scatter.layers[0]):
		var ids := tile_ids(scatter, 0, tile)
		var buffers := tile_buffers(scatter, 0, tile)
		check_equal(buffers.size(), 3, "buffers of tile %s" % tile)
		for mesh in 3:
			check_equal(buffers[mesh].size(), 12 * ids[mesh].size(), "buffer %d of tile %s" % [mesh, tile])
			counts[mesh] += ids[mesh].size()
	var total: float = counts[0] + counts[1] + counts[2]
	for mesh in 3:
		check(absf(counts[mesh] / total - [0.25, 0.5, 0.25][mesh]) < 0.02, "fractions of the meshes: %s" % [counts])


func test_mesh_density_expressions() -> void:
	var layer := make_layer(1.0)
	layer.meshes = [BoxMesh.new(), SphereMesh.new(), CylinderMesh.new()]
	var scatter := make_scatter([layer], ScatterGroundFlat.new(), make_viewer())
	await settle(scatter)
	var before := mesh_of_ids(scatter)
	layer.mesh_density_expressions = ["x < 10", "x > -10", "0"]
	await settle(scatter)
	var after := mesh_of_ids(scatter)
	check_equal(after.keys().size(), before.keys().size(), "instances with expressions")
	var counts := [0, 0]
	for id: int in after:
		var x := scatter.get_instance(id).position.x
		check(before.has(id), "instance %d was there before" % id)
		var mesh: int = after[id]
		if mesh != (0 if x < -10 else 1) and (absf(x) > 10.01 or mesh == 2):
			check(false, "an instance at x = %f has mesh %d" % [x, mesh])
			return
		if absf(x) < 10.0:
			counts[mesh] += 1
	check(counts[0] > 100 and absf(counts[0] - counts[1]) < 0.2 * (counts[0] + counts[1]), "both meshes between -10 and 10: %s" % [counts])
	layer.mesh_density_expressions = ["0", "-1", "sqrt(-1)"]
	await settle(scatter)
	check_equal(mesh_of_ids(scatter), before, "plain weights apply if all expressions are 0")
	layer.mesh_density_expressions = ["", "", "", "1"]
	check_equal(layer.mesh_density_expressions, PackedStringArray(["", "", "", "1"]), "empty entries are kept")
	var problems := scatter.get_problems()
	check(Array(problems).any(func(text: String) -> bool: return "mesh_density_expressions has more entries than meshes" in text), "%s" % [problems])


## Returns the index of the mesh of each instance in the visible tiles, by ID.
func mesh_of_ids(scatter: TerrainScatter3D) -> Dictionary[int, int]:
	var meshes: Dictionary[int, int] = {}
	for tile: Vector2i in scatter.get_shown_tiles(scatter.layers[0]):
		var ids := tile_ids(scatter, 0, tile)
		for mesh in ids.size():
			for id: int in ids[mesh]:
				meshes[id] = mesh
	return meshes


func test_a_lower_density_keeps_a_prefix() -> void:
	var layer := make_layer()
	var scatter := make_scatter([layer], ScatterGroundFlat.new(), make_viewer())
	await settle(scatter)
	var all := {}
	for tile: Vector2i in scatter.get_shown_tiles(scatter.layers[0]):
		all[tile] = tile_ids(scatter, 0, tile)[0]
	layer.density = 0.5
	await settle(scatter)
	for tile: Vector2i in all:
		var ids: PackedInt64Array = tile_ids(scatter, 0, tile)[0]
		check_equal(ids, (all[tile] as PackedInt64Array).slice(0, ids.size()), "half of tile %s" % tile)
		var whole: int = all[tile].size()
		check(absf(ids.size() - 0.5 * whole) < 25.0, "tile %s has %d of %d" % [tile, ids.size(), whole])


func test_a_change_keeps_old_tiles_until_new_ones_are_ready() -> void:
	var layer := make_layer()
	var scatter := make_scatter([layer], ScatterGroundFlat.new(), make_viewer())
	await settle(scatter)
	var count: int = scatter.get_stats()["tiles"]
	var before := digests(scatter, 0)
	scatter.seed = 8
	while true:
		await process_frame
		check_equal(scatter.get_stats()["tiles"], count, "visible tiles while all are regenerated")
		if scatter.is_settled():
			break
	for tile: Vector2i in before:
		check(before[tile] != scatter.get_tile(scatter.layers[0], tile).get_digest(), "tile %s has changed" % tile)
	layer.cast_shadow = GeometryInstance3D.SHADOW_CASTING_SETTING_OFF
	var tiles_made: int = scatter.get_stats()["tiles_made"]
	await settle(scatter)
	check_equal(scatter.get_stats()["tiles_made"], tiles_made, "tiles generated for a new shadow setting")


func test_a_mesh_whose_size_changes_is_detected() -> void:
	var mesh := BoxMesh.new()
	var layer := make_layer()
	layer.meshes = [mesh, mesh]
	var scatter := make_scatter([layer], ScatterGroundFlat.new(), make_viewer())
	await settle(scatter)
	var tiles_made: int = scatter.get_stats()["tiles_made"]
	mesh.size = Vector3(1.0, 30.0, 1.0)
	await settle(scatter)
	check(scatter.get_stats()["tiles_made"] > tiles_made, "tiles with larger boxes")
	tiles_made = scatter.get_stats()["tiles_made"]
	layer.meshes = [SphereMesh.new()]
	await settle(scatter)
	check(scatter.get_stats()["tiles_made"] > tiles_made, "tiles with a new mesh")
	tiles_made = scatter.get_stats()["tiles_made"]
	mesh.size = Vector3.ONE
	await settle(scatter)
	check_equal(scatter.get_stats()["tiles_made"], tiles_made, "tiles generated for an unused mesh")


func test_the_tile_size_may_change() -> void:
	var layer := make_layer()
	var scatter := make_scatter([layer], ScatterGroundFlat.new(), make_viewer())
	await settle(scatter)
	layer.tile_size = 25.0
	await settle(scatter)
	await frames(10)
	var fresh_layer := make_layer()
	fresh_layer.tile_size = 25.0
	var new_scatter := make_scatter([fresh_layer], ScatterGroundFlat.new(), make_viewer())
	await settle(new_scatter)
	check_equal(digests(scatter, 0), digests(new_scatter, 0), "after a change to the tile size")


func test_layers_do_not_share_random_numbers() -> void:
	var scatter := make_scatter([make_layer(), make_layer()], ScatterGroundFlat.new(), make_viewer())
	await settle(scatter)
	var first := {}
	for transform in transforms(scatter, 0, Vector2i.ZERO):
		first[transform.origin] = true
	for transform in transforms(scatter, 1, Vector2i.ZERO):
		check(not transform.origin in first, "both layers have an instance at %s" % transform.origin)


func test_layer_id_survives_reordering() -> void:
	var pinned := make_layer()
	pinned.layer_id = 40
	var other := make_layer(3.0)
	other.layer_id = 41
	var scatter := make_scatter([pinned, other], ScatterGroundFlat.new(), make_viewer())
	await settle(scatter)
	var before := digests(scatter, 0)
	scatter.layers = [other, pinned]
	await settle(scatter)
	check_equal(digests(scatter, 1), before, "instances of the moved layer")


func test_setting_the_same_value_has_no_effect() -> void:
	var scatter := make_scatter([make_layer()], ScatterGroundFlat.new(), make_viewer())
	scatter.biomes = ScatterBiomeMap.new()
	scatter.state = ScatterState.new()
	scatter.world_offset = Vector3(64.0, 0.0, 0.0)
	await settle(scatter)
	var before := digests(scatter, 0)
	var stats := scatter.get_stats()
	check(before.size() > 10, "%d tiles" % before.size())
	for property: StringName in [&"ground", &"biomes", &"state", &"world_offset", &"visible"]:
		scatter.set(property, scatter.get(property))
		check(scatter.is_settled(), "%s: still settled" % property)
	await frames(3)
	for figure: String in ["tiles_made", "uploads", "redrawn"]:
		check_equal(scatter.get_stats()[figure], stats[figure], figure)
	check_equal(digests(scatter, 0), before, "digests of the instances")


func test_moving_the_node_moves_nothing() -> void:
	var scatter := make_scatter([make_layer()], ScatterGroundFlat.new(), make_viewer())
	await settle(scatter)
	var before := digests(scatter, 0)
	scatter.global_transform = Transform3D(Basis().scaled(Vector3(2.0, 2.0, 2.0)), Vector3(500.0, 5.0, 5.0))
	await frames(3)
	check(scatter.is_settled(), "nothing is regenerated")
	check_equal(digests(scatter, 0), before, "instances after the node moved")


func test_pausing_stops_the_stream() -> void:
	var viewer := make_viewer()
	var scatter := make_scatter([make_layer()], ScatterGroundFlat.new(), viewer)
	await settle(scatter)
	paused = true
	viewer.global_position.x = 500.0
	await frames(20)
	check(Vector2i(0, 0) in scatter.get_shown_tiles(scatter.layers[0]), "a paused stream keeps its tiles")
	paused = false
	await settle(scatter)
	check(Vector2i(15, 0) in scatter.get_shown_tiles(scatter.layers[0]), "the stream continues after the pause")


func test_grounds_can_be_queried_by_scripts() -> void:
	var hills := Hills.new()
	check(absf(hills.get_height(Vector3(13.0, 99.0, 7.0)) - Hills.height(Vector2(13.0, 7.0))) < 1e-4, "the height of the hills")
	var normal := Vector3(-0.5 * cos(13.0 * 0.05), 1.0, 0.4 * sin(7.0 * 0.08)).normalized()
	check(normal.angle_to(hills.get_normal(Vector3(13.0, 0.0, 7.0))) < 0.01, "the normal of the hills")
	var leaning := LeaningHills.new()
	check(is_nan(leaning.get_height(Vector3(1.0, 0.0, 1.0))), "no height in a hole")
	check_equal(leaning.get_normal(Vector3(1.0, 0.0, 1.0)), Vector3.ZERO, "normal in a hole")
	var slope := Vector3(-1.0, 1.0, 0.0)
	check(slope.angle_to(Cliff.new().get_normal(Vector3(-9.0, 0.0, 0.0))) < 0.001, "normal on a slope")
	check(slope.angle_to(Cliff.new().get_normal(Vector3(-0.1, 0.0, 0.0))) < 0.001, "normal next to a hole")
	check(is_nan(ScatterGround.new().get_height(Vector3.ZERO)), "no height without a script")


func test_frame_parts() -> void:
	var scatter := make_scatter([make_layer()], ScatterGroundFlat.new(), make_viewer())
	var seen := {}
	var unlike := []
	for frame in 200:
		await process_frame
		var stats := scatter.get_stats()
		var parts: Dictionary = stats["frame_parts"]
		var sum := 0
		for part: String in parts:
			sum += parts[part]
			seen[part] = true
		# frame_usec excludes signals, and each part is rounded down.
		var spent: int = stats["frame_usec"]
		if sum - parts.get("signals", 0) > spent + 1 or sum + 14 + 20 < spent:
			unlike.push_back([parts, spent])
	check(unlike.size() < 20, "frame parts that do not add up: %s" % [unlike]) # The system may interrupt the thread between two measurements.
	check(seen.has("upload") and seen.has("made"), "frame parts that occurred: %s" % [seen.keys()])


func test_instance_bytes() -> void:
	var upright := make_layer()
	upright.align_to_normal = 0.0
	var leaning := make_layer()
	leaning.align_to_normal = 1.0
	for case: Array in [[upright, 20.0], [leaning, 32.0]]:
		var scatter := make_scatter([case[0]], ScatterGroundFlat.new(), make_viewer())
		await settle(scatter)
		var stats := scatter.get_stats()
		check(stats.instances > 1000, "instances: %d" % stats.instances)
		var each: float = float(stats.instance_bytes) / stats.instances
		# The tiles are small, so the fixed memory per tile matters. The tiles are drawn in cells, and each cell lists its instances.
		check(each > 16.0 and each < case[1] + 16.0, "bytes per instance: %.1f" % each)
		scatter.layers = []
		await settle(scatter)
		check_equal(scatter.get_stats().instance_bytes, 0, "bytes without instances")
		scatter.free()
