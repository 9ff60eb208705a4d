extends "harness.gd"
## The kinds of ground: each where it should be, with holes where it has them, the same whichever way it is asked.

## Behaves like Terrain3D's data: heights and normals with a round hole, textures by halves, told edits.
class Terrain3DLikeData extends Object:
	signal maps_edited(area: AABB)
	var lift := 0.0

	func is_hole(at: Vector3) -> bool:
		return Vector2(at.x, at.z).length() < 12.0 or absf(at.x) > 100.0

	func get_height(at: Vector3) -> float:
		return NAN if is_hole(at) else lift + 0.2 * at.x + 3.0 * sin(at.z * 0.1)

	func get_normal(at: Vector3) -> Vector3:
		return Vector3(NAN, NAN, NAN) if is_hole(at) else Vector3(-0.2, 1.0, -0.3 * cos(at.z * 0.1)).normalized()

	func get_texture_id(at: Vector3) -> Vector3:
		return Vector3(NAN, NAN, NAN) if is_hole(at) else Vector3(0.0, 3.0, 0.25 if at.x < 0.0 else 1.0)


class Terrain3DLike extends Node3D:
	var data := Terrain3DLikeData.new()

	func _notification(what: int) -> void:
		if what == NOTIFICATION_EXIT_TREE:
			data.free()


## Behaves like HTerrain's data: an image of heights, asked in its own pixels, clamped at its border.
class HTerrainLikeData extends Resource:
	signal region_changed(x: int, y: int, w: int, h: int, channel: int)
	const SIZE := 65
	var lift := 0.0

	func get_resolution() -> int:
		return SIZE

	func get_interpolated_height_at(at: Vector3) -> float:
		return lift + 0.5 * clampf(at.x, 0.0, SIZE - 1.0)


class HTerrainLike extends Node3D:
	signal transform_changed(to: Transform3D)
	var map_scale := Vector3(2.0, 3.0, 2.0)
	var _data := HTerrainLikeData.new()

	func get_data() -> HTerrainLikeData:
		return _data

	func get_internal_transform() -> Transform3D:
		var half := Vector3(0.5 * (HTerrainLikeData.SIZE - 1.0), 0.0, 0.5 * (HTerrainLikeData.SIZE - 1.0))
		var made := Transform3D(global_transform.basis * Basis().scaled(map_scale), global_position)
		made.origin += made.basis * -half
		return made


## Any node with heights only, that counts how it is asked.
class Slope extends Node3D:
	var rise := 1.0
	var asked_elsewhere := false

	func get_height(at: Vector3) -> float:
		if OS.get_thread_caller_id() != OS.get_main_thread_id():
			asked_elsewhere = true
		return rise * at.x


## Has the right names and gives the wrong things.
class Wrong extends Node3D:
	var answer: Variant = "high"

	func get_height(_at: Vector3) -> Variant:
		return answer


func all_transforms(scatter: TerrainScatter3D, layer := 0) -> Array[Transform3D]:
	var result: Array[Transform3D] = []
	for tile: Vector2i in scatter.get_shown_tiles(layer):
		result.append_array(transforms(scatter, layer, tile))
	return result


## All instances of a layer by their ids, for comparing scatters of other tile sizes. Positions to the millimetre: a
## tile's own floats count from its centre.
func by_id(scatter: TerrainScatter3D, layer := 0) -> Dictionary:
	var result := {}
	for tile: Vector2i in scatter.get_shown_tiles(layer):
		var ids: Array[int] = []
		for of_mesh: PackedInt64Array in scatter.get_tile_ids(layer, tile):
			ids.append_array(Array(of_mesh))
		var stand := transforms(scatter, layer, tile)
		for index in ids.size():
			result[ids[index]] = stand[index].origin.snapped(Vector3.ONE * 0.002)
	return result


func make_hills() -> ScatterTerrainNoise:
	var terrain := ScatterTerrainNoise.new()
	var noise := FastNoiseLite.new()
	noise.seed = 5
	noise.frequency = 0.02
	noise.fractal_octaves = 4
	terrain.noise = noise
	terrain.amplitude = 25.0
	terrain.base_height = 100.0
	return terrain


## A scatter on the ground that a node gives, both in the tree.
func make_on(node: Node, thread_safe := false, layer := make_layer()) -> TerrainScatter3D:
	if not node.is_inside_tree():
		root.add_child(node)
	var terrain := ScatterTerrainObject.new()
	terrain.thread_safe = thread_safe
	var scatter := make_scatter([layer], terrain, make_viewer())
	terrain.node = scatter.get_path_to(node)
	return scatter


