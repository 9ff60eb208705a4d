extends "edits_harness.gd"
## Tests build_rect and build_tile, which build tiles on request for the caller to keep.

const SHARED := Rect2(-60, -60, 120, 120)

## Level ground that detects parallel queries. A large query waits until `wanted` threads have made one, but at most 20 seconds.
class RendezvousGround extends ScatterGround:
	var wanted := 2
	var threads: Dictionary[int, bool] = {}
	var mutex := Mutex.new()
	var gave_up := false
	## The maximum number of positions of a query that does not wait: five points, each with four more positions for the slope.
	const FEW := 25

	func _get_heights(positions: PackedVector2Array) -> PackedFloat32Array:
		var until := Time.get_ticks_msec() + 20_000
		var count := 0
		while count < wanted and positions.size() > FEW and not gave_up:
			gave_up = Time.get_ticks_msec() >= until
			mutex.lock()
			threads[OS.get_thread_caller_id()] = true
			count = threads.size()
			mutex.unlock()
			OS.delay_msec(1)
		var heights := PackedFloat32Array()
		heights.resize(positions.size())
		return heights

	func _is_thread_safe() -> bool:
		return wanted > 1


func test_build_rect() -> void:
	for ground: Mound in [Mound.new(), MainMound.new()]:
		var scatter := make_scatter(make_forest(), ground, make_viewer())
		scatter.layers[FERN].meshes = [BoxMesh.new(), null, SphereMesh.new()]
		scatter.add_child(make_clearing())
		var first := scatter.build_rect(scatter.layers[FERN], Rect2(32, 0, 32, 32))
		await settle(scatter)
		var tile := Vector2i(1, 0)
		var built := scatter.build_rect(scatter.layers[FERN], tile_rect(scatter, FERN, tile))
		check_equal(built.get_origin(), scatter.get_tile(scatter.layers[FERN], tile).get_origin(), "origin")
		check(buffers_of(built) == tile_buffers(scatter, FERN, tile), "the buffers match the tile")
		check(ids_of(built) == tile_ids(scatter, FERN, tile), "the IDs match the tile")
		check_equal(built.get_digest(), scatter.get_tile(scatter.layers[FERN], tile).get_digest(), "the digest matches the tile")
		check_equal(built.get_mesh_count(), 3, "meshes")
		for index in 3:
			check(built.get_mesh(index) == scatter.layers[FERN].meshes[index], "mesh %d" % index)
			check(not built.get_multimesh(index).is_valid(), "it has no multimesh")
		check(ids_of(first) == ids_of(built), "the IDs are the same before the first frame")
		check(built.get_ids(0).size() > 10 and not built.is_empty(), "%d instances" % built.get_ids(0).size())
		var far := scatter.build_rect(scatter.layers[OAK], Rect2(9000, -9000, 64, 48))
		check(far.get_ids(0).size() > 20, "build_rect works far from any viewer, with the layer object as its argument")
		check(built.get_buffer(3).is_empty(), "no such mesh")
		check_error(["ScatterTile.get_buffer", "index", "3"], "no such mesh")
		scatter.free()


func test_build_rect_rejects() -> void:
	var layers: Array[ScatterLayer] = [make_layer(), null]
	var scatter := make_scatter(layers, ScatterGroundFlat.new(), make_viewer())
	for rect: Rect2 in [Rect2(0, 0, -5, 5), Rect2(0, 0, NAN, 5), Rect2(0, 0, 1e6, 1e6)]:
		check_equal(scatter.build_rect(scatter.layers[0], rect).get_mesh_count(), 0, "meshes in %s" % rect)
		check_error(["TerrainScatter3D.build_rect", "rect"], "an invalid rectangle")
	for layer: Variant in [-1, 0, "nothing", null, 1.5, ScatterLayer.new()]:
		check(scatter.build_rect(layer, Rect2(0, 0, 5, 5)).is_empty(), "no instances of layer %s" % layer)
		check_error(["TerrainScatter3D.build_rect", "ayer"], "no such layer")
	check_equal(scatter.build_rect(scatter.layers[0], Rect2(3, 3, 0, 5)).get_mesh_count(), 1, "meshes in an empty rectangle")
	check_no_error("an empty rectangle")
	scatter.ground = null
	check(scatter.build_rect(scatter.layers[0], Rect2(0, 0, 5, 5)).is_empty(), "no ground")
	check_error(["ground", "missing"], "no ground")
	await frames(1)


## A built tile and its rows equal the visible tile bit for bit, including a game's changes.
func test_build_tile() -> void:
	for offset: Vector3 in [Vector3.ZERO, Vector3(4096.0, 0.0, -2048.0)]:
		var scatter := make_scatter(make_forest(), Mound.new(), make_viewer())
		scatter.world_offset = offset
		scatter.layers[OAK].use_colors = true
		scatter.layers[OAK].use_custom_data = true
		await settle(scatter)
		var felled := scatter.query_sphere(Vector3.ZERO, 20.0, scatter.layers[OAK])
		scatter.remove_instances(felled.ids)
		scatter.add_instance(scatter.layers[OAK], Transform3D(Basis.from_scale(Vector3(1, 2, 3)), Vector3(1.0, 2.0, 3.0)))
		await settle(scatter)
		var seen := 0
		for layer: ScatterLayer in [scatter.layers[OAK], scatter.layers[FERN]]:
			for tile in scatter.get_shown_tiles(layer):
				var built := scatter.build_tile(layer, tile)
				seen += int(not built.is_empty())
				check_equal(built.get_digest(), scatter.get_tile(layer, tile).get_digest(), "tile %s of %s" % [tile, layer.resource_name])
				check(built.get_rows() == scatter.get_tile(layer, tile).get_rows(), "rows of tile %s of %s" % [tile, layer.resource_name])
		check(seen > 8 and felled.size() > 5, "%d tiles with instances" % seen)
		scatter.free()
	check_no_error("tiles")


