extends "harness.gd"
## Tests nodes that are freed, changed and moved while tiles are generated. Nothing may crash or leak, and the result must be the same.

## Ground that runs an action during its next query.
class ActingGround extends ScatterGround:
	var action_once := Callable()

	func _get_heights(positions: PackedVector2Array) -> PackedFloat32Array:
		var heights := PackedFloat32Array()
		heights.resize(positions.size())
		if action_once.is_valid():
			var once := action_once
			action_once = Callable()
			once.call()
		return heights


class SlowGround extends ScatterGround:
	func _get_heights(positions: PackedVector2Array) -> PackedFloat32Array:
		var heights := PackedFloat32Array()
		for at in positions:
			heights.push_back(sin(at.x) + cos(at.y))
		return heights

	func _is_thread_safe() -> bool:
		return true


var viewer: Node3D


## Returns a scatter that takes some seconds to settle, with many tiles of many points.
func make_busy(terrain: ScatterGround) -> TerrainScatter3D:
	var layers: Array[ScatterLayer] = []
	for index in 3:
		var layer := make_layer(0.3)
		layer.progressive_levels = index + 1
		layer.view_distance = 500.0
		layer.meshes = [BoxMesh.new(), SphereMesh.new()]
		layers.push_back(layer)
	viewer = make_viewer()
	return make_scatter(layers, terrain, viewer)


func grounds() -> Array[ScatterGround]:
	return [ScatterGroundFlat.new(), ActingGround.new(), SlowGround.new()]


func test_freed_in_mid_generation() -> void:
	for round in 24:
		var scatter := make_busy(grounds()[round % 3])
		@warning_ignore("integer_division")
		await frames(round / 3)
		check(round < 3 or not scatter.is_settled(), "tiles are still being generated after %d frames" % (round / 3.0))
		if round % 2:
			scatter.free()
		else:
			scatter.queue_free()
			await process_frame
		check(not is_instance_valid(scatter), "freed")
	await frames(5)


func has_tiles(scatter: TerrainScatter3D) -> bool:
	return scatter.get_stats()["tiles"] > 0


func show_and_free() -> void:
	for terrain in grounds():
		var scatter := make_busy(terrain)
		scatter.layers[0].view_distance = 100.0
		scatter.layers = [scatter.layers[0]]
		await settle(scatter)
		check(scatter.get_stats()["instances"] > 100000, "many instances")
		var layer: WeakRef = weakref(scatter.layers[0])
		scatter.queue_free()
		await frames(2)
		check(layer.get_ref() == null, "the layer is freed with the node")
	await clean()


func test_nothing_leaks() -> void:
	var counts: Array[float] = []
	for round in 3: # In the first round, scripts and the renderer allocate permanent objects.
		await show_and_free()
		await frames(3)
		counts.push_back(Performance.get_monitor(Performance.OBJECT_COUNT))
	check_equal(counts[2], counts[1], "objects")


func test_leaving_and_reentering_the_tree() -> void:
	var scatter := make_busy(ScatterGroundFlat.new())
	for round in 5:
		await frames(round)
		root.remove_child(scatter)
		check_equal(scatter.get_stats()["tiles"], 0, "tiles outside of the tree")
		root.add_child(scatter)
	await until(has_tiles.bind(scatter), "tiles after returning to the tree")
	var other_world := SubViewport.new()
	other_world.own_world_3d = true
	root.add_child(other_world)
	scatter.reparent(other_world)
	other_world.add_child(Node3D.new())
	scatter.viewers = [scatter.get_path_to(viewer)]
	check_equal(scatter.get_stats()["tiles"], 0, "tiles on entering another world")
	await until(has_tiles.bind(scatter), "tiles in another world")