func test_noise_heights_and_normals() -> void:
	var terrain := make_hills()
	var noise := terrain.noise
	for at: Vector3 in [Vector3.ZERO, Vector3(12.5, 9.0, -70.25), Vector3(-1e5, 0.0, 3.0)]:
		var height := func(x: float, z: float) -> float: return 100.0 + 25.0 * noise.get_noise_2d(x, z)
		check(absf(terrain.get_height(at) - height.call(at.x, at.z)) < 1e-4, "height at %s" % at)
		var x: float = height.call(at.x + 0.5, at.z) - height.call(at.x - 0.5, at.z)
		var z: float = height.call(at.x, at.z + 0.5) - height.call(at.x, at.z - 0.5)
		check(terrain.get_normal(at).distance_to(Vector3(-x, 1.0, -z).normalized()) < 1e-3, "normal at %s" % at)
	check(is_nan(terrain.get_height(Vector3(INF, 0.0, 0.0))), "no ground at infinity")
	check(is_finite(terrain.get_height(Vector3(3e9, 0.0, -3e9))), "ground far out")
	check(terrain.get_normal(Vector3(3e9, 0.0, -3e9)).y > 0.0, "a normal far out")


func test_noise_stands_and_follows() -> void:
	var terrain := make_hills()
	var scatter := make_scatter([make_layer()], terrain, make_viewer())
	await settle(scatter)
	var stand := all_transforms(scatter)
	check(stand.size() > 1000, "instances: %d" % stand.size())
	var wrong := 0
	for one in stand:
		wrong += int(absf(one.origin.y - terrain.get_height(one.origin)) > 0.01)
	check_equal(wrong, 0, "instances off the ground")
	var before := digests(scatter, 0)
	(terrain.noise as FastNoiseLite).frequency = 0.05
	await settle(scatter)
	check(digests(scatter, 0) != before, "an edited noise shows")
	(terrain.noise as FastNoiseLite).frequency = 0.02
	await settle(scatter)
	check_equal(digests(scatter, 0), before, "the old noise gives the old instances")
	terrain.amplitude = 30.0
	terrain.base_height = -5.0
	await settle(scatter)
	check(digests(scatter, 0) != before, "an edited height shows")
	var old: Noise = terrain.noise
	terrain.noise = null
	await settle(scatter)
	check_equal(scatter.get_stats()["tiles"], 0, "tiles without a noise")
	check("ScatterTerrainNoise.noise" in "\n".join(scatter.get_problems()), "a warning without a noise")
	terrain.noise = old
	await settle(scatter)
	check_equal(scatter.get_problems().size(), 0, "no warning with a noise")
	check(scatter.get_stats()["tiles"] > 0, "tiles with a noise again")


func test_noise_does_not_know_tiles() -> void:
	var layers: Array[ScatterLayer] = []
	for tile_size: float in [32.0, 21.0]:
		var layer := make_layer()
		layer.tile_size = tile_size
		layer.layer_id = 3
		layer.max_slope_degrees = 25.0
		layer.view_distance = 60.0
		layers.push_back(layer)
	var terrain := make_hills()
	var whole := make_scatter([layers[0]], terrain, make_viewer())
	var parts := make_scatter([layers[1]], terrain, make_viewer())
	await settle(whole)
	await settle(parts)
	var a := by_id(whole)
	var b := by_id(parts)
	var common := 0
	for id: int in a:
		if b.has(id):
			common += 1
			check((a[id] as Vector3).distance_to(b[id]) < 0.005, "instance %d" % id)
		else:
			check(Vector2(a[id].x, a[id].z).length() > 60.0, "instance %d is missing in small tiles" % id)
	for id: int in b:
		check(a.has(id) or Vector2(b[id].x, b[id].z).length() > 60.0, "instance %d is missing in large tiles" % id)
	check(common > 300, "instances compared: %d" % common)


func test_noise_refuses() -> void:
	var terrain := make_hills()
	for property: String in ["amplitude", "base_height"]:
		for value: float in [NAN, INF, 1e9, -2e6]:
			var good: float = terrain.get(property)
			terrain.set(property, value)
			check_error(["ScatterTerrainNoise." + property], "%s = %s" % [property, value])
			check_equal(terrain.get(property), good, property)
	terrain.amplitude = -1.0
	check_error(["ScatterTerrainNoise.amplitude", "-1"], "a negative amplitude")


func check_terrain3d_like(scatter: TerrainScatter3D, node: Terrain3DLike, what: String) -> void:
	var stand := all_transforms(scatter)
	var wrong := 0
	for one in stand:
		var height := node.data.get_height(one.origin)
		wrong += int(is_nan(height) or absf(height - one.origin.y) > 0.01)
	check(stand.size() > 1000, "%s: %d instances" % [what, stand.size()])
	check_equal(wrong, 0, what + ": instances off the ground or in a hole")


