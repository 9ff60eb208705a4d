extends "terrain_harness.gd"
## Tests that scripts and nodes that provide ground are queried only for data that layers need, and only within their bounds.

## A terrain of 40 by 40 m around the origin, with height 0 outside. Its data counts the calls.
class Counting extends Node3D:
	var data := CountingData.new()

	func _notification(context: int) -> void:
		if context == NOTIFICATION_PREDELETE:
			data.free()


class CountingData extends Object:
	var heights := 0
	var normals := 0
	var textures := 0
	var outside := 0
	var above_nothing := 0 ## The number of queries for normals and textures where there is no ground.
	var hole_is_nan := false
	var mutex := Mutex.new()

	func _count(at: Vector3, kind: StringName) -> void:
		mutex.lock()
		set(kind, get(kind) + 1)
		outside += int(not CountingData.covers(at))
		above_nothing += int(kind != &"heights" and CountingData.is_hole(at))
		mutex.unlock()

	static func covers(at: Vector3) -> bool:
		return Rect2(-20.0, -20.0, 40.0, 40.0).has_point(Vector2(at.x, at.z))

	static func is_hole(at: Vector3) -> bool:
		return Vector2(at.x, at.z).length() < 8.0

	func get_height(at: Vector3) -> float:
		_count(at, &"heights")
		if CountingData.is_hole(at) and hole_is_nan:
			return NAN
		return 0.0 if CountingData.is_hole(at) or not CountingData.covers(at) else 5.0 + 0.1 * at.x

	func get_normal(at: Vector3) -> Vector3:
		_count(at, &"normals")
		return Vector3(-0.1, 1.0, 0.0).normalized()

	func get_texture_id(at: Vector3) -> Vector3:
		_count(at, &"textures")
		return Vector3(1.0, 2.0, 0.0)


## A node with heights only, so that the library computes slopes from the heights around a position.
class HeightsOnly extends Node3D:
	var heights := 0
	var outside := 0
	var mutex := Mutex.new()

	func get_height(at: Vector3) -> float:
		mutex.lock()
		heights += 1
		outside += int(not CountingData.covers(at))
		mutex.unlock()
		return 5.0


## A ground script that counts the queried positions.
class CountingScript extends ScatterGround:
	var heights := 0
	var normals := 0
	var weights := 0
	var above_nothing := 0
	var threaded := false
	var mutex := Mutex.new()

	func _get_heights(positions: PackedVector2Array) -> PackedFloat32Array:
		var result := PackedFloat32Array()
		for at in positions:
			result.push_back(NAN if at.length() < 8.0 else 2.0)
		_add(&"heights", positions)
		return result

	func _get_normals(positions: PackedVector2Array) -> PackedVector3Array:
		var result := PackedVector3Array()
		result.resize(positions.size())
		result.fill(Vector3.UP)
		_add(&"normals", positions)
		return result

	func _get_weights(positions: PackedVector2Array, _textures: PackedInt32Array) -> PackedFloat32Array:
		var result := PackedFloat32Array()
		result.resize(positions.size())
		result.fill(1.0)
		_add(&"weights", positions)
		return result

	func _is_thread_safe() -> bool:
		return threaded

	func _add(kind: StringName, positions: PackedVector2Array) -> void:
		mutex.lock()
		set(kind, get(kind) + positions.size())
		if kind != &"heights":
			for at in positions:
				above_nothing += int(at.length() < 8.0)
		mutex.unlock()


## A ground script without normals. Records the largest number of positions per query.
class SlopesByHeights extends ScatterGround:
	var most := 0

	func _get_heights(positions: PackedVector2Array) -> PackedFloat32Array:
		most = maxi(most, positions.size())
		var result := PackedFloat32Array()
		result.resize(positions.size())
		return result


func upright(aligned := 0.0, textures := PackedInt32Array()) -> ScatterLayer:
	var layer := make_layer(1.0)
	layer.tile_size = 16.0
	layer.view_distance = 32.0
	layer.align_to_normal = aligned
	layer.ground_textures = textures
	return layer


func test_a_node_is_called_only_for_needed_data() -> void:
	for thread_safe: bool in [false, true]:
		for needs: int in 4:
			var context := "thread_safe %s, normals %s, textures %s" % [thread_safe, needs & 1, needs & 2]
			var node := Counting.new()
			var textures := PackedInt32Array([1]) if needs & 2 else PackedInt32Array()
			node.data.hole_is_nan = true
			var scatter := make_on(node, thread_safe, upright(float(needs & 1), textures))
			await settle(scatter)
			check(scatter.get_stats()["instances"] > 1000, context + ": instances")
			check_equal(node.data.normals > 1000, bool(needs & 1), context + ": normals")
			check_equal(node.data.textures > 1000, bool(needs & 2), context + ": textures")
			check_equal(node.data.above_nothing, 0, context + ": calls for normals or textures where there is no ground")
			var normals := node.data.normals
			check(scatter.ground.get_height(Vector3(10.0, 0.0, 10.0)) > 0.0, context + ": a height")
			scatter.get_density_map(scatter.layers[0], Rect2(-16, -16, 32, 32), Vector2i(8, 8))
			check_equal(node.data.normals, normals, context + ": a height and a density need no normals")
			scatter.free()
			node.free()


