extends "draw_cells_harness.gd"
## Tests draw cells: nearby tiles are divided into smaller parts for drawing, and each frame draws every instance once. Needs a renderer
## that stores buffers, so run it without --headless.


func test_near_tiles_are_in_cells_and_far_tiles_whole() -> void:
	var viewer := make_viewer(Vector3(200.0, 2.0, 200.0))
	var scatter := make_scatter([make_forest()], Island.new(), viewer)
	await settle(scatter)
	var exact := built_digests(scatter)
	for corner: Vector2i in [Vector2i(1, 1), Vector2i(-2, 1), Vector2i(-2, -2), Vector2i(1, 1)]:
		viewer.global_position = Vector3(corner.x + 0.5, 0.0, corner.y + 0.5) * TILE
		await settle(scatter)
		var in_cells := tiles_in_cells(scatter)
		check(corner in in_cells, "the viewer's tile %s is in cells: %s" % [corner, in_cells])
		check(not Vector2i(-1 - corner.x, -1 - corner.y) in in_cells, "the opposite tile is whole: %s" % [in_cells])
		check(in_cells.size() < 6, "few tiles are in cells: %s" % [in_cells])
		check_equal(island_digests(scatter), exact, "the renderer's buffers")
		check_equal(scatter.get_stats()["multimeshes"], multimesh_count(scatter), "multimeshes in the stats")
		check_equal(scatter.get_stats()["drawn"], drawn_of_all(scatter), "drawn instances in the stats")
	var uploads: int = scatter.get_stats()["uploads"]
	for step in 40: # Move back and forth by less than a tenth of a tile.
		viewer.global_position.x += 10.0 if step % 2 == 0 else -10.0
		await frames(2)
	await settle(scatter)
	check(scatter.get_stats()["uploads"] - uploads <= 3 * 2 * 16, "few uploads for steps back and forth")
	uploads = scatter.get_stats()["uploads"]
	for step in 40:
		viewer.global_position.x += 10.0 if step % 2 == 0 else -10.0
		await frames(2)
	await settle(scatter)
	check_equal(scatter.get_stats()["uploads"], uploads, "uploads after both ends were visited")


func test_cells_draw_exactly_their_instances() -> void:
	var viewer := make_viewer(Vector3(64.0, 2.0, 64.0))
	var scatter := make_scatter([make_forest()], Island.new(), viewer)
	await settle(scatter)
	var tile := scatter.get_tile(scatter.layers[0], Vector2i.ZERO)
	for mesh in 2:
		check_equal(tile.get_multimesh(mesh), RID(), "the single multimesh of mesh %d" % mesh)
		var count := 0
		var seen := {}
		for multimesh: RID in tile.get_multimeshes(mesh):
			var buffer := RenderingServer.multimesh_get_buffer(multimesh)
			var cell := Vector2i(((Vector2(buffer[3], buffer[11]) + Vector2.ONE * TILE * 0.5) / CELL).floor())
			for at in range(0, buffer.size(), 12):
				var its := Vector2i(((Vector2(buffer[at + 3], buffer[at + 11]) + Vector2.ONE * TILE * 0.5) / CELL).floor())
				if its != cell:
					check(false, "an instance of cell %s is drawn in %s" % [its, cell])
				count += 1
			check(not cell in seen, "cell %s occurs once" % cell)
			seen[cell] = true
			var box := box_of(buffer, 12, Vector3.ZERO)
			check(RenderingServer.multimesh_get_custom_aabb(multimesh).grow(0.01).encloses(box), "the box of cell %s" % cell)
			check(box.size.x < CELL + 2.0 and box.size.z < CELL + 2.0, "the box of cell %s is not too large" % cell)
		check_equal(count, tile.get_ids(mesh).size(), "instances in the cells of mesh %d" % mesh)
		check(seen.size() > 12, "cells of mesh %d: %d" % [mesh, seen.size()])
	var far := scatter.get_tile(scatter.layers[0], Vector2i(-2, -2))
	check_equal(far.get_multimeshes(0), [far.get_multimesh(0)] as Array[RID], "a far tile has one multimesh")
	check(far.get_multimesh(0).is_valid(), "the multimesh of a far tile is valid")
	check_equal(scatter.get_tile(scatter.layers[0], Vector2i(100, 0)).get_mesh_count(), 0, "a missing tile")
	scatter.get_tile(scatter.layers[0], Vector2i.ZERO).get_multimeshes(2)
	check_error(["get_multimeshes", "index", "2"], "an index beyond the list")