func test_terrain3d_like() -> void:
	var node := Terrain3DLike.new()
	var slow := make_on(node)
	var fast := make_on(node, true)
	await settle(slow)
	await settle(fast)
	check_terrain3d_like(slow, node, "on the main thread")
	check_equal(digests(slow, 0), digests(fast, 0), "both ways")
	var terrain: ScatterTerrainObject = slow.terrain
	check(is_nan(terrain.get_height(Vector3(3.0, 0.0, 3.0))), "a hole has no height")
	check(absf(terrain.get_height(Vector3(20.0, 0.0, 0.0)) - 4.0) < 1e-5, "height")
	check(terrain.get_normal(Vector3(20.0, 5.0, 0.0)).distance_to(Vector3(-0.2, 1.0, -0.3).normalized()) < 1e-5, "normal")
	var rects: Array[Rect2] = []
	terrain.terrain_changed.connect(func(rect: Rect2) -> void: rects.push_back(rect))
	node.data.maps_edited.emit(AABB(Vector3(1.0, -5.0, 2.0), Vector3(3.0, 50.0, 4.0)))
	check_equal(rects, [Rect2(1.0, 2.0, 3.0, 4.0)] as Array[Rect2], "the edited area")


func test_hterrain_like() -> void:
	var node := HTerrainLike.new()
	node.position = Vector3(10.0, -4.0, 6.0)
	node.rotation.y = 0.5
	var slow := make_on(node)
	var fast := make_on(node, true)
	await settle(slow)
	await settle(fast)
	check_equal(digests(slow, 0), digests(fast, 0), "both ways")
	var to_map := node.get_internal_transform().affine_inverse()
	var stand := all_transforms(slow)
	var wrong := 0
	for one in stand:
		var on_map := to_map * one.origin
		var inside := on_map.x >= -0.01 and on_map.x <= 64.01 and on_map.z >= -0.01 and on_map.z <= 64.01
		wrong += int(not inside or absf(on_map.y - 0.5 * on_map.x) > 0.01)
	check(stand.size() > 500, "instances: %d" % stand.size())
	check_equal(wrong, 0, "instances off the map or off the ground")
	var terrain: ScatterTerrainObject = slow.terrain
	check(is_nan(terrain.get_height(Vector3(200.0, 0.0, 0.0))), "off the map")
	var along := node.global_basis.x
	var steep := Vector3(along.x * 0.75, -1.0, along.z * 0.75).normalized()
	check(terrain.get_normal(node.position).distance_to(-steep) < 1e-3, "normal")
	var rects: Array[Rect2] = []
	terrain.terrain_changed.connect(func(rect: Rect2) -> void: rects.push_back(rect))
	node.get_data().region_changed.emit(32, 32, 4, 4, 0)
	if check_equal(rects.size(), 1, "an edit"):
		for corner: Vector3 in [Vector3(32, 0, 32), Vector3(36, 0, 32), Vector3(32, 0, 36), Vector3(36, 0, 36)]:
			var world := node.get_internal_transform() * corner
			check(rects[0].has_point(Vector2(world.x, world.z)), "%s lies in the edited area" % corner)
		check(rects[0].size.x < 30.0, "the edited area is small: %s" % rects[0])
	node.position.y = 50.0
	node.transform_changed.emit(node.get_internal_transform())
	await settle(slow)
	check(all_transforms(slow)[0].origin.y > stand[0].origin.y + 40.0, "follows the moved node")


func test_any_object() -> void:
	var node := Slope.new()
	var slow := make_on(node)
	await settle(slow)
	check(not node.asked_elsewhere, "asked on the main thread")
	var fast := make_on(node, true)
	await settle(fast)
	check(node.asked_elsewhere, "asked on workers")
	check_equal(digests(slow, 0), digests(fast, 0), "both ways")
	check(slow.get_stats()["instances"] > 1000, "instances")
	check(slow.terrain.get_normal(Vector3.ZERO).distance_to(Vector3(-1.0, 1.0, 0.0).normalized()) < 1e-5, "slope")
	node.rise = 0.0
	slow.regenerate()
	await settle(slow)
	check(absf(all_transforms(slow)[0].origin.y) < 1e-5, "made anew")


