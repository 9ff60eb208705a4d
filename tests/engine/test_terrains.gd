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
	const CHANNEL_SPLAT := 2
	const CHANNEL_COLOR := 3
	var lift := 0.0
	var maps := {}

	func get_map_count(map_type: int) -> int:
		return maps[map_type].size() if maps.has(map_type) else 0

	func get_image(map_type: int, index := 0) -> Image:
		return maps[map_type][index]

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


## Hills with textures by thirds of the world, and weights that depend on them.
class Textured extends ScatterTerrain:
	var extra := 0

	func _get_heights(positions: PackedVector2Array) -> PackedFloat32Array:
		var heights := PackedFloat32Array()
		for at in positions:
			heights.push_back(0.1 * at.x)
		return heights

	func _get_weights(positions: PackedVector2Array, textures: PackedInt32Array) -> PackedFloat32Array:
		var weights := PackedFloat32Array()
		for at in positions:
			weights.push_back(NAN if at.y > 40.0 else 5.0 if (0 if at.x < 0.0 else 1) in textures else -1.0)
		weights.resize(weights.size() + extra)
		return weights


class ThreadedTextured extends Textured:
	func _is_thread_safe() -> bool:
		return true


func test_weights_of_scripts() -> void:
	var found: Array[Dictionary] = []
	for terrain: Textured in [Textured.new(), ThreadedTextured.new()]:
		var layer := make_layer()
		layer.ground_textures = PackedInt32Array([1, 7])
		var scatter := make_scatter([layer], terrain, make_viewer())
		await settle(scatter)
		var stand := all_transforms(scatter)
		check(stand.size() > 300, "instances: %d" % stand.size())
		check(stand.all(func(one: Transform3D) -> bool: return one.origin.x >= 0.0 and one.origin.z <= 40.0),
				"all stand on their texture")
		found.push_back(digests(scatter, 0))
		layer.ground_textures = PackedInt32Array()
		await settle(scatter)
		check(all_transforms(scatter).size() > 2 * stand.size(), "all textures")
		var before := digests(scatter, 0)
		layer.ground_textures = PackedInt32Array([0])
		terrain.extra = 3
		await settle(scatter)
		check_error(["_get_weights()", "wrong size"], "three weights too many")
		check_equal(digests(scatter, 0), before, "what stands stays")
	check_equal(found[0], found[1], "asked on the main thread and on workers")


func test_textures_of_terrain3d_like() -> void:
	var counts: Array[int] = []
	for textures: Array in [[3], [0], [0, 3], [9]]:
		var node := Terrain3DLike.new()
		var layer := make_layer()
		layer.ground_textures = PackedInt32Array(textures)
		var scatter := make_on(node, true, layer)
		await settle(scatter)
		var stand := all_transforms(scatter)
		counts.push_back(stand.size())
		if textures == [0]:
			check(stand.all(func(one: Transform3D) -> bool: return one.origin.x < 0.0), "the base lies on the left")
		node.free()
		scatter.free()
		errors.take()
	check_equal(counts[3], 0, "instances on a texture that is nowhere")
	check(counts[2] > counts[0] and counts[0] > counts[1] and counts[1] > 100, "instances by texture: %s" % [counts])
	# To the left the overlay has a quarter, so that much of the points; to the right all.
	check(absf(counts[0] - (0.25 * 0.5 + 0.5) * counts[2]) < 0.06 * counts[2], "a quarter on the left: %s" % [counts])


func make_collider(shape: Shape3D, at: Transform3D, layers := 1) -> StaticBody3D:
	var body := StaticBody3D.new()
	body.collision_layer = layers
	var collision := CollisionShape3D.new()
	collision.shape = shape
	body.add_child(collision)
	root.add_child(body)
	body.global_transform = at
	return body


## A floor of 80 m with its top at 2, with a gap in x from 10 to 20, and a ramp of 30 degrees above it in -x.
func make_colliders() -> void:
	for part: Array in [[-40.0, 10.0], [20.0, 40.0]]:
		var floor_box := BoxShape3D.new()
		floor_box.size = Vector3(part[1] - part[0], 4.0, 80.0)
		make_collider(floor_box, Transform3D(Basis(), Vector3(0.5 * (part[0] + part[1]), 0.0, 0.0)))
	var ramp := BoxShape3D.new()
	ramp.size = Vector3(20.0, 1.0, 20.0)
	make_collider(ramp, Transform3D(Basis(Vector3.BACK, deg_to_rad(30.0)), Vector3(-20.0, 15.0, 0.0)))
	var roof := BoxShape3D.new()
	roof.size = Vector3(200.0, 1.0, 200.0)
	make_collider(roof, Transform3D(Basis(), Vector3(0.0, 80.0, 0.0)), 2)