func test_mesh_and_thinning_depend_on_a_cells_distance() -> void:
	var layer := make_forest()
	layer.use_custom_data = true
	layer.thin_begin = 20.0
	layer.thin_end = 120.0
	layer.thin_density = 0.25
	var viewer := make_viewer(Vector3(4.0, 2.0, 4.0))
	var scatter := make_scatter([layer], Island.new(), viewer)
	await settle(scatter)
	var meshes := {}
	for tile: Vector2i in tiles_in_cells(scatter):
		var displayed_tile := scatter.get_tile(scatter.layers[0], tile)
		meshes[tile] = {}
		for multimesh: RID in displayed_tile.get_multimeshes(0):
			var buffer := RenderingServer.multimesh_get_buffer(multimesh)
			var distance := distance_to(box_of(buffer, 16, displayed_tile.get_origin()), viewer.global_position)
			var mesh := RenderingServer.multimesh_get_mesh(multimesh)
			meshes[tile][mesh] = true
			if absf(distance - 58.5) > 3.0:
				var expected: Mesh = lod_mesh(layer, 0, 0 if distance < 60.0 else 1)
				check(mesh == expected.get_rid(), "the mesh of a cell of %s at %f m" % [tile, distance])
			var density := 1.0 - 0.75 * clampf((distance - 20.0) / 100.0, 0.0, 1.0)
			var ranks := range(14, buffer.size(), 16).map(func(index: int) -> float: return buffer[index])
			var fewest := ranks.filter(func(rank: float) -> bool: return rank < density - 0.02).size()
			var maximum := ranks.filter(func(rank: float) -> bool: return rank < density + 0.02).size()
			var drawn := visible_count(multimesh)
			check(drawn >= fewest and drawn <= maximum, "%f m: %d drawn, %d to %d" % [distance, drawn, fewest, maximum])
	check_equal(meshes[Vector2i.ZERO].size(), 2, "meshes in the viewer's tile")
	check(scatter.get_stats()["drawn"] < scatter.get_stats()["instances"], "some instances are thinned out")
	check_equal(scatter.get_stats()["drawn"], drawn_of_all(scatter), "drawn instances in the stats")
	scatter.quality = 0.5
	await frames(20)
	check_equal(scatter.get_stats()["drawn"], drawn_of_all(scatter), "drawn at half the quality")


## Every instance adds the same light wherever it is, so an instance that is drawn twice or not at all changes the image.
func test_every_frame_draws_each_instance_once() -> void:
	var material := StandardMaterial3D.new()
	material.shading_mode = BaseMaterial3D.SHADING_MODE_UNSHADED
	material.transparency = BaseMaterial3D.TRANSPARENCY_ALPHA
	material.blend_mode = BaseMaterial3D.BLEND_MODE_ADD
	material.albedo_color = Color(0.2, 0.2, 0.2)
	var layer := make_forest()
	var plane := PlaneMesh.new()
	plane.size = Vector2.ONE * 3.0
	layer.meshes = with_lods([plane, plane.duplicate()], [[plane.duplicate(), plane.duplicate()]], [60.0])
	layer.material_override = material
	layer.cast_shadow = GeometryInstance3D.SHADOW_CASTING_SETTING_OFF
	var viewer := make_viewer(Vector3(-200.0, 2.0, -180.0))
	var camera := look_down()
	camera.projection = Camera3D.PROJECTION_ORTHOGONAL
	camera.size = 540.0
	camera.position = Vector3(0.0, 300.0, 0.0)
	var scatter := make_scatter([layer], Island.new(), viewer)
	scatter.frame_budget_usec = 200 # A small budget spreads changes across several frames.
	await settle(scatter)
	await frames(4)
	var whole := await light()
	check(whole.get_data().count(0) < whole.get_data().size() / 2, "some pixels are lit")
	var counts := {}
	var differing := 0
	for step in 80:
		viewer.global_position += Vector3(5.0, 0.0, 4.5)
		# On a slow machine, changes may lag behind the viewer. Every tenth step waits until they are done.
		var deadline := Time.get_ticks_msec() + IDLE_TIMEOUT_MSEC
		while true:
			if (await light()).get_data() != whole.get_data():
				differing += 1
			counts[scatter.get_stats()["multimeshes"]] = true
			if step % 10 != 9 or scatter.is_settled() or Time.get_ticks_msec() > deadline:
				break
	check_equal(differing, 0, "frames with a different image")
	check(counts.size() > 3, "tiles were divided on the way: %s" % [counts.keys()])


func light() -> Image:
	await RenderingServer.frame_post_draw
	var image := root.get_texture().get_image()
	image.convert(Image.FORMAT_L8)
	return image