func test_changed_in_mid_generation() -> void:
	var layer := make_layer(1.0)
	var scatter := make_scatter([layer], ScatterGroundFlat.new(), make_viewer())
	var random := RandomNumberGenerator.new()
	random.seed = 1
	for round in 150:
		match random.randi_range(0, 9):
			0: layer.radius = random.randf_range(0.5, 2.0)
			1: layer.tile_size = random.randf_range(10.0, 60.0)
			2: layer.view_distance = random.randf_range(0.0, 150.0)
			3: layer.density = random.randf()
			4: layer.meshes = [BoxMesh.new(), SphereMesh.new()].slice(0, random.randi_range(0, 2))
			5: scatter.seed = random.randi()
			6: scatter.ground = grounds()[random.randi_range(0, 2)]
			7: scatter.layers = [[layer], [layer, layer], [null, layer], []][random.randi_range(0, 3)]
			8: layer.material_override = StandardMaterial3D.new()
			9: scatter.visible = not scatter.visible
		await frames(random.randi_range(0, 2))
	layer.radius = 1.0
	layer.tile_size = 32.0
	layer.view_distance = 64.0
	layer.density = 1.0
	layer.meshes = [BoxMesh.new()]
	scatter.seed = 7
	scatter.ground = ScatterGroundFlat.new()
	scatter.layers = [layer]
	await settle(scatter)
	await frames(30)
	var new_scatter := make_scatter([make_layer(1.0)], ScatterGroundFlat.new(), make_viewer())
	await settle(new_scatter)
	check_equal(digests(scatter, 0), digests(new_scatter, 0), "after 150 changes")


func test_the_main_thread_does_not_wait_for_a_huge_tile() -> void:
	var layer := make_layer(0.5)
	layer.tile_size = 1000.0
	layer.view_distance = 0.0
	var scatter := make_scatter([layer], ScatterGroundFlat.new(), make_viewer(Vector3(500.0, 0.0, 500.0)))
	for action: Callable in [
			func() -> void: root.remove_child(scatter),
			func() -> void: root.add_child(scatter),
			func() -> void: scatter.ground = null,
			func() -> void: scatter.ground = ScatterGroundFlat.new(),
			func() -> void: scatter.free()]:
		await frames(10)
		OS.delay_msec(50)
		var start := Time.get_ticks_msec()
		action.call()
		await process_frame
		var time := Time.get_ticks_msec() - start
		check(time < 500, "work on 2.8 million points blocked the main thread for %d ms" % time)


func test_viewer_freed_and_teleported() -> void:
	var scatter := make_busy(ScatterGroundFlat.new())
	for round in 30:
		viewer.global_position = Vector3(round * 1777.0, 0.0, -round * 999.0)
		await process_frame
	viewer.free()
	await frames(10)
	check(not scatter.is_settled(), "without a viewer, the node does not settle")
	scatter.viewers = [scatter.get_path_to(make_viewer())]
	await until(has_tiles.bind(scatter), "it continues")


func test_grounds_that_change_the_node() -> void:
	for action in 7:
		var ground := ActingGround.new()
		# With so few points, one query suffices for a tile. The code after it must handle the result of the action.
		var scatter := make_scatter([make_layer(8.0)], ground, make_viewer())
		ground.action_once = [
			func() -> void: scatter.queue_free(),
			func() -> void: scatter.free(),
			func() -> void: root.remove_child.call_deferred(scatter),
			func() -> void: scatter.ground = null,
			func() -> void: scatter.layers = [],
			func() -> void: ground.emit_changed(),
			func() -> void: root.remove_child(scatter),
		][action]
		await frames(20)
		check(not ground.action_once.is_valid(), "action %d is done" % action)
		check_equal(was_kept_from_being_freed(), action == 1, "action %d: the engine refuses to free the node" % action)
		if is_instance_valid(scatter):
			scatter.free()
	await frames(3)


func test_signal_handlers_that_change_the_node() -> void:
	var layer := make_layer()
	var scatter := make_scatter([layer], ScatterGroundFlat.new(), make_viewer())
	var counts := [0, 0]
	scatter.tile_shown.connect(func(_layer: ScatterLayer, _tile: Vector2i) -> void:
		counts[0] += 1
		if counts[0] == 5:
			scatter.seed += 1
		if counts[0] == 10:
			scatter.layers = [layer, layer]
		if counts[0] == 15:
			root.remove_child(scatter)
			root.add_child(scatter))
	scatter.settled.connect(func() -> void:
		counts[1] += 1
		scatter.queue_free())
	await frames(5)
	while is_instance_valid(scatter):
		await process_frame
	check(counts[0] > 15, "signals: %s" % [counts])
	check_equal(counts[1], 1, "settled signals")