## Rows contain what queries return: the same IDs, world positions, meshes and rotations.
func test_rows() -> void:
	var scatter := make_scatter(make_forest(), Mound.new(), make_viewer())
	scatter.world_offset = Vector3(1024.0, 0.0, 0.0)
	scatter.layers[FERN].meshes = [BoxMesh.new(), SphereMesh.new()]
	scatter.layers[FERN].min_scale = 0.5
	scatter.layers[FERN].max_tilt_degrees = 30.0
	var tile := Vector2i(32, 0) # This tile covers 1024 to 1056 m in the world, which is 0 to 32 m in the engine.
	var rows := scatter.build_tile("fern", tile).get_rows()
	var found := scatter.query_rect(Rect2(0, 0, 32, 32), "fern")
	var count := rows.decode_u32(0)
	check(count > 50 and count == found.size(), "%d rows, %d instances" % [count, found.size()])
	check_equal(rows.decode_u32(4), 0, "floats of color and custom data")
	check_equal(rows.size(), 16 + count * 66, "bytes")
	var indices: Dictionary[int, int] = {}
	for index in found.size():
		indices[found.get_id(index)] = index
	for row: int in count:
		var at: int = indices[rows.decode_s64(16 + 8 * row)]
		var stands := found.get_transform(at)
		var position := Vector3.ZERO
		var turn := Vector4.ZERO
		var size := Vector3.ZERO
		for axis in 3:
			position[axis] = rows.decode_double(16 + 8 * (count * (1 + axis) + row)) - scatter.world_offset[axis]
			size[axis] = rows.decode_float(16 + 32 * count + 4 * (count * (4 + axis) + row))
		for part in 4:
			turn[part] = rows.decode_float(16 + 32 * count + 4 * (count * part + row))
		var basis_there := Basis(Quaternion(turn.x, turn.y, turn.z, turn.w)) * Basis.from_scale(size)
		if not (position.distance_to(stands.origin) < 1e-4 and basis_there.is_equal_approx(stands.basis)
				and rows.decode_u16(16 + 64 * count + 2 * row) == found.get_mesh(at)):
			check(false, "row %d is %s, %s" % [row, position, basis_there])
			return
	check(true, "all rows are correct")


func test_build_tile_rejects() -> void:
	var layers: Array[ScatterLayer] = [make_layer(), null]
	var scatter := make_scatter(layers, ScatterGroundFlat.new(), make_viewer())
	check_equal(scatter.build_tile(scatter.layers[0], Vector2i(1 << 30, 0)).get_mesh_count(), 0, "meshes beyond the end of the world")
	check_error(["TerrainScatter3D.build_tile"], "beyond the end of the world")
	check(scatter.build_tile("nothing", Vector2i.ZERO).is_empty(), "no such layer")
	check_error(["TerrainScatter3D.build_tile", "ayer"], "no such layer")
	check_equal(scatter.build_tile(scatter.layers[1], Vector2i.ZERO).get_rows(), PackedByteArray([0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0]), "no rows")
	check_error(["TerrainScatter3D.build_tile", "<null>"], "an empty entry")
	scatter.ground = null
	check(scatter.build_tile(scatter.layers[0], Vector2i.ZERO).is_empty(), "no ground")
	check_error(["ground", "missing"], "no ground")
	await frames(1)


## Worker threads share the work on a large rectangle. If a single thread did all of it, the ground would wait until its timeout.
func test_build_rect_uses_workers() -> void:
	var layers: Array[ScatterLayer] = [make_layer(0.5)]
	var single_threaded := RendezvousGround.new()
	single_threaded.wanted = 1
	var alone := make_scatter(layers, single_threaded, make_viewer())
	var ground := RendezvousGround.new()
	var together := make_scatter(layers, ground, make_viewer())
	var expected := alone.build_rect(alone.layers[0], SHARED)
	var built := together.build_rect(together.layers[0], SHARED)
	check(ground.threads.size() > 1, "%d threads queried the ground" % ground.threads.size())
	check_equal(single_threaded.threads.size(), 1, "threads that queried the single-threaded ground")
	check(expected.get_ids(0).size() > 20000, "%d instances" % expected.get_ids(0).size())
	check_equal(built.get_digest(), expected.get_digest(), "bit-identical to the result on one thread")
	alone.free()
	together.free()


## Worker threads also share the tiles that a query must generate.
func test_queries_use_workers() -> void:
	var ground := RendezvousGround.new()
	var scatter := make_scatter([make_layer(1.0)], ground, make_viewer())
	var found := scatter.query_rect(Rect2(1000, 1000, 100, 100))
	check(ground.threads.size() > 1, "%d threads queried the ground" % ground.threads.size())
	check(found.size() > 4000, "%d instances" % found.size())
	scatter.free()