func test_a_change_uploads_only_its_cell() -> void:
	var viewer := make_viewer(Vector3(64.0, 2.0, 64.0))
	var scatter := make_scatter([make_forest()], Island.new(), viewer)
	await settle(scatter)
	var before := island_digests(scatter)
	var multimeshes := multimeshes_of(scatter, Vector2i.ZERO)
	var id: int = tile_ids(scatter, 0, Vector2i.ZERO)[0][5]
	var uploads: int = scatter.get_stats()["uploads"]
	check(scatter.remove_instance(id), "an instance was removed")
	await frames(2)
	check_equal(scatter.get_stats()["uploads"] - uploads, 1, "uploads for the removal")
	check(not id in tile_ids(scatter, 0, Vector2i.ZERO)[0], "the instance is gone")
	check_equal(tile_buffers(scatter, 0, Vector2i.ZERO)[0].size(), 12 * tile_ids(scatter, 0, Vector2i.ZERO)[0].size(), "floats")
	check_equal(multimeshes_of(scatter, Vector2i.ZERO), multimeshes, "the multimeshes are the same")
	check_equal(scatter.get_stats()["drawn"], drawn_of_all(scatter), "drawn")
	check(scatter.restore_instance(id), "it is restored")
	await frames(2)
	check_equal(scatter.get_stats()["uploads"] - uploads, 2, "uploads for the removal and the restoration")
	check_equal(island_digests(scatter), before, "the buffers are the same as before")
	# A cell loses all of its instances and then gains one.
	var lone: RID = multimeshes[0][0]
	var floats := RenderingServer.multimesh_get_buffer(lone)
	var points := range(0, floats.size(), 12).map(func(at: int) -> Vector3: return Vector3(floats[at + 3], 0.0, floats[at + 11]))
	var origin := scatter.get_tile(scatter.layers[0], Vector2i.ZERO).get_origin()
	for point: Vector3 in points:
		for gone in scatter.remove_in_sphere(point + origin, 0.5):
			check(true, "%d is removed" % gone)
	await frames(2)
	check_equal(multimeshes_of(scatter, Vector2i.ZERO)[0].size(), multimeshes[0].size() - 1, "an empty cell draws nothing")
	var added := scatter.add_instance(scatter.layers[0], Transform3D(Basis(), points[0] + origin), 0)
	await frames(2)
	check(added in tile_ids(scatter, 0, Vector2i.ZERO)[0], "a hand-placed instance is drawn")
	check_equal(multimeshes_of(scatter, Vector2i.ZERO)[0].size(), multimeshes[0].size(), "the cell has a multimesh again")
	check_equal(scatter.get_stats()["drawn"], drawn_of_all(scatter), "drawn")


func test_max_multimeshes_prefers_near_tiles() -> void:
	var layer := make_forest()
	for model: ScatterModel in layer.meshes:
		model.lods[1].distance = 120.0
	var viewer := make_viewer(Vector3(-200.0, 2.0, -200.0))
	var scatter := make_scatter([layer], Island.new(), viewer)
	await settle(scatter)
	var maximum: int = scatter.get_stats()["multimeshes"]
	check(maximum > 100, "%d multimeshes without a limit" % maximum)
	var exact := island_digests(scatter)
	scatter.max_multimeshes = 80
	await settle(scatter)
	check(scatter.get_stats()["multimeshes"] in range(60, 81), "%s multimeshes with a limit" % scatter.get_stats()["multimeshes"])
	check_nearest_in_cells(scatter, Vector2i(-2, -2))
	check_equal(island_digests(scatter), exact, "the renderer's buffers")
	for step in 100:
		viewer.global_position += Vector3(4.0, 0.0, 4.0)
		await frames(1)
		if scatter.get_stats()["multimeshes"] > 80:
			check(false, "%d multimeshes on the way" % scatter.get_stats()["multimeshes"])
	await settle(scatter)
	check_nearest_in_cells(scatter, Vector2i(1, 1))
	scatter.max_multimeshes = 0
	await settle(scatter)
	check_equal(scatter.get_stats()["multimeshes"], WHOLE, "multimeshes of whole tiles")
	check_equal(island_digests(scatter), exact, "the renderer's buffers for whole tiles")
	scatter.max_multimeshes = -1
	check_error(["max_multimeshes", "-1"], "a limit below 0")
	check_equal(scatter.max_multimeshes, 0, "the last valid limit stays")


## Checks that `nearest` and few other tiles have cells. The limit suffices for one tile, and for a second one with few cells.
func check_nearest_in_cells(scatter: TerrainScatter3D, nearest: Vector2i) -> void:
	var in_cells := tiles_in_cells(scatter)
	check(nearest in in_cells and in_cells.size() < 4, "%s is in cells, and few others are: %s" % [nearest, in_cells])
	check(multimeshes_of(scatter, nearest)[0].size() > 12, "the nearest tile has many small cells")