func test_change_of_scene_in_mid_generation() -> void:
	for round in 6:
		var scatter := make_busy(grounds()[round % 3])
		var eye := Node3D.new()
		root.remove_child(scatter)
		scatter.add_child(eye)
		eye.owner = scatter
		scatter.viewers = [NodePath(eye.name)]
		var packed := PackedScene.new()
		check_equal(packed.pack(scatter), OK, "packing")
		scatter.free()
		check_equal(change_scene_to_packed(packed), OK, "the scene is changed")
		await frames(2 + round)
		check(current_scene is TerrainScatter3D, "the scene is running")
		check(current_scene.get_child_count() == 1, "the scene does not contain the visible instances")
		check(not current_scene.is_settled(), "the new scene is still generating tiles")
	unload_current_scene()
	await frames(3)


func test_saved_settings_are_restored() -> void:
	var scatter := make_busy(ScatterGroundFlat.new())
	scatter.layers[1].min_height = -5.0
	scatter.layers[1].min_scale = 3.0
	scatter.layers[1].max_scale = 4.0
	scatter.layers[2].mesh_weights = PackedFloat32Array([0.5, 2.0])
	scatter.seed = -12345678901234
	var packed := PackedScene.new()
	packed.pack(scatter)
	ResourceSaver.save(packed, "user://thicket_test.tscn")
	var text := FileAccess.get_file_as_string("user://thicket_test.tscn")
	check(text.length() < 4000, "a saved scene is small: %d bytes" % text.length())
	var loaded: PackedScene = ResourceLoader.load("user://thicket_test.tscn", "", ResourceLoader.CACHE_MODE_IGNORE)
	var copy := loaded.instantiate()
	for property in scatter.get_property_list():
		if property["usage"] & PROPERTY_USAGE_STORAGE and not property["type"] in [TYPE_OBJECT, TYPE_ARRAY]:
			check_equal(copy.get(property["name"]), scatter.get(property["name"]), property["name"])
	for index in 3:
		for property in scatter.layers[index].get_property_list():
			var skipped: bool = property["type"] in [TYPE_OBJECT, TYPE_ARRAY, TYPE_STRING]
			if property["usage"] & PROPERTY_USAGE_STORAGE and not skipped:
				check_equal(copy.layers[index].get(property["name"]), scatter.layers[index].get(property["name"]),
						"layer %d: %s" % [index, property["name"]])
		check_equal(copy.layers[index].meshes.size(), 2, "meshes")
	copy.free()
	DirAccess.remove_absolute("user://thicket_test.tscn")


func test_workers_free_unneeded_memory() -> void:
	var viewer := make_viewer()
	var scatter := make_scatter([make_layer()], ScatterGroundFlat.new(), viewer)
	await settle(scatter)
	var tiles: int = scatter.get_stats()["tiles"]
	viewer.global_position = Vector3(1000.0, 0.0, 1000.0)
	await settle(scatter)
	# Workers free the removed tiles and buffers of the new tiles.
	var limit := Time.get_ticks_msec() + 20_000
	@warning_ignore("integer_division")
	var wanted := tiles + tiles / 2
	while scatter.get_stats()["worker_frees"] < wanted and Time.get_ticks_msec() < limit:
		await process_frame
	var freed: int = scatter.get_stats()["worker_frees"]
	check(freed >= wanted, "workers freed %d tiles and buffers, for %d tiles" % [freed, tiles])


func test_workers_reuse_uploaded_buffers() -> void:
	var viewer := make_viewer()
	var scatter := make_scatter([make_layer()], ScatterGroundFlat.new(), viewer)
	for step in 5:
		viewer.global_position.x += 1000.0
		await settle(scatter)
	var tiles: int = scatter.get_stats()["tiles"]
	var reused: int = scatter.get_stats()["buffers_reused"]
	check(reused >= tiles, "reused: %d, for five times %d tiles" % [reused, tiles])
	# The reused buffers contain the right instances.
	for tile in shown_tiles(scatter, 0):
		var built := scatter.build_tile(scatter.layers[0], tile)
		check_equal(scatter.get_tile(scatter.layers[0], tile).get_digest(), built.get_digest(), "tile %s" % tile)
