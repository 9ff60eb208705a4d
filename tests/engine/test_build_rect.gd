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
		check_equal(built["origin"], scatter.get_tile_origin(FERN, tile), "origin")
		check(built["buffers"] == scatter.get_tile_buffers(FERN, tile), "buffers are those of the tile")
		check(built["ids"] == scatter.get_tile_ids(FERN, tile), "ids are those of the tile")
		for index in 3:
			check((built["meshes"] as Array[Mesh])[index] == scatter.layers[FERN].meshes[index], "mesh %d" % index)
		check(first["ids"] == built["ids"], "asked before the first frame")
		check((built["ids"] as Array)[0].size() > 10, "%d instances" % (built["ids"] as Array)[0].size())
		check(built["buffers"] is Array[PackedFloat32Array] and built["ids"] is Array[PackedInt64Array], "typed arrays")
		var far: Array = scatter.build_rect(OAK, Rect2(9000, -9000, 64, 48))["ids"]
		check(far[0].size() > 20, "far from any viewer")
		scatter.free()


func test_build_rect_refuses() -> void:
	var layers: Array[ScatterLayer] = [make_layer(), null]
	var scatter := make_scatter(layers, ScatterTerrainFlat.new(), make_viewer())
	for rect: Rect2 in [Rect2(0, 0, -5, 5), Rect2(0, 0, NAN, 5), Rect2(0, 0, 1e6, 1e6)]:
		check_equal(scatter.build_rect(0, rect)["buffers"].size(), 0, "buffers in %s" % rect)
		check_error(["TerrainScatter3D.rect"], "a bad rectangle")
	for layer: int in [-1, 1, 2, 70000]:
		check_equal(scatter.build_rect(layer, Rect2(0, 0, 5, 5))["ids"].size(), 0, "ids of layer %d" % layer)
		check_error(["TerrainScatter3D.layer", str(layer)], "no such layer")
	check_equal(scatter.build_rect(0, Rect2(3, 3, 0, 5))["ids"].size(), 1, "meshes in an empty rectangle")
	check_no_error("an empty rectangle")
	scatter.terrain = null
	check(scatter.build_rect(0, Rect2(0, 0, 5, 5))["meshes"].is_empty(), "no ground")
	check_error(["terrain", "missing"], "no ground")
	await frames(1)
