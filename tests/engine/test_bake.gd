extends "harness.gd"
## Tests the files that the add-on bakes, without an editor, and the point where the editor's brush hits the ground.

const Bake := preload("res://addons/thicket/bake.gd")
const GroundRay := preload("res://addons/thicket/ground_ray.gd")

const FOLDER := "res://baked/deep"
const SCENE := FOLDER + "/wood.tscn"


class Hills extends ScatterGround:
	func _get_heights(positions: PackedVector2Array) -> PackedFloat32Array:
		var heights := PackedFloat32Array()
		for at in positions:
			heights.push_back(4.0 * sin(0.1 * at.x) + 2.0 * cos(0.07 * at.y) if at.length() < 200.0 else NAN)
		return heights

	func _is_thread_safe() -> bool:
		return true


## Returns a scatter of two layers. One has colors and two meshes, one of them saved in a file. The other has one mesh.
func wood() -> TerrainScatter3D:
	var trees := make_layer(3.0)
	trees.resource_name = "Trees"
	trees.use_colors = true
	var cone := CylinderMesh.new()
	cone.top_radius = 0.0
	ResourceSaver.save(cone, "res://cone.res")
	cone.take_over_path("res://cone.res")
	trees.meshes = [BoxMesh.new(), cone]
	trees.cast_shadow = GeometryInstance3D.SHADOW_CASTING_SETTING_OFF
	trees.render_layers = 5
	var stones := make_layer(2.0)
	stones.tile_size = 48.0
	return make_scatter([trees, stones], Hills.new(), make_viewer())


func all_files() -> PackedStringArray:
	return DirAccess.get_files_at(FOLDER) if DirAccess.dir_exists_absolute(FOLDER) else PackedStringArray()


func empty_folder() -> void:
	for file in all_files():
		DirAccess.remove_absolute(FOLDER.path_join(file))


func run_to_end(bake: Bake) -> void:
	var last := -1.0
	while bake.step(1.0):
		check(bake.progress >= last and bake.progress < 1.0, "progress grows")
		last = bake.progress
		await process_frame


## Whole baked tiles equal the visible ones bit for bit. They share their meshes and use the layer's render settings.
func test_whole_tiles() -> void:
	empty_folder()
	var scatter := wood()
	await settle(scatter)
	var bake := Bake.new()
	check_equal(bake.begin(scatter, Rect2(-32, -64, 96, 64), FOLDER, "wood", [scatter.layers[0]]), OK, "begun")
	await run_to_end(bake)
	check_equal(bake.problem, "", "no problem")
	check_equal(bake.progress, 1.0, "the progress of a complete bake")
	var scene := (load(SCENE) as PackedScene).instantiate()
	check_equal(scene.get_child_count(), 3 * 2 * 2, "nodes: one for each tile and mesh")
	var seen: Dictionary[Mesh, int] = {}
	for node: MultiMeshInstance3D in scene.get_children():
		var tile := Vector2i((Vector2(node.position.x, node.position.z) / 32.0).floor())
		var mesh := 1 if node.multimesh.mesh is CylinderMesh else 0
		check_equal(node.position, scatter.get_tile(scatter.layers[0], tile).get_origin(), "the node is at the tile's origin")
		check(node.multimesh.buffer == tile_buffers(scatter, 0, tile)[mesh], "the buffer matches tile %s" % tile)
		check(node.multimesh.use_colors and not node.multimesh.use_custom_data, "the multimesh has colors and no custom data")
		check_equal(node.cast_shadow, GeometryInstance3D.SHADOW_CASTING_SETTING_OFF, "the layer's shadows")
		check_equal(node.layers, 5, "the layer's render layers")
		seen[node.multimesh.mesh] = mesh
	check_equal(seen.size(), 2, "different meshes in the scene")
	check(seen.keys().any(func(mesh: Mesh) -> bool: return mesh.resource_path == "res://cone.res"), "a mesh with a file keeps it")
	check_equal(all_files().size(), 12 + 1 + 1, "multimeshes, a mesh, the scene: %s" % all_files())
	scene.free()