func test_colliders() -> void:
	make_colliders()
	var terrain := ScatterTerrainColliders.new()
	var scatter := make_scatter([make_layer()], terrain, make_viewer())
	await settle(scatter)
	var stand := all_transforms(scatter)
	check(stand.size() > 500, "instances: %d" % stand.size())
	var wrong := 0
	var on_ramp := 0
	for one in stand:
		var at := one.origin
		if absf(at.y - 2.0) > 0.001:
			on_ramp += 1
			wrong += int(absf(at.x + 20.0) > 10.0 or absf(at.z) > 10.01 or at.y < 9.0)
		wrong += int((at.x > 10.001 and at.x < 19.999) or absf(at.x) > 40.001 or absf(at.z) > 40.001)
	check_equal(wrong, 0, "instances in the gap, beside the floor or in the air")
	check(on_ramp > 20, "instances on the ramp: %d" % on_ramp)
	check(is_nan(terrain.get_height(Vector3(15.0, 0.0, 0.0))), "no ground in the gap")
	check(absf(terrain.get_height(Vector3(5.0, 0.0, 0.0)) - 2.0) < 0.001, "the floor")
	var slope := terrain.get_normal(Vector3(-20.0, 0.0, 0.0))
	check(slope.distance_to(Vector3(-0.5, sqrt(0.75), 0.0)) < 0.001, "the ramp's normal: %s" % slope)
	var before := digests(scatter, 0)
	terrain.rays_per_frame = 37
	scatter.regenerate()
	await settle(scatter)
	check_equal(digests(scatter, 0), before, "in other slices")
	terrain.collision_mask = 2
	await settle(scatter)
	check(all_transforms(scatter).all(func(one: Transform3D) -> bool: return absf(one.origin.y - 80.5) < 0.001), "on the roof")
	terrain.collision_mask = 1
	terrain.ray_top = 10.0
	await settle(scatter)
	check(all_transforms(scatter).all(func(one: Transform3D) -> bool: return one.origin.y < 10.0), "below the top of the rays")


func test_rays_wait_for_physics_frames() -> void:
	make_colliders()
	var terrain := ScatterTerrainColliders.new()
	terrain.rays_per_frame = 100
	var scatter := make_scatter([make_layer(1.0)], terrain, make_viewer())
	var start := Engine.get_physics_frames()
	await settle(scatter)
	var sampled: int = scatter.get_stats()["points_sampled"]
	var needed := sampled / 100.0
	check(sampled > 5000, "points: %d" % sampled)
	check(Engine.get_physics_frames() - start >= needed * 0.9, "%d points took %d physics frames" % [sampled, Engine.get_physics_frames() - start])


func test_colliders_refuse() -> void:
	make_colliders()
	var terrain := ScatterTerrainColliders.new()
	for wrong: Array in [["collision_mask", -1], ["collision_mask", 1 << 32], ["rays_per_frame", 0], ["rays_per_frame", 1 << 40],
			["ray_top", NAN], ["ray_top", 2e6], ["ray_bottom", INF], ["ray_bottom", -2e6]]:
		var good: Variant = terrain.get(wrong[0])
		terrain.set(wrong[0], wrong[1])
		check_error(["ScatterTerrainColliders." + wrong[0]], "%s = %s" % wrong)
		check_equal(terrain.get(wrong[0]), good, wrong[0])
	var scatter := make_scatter([make_layer()], terrain, make_viewer())
	await settle(scatter)
	var before := digests(scatter, 0)
	check(before.size() > 10, "tiles")
	terrain.ray_bottom = 2000.0
	await settle(scatter)
	check_error(["ScatterTerrainColliders.ray_bottom", "2000"], "a bottom above the top")
	check_equal(digests(scatter, 0), before, "what stands stays")
	check("ray_bottom" in "\n".join(scatter.get_problems()), "a warning")
	terrain.ray_bottom = -1000.0
	await settle(scatter)
	check_equal(digests(scatter, 0), before, "the same rays")
	terrain.collision_mask = 0
	await settle(scatter)
	check_equal(scatter.get_stats()["instances"], 0, "instances without a layer")
	check("collision_mask" in "\n".join(scatter.get_problems()), "a warning without a layer")


