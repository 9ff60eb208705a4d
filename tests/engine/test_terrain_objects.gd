extends "terrain_harness.gd"
## Ground that another node gives: doubles of Terrain3D and of HTerrain, nodes that go, come, or give the wrong things.

## Behaves like Terrain3D's data: heights and normals with a round hole, textures by halves, told edits.
class Terrain3DLikeData extends Object:
	signal maps_edited(area: AABB)
	signal maps_changed
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


## The same with posts that are farther apart.
class SparseTerrain3DLike extends Terrain3DLike:
	var vertex_spacing := 4.0


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


## Tells of edits as HTerrain does since July 2026.
class LaterHTerrainLikeData extends Resource:
	signal region_changed(rect: Rect2i, channel: int, index: int)
	var lift := 7.0

	func get_map_count(_map_type: int) -> int:
		return 0

	func get_resolution() -> int:
		return HTerrainLikeData.SIZE

	func get_interpolated_height_at(at: Vector3) -> float:
		return lift + 0.5 * clampf(at.x, 0.0, HTerrainLikeData.SIZE - 1.0)


class HTerrainLike extends Node3D:
	signal transform_changed(to: Transform3D)
	var map_scale := Vector3(2.0, 3.0, 2.0)
	var _data: Resource = HTerrainLikeData.new()

	func get_data() -> Resource:
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
	var normal := Vector3(-0.2, 1.0, -0.3).normalized()
	check(terrain.get_normal(Vector3(20.0, 5.0, 0.0)).distance_to(normal) < 1e-5, "normal")
	var rects: Array[Rect2] = []
	terrain.terrain_changed.connect(func(rect: Rect2) -> void: rects.push_back(rect))
	node.data.maps_edited.emit(AABB(Vector3(1.0, -5.0, 2.0), Vector3(3.0, 50.0, 4.0)))
	check_equal(rects, [Rect2(1.0, 2.0, 3.0, 4.0)] as Array[Rect2], "the edited area")


func test_edits_of_sparse_terrain3d_like() -> void:
	var node := SparseTerrain3DLike.new()
	var scatter := make_on(node)
	await settle(scatter)
	var rects: Array[Rect2] = []
	scatter.terrain.terrain_changed.connect(func(rect: Rect2) -> void: rects.push_back(rect))
	node.data.maps_edited.emit(AABB(Vector3(1.0, -5.0, 2.0), Vector3(3.0, 50.0, 4.0)))
	check_equal(rects, [Rect2(-7.0, -6.0, 19.0, 20.0)] as Array[Rect2], "the edited area and two posts around it")
	var count := digests(scatter, 0).size()
	node.data.lift = 3.0
	var made := await made_again(scatter, func() -> void: node.data.maps_changed.emit())
	check_equal(made.size(), count, "what a script has changed somewhere makes all anew")


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


func test_textures_that_a_node_has_not() -> void:
	for node: Node3D in [Terrain3DLike.new(), HTerrainLike.new(), Slope.new()]:
		var scatter := make_on(node)
		scatter.layers[0].ground_textures = PackedInt32Array([0])
		await settle(scatter)
		var problems := "\n".join(scatter.get_problems())
		check_equal("ground_textures has no effect" in problems, not node is Terrain3DLike, "a warning of %s" % node)


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


func test_later_hterrain_like() -> void:
	var node := HTerrainLike.new()
	node._data = LaterHTerrainLikeData.new()
	var scatter := make_on(node)
	await settle(scatter)
	var rects: Array[Rect2] = []
	scatter.terrain.terrain_changed.connect(func(rect: Rect2) -> void: rects.push_back(rect))
	node._data.region_changed.emit(Rect2i(32, 32, 4, 4), 0, 0)
	if check_equal(rects.size(), 1, "an edit"):
		var world := node.get_internal_transform() * Vector3(34, 0, 34)
		check(rects[0].has_point(Vector2(world.x, world.z)), "%s is in %s" % [world, rects[0]])
		check(rects[0].size.x > 8.0 and rects[0].size.x < 30.0, "the edited area is small: %s" % rects[0])


func test_a_node_that_has_other_data_is_asked_again() -> void:
	for how: String in ["regenerate", "terrain_changed"]:
		var node := HTerrainLike.new()
		var scatter := make_on(node)
		await settle(scatter)
		var before := all_transforms(scatter)
		node._data = LaterHTerrainLikeData.new()
		if how == "regenerate":
			scatter.regenerate()
		else:
			scatter.terrain.terrain_changed.emit(Rect2())
		await settle(scatter)
		var after := all_transforms(scatter)
		var higher := after[0].origin.y - before[0].origin.y
		check(after.size() == before.size() and absf(higher - 7.0 * node.map_scale.y) < 0.01, "%s: %f m higher" % [how, higher])
		scatter.free()
		node.free()


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


func test_objects_do_not_know_tiles() -> void:
	for thread_safe: bool in [false, true]:
		var scatter := make_on(Terrain3DLike.new(), thread_safe)
		var node := scatter.get_node((scatter.terrain as ScatterTerrainObject).node)
		await check_tiling(scatter.terrain, "an object")
		scatter.free()
		node.free()


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