## A bake of a rectangle that cuts through tiles contains exactly the instances inside it.
func test_parts_of_tiles() -> void:
	empty_folder()
	var scatter := wood()
	await settle(scatter)
	var rect := Rect2(-21.5, -40.25, 61.0, 33.5)
	var bake := Bake.new()
	check_equal(bake.begin(scatter, rect, FOLDER, "wood"), OK, "begun")
	await run_to_end(bake)
	var expected := 0
	for layer in 2:
		for tile: Vector2i in scatter.get_shown_tiles(scatter.layers[layer]):
			var origin := scatter.get_tile(scatter.layers[layer], tile).get_origin()
			for buffer: PackedFloat32Array in tile_buffers(scatter, layer, tile):
				var stride := 16 if layer == 0 else 12
				for at in range(0, buffer.size(), stride):
					expected += int(rect.has_point(Vector2(origin.x + buffer[at + 3], origin.z + buffer[at + 11])))
	check(expected > 100 and bake.instances == expected, "%d instances in the bake, %d expected" % [bake.instances, expected])


## A canceled bake leaves existing files unchanged. A second bake replaces the first and removes the files that it no longer needs.
func test_cancel_and_again() -> void:
	empty_folder()
	var scatter := wood()
	await settle(scatter)
	var bake := Bake.new()
	bake.begin(scatter, Rect2(0, 0, 64, 64), FOLDER, "wood")
	bake.step(0.0)
	bake.cancel()
	check_equal(all_files(), PackedStringArray(), "no files are left")
	check_equal(DirAccess.get_directories_at(FOLDER), PackedStringArray(), "no folders are left")
	check(not bake.step(1.0), "a canceled bake does not continue")
	bake.begin(scatter, Rect2(0, 0, 64, 64), FOLDER, "wood")
	await run_to_end(bake)
	var mine := FileAccess.open(FOLDER + "/wood_of_mine.res", FileAccess.WRITE)
	mine.store_string("mine")
	mine.close()
	var first := {}
	for file in all_files():
		first[file] = FileAccess.get_md5(FOLDER.path_join(file))
	bake.begin(scatter, Rect2(0, 0, 32, 32), FOLDER, "wood")
	bake.step(0.0)
	bake.cancel()
	for file: String in first:
		check_equal(FileAccess.get_md5(FOLDER.path_join(file)), first[file], file)
	bake.begin(scatter, Rect2(0, 0, 32, 32), FOLDER, "wood")
	await run_to_end(bake)
	check(all_files().has("wood_of_mine.res"), "files that do not belong to the bake are kept")
	check_equal(all_files().size(), 2 + 1 + 1 + 1 + 1 + 1, "fewer files: %s" % all_files())
	check_equal((load(SCENE) as PackedScene).get_state().get_node_count(), 1 + 3, "nodes in the second, smaller scene")


func test_rejections() -> void:
	var scatter := wood()
	await settle(scatter)
	var bake := Bake.new()
	for wrong: Array in [
		[Rect2(0, 0, 0, 10), "wood", "rectangle"], [Rect2(0, 0, NAN, 10), "wood", "rectangle"],
		[Rect2(0, 0, 10, 10), "", "name"], [Rect2(0, 0, 10, 10), "a/b", "name"], [Rect2(0, 0, 1e6, 1e6), "wood", "tiles"],
	]:
		check(bake.begin(scatter, wrong[0], FOLDER, wrong[1]) != OK, "rejected: %s" % [wrong])
		check(wrong[2] in bake.problem, "the problem names the reason: " + bake.problem)
		check(not bake.step(1.0), "a rejected bake does not continue")
	for layers: Array in [["larch"], [scatter.layers[0], "larch"], [0], [null], [ScatterLayer.new()]]:
		check(bake.begin(scatter, Rect2(0, 0, 10, 10), FOLDER, "wood", layers) != OK, "no such layer: %s" % [layers])
		check("layers contains %s" % layers[-1] in bake.problem, bake.problem)
	scatter.ground = null
	check(bake.begin(scatter, Rect2(0, 0, 10, 10), FOLDER, "wood") != OK and "TerrainScatter3D.ground" in bake.problem, bake.problem)