func make_mesh(mesh: Mesh, at: Transform3D, group := &"ground") -> MeshInstance3D:
	var instance := MeshInstance3D.new()
	instance.mesh = mesh
	instance.add_to_group(group)
	root.add_child(instance)
	instance.global_transform = at
	return instance


func make_meshes() -> Array[MeshInstance3D]:
	var plane := PlaneMesh.new()
	plane.size = Vector2(60.0, 40.0)
	var box := BoxMesh.new()
	box.size = Vector3(10.0, 10.0, 10.0)
	return [make_mesh(plane, Transform3D(Basis(), Vector3(10.0, 3.0, 0.0))),
		make_mesh(plane, Transform3D(Basis(Vector3.BACK, deg_to_rad(20.0)), Vector3(-60.0, 5.0, 0.0))),
		make_mesh(box, Transform3D(Basis(Vector3.UP, 0.6), Vector3(20.0, 0.0, 0.0)))]


func test_meshes() -> void:
	var instances := make_meshes()
	make_mesh(BoxMesh.new(), Transform3D(Basis().scaled(Vector3.ONE * 90.0), Vector3.ZERO), &"other")
	var terrain := ScatterTerrainMeshes.new()
	terrain.group = &"ground"
	var scatter := make_scatter([make_layer()], terrain, make_viewer())
	await settle(scatter)
	var wrong := 0
	var on_box := 0
	var stand := all_transforms(scatter)
	for one in stand:
		var local := instances[2].global_transform.affine_inverse() * one.origin
		var box := absf(local.x) < 4.99 and absf(local.z) < 4.99
		on_box += int(box)
		var height := 5.0 if box else 3.0 if one.origin.x > -20.0 else 5.0 + (one.origin.x + 60.0) * tan(deg_to_rad(20.0))
		wrong += int(absf(one.origin.y - height) > 0.01 and (absf(local.x) < 4.99) == (absf(local.x) < 5.01) and (absf(local.z) < 4.99) == (absf(local.z) < 5.01))
		wrong += int(absf(one.origin.z) > 20.001 or one.origin.x > 40.001)
	check(stand.size() > 300 and on_box > 10, "instances: %d, on the box %d" % [stand.size(), on_box])
	check_equal(wrong, 0, "instances off the meshes")
	check(is_nan(terrain.get_height(Vector3(0.0, 0.0, 25.0))), "no ground beside the meshes")
	check(terrain.get_normal(Vector3(-60.0, 0.0, 0.0)).distance_to(Vector3.UP.rotated(Vector3.BACK, deg_to_rad(20.0))) < 1e-4, "normal")
	var rects: Array[Rect2] = []
	terrain.terrain_changed.connect(func(rect: Rect2) -> void: rects.push_back(rect))
	terrain.refresh()
	check_equal(rects.size(), 0, "nothing has changed")
	instances[2].global_position = Vector3(0.0, 0.0, 5.0)
	terrain.refresh()
	if check_equal(rects.size(), 1, "a box was moved"):
		var reach := 5.0 * (cos(0.6) + sin(0.6))
		check(rects[0].is_equal_approx(Rect2(-reach, -reach, 20.0 + 2.0 * reach, 5.0 + 2.0 * reach)), "area: %s" % rects[0])
	check(absf(terrain.get_height(Vector3(0.0, 0.0, 5.0)) - 5.0) < 1e-5, "the box is there now")
	await settle(scatter)
	var moved := all_transforms(scatter).filter(func(one: Transform3D) -> bool: return one.origin.distance_to(Vector3(0.0, 5.0, 5.0)) < 3.0)
	check(moved.size() > 0, "instances on the moved box")
	for instance in instances:
		instance.free()
	terrain.refresh()
	check_equal(rects.size(), 2, "all are gone")
	await settle(scatter)
	check_equal(scatter.get_stats()["instances"], 0, "instances on no mesh")
	check("\"ground\"" in "\n".join(scatter.get_problems()), "a warning of a group without meshes")
	terrain.group = &""
	check("ScatterTerrainMeshes.group" in "\n".join(scatter.get_problems()), "a warning without a group")


