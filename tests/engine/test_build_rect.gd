extends "edits_harness.gd"
## What a scatter makes at once, for those who want to keep it.

func test_build_rect() -> void:
	for ground: Mound in [Mound.new(), MainMound.new()]:
		var scatter := make_scatter(make_forest(), ground, make_viewer())
		scatter.layers[FERN].meshes = [BoxMesh.new(), null, SphereMesh.new()]
		scatter.add_child(make_clearing())
		var first := scatter.build_rect(FERN, Rect2(32, 0, 32, 32))
		await settle(scatter)
		var tile := Vector2i(1, 0)
		var built := scatter.build_rect(FERN, tile_rect(scatter, FERN, tile))
		check_equal(built.get_origin(), scatter.get_tile(FERN, tile).get_origin(), "origin")
		check(buffers_of(built) == tile_buffers(scatter, FERN, tile), "buffers are those of the tile")
		check(ids_of(built) == tile_ids(scatter, FERN, tile), "ids are those of the tile")
		check_equal(built.get_digest(), scatter.get_tile(FERN, tile).get_digest(), "and so is the digest")
		check_equal(built.get_mesh_count(), 3, "meshes")
		for index in 3:
			check(built.get_mesh(index) == scatter.layers[FERN].meshes[index], "mesh %d" % index)
			check(not built.get_multimesh(index).is_valid(), "nothing is drawn of it")
		check(ids_of(first) == ids_of(built), "asked before the first frame")
		check(built.get_ids(0).size() > 10 and not built.is_empty(), "%d instances" % built.get_ids(0).size())
		var far := scatter.build_rect(scatter.layers[OAK], Rect2(9000, -9000, 64, 48))
		check(far.get_ids(0).size() > 20, "far from any viewer, by the layer itself")
		check(built.get_buffer(3).is_empty(), "no such mesh")
		check_error(["ScatterTile.get_buffer", "index", "3"], "no such mesh")
		scatter.free()


func test_build_rect_refuses() -> void:
	var layers: Array[ScatterLayer] = [make_layer(), null]
	var scatter := make_scatter(layers, ScatterTerrainFlat.new(), make_viewer())
	for rect: Rect2 in [Rect2(0, 0, -5, 5), Rect2(0, 0, NAN, 5), Rect2(0, 0, 1e6, 1e6)]:
		check_equal(scatter.build_rect(0, rect).get_mesh_count(), 0, "meshes in %s" % rect)
		check_error(["TerrainScatter3D.build_rect", "rect"], "a bad rectangle")
	for layer: Variant in [-1, 2, 70000, "nothing", null, 1.5, ScatterLayer.new()]:
		check(scatter.build_rect(layer, Rect2(0, 0, 5, 5)).is_empty(), "nothing of layer %s" % layer)
		check_error(["TerrainScatter3D.build_rect", "ayer"], "no such layer")
	check(scatter.build_rect(1, Rect2(0, 0, 5, 5)).is_empty(), "nothing of an empty entry")
	check_error(["TerrainScatter3D.build_rect", "layer"], "an empty entry")
	check_equal(scatter.build_rect(0, Rect2(3, 3, 0, 5)).get_mesh_count(), 1, "meshes in an empty rectangle")
	check_no_error("an empty rectangle")
	scatter.terrain = null
	check(scatter.build_rect(0, Rect2(0, 0, 5, 5)).is_empty(), "no ground")
	check_error(["terrain", "missing"], "no ground")
	await frames(1)