## A layer that cannot be generated ends the bake and leaves no files.
func test_layer_that_cannot_be_generated() -> void:
	empty_folder()
	var wrong := make_layer()
	wrong.min_scale = 3.0
	var scatter := make_scatter([make_layer(), wrong], Hills.new(), make_viewer())
	await frames(2)
	errors.take()
	var bake := Bake.new()
	check_equal(bake.begin(scatter, Rect2(0, 0, 32, 32), FOLDER, "wood"), OK, "begun")
	await run_to_end(bake)
	check("Layer 1" in bake.problem and bake.progress < 1.0, bake.problem)
	check(not errors.take().is_empty(), "an error names the reason")
	check_equal(all_files(), PackedStringArray(), "no files are left")


## A bake reports an earlier bake's file that it cannot delete. A baked world reports an index whose lists differ in length.
func test_leftover_files_are_reported() -> void:
	empty_folder()
	var scatter := wood()
	await settle(scatter)
	var bake := Bake.new()
	bake.begin(scatter, Rect2(0, 0, 64, 64), FOLDER, "wood")
	await run_to_end(bake)
	var kept := ""
	for file in all_files():
		if file.ends_with("_0_1_1.res"):
			kept = FOLDER.path_join(file)
	DirAccess.remove_absolute(kept)
	DirAccess.make_dir_absolute(kept)
	FileAccess.open(kept.path_join("mine"), FileAccess.WRITE).store_string("mine")
	bake.begin(scatter, Rect2(0, 0, 16, 16), FOLDER, "wood")
	await run_to_end(bake)
	check_equal(bake.problem, "", "the bake succeeds")
	check_error([kept, "Delete it"], "the file that cannot be deleted")
	DirAccess.remove_absolute(kept.path_join("mine"))
	DirAccess.remove_absolute(kept)
	var index := preload("res://addons/thicket/baked_world_index.gd").new()
	index.tile_size = 32.0
	index.tiles = PackedInt32Array([0, 0, 1, 0])
	index.instances = PackedInt32Array([5])
	index.centers = PackedFloat64Array([0, 0, 0])
	FileAccess.open(FOLDER.path_join("world.baked"), FileAccess.WRITE).store_buffer(index.packed())
	var world := preload("res://addons/thicket/baked_world.gd").new()
	world.index_file = FOLDER.path_join("world.baked")
	check_error(["ScatterBakedWorld.index_file", "68 bytes for 1 tiles, got 44"], "an inconsistent index")
	world.index_file = FOLDER.path_join("none.baked")
	check_error(["ScatterBakedWorld.index_file", "cannot be opened"], "a missing index")
	DirAccess.remove_absolute(FOLDER.path_join("world.baked"))
	world.free()


## A ray hits the ground from above, at its first intersection. It misses where there is no ground.
func test_rays() -> void:
	var hills := Hills.new()
	var random := RandomNumberGenerator.new()
	random.seed = 3
	var met := 0
	for index in 200:
		var from := Vector3(random.randf_range(-60, 60), random.randf_range(8, 60), random.randf_range(-60, 60))
		var to := Vector3(random.randf_range(-60, 60), -8.0, random.randf_range(-60, 60))
		var hit := GroundRay.hit(hills, from, from.direction_to(to))
		if check(hit.is_finite(), "a downward ray hits the ground"):
			met += int(absf(hit.y - hills.get_height(hit)) < 0.001)
			for part in 40:
				var before := from.lerp(hit, part / 40.0)
				check(before.y > hills.get_height(before) - 0.05, "the ray does not pass through the ground before the hit")
	check_equal(met, 200, "rays that hit the ground")
	check(not GroundRay.hit(hills, Vector3(0, 10, 0), Vector3.UP).is_finite(), "no hit in the sky")
	check(not GroundRay.hit(hills, Vector3(300, 10, 0), Vector3.DOWN).is_finite(), "no hit where there is no ground")
	var over_hole := GroundRay.hit(hills, Vector3(260, 60, 0), Vector3(-1, -0.5, 0).normalized())
	check(over_hole.is_finite() and over_hole.x < 200.0, "a ray through a hole hits the ground behind it: %s" % over_hole)