func test_object_goes_and_comes() -> void:
	for thread_safe: bool in [false, true]:
		var node := Slope.new()
		node.name = "Ground"
		var viewer := make_viewer()
		root.add_child(node)
		var terrain := ScatterTerrainObject.new()
		terrain.thread_safe = thread_safe
		var scatter := make_scatter([make_layer()], terrain, viewer)
		terrain.node = ^"../Ground"
		await settle(scatter)
		var before := digests(scatter, 0)
		check(before.size() > 10, "tiles")
		root.remove_child(node)
		await settle(scatter)
		check_error(["ScatterTerrainObject.node", "../Ground"], "the node is gone")
		check_equal(digests(scatter, 0), before, "what stands when the node is gone")
		check("../Ground" in "\n".join(scatter.get_problems()), "a warning")
		viewer.global_position.x = 40.0
		await settle(scatter)
		check_no_error("new tiles without the node")
		viewer.global_position.x = 0.0
		root.add_child(node)
		await settle(scatter)
		check_no_error("the node is back")
		check_equal(scatter.get_problems().size(), 0, "no warning")
		check_equal(shared(digests(scatter, 0), before), before, "what stands when the node is back")
		node.free()
		await settle(scatter)
		check_error(["ScatterTerrainObject.node", "../Ground"], "the node is freed")
		check_equal(shared(digests(scatter, 0), before), before, "what stands when the node is freed")
		check(is_nan(terrain.get_height(Vector3.ZERO)), "no height without the node")
		errors.take()
		scatter.free()


## The entries of `all` whose keys are in `some`.
func shared(all: Dictionary, some: Dictionary) -> Dictionary:
	var result := {}
	for key: Variant in some:
		if all.has(key):
			result[key] = all[key]
	return result


func test_object_goes_in_mid_work() -> void:
	for thread_safe: bool in [false, true]:
		for wait in [1, 2, 3, 5, 8]:
			var node := Terrain3DLike.new()
			var layer := make_layer(0.5)
			var scatter := make_on(node, thread_safe, layer)
			await frames(wait)
			node.queue_free()
			await settle(scatter)
			check_error(["ScatterTerrainObject.node"], "freed after %d frames" % wait)
			scatter.free()


func test_wrong_objects() -> void:
	var plain := Node3D.new()
	plain.name = "Plain"
	root.add_child(plain)
	var scatter := make_on(plain)
	await settle(scatter)
	check_error(["ScatterTerrainObject.node", "Plain", "Node3D", "get_height"], "a node without heights")
	check_equal(scatter.get_stats()["tiles"], 0, "tiles on nothing")
	var terrain: ScatterTerrainObject = scatter.terrain
	terrain.node = ^"../Nobody"
	await settle(scatter)
	check_error(["ScatterTerrainObject.node", "../Nobody"], "no node")
	terrain.node = ^""
	await settle(scatter)
	check_error(["ScatterTerrainObject.node is missing"], "an empty path")
	var node := Slope.new()
	root.add_child(node)
	terrain.node = scatter.get_path_to(node)
	await settle(scatter)
	var before := digests(scatter, 0)
	check(before.size() > 10, "tiles on a slope")
	terrain.node = ^"../Plain"
	await settle(scatter)
	check_error(["ScatterTerrainObject.node", "Plain"], "a node without heights after a good one")
	check_equal(digests(scatter, 0), before, "what stands stays")
	for thread_safe: bool in [false, true]:
		for answer: Variant in ["high", null, Vector3.ONE, plain]:
			var wrong := Wrong.new()
			wrong.answer = answer
			var on_wrong := make_on(wrong, thread_safe)
			await settle(on_wrong)
			check_error(["ScatterTerrainObject.node", "number", "missing"], "an answer of %s" % answer)
			check_equal(on_wrong.get_stats()["instances"], 0, "instances")
			wrong.answer = 5
			on_wrong.regenerate()
			await settle(on_wrong)
			check(on_wrong.get_stats()["instances"] > 1000, "instances on an integer height")
			on_wrong.free()


func test_a_failure_leaves_what_stands() -> void:
	var node := Wrong.new()
	node.answer = 1.0
	var scatter := make_on(node)
	await settle(scatter)
	var before := digests(scatter, 0)
	check(before.size() > 10, "tiles")
	node.answer = "low"
	scatter.regenerate()
	await settle(scatter)
	check_error(["ScatterTerrainObject.node"], "a wrong answer")
	check_equal(digests(scatter, 0), before, "what stands after a wrong answer")


func test_shared_terrain_has_another_host_when_the_first_goes() -> void:
	var node := Slope.new()
	var first := make_on(node)
	var second := make_scatter([make_layer()], first.terrain, make_viewer())
	await settle(first)
	await settle(second)
	check_equal(digests(first, 0), digests(second, 0), "both on one ground")
	var before := digests(second, 0)
	first.free()
	await settle(second)
	check_equal(digests(second, 0), before, "after the first has gone")
	node.rise = 2.0
	second.regenerate()
	await settle(second)
	check_no_error("the ground has a host")
	check(digests(second, 0) != before, "asked again")