func test_settings_of_cells() -> void:
	var layer := make_forest()
	var viewer := make_viewer(Vector3(64.0, 2.0, 64.0))
	var scatter := make_scatter([layer], Island.new(), viewer)
	await settle(scatter)
	var tiles_made: int = scatter.get_stats()["tiles_made"]
	var exact := island_digests(scatter)
	for wanted: Array in [[64.0, 4], [128.0, 1], [1000.0, 1], [0.0, 25], [32.0, 16]]: # [draw_cell_size, cells]. 0 means about 24 m here.
		layer.draw_cell_size = wanted[0]
		await settle(scatter)
		var count: int = multimeshes_of(scatter, Vector2i.ZERO)[0].size()
		check_equal(count, wanted[1], "cells of a mesh for a size of %f" % wanted[0])
		check_equal(island_digests(scatter), exact, "the renderer's buffers")
	check_equal(scatter.get_stats()["tiles_made"], tiles_made, "tiles generated for new cell sizes")
	for bad: float in [-1.0, 0.5, INF, NAN, 1e10]:
		layer.draw_cell_size = bad
		check_error(["draw_cell_size"], "a size of %f" % bad)
	check_equal(layer.draw_cell_size, 32.0, "the last valid size stays")
	# A layer may change its settings or be removed while its tiles are being divided.
	scatter.frame_budget_usec = 1
	layer.draw_cell_size = 16.0
	await frames(3)
	layer.cast_shadow = GeometryInstance3D.SHADOW_CASTING_SETTING_OFF
	await frames(3)
	scatter.world_offset = Vector3(100.0, 0.0, 0.0)
	await frames(3)
	scatter.visible = false
	await frames(3)
	scatter.layers = []
	await frames(3)
	scatter.visible = true
	scatter.world_offset = Vector3.ZERO
	scatter.frame_budget_usec = 20000
	scatter.layers = [layer]
	await settle(scatter)
	check_equal(island_digests(scatter), exact, "the renderer's buffers after all changes")


func test_draw_stats() -> void:
	var layer := make_forest()
	layer.meshes = [BoxMesh.new(), null]
	var scatter := make_scatter([layer], Island.new(), make_viewer(Vector3(64.0, 2.0, 64.0)))
	await settle(scatter)
	var all := scatter.get_draw_stats()
	var stats := scatter.get_stats()
	check_equal(all["instances"], stats["drawn"], "instances")
	check_equal(all["triangles"], 12 * stats["drawn"], "triangles of boxes")
	check_equal(all["draw_calls"], stats["multimeshes"], "draw calls of meshes with one surface")
	var surfaces := ArrayMesh.new()
	var arrays := BoxMesh.new().get_mesh_arrays()
	surfaces.add_surface_from_arrays(Mesh.PRIMITIVE_TRIANGLES, arrays)
	surfaces.add_surface_from_arrays(Mesh.PRIMITIVE_TRIANGLES, arrays)
	surfaces.add_surface_from_arrays(Mesh.PRIMITIVE_LINES, arrays)
	layer.meshes = [surfaces, null]
	await settle(scatter)
	var more := scatter.get_draw_stats()
	check_equal(more["triangles"], 24 * stats["drawn"], "triangles of a mesh of three surfaces, one of them lines")
	check_equal(more["draw_calls"], 3 * more["multimeshes"], "draw calls of that mesh")
	var camera := look_down()
	camera.far = 100.0
	await frames(2)
	var below := scatter.get_draw_stats(camera)
	check(below["triangles"] > 0 and below["triangles"] < more["triangles"] / 3, "below the camera: %s" % below)
	camera.rotation_degrees.x = 90.0
	check_equal(scatter.get_draw_stats(camera)["draw_calls"], 0, "draw calls when the camera looks into the sky")
	scatter.visible = false
	check_equal(scatter.get_draw_stats()["draw_calls"], 0, "draw calls of a hidden node")
	var outside := Camera3D.new()
	check_equal(scatter.get_draw_stats(outside), {}, "stats for a camera outside of the tree")
	check_error(["get_draw_stats", "camera"], "a camera outside of the tree")
	outside.free()


## When a viewer moves, a frame checks only cells whose distance may have changed enough.
func test_a_step_checks_few_cells() -> void:
	var camera := Camera3D.new()
	root.add_child(camera)
	camera.position = Vector3(10.0, 2.0, 10.0)
	var scatter := make_scatter([make_forest()], Island.new(), camera)
	await settle(scatter)
	var all: int = scatter.get_stats()["multimeshes"]
	check(all > 150, "%d multimeshes" % all)
	var before: int = scatter.get_stats()["lod_looks"]
	await frames(20)
	check_equal(scatter.get_stats()["lod_looks"], before, "checks while the viewer rests")
	for step in 40:
		camera.position += Vector3(0.25, 0.0, 0.1)
		await frames(1)
	await settle(scatter)
	var checks_made: int = scatter.get_stats()["lod_looks"] - before
	check(checks_made > 10, "%d checks" % checks_made)
	check(checks_made < all, "%d checks for %d multimeshes" % [checks_made, all])
	scatter.free()
	camera.free()
