extends "terrain_likes_harness.gd"
## Tests ground from a node: nodes that are added, removed or return invalid values.

## A node whose get_height returns invalid values.
class Wrong extends Node3D:
	var answer: Variant = "high"

	func get_height(_at: Vector3) -> Variant:
		return answer


func test_nodes_without_textures() -> void:
	for node: Node3D in [Terrain3DLike.new(), HTerrainLike.new(), Slope.new()]:
		var scatter := make_on(node)
		scatter.layers[0].ground_textures = PackedInt32Array([0])
		await settle(scatter)
		var problems := "\n".join(scatter.get_problems())
		check_equal("ground_textures has no effect" in problems, not node is Terrain3DLike, "a warning for %s" % node)


func test_any_object() -> void:
	var node := Slope.new()
	var slow := make_on(node)
	await settle(slow)
	check(not node.called_on_worker, "called on the main thread")
	var fast := make_on(node, true)
	await settle(fast)
	check(node.called_on_worker, "the node is called on workers")
	check_equal(digests(slow, 0), digests(fast, 0), "the instances are the same on workers")
	check(slow.get_stats()["instances"] > 1000, "many instances are placed")
	check(slow.ground.get_normal(Vector3.ZERO).distance_to(Vector3(-1.0, 1.0, 0.0).normalized()) < 1e-5, "the normal of the slope")
	node.rise = 0.0
	slow.regenerate()
	await settle(slow)
	check(absf(all_transforms(slow)[0].origin.y) < 1e-5, "the instances are at the new height")


func test_objects_do_not_depend_on_tiles() -> void:
	for thread_safe: bool in [false, true]:
		var scatter := make_on(Terrain3DLike.new(), thread_safe)
		var node := scatter.get_node((scatter.ground as ScatterGroundNode).node)
		await check_tiling(scatter.ground, "an object")
		scatter.free()
		node.free()


func test_an_edit_regenerates_its_tiles() -> void:
	for thread_safe: bool in [false, true]:
		var node := Terrain3DLike.new()
		var scatter := make_on(node, thread_safe)
		# The ground is raised everywhere, but only a part is reported. Re-checks would find the rest.
		scatter.ground.recheck_enabled = false
		await settle(scatter)
		var before := digests(scatter, 0)
		var edit := func() -> void:
			node.data.lift = 2.0
			node.data.maps_edited.emit(AABB(Vector3(34.0, -5.0, 34.0), Vector3(8.0, 50.0, 8.0)))
		var regenerated_tiles := await regenerated_by(scatter, edit)
		check_equal(regenerated_tiles, [Vector2i(1, 1)] as Array[Vector2i], "regenerated tiles")
		var after := digests(scatter, 0)
		for tile: Vector2i in before:
			check_equal(after[tile] == before[tile], tile != Vector2i(1, 1), "tile %s" % tile)
		var everything := func() -> void: scatter.ground.ground_changed.emit(Rect2())
		regenerated_tiles = await regenerated_by(scatter, everything)
		check_equal(regenerated_tiles.size(), before.size(), "an empty rect regenerates everything")
		scatter.free()
		node.free()
		errors.take()


func test_the_node_is_removed_and_added() -> void:
	for thread_safe: bool in [false, true]:
		var node := Slope.new()
		node.name = "Ground"
		var viewer := make_viewer()
		root.add_child(node)
		var terrain := ScatterGroundNode.new()
		terrain.thread_safe = thread_safe
		var scatter := make_scatter([make_layer()], terrain, viewer)
		terrain.node = ^"../Ground"
		await settle(scatter)
		var before := digests(scatter, 0)
		check(before.size() > 10, "many tiles are visible")
		root.remove_child(node)
		await settle(scatter)
		check_error(["ScatterGroundNode.node", "../Ground"], "the node is gone")
		check_equal(digests(scatter, 0), before, "instances after the node was removed")
		check("../Ground" in "\n".join(scatter.get_problems()), "the missing node is reported as a problem")
		viewer.global_position.x = 40.0
		await settle(scatter)
		check_no_error("new tiles without the node")
		viewer.global_position.x = 0.0
		root.add_child(node)
		await settle(scatter)
		check_no_error("the node is back")
		check_equal(scatter.get_problems().size(), 0, "no problems")
		check_equal(shared(digests(scatter, 0), before), before, "instances after the node was added again")
		node.free()
		await settle(scatter)
		check_error(["ScatterGroundNode.node", "../Ground"], "the node is freed")
		check_equal(shared(digests(scatter, 0), before), before, "instances after the node was freed")
		check(is_nan(terrain.get_height(Vector3.ZERO)), "no height without the node")
		errors.take()
		scatter.free()