func test_a_script_is_called_only_for_needed_data() -> void:
	for threaded: bool in [false, true]:
		for needs: int in 4:
			var context := "threaded %s, normals %s, textures %s" % [threaded, needs & 1, needs & 2]
			var terrain := CountingScript.new()
			terrain.threaded = threaded
			var textures := PackedInt32Array([1]) if needs & 2 else PackedInt32Array()
			var scatter := make_scatter([upright(float(needs & 1), textures)], terrain, make_viewer())
			await settle(scatter)
			check(scatter.get_stats()["instances"] > 1000, context + ": instances")
			check_equal(terrain.normals > 1000, bool(needs & 1), context + ": normals")
			check_equal(terrain.weights > 1000, bool(needs & 2), context + ": weights")
			check_equal(terrain.above_nothing, 0, context + ": calls for normals or textures where there is no ground")
			scatter.free()


func test_slopes_are_measured_only_if_needed() -> void:
	for aligned: bool in [false, true]:
		var terrain := SlopesByHeights.new()
		var scatter := make_scatter([upright(float(aligned))], terrain, make_viewer())
		await settle(scatter)
		check(scatter.get_stats()["instances"] > 1000, "instances")
		check_equal(terrain.most, 128 if aligned else 32, "positions per call, aligned %s" % aligned)
		scatter.free()


## Returns the number of instances at a height in meters.
func count_at(scatter: TerrainScatter3D, height: float) -> int:
	return all_transforms(scatter).filter(func(one: Transform3D) -> bool: return absf(one.origin.y - height) < 1e-4).size()


func test_no_call_outside_of_bounds() -> void:
	for thread_safe: bool in [false, true]:
		for offset: Vector3 in [Vector3.ZERO, Vector3(4.0, 0.0, -4.0)]:
			var context := "thread_safe %s, offset %s" % [thread_safe, offset]
			var node := Counting.new()
			var scatter := make_on(node, thread_safe, upright(1.0, PackedInt32Array([1])))
			scatter.world_offset = offset
			(scatter.ground as ScatterGroundNode).bounds = Rect2(-20.0 + offset.x, -20.0 + offset.z, 40.0, 40.0)
			await settle(scatter)
			check_equal(node.data.outside, 0, context + ": calls outside")
			var stand := all_transforms(scatter)
			check(stand.size() > 500, context + ": instances inside")
			check(stand.all(func(one: Transform3D) -> bool: return CountingData.covers(one.origin)), context + ": none outside")
			check(is_nan(scatter.ground.get_height(offset + Vector3(30.0, 0.0, 0.0))), context + ": no height outside")
			check_equal(node.data.outside, 0, context + ": calls outside of the bounds")
			scatter.free()
			node.free()
		var heights := HeightsOnly.new()
		var scatter := make_on(heights, thread_safe, upright(1.0))
		(scatter.ground as ScatterGroundNode).bounds = Rect2(-20.0, -20.0, 40.0, 40.0)
		await settle(scatter)
		check(heights.heights > 1000, "heights")
		check_equal(heights.outside, 0, "calls outside of the bounds to measure slopes")
		scatter.free()
		heights.free()


func test_a_height_that_means_no_ground() -> void:
	for thread_safe: bool in [false, true]:
		var node := Counting.new()
		var scatter := make_on(node, thread_safe, upright(1.0, PackedInt32Array([1])))
		var terrain := scatter.ground as ScatterGroundNode
		await settle(scatter)
		check(count_at(scatter, 0.0) > 500, "instances at height 0 without no_ground_enabled")
		node.data.above_nothing = 0
		terrain.no_ground_enabled = true
		await settle(scatter)
		check_equal(count_at(scatter, 0.0), 0, "no instances at height 0")
		check(all_transforms(scatter).size() > 500, "instances at other heights remain")
		check_equal(node.data.above_nothing, 0, "calls for normals or textures where there is no ground")
		check(is_nan(terrain.get_height(Vector3.ZERO)), "no height")
		terrain.no_ground_height = 5.0
		await settle(scatter)
		check(count_at(scatter, 0.0) > 500, "instances at height 0 with a new no_ground_height")
		scatter.free()
		node.free()


func test_wrong_limits_are_rejected() -> void:
	var terrain := ScatterGroundNode.new()
	terrain.bounds = Rect2(1.0, 2.0, 3.0, 4.0)
	terrain.bounds = Rect2(0.0, 0.0, -1.0, 5.0)
	check_error(["ScatterGroundNode.bounds", "size of 0 or more", "-1"], "a negative size")
	terrain.bounds = Rect2(NAN, 0.0, 1.0, 5.0)
	check_error(["ScatterGroundNode.bounds", "finite"], "not a number")
	check_equal(terrain.bounds, Rect2(1.0, 2.0, 3.0, 4.0), "the last bounds stay")
	terrain.no_ground_height = INF
	check_error(["ScatterGroundNode.no_ground_height", "inf"], "an infinite height")
	check_equal(terrain.no_ground_height, 0.0, "the last height stays")