func test_meshes_do_not_know_tiles() -> void:
	make_meshes()
	var terrain := ScatterTerrainMeshes.new()
	terrain.group = &"ground"
	var large := make_layer()
	var small := make_layer()
	for layer: ScatterLayer in [large, small]:
		layer.layer_id = 1
		layer.view_distance = 70.0
	small.tile_size = 13.0
	var whole := make_scatter([large], terrain, make_viewer())
	var parts := make_scatter([small], terrain, make_viewer())
	await settle(whole)
	await settle(parts)
	var a := by_id(whole)
	var b := by_id(parts)
	var missing := a.keys().filter(func(id: int) -> bool: return not b.has(id) and Vector2(a[id].x, a[id].z).length() < 70.0)
	check_equal(missing.size(), 0, "instances missing in small tiles")
	check(a.size() > 300, "instances: %d" % a.size())


func make_heights(format: Image.Format, size := Vector2i(5, 4)) -> Image:
	var image := Image.create_empty(size.x, size.y, false, format)
	for x in size.x:
		for y in size.y:
			image.set_pixel(x, y, Color((x + 0.5 * y) / 8.0, 0.3, 0.6, 1.0))
	return image


func test_heightmap_formats() -> void:
	for format: Image.Format in [Image.FORMAT_L8, Image.FORMAT_R8, Image.FORMAT_RGB8, Image.FORMAT_RGBA8, Image.FORMAT_R16, Image.FORMAT_RGBA16,
			Image.FORMAT_RH, Image.FORMAT_RGBAH, Image.FORMAT_RF, Image.FORMAT_RGBF, Image.FORMAT_RGBAF]:
		var terrain := ScatterTerrainHeightmap.new()
		terrain.rect = Rect2(-10.0, 5.0, 40.0, 30.0)
		terrain.min_height = 100.0
		terrain.max_height = 900.0
		terrain.image = make_heights(format)
		var coarse := 4.0 if format in [Image.FORMAT_L8, Image.FORMAT_R8, Image.FORMAT_RGB8, Image.FORMAT_RGBA8] else \
				0.5 if format in [Image.FORMAT_RH, Image.FORMAT_RGBAH] else 0.02
		for x in 5:
			for y in 4:
				if format == Image.FORMAT_L8:
					continue # Luminance is made of all channels.
				var height := terrain.get_height(Vector3(-10.0 + 10.0 * x, 0.0, 5.0 + 10.0 * y))
				check(absf(height - (100.0 + 100.0 * (x + 0.5 * y))) < coarse, "format %d, post %d, %d: %f" % [format, x, y, height])
		check(is_finite(terrain.get_height(Vector3(0.0, 0.0, 10.0))), "format %d has ground" % format)
		check_no_error("format %d" % format)


func test_heightmap_in_metres_with_holes() -> void:
	var image := Image.create_empty(33, 33, false, Image.FORMAT_RF)
	for x in 33:
		for y in 33:
			image.set_pixel(x, y, Color(NAN if x > 20 and x < 24 else -250.0 + 1.25 * x, 0.0, 0.0))
	var terrain := ScatterTerrainHeightmap.new()
	terrain.rect = Rect2(-64.0, -64.0, 128.0, 128.0)
	terrain.heights_in_metres = true
	terrain.image = image
	check_equal(terrain.get_height(Vector3(-64.0, 0.0, 3.0)), -250.0, "height")
	check(is_nan(terrain.get_height(Vector3(24.0, 0.0, 0.0))), "a hole")
	var scatter := make_scatter([make_layer()], terrain, make_viewer())
	await settle(scatter)
	var stand := all_transforms(scatter)
	check(stand.size() > 1000, "instances: %d" % stand.size())
	check(stand.all(func(one: Transform3D) -> bool: return one.origin.x <= 16.0 or one.origin.x >= 32.0), "none in the hole")
	var before := digests(scatter, 0)
	for value: float in [INF, 2e6]:
		var bad := image.duplicate() as Image
		bad.set_pixel(0, 0, Color(value, 0.0, 0.0))
		terrain.image = bad
		await settle(scatter)
		check_error(["ScatterTerrainHeightmap."], "a height of %s" % value)
		check_equal(digests(scatter, 0), before, "what stands stays")
	terrain.image = ImageTexture.create_from_image(image)
	await settle(scatter)
	check_equal(digests(scatter, 0), before, "the same by a texture")
	terrain.heights_in_metres = false
	await settle(scatter)
	check_error(["ScatterTerrainHeightmap.image", "-250"], "metres taken as 0 to 1")