func test_the_node_is_freed_during_the_work() -> void:
	for thread_safe: bool in [false, true]:
		for wait in [1, 2, 3, 5, 8]:
			var node := Terrain3DLike.new()
			var layer := make_layer(0.5)
			var scatter := make_on(node, thread_safe, layer)
			await frames(wait)
			node.queue_free()
			await settle(scatter)
			check_error(["ScatterGroundNode.node"], "freed after %d frames" % wait)
			scatter.free()


func test_wrong_objects() -> void:
	var plain := Node3D.new()
	plain.name = "Plain"
	root.add_child(plain)
	var scatter := make_on(plain)
	await settle(scatter)
	check_error(["ScatterGroundNode.node", "Plain", "Node3D", "get_height"], "a node without heights")
	check_equal(scatter.get_stats()["tiles"], 0, "tiles without ground")
	var terrain: ScatterGroundNode = scatter.ground
	terrain.node = ^"../Nobody"
	await settle(scatter)
	check_error(["ScatterGroundNode.node", "../Nobody"], "no node")
	terrain.node = ^""
	await settle(scatter)
	check_error(["ScatterGroundNode.node is missing"], "an empty path")
	var node := Slope.new()
	root.add_child(node)
	terrain.node = scatter.get_path_to(node)
	await settle(scatter)
	var before := digests(scatter, 0)
	check(before.size() > 10, "a valid node has tiles")
	terrain.node = ^"../Plain"
	await settle(scatter)
	check_error(["ScatterGroundNode.node", "Plain"], "a node without heights after a valid one")
	check_equal(digests(scatter, 0), before, "the instances do not change")
	for thread_safe: bool in [false, true]:
		for answer: Variant in ["high", null, Vector3.ONE, plain]:
			var wrong := Wrong.new()
			wrong.answer = answer
			var on_wrong := make_on(wrong, thread_safe)
			await settle(on_wrong)
			check_error(["ScatterGroundNode.node", "height method", "wrong type", "Return a float"], "a result of %s" % answer)
			check_equal(on_wrong.get_stats()["instances"], 0, "instances on a height of the wrong type")
			wrong.answer = 5
			on_wrong.regenerate()
			await settle(on_wrong)
			check(on_wrong.get_stats()["instances"] > 1000, "instances on an integer height")
			on_wrong.free()


func test_a_failure_keeps_the_instances() -> void:
	var node := Wrong.new()
	node.answer = 1.0
	var scatter := make_on(node)
	await settle(scatter)
	var before := digests(scatter, 0)
	check(before.size() > 10, "many tiles are visible")
	node.answer = "low"
	scatter.regenerate()
	await settle(scatter)
	check_error(["ScatterGroundNode.node"], "a wrong result")
	check_equal(digests(scatter, 0), before, "instances after a wrong result")
	await frames(60)
	check_no_error("a re-check does not report it again")


func test_a_shared_ground_survives_its_first_node() -> void:
	var node := Slope.new()
	var first := make_on(node)
	var second := make_scatter([make_layer()], first.ground, make_viewer())
	await settle(first)
	await settle(second)
	check_equal(digests(first, 0), digests(second, 0), "both scatters have the same instances")
	var before := digests(second, 0)
	first.free()
	await settle(second)
	check_equal(digests(second, 0), before, "the second scatter keeps its instances after the first was freed")
	node.rise = 2.0
	second.regenerate()
	await settle(second)
	check_no_error("regenerate after the first node was freed")
	check(digests(second, 0) != before, "the ground is read again")