func test_heightmap_exr() -> void:
	var image := make_heights(Image.FORMAT_RF, Vector2i(9, 7))
	var path := "user://thicket_test.exr"
	check_equal(image.save_exr(path, true), OK, "saved")
	var terrain := ScatterTerrainHeightmap.new()
	terrain.rect = Rect2(0.0, 0.0, 8.0, 6.0)
	terrain.heights_in_metres = true
	terrain.image = Image.load_from_file(path)
	for x in 9:
		for y in 7:
			check(absf(terrain.get_height(Vector3(x, 0.0, y)) - (x + 0.5 * y) / 8.0) < 1e-6, "post %d, %d" % [x, y])
	DirAccess.remove_absolute(path)


func test_heightmap_raw_depths() -> void:
	var path := "user://thicket_test.raw"
	for depth: int in [1, 2, 4]:
		var bytes := PackedByteArray()
		bytes.resize(6 * depth)
		for post in 6:
			match depth:
				1: bytes.encode_u8(post, post * 51)
				2: bytes.encode_u16(2 * post, post * 13107)
				4: bytes.encode_float(4 * post, post / 5.0)
		FileAccess.open(path, FileAccess.WRITE).store_buffer(bytes)
		var terrain := ScatterTerrainHeightmap.new()
		terrain.heightmap_path = path
		terrain.post_count = Vector2i(3, 2)
		terrain.rect = Rect2(0.0, 0.0, 2.0, 1.0)
		terrain.max_height = 50.0
		for post in 6:
			var height := terrain.get_height(Vector3(post % 3, 0.0, post / 3))
			check(absf(height - 10.0 * post) < 1e-4, "%d bytes, post %d: %f" % [depth, post, height])
	DirAccess.remove_absolute(path)
	var none := ScatterTerrainHeightmap.new()
	none.post_count = Vector2i(3, 4)
	none.post_count = Vector2i.ZERO
	check_no_error("a post_count of none")
	check_equal(none.post_count, Vector2i.ZERO, "post_count")
	none.post_count = Vector2i(0, 5)
	check_error(["ScatterTerrainHeightmap.post_count"], "half a post_count")


func test_heightmap_weights() -> void:
	var terrain := ScatterTerrainHeightmap.new()
	terrain.rect = Rect2(-64.0, -64.0, 128.0, 128.0)
	terrain.image = make_heights(Image.FORMAT_RF)
	var image := Image.create_empty(2, 1, false, Image.FORMAT_RGB8)
	image.set_pixel(0, 0, Color(1.0, 0.0, 0.0))
	image.set_pixel(1, 0, Color(0.0, 0.0, 1.0))
	terrain.weight_image = image
	var counts: Array[int] = []
	for textures: Array in [[], [0], [2], [0, 2], [1], [3]]:
		var layer := make_layer()
		layer.ground_textures = PackedInt32Array(textures)
		var scatter := make_scatter([layer], terrain, make_viewer())
		await settle(scatter)
		counts.push_back(all_transforms(scatter).size())
		if textures == [0]:
			var left := all_transforms(scatter).filter(func(one: Transform3D) -> bool: return one.origin.x < 0.0).size()
			check(left > 0.7 * counts[1], "texture 0 lies to the left: %d of %d" % [left, counts[1]])
		scatter.free()
	check_equal(counts[3], counts[0], "both textures are everything")
	check(absf(counts[1] - 0.5 * counts[0]) < 0.1 * counts[0] and absf(counts[2] - 0.5 * counts[0]) < 0.1 * counts[0], "halves: %s" % [counts])
	check_equal(counts.slice(4), [0, 0] as Array[int], "textures that are nowhere")
	terrain.weight_image = Image.new()
	check_error(["ScatterTerrainHeightmap.weight_image", "wrong size"], "an empty image")
	check_equal(terrain.weight_image, image, "the old image")
	terrain.weight_image = BoxMesh.new()
	check_error(["ScatterTerrainHeightmap.weight_image", "missing"], "a mesh")
	terrain.image = BoxMesh.new()
	check_error(["ScatterTerrainHeightmap.image", "missing"], "a mesh")


func test_holes_and_textures_of_hterrain_like() -> void:
	var node := HTerrainLike.new()
	var size := HTerrainLikeData.SIZE
	var colors := Image.create_empty(size, size, false, Image.FORMAT_RGBA8)
	colors.fill(Color.WHITE)
	colors.fill_rect(Rect2i(20, 0, 10, size), Color(1.0, 1.0, 1.0, 0.0))
	var splats: Array[Image] = []
	for index in 2:
		splats.push_back(Image.create_empty(size, size, false, Image.FORMAT_RGBA8))
		splats[index].fill(Color(0.0, 0.0, 0.0, 0.0))
	splats[0].fill_rect(Rect2i(0, 0, size, 33), Color(0.0, 1.0, 0.0, 0.0))
	splats[1].fill_rect(Rect2i(0, 33, size, 32), Color(0.0, 0.0, 0.0, 1.0))
	node.get_data().maps = {HTerrainLikeData.CHANNEL_COLOR: [colors], HTerrainLikeData.CHANNEL_SPLAT: splats}
	var counts := {}
	for textures: Array in [[], [1], [7], [1, 7], [0, 2, 3, 4, 5, 6, 8]]:
		var layer := make_layer()
		layer.ground_textures = PackedInt32Array(textures)
		var scatter := make_on(node, false, layer)
		await settle(scatter)
		var stand := all_transforms(scatter)
		counts[textures] = stand.size()
		var in_hole := stand.filter(func(one: Transform3D) -> bool: return one.origin.x > -23.5 and one.origin.x < -5.5)
		check_equal(in_hole.size(), 0, "instances in the hole")
		if textures == [1]:
			check(stand.all(func(one: Transform3D) -> bool: return one.origin.z < 2.0), "texture 1 lies in front")
		scatter.free()
	check(counts[[]] > 500, "instances: %d" % counts[[]])
	check_equal(counts[[1, 7]], counts[[]], "both textures are everything")
	check(counts[[1]] > 100 and counts[[7]] > 100, "halves: %s" % counts)
	check_equal(counts[[0, 2, 3, 4, 5, 6, 8]], 0, "textures that are nowhere")
	var on := make_on(node)
	await settle(on)
	var before := all_transforms(on).size()
	colors.fill(Color.WHITE)
	node.get_data().region_changed.emit(20, 0, 10, size, HTerrainLikeData.CHANNEL_COLOR)
	on.regenerate()
	await settle(on)
	check(all_transforms(on).size() > before, "the hole is filled")


## Tiles that were made since the scatter was settled, once it is again.
func made_again(scatter: TerrainScatter3D, edit: Callable) -> Array[Vector2i]:
	var made: Array[Vector2i] = []
	var note := func(_layer: int, tile: Vector2i) -> void: made.push_back(tile)
	scatter.tile_shown.connect(note)
	edit.call()
	await settle(scatter)
	scatter.tile_shown.disconnect(note)
	return made


func test_an_edit_makes_its_tiles_anew() -> void:
	for thread_safe: bool in [false, true]:
		var node := Terrain3DLike.new()
		var scatter := make_on(node, thread_safe)
		await settle(scatter)
		var before := digests(scatter, 0)
		var edit := func() -> void:
			node.data.lift = 2.0
			node.data.maps_edited.emit(AABB(Vector3(34.0, -5.0, 34.0), Vector3(8.0, 50.0, 8.0)))
		var made := await made_again(scatter, edit)
		check_equal(made, [Vector2i(1, 1)] as Array[Vector2i], "tiles made anew")
		var after := digests(scatter, 0)
		for tile: Vector2i in before:
			check_equal(after[tile] == before[tile], tile != Vector2i(1, 1), "tile %s" % tile)
		var everything := func() -> void: scatter.terrain.terrain_changed.emit(Rect2())
		made = await made_again(scatter, everything)
		check_equal(made.size(), before.size(), "an empty rect stands for everything")
		scatter.free()
		node.free()
		errors.take()
