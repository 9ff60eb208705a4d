extends "harness.gd"
## Scenes in place of meshes: what comes and goes when, and that nothing ever stands twice or not at all.

const DISTANCE := 20.0
const LEAVE := 1.1 * DISTANCE + 1.0

## The root of the scenes.
class Plant extends Node3D:
	static var made := 0
	static var hooks: Dictionary[StringName, Callable] = {}  # What to do in _init, _ready, _scatter_shown, _scatter_hidden.

	var id := 0
	var layer := -1
	var data: Variant
	var times_shown := 0
	var times_hidden := 0
	var ready_at: Transform3D

	func _init() -> void:
		made += 1
		_meddle(&"_init")

	func _ready() -> void:
		ready_at = global_transform
		_meddle(&"_ready")

	func _scatter_shown(p_id: int, p_layer: int, p_data: Variant) -> void:
		id = p_id
		layer = p_layer
		data = p_data
		times_shown += 1
		_meddle(&"_scatter_shown")

	func _scatter_hidden() -> void:
		times_hidden += 1
		_meddle(&"_scatter_hidden")

	func _meddle(place: StringName) -> void:
		if hooks.has(place):
			hooks[place].call(self)


var shown: Dictionary[int, int] = {}  # How often a scene came for an id,
var hidden: Dictionary[int, int] = {}  # and went.
var standing_scenes: Dictionary[int, Node3D] = {}
var viewer: Node3D
var meddled: TerrainScatter3D


func clean() -> void:
	Plant.hooks.clear()
	await super()


func pack(node: Node) -> PackedScene:
	var scene := PackedScene.new()
	scene.pack(node)
	node.free()
	return scene


func make_plants(radius := 2.0) -> ScatterLayer:
	var layer := make_layer(radius)
	layer.resource_name = "Plants"
	layer.min_scale = 0.5
	layer.max_scale = 2.0
	layer.scene = pack(Plant.new())
	layer.scene_distance = DISTANCE
	return layer


func make_garden(layers: Array[ScatterLayer], at := Vector3.ZERO) -> TerrainScatter3D:
	Plant.made = 0
	shown.clear()
	hidden.clear()
	standing_scenes.clear()
	viewer = make_viewer(at)
	var scatter := make_scatter(layers, ScatterTerrainFlat.new(), viewer)
	scatter.scene_shown.connect(func(id: int, scene: Node3D) -> void:
		shown[id] = shown.get(id, 0) + 1
		check(not standing_scenes.has(id), "no second scene of %d" % id)
		standing_scenes[id] = scene)
	scatter.scene_hidden.connect(func(id: int, scene: Node3D) -> void:
		hidden[id] = hidden.get(id, 0) + 1
		check(standing_scenes.get(id) == scene, "the scene that came goes")
		standing_scenes.erase(id))
	return scatter


## The instances that the picture has in the tiles on show, by id.
func drawn(scatter: TerrainScatter3D, layer := 0) -> Dictionary[int, bool]:
	var ids: Dictionary[int, bool] = {}
	for tile: Vector2i in scatter.get_shown_tiles(layer):
		var buffers: Array = scatter.get_tile_buffers(layer, tile)
		var parts: Array = scatter.get_tile_ids(layer, tile)
		for part in parts.size():
			check_equal((buffers[part] as PackedFloat32Array).size(), 12 * (parts[part] as PackedInt64Array).size(),
					"floats of the picture")
			for id in parts[part] as PackedInt64Array:
				check(not ids.has(id), "%d is drawn once" % id)
				ids[id] = true
	return ids


## The scenes in the tree, by id.
func scenes_of(scatter: TerrainScatter3D) -> Dictionary[int, Node3D]:
	var found: Dictionary[int, Node3D] = {}
	for child in scatter.get_children(true):
		if child is Plant and not child.is_queued_for_deletion():
			found[child.id] = child
	return found


## What the picture or a scene shows.
func everything_of(scatter: TerrainScatter3D) -> Dictionary[int, bool]:
	var ids := drawn(scatter)
	for id in scenes_of(scatter):
		ids[id] = true
	return ids


## Every instance is in the picture or has a scene, and none is both; of those that are given or, without any, of all that one of both has.
func check_once(scatter: TerrainScatter3D, ids: Dictionary, what: String) -> void:
	var picture := drawn(scatter)
	var scenes := scenes_of(scatter)
	for id in ids:
		if picture.has(id) == scenes.has(id):
			check(false, "%s: %d is %s" % [what, id, "there twice" if scenes.has(id) else "not there"])
			return
	for id in scenes:
		if picture.has(id) or scatter.get_scene(id) != scenes[id]:
			check(false, "%s: %d is drawn beside its scene" % [what, id])
			return
	check(true, what)


func test_swap_at_the_distance() -> void:
	var scatter := make_garden([make_plants()], Vector3(-60, 0, 3))
	scatter.upload_budget_usec = 1000000
	await settle(scatter)
	var forest := scatter.query_rect(Rect2(-90, -40, 160, 80))
	var ids: PackedInt64Array = forest["ids"]
	var places: PackedVector3Array = forest["positions"]
	check(ids.size() > 1000, "%d instances" % ids.size())
	var near: Dictionary[int, bool] = {}
	var came: Dictionary[int, int] = {}
	for step in 132:
		viewer.global_position.x = -60.0 + (step if step <= 90 else 180 - step)
		await frames(1)
		await settle(scatter)
		for index in ids.size():
			var away := viewer.global_position.distance_to(places[index])
			var is_near := away <= (LEAVE if near.has(ids[index]) else DISTANCE)
			if is_near and not near.has(ids[index]):
				near[ids[index]] = true
				came[ids[index]] = came.get(ids[index], 0) + 1
			elif not is_near:
				near.erase(ids[index])
			if (scatter.get_scene(ids[index]) != null) != near.has(ids[index]):
				check(false, "step %d: %d at %f m has %s" % [step, ids[index], away, scatter.get_scene(ids[index])])
				return
		check_equal(scatter.get_stats()["scenes"], near.size(), "scenes")
	check(came.values().max() == 2 and came.size() > 200, "the walk goes there and back: %d" % came.size())
	check_equal(shown, came, "scenes came")
	for id in shown:
		check_equal(hidden.get(id, 0), shown[id] - (1 if near.has(id) else 0), "and went")


func test_stands_as_the_instance() -> void:
	var layer := make_plants()
	var scatter := make_garden([null, layer])
	scatter.position = Vector3(5, 6, 7)  # Does not move instances.
	scatter.scale = Vector3(2, 2, 2)
	await settle(scatter)
	var near: Dictionary = scatter.query_sphere(Vector3.ZERO, 10.0)
	for id: int in near["ids"]:
		var scene: Plant = scatter.get_scene(id)
		if not check(scene != null and scene.get_parent() == scatter, "a child for %d" % id):
			continue
		var expected: Transform3D = scatter.get_instance(id)["transform"]
		check(scene.global_transform.is_equal_approx(expected), "%s is at %s" % [scene.global_transform, expected])
		check_equal(scene.layer, 1, "layer")
		check_equal(scene.data, null, "data")
	check(near["ids"].size() > 50, "many")
	check_equal(scatter.get_child_count(), 0, "all are internal")
	scatter.position = Vector3(9, 9, 9)
	await frames(2)
	var id: int = near["ids"][0]
	check(scatter.get_scene(id).global_transform.is_equal_approx(scatter.get_instance(id)["transform"]), "still there")
	scatter.set_instance_data(id, {"age": 70})
	viewer.position.x = 1000.0
	await settle(scatter)
	check(scatter.get_scene(id) == null, "left")
	viewer.position.x = 0.0
	await settle(scatter)
	check_equal((scatter.get_scene(id) as Plant).data, {"age": 70}, "data of the instance")


## In every frame of a walk with jumps, edits of the ground, felling, thinning: everything once.
func test_everything_once_in_every_frame() -> void:
	var layer := make_plants(3.0)
	layer.view_distance = 48.0
	var scatter := make_garden([layer])
	scatter.upload_budget_usec = 1500
	await settle(scatter)
	var random := RandomNumberGenerator.new()
	random.seed = 3
	var felled: PackedInt64Array = []
	var speed := Vector3(0.7, 0, 0.3)
	for step in 300:
		speed = speed.rotated(Vector3.UP, random.randf_range(-0.3, 0.3))
		viewer.global_position += speed
		match random.randi_range(0, 30):
			0: viewer.global_position = Vector3(random.randf_range(-100, 100), 0, random.randf_range(-100, 100))
			1: scatter.regenerate()
			2: layer.max_scale = random.randf_range(1.0, 3.0)
			3: scatter.quality = random.randf_range(0.5, 1.0)
			4, 5, 6:
				var near := scenes_of(scatter).keys()
				if not near.is_empty():
					felled.push_back(near[random.randi_range(0, near.size() - 1)])
					check(scatter.remove_instance(felled[-1]), "felled")
			7:
				if not felled.is_empty():
					check(scatter.restore_instance(felled[-1]), "restored")
					felled.resize(felled.size() - 1)
		await process_frame
		check_once(scatter, {}, "step %d" % step)
		var tiles := scatter.get_shown_tiles(0)
		var standing: Dictionary[int, bool] = {}
		for tile: Vector2i in tiles:
			for id: int in scatter.query_rect(Rect2(Vector2(tile) * 32.0, Vector2(32, 32)))["ids"]:
				standing[id] = true
		check_once(scatter, standing, "step %d, of those that stand" % step)
		for id in felled:
			check(scatter.get_scene(id) == null and not scenes_of(scatter).has(id), "a felled one has no scene")
	check(shown.size() > 200, "%d scenes came" % shown.size())
	await settle(scatter)
	check_equal(scatter.get_stats()["scenes"], standing_scenes.size(), "scenes by their signals")


func test_budget_and_order() -> void:
	var scatter := make_garden([make_plants()], Vector3(5000, 0, 0))
	await settle(scatter)
	scatter.upload_budget_usec = 1
	var places: Dictionary[int, Vector3] = {}
	var order: Array[int] = []
	scatter.scene_shown.connect(func(id: int, scene: Node3D) -> void:
		order.push_back(id)
		places[id] = scene.global_position)
	viewer.position.x += 15.0
	var before_frame := -1
	while before_frame < 0 or not scatter.is_idle():
		before_frame = shown.size() + hidden.size()
		await process_frame
		check(shown.size() + hidden.size() - before_frame <= 1, "one a frame")
	check(order.size() > 50, "%d came" % order.size())
	for index in range(1, order.size()):
		var before := places[order[index - 1]].distance_to(viewer.position)
		check(places[order[index]].distance_to(viewer.position) >= before - 1e-3, "the nearest first")


func test_pool() -> void:
	var layer := make_plants()
	var scatter := make_garden([layer])
	await settle(scatter)
	var at_once: int = scatter.get_stats()["scenes"]
	check_equal(Plant.made, at_once, "made")
	check(at_once > 100, "more than the pool holds")
	viewer.position.x = 500.0
	await settle(scatter)
	check(Plant.made <= 2 * at_once, "some are used again")
	layer.scene_distance = 3.0
	await settle(scatter)
	check_equal(scatter.get_stats()["scenes_pooled"], 64, "the pool is full")
	var made := Plant.made
	var often := 0
	for step in 20:
		viewer.position.x += 7.0
		await settle(scatter)
		for plant: Plant in scenes_of(scatter).values():
			often = maxi(often, plant.times_shown)
			check_equal(plant.times_hidden, plant.times_shown - 1, "told each time")
	check_equal(Plant.made, made, "nothing is made where a pool has some")
	check(often > 5, "used again and again: %d times" % often)
	layer.scene = pack(Plant.new())
	await settle(scatter)
	check_equal(scatter.get_stats()["scenes_pooled"], 0, "scenes of another kind are freed")
	check(Plant.made > made + 1 and scatter.get_stats()["scenes"] > 0, "and made anew")
	layer.scene = null
	await settle(scatter)
	check_equal(scatter.get_stats()["scenes"], 0, "no scene")
	check_once(scatter, drawn(scatter), "meshes instead")


func show_walk_and_free() -> void:
	var layer := make_plants()
	layer.min_height = -5.0
	var scatter := make_garden([layer])
	for step in 5:
		viewer.position.x += 11.0
		await settle(scatter)
	scatter.remove_instance(scatter.query_nearest(viewer.position, 20.0)["id"])
	if viewer.position.z > 0.0:
		scatter.free()
	else:
		scatter.queue_free()
	await clean()


func test_nothing_is_left() -> void:
	var nodes: Array[float] = []
	var orphans: Array[float] = []
	for round in 3:
		await show_walk_and_free()
		await frames(3)
		nodes.push_back(Performance.get_monitor(Performance.OBJECT_NODE_COUNT))
		orphans.push_back(Performance.get_monitor(Performance.OBJECT_ORPHAN_NODE_COUNT))
	check_equal(nodes[2], nodes[0], "nodes")
	check_equal(orphans[2], 0.0, "orphans")


func test_out_of_the_tree() -> void:
	var scatter := make_garden([make_plants()])
	await settle(scatter)
	check(not standing_scenes.is_empty(), "scenes")
	standing_scenes.clear()
	root.remove_child(scatter)
	check_equal(scatter.get_stats()["scenes"], 0, "scenes outside of the tree")
	check_equal(scatter.get_child_count(true), 0, "children")
	check(hidden.is_empty(), "nobody is told")
	root.add_child(scatter)
	await settle(scatter)
	check(not standing_scenes.is_empty(), "scenes again")
	standing_scenes.clear()
	scatter.terrain = null
	await frames(2)
	check_equal(scatter.get_child_count(true), 0, "children without ground")


func test_felled_and_taken() -> void:
	var scatter := make_garden([make_plants()])
	await settle(scatter)
	var near: PackedInt64Array = scatter.query_sphere(Vector3.ZERO, 15.0)["ids"]
	var everything := everything_of(scatter)
	var scene: Plant = scatter.get_scene(near[0])
	check(scatter.remove_instance(near[0]), "felled")
	check(scatter.get_scene(near[0]) == null, "gone at once")
	await process_frame
	check(not scene.is_inside_tree() and scene.times_hidden == 1 and hidden[near[0]] == 1, "back in the pool")
	everything.erase(near[0])
	check_once(scatter, everything, "felled")

	var taken: Array[Node3D] = []
	for turn in 2:  # Taken and felled, in either order.
		var id := near[1 + turn]
		var before: Transform3D = scatter.get_scene(id).global_transform
		if turn == 1:
			scatter.remove_instance(id)
		taken.push_back(scatter.take_scene(id))
		if turn == 0:
			scatter.remove_instance(id)
		check(taken[turn] is Plant and taken[turn].is_inside_tree(), "in the tree")
		check(scatter.take_scene(id) == null and scatter.get_scene(id) == null, "once")
		taken[turn].reparent(root)
		check(taken[turn].global_transform.is_equal_approx(before), "where it was")
		check(not taken[turn].top_level, "an ordinary node")
		everything.erase(id)
		for frame in 3:
			await process_frame
			check_once(scatter, everything, "taken")
		check_equal((taken[turn] as Plant).times_hidden, 0, "not told to hide")
		check(not hidden.has(id), "no signal")

	var kept := scatter.take_scene(near[3])  # Taken, and the instance stands.
	standing_scenes.erase(near[3])
	for frame in 3:
		await process_frame
		check(drawn(scatter).has(near[3]) and scatter.get_scene(near[3]) == null, "its mesh is back")
	kept.free()
	viewer.position.x = 200.0
	await settle(scatter)
	viewer.position.x = 0.0
	await settle(scatter)
	check(scatter.get_scene(near[3]) != null, "a scene again, after it was out of range")
	check(scatter.get_scene(near[1]) == null, "a felled one stays away when its tile comes again")
	scatter.restore_instance(near[1])
	standing_scenes.erase(near[1])
	await settle(scatter)
	check(scatter.get_scene(near[1]) != null, "a restored one gets a scene")
	everything[near[1]] = true
	check_once(scatter, everything, "in the end")
	check(scatter.take_scene(0) == null and scatter.get_scene(-5) == null, "no such id")


func test_hand_placed() -> void:
	var scatter := make_garden([make_plants()])
	await settle(scatter)
	var at := Transform3D(Basis.from_scale(Vector3(3, 3, 3)), Vector3(1, 8, 2))
	var id := scatter.add_instance(0, at)
	await settle(scatter)
	var scene := scatter.get_scene(id)
	check(scene != null and scene.global_transform.is_equal_approx(at), "a scene where it was placed")
	check(not drawn(scatter).has(id), "and no mesh")
	scatter.remove_instance(id)
	check(scatter.get_scene(id) == null, "gone at once")
	await process_frame
	check(not drawn(scatter).has(id), "all of it")


func test_tile_made_anew() -> void:
	var layer := make_plants()
	var scatter := make_garden([layer])
	await settle(scatter)
	var before := scenes_of(scatter)
	var everything := everything_of(scatter)
	scatter.regenerate()
	layer.cast_shadow = GeometryInstance3D.SHADOW_CASTING_SETTING_OFF
	for frame in 30:
		await process_frame
		check_once(scatter, everything, "made anew")
	await settle(scatter)
	check_equal(scenes_of(scatter), before, "the same scenes")
	check(hidden.is_empty(), "none of them went")
	layer.min_scale = 1.0  # Moves nothing, but changes every instance.
	layer.max_scale = 1.0
	await settle(scatter)
	check_equal(scenes_of(scatter), before, "still the same scenes")
	for id in before:
		check(before[id].global_transform.is_equal_approx(scatter.get_instance(id)["transform"]), "as the instance is")
		if before[id].global_transform != before[id].ready_at:
			break
	check(hidden.is_empty(), "none of them went")
	layer.density = 0.5
	await settle(scatter)
	check(not hidden.is_empty() and shown.size() == before.size(), "what stands no longer goes")
	check_once(scatter, {}, "half of it")


func test_recentred() -> void:
	var scatter := make_garden([make_plants()], Vector3(40, 0, 0))
	await settle(scatter)
	var before := scenes_of(scatter)
	var came := shown.size()
	var places: Dictionary[int, Vector3] = {}
	for id in before:
		places[id] = before[id].global_position
	var shift := Vector3(256, 16, -1024)
	viewer.global_position -= shift
	scatter.world_offset = shift
	for id in before:
		check(before[id].global_position.distance_to(places[id] - shift) < 1e-3, "moved at once")
	await settle(scatter)
	check_equal(scenes_of(scatter), before, "the same scenes")
	check(hidden.is_empty() and shown.size() == came, "none came, none went")
	viewer.global_position.x += 30.0
	await settle(scatter)
	check(shown.size() > came, "others came")
	for id in standing_scenes:
		check(standing_scenes[id].global_transform.is_equal_approx(scatter.get_instance(id)["transform"]), "in its place")
	check_once(scatter, everything_of(scatter), "elsewhere")


func test_around_bodies() -> void:
	var scatter := make_garden([make_plants()])
	await settle(scatter)
	var body := make_viewer(Vector3(50, 0, 0))
	body.add_to_group(scatter.body_group)
	await frames(2)
	await settle(scatter)
	for at: Vector3 in [Vector3.ZERO, body.position]:
		var near: Dictionary = scatter.query_nearest(at, 10.0)
		check(scatter.get_scene(near["id"]) != null, "a scene at %s" % at)
	body.free()
	await frames(2)
	await settle(scatter)
	check(scatter.get_scene(scatter.query_nearest(Vector3(50, 0, 0), 10.0)["id"]) == null, "nobody is there any more")


func test_bad_scenes() -> void:
	var layer := make_plants()
	layer.scene = pack(Node.new())
	var scatter := make_garden([layer])
	await settle(scatter)
	check_error(["Plants", "Node3D"], "a root that is no Node3D")
	check_equal(scatter.get_stats()["scenes"], 0, "no scene")
	var everything := drawn(scatter)
	check(everything.size() > 1000, "meshes")
	viewer.position.x = 5.0
	await settle(scatter)
	check_no_error("said once")
	layer.scene = PackedScene.new()
	await settle(scatter)
	check_error(["Plants", "Node3D"], "an empty scene")
	layer.scene = pack(Plant.new())
	await settle(scatter)
	check(scatter.get_stats()["scenes"] > 100, "a good one")
	var fresh := pack(Node3D.new())
	layer.scene = fresh
	await settle(scatter)
	check(scatter.get_stats()["scenes"] > 100, "one without a script")


func count_of(scatter: TerrainScatter3D) -> int:
	return scatter.get_stats()["scenes"]


func test_scenes_that_free_themselves() -> void:
	var scatter := make_garden([make_plants()])
	await settle(scatter)
	var everything := everything_of(scatter)
	var ids := standing_scenes.keys()
	standing_scenes[ids[0]].free()
	standing_scenes[ids[1]].queue_free()
	standing_scenes[ids[2]].reparent(root)
	scatter.remove_child(standing_scenes[ids[3]])
	standing_scenes[ids[3]].queue_free()
	for index in 4:
		standing_scenes.erase(ids[index])
	for frame in 5:
		await process_frame
		check_once(scatter, everything, "scenes that were taken away")
		for index in 4:
			check(drawn(scatter).has(ids[index]), "its mesh is back")
	viewer.position.x += 500.0
	Plant.hooks[&"_scatter_shown"] = func(plant: Plant) -> void: plant.queue_free()
	await settle(scatter)
	standing_scenes.clear()
	for frame in 5:
		await process_frame
		check_once(scatter, drawn(scatter), "scenes that are gone again")
	check_equal(count_of(scatter), 0, "no scene is left")


func test_meddling_scenes() -> void:
	var near := func() -> PackedInt64Array: return meddled.query_sphere(viewer.position, 18.0)["ids"]
	var deeds: Array[Callable] = [
		func(plant: Plant) -> void: meddled.remove_instance(plant.id),
		func(_plant: Plant) -> void: meddled.remove_instance(near.call()[0]),
		func(_plant: Plant) -> void: meddled.remove_in_sphere(viewer.position, 30.0),
		func(plant: Plant) -> void:
			var taken := meddled.take_scene(plant.id)
			if taken != null:
				taken.reparent(root),
		func(plant: Plant) -> void: plant.queue_free(),
		func(_plant: Plant) -> void: meddled.layers = [],
		func(_plant: Plant) -> void: meddled.terrain = null,
		func(_plant: Plant) -> void: meddled.layers[0].scene = null,
		func(_plant: Plant) -> void: root.remove_child(meddled),
		func(_plant: Plant) -> void: meddled.queue_free(),
		func(_plant: Plant) -> void: meddled.free(),
	]
	for place: StringName in [&"_init", &"_ready", &"_scatter_shown", &"_scatter_hidden"]:
		for deed in deeds.size():
			if place == &"_ready" and deed in [8, 10]:
				continue  # No parent may go while a child enters the tree.
			meddled = TerrainScatter3D.new()
			meddled.seed = 7
			meddled.layers = [make_plants(4.0)]
			meddled.terrain = ScatterTerrainFlat.new()
			root.add_child(meddled)
			viewer = make_viewer()
			meddled.viewers = [meddled.get_path_to(viewer)]
			var calls := [0]
			Plant.hooks[place] = func(plant: Plant) -> void:
				calls[0] += 1
				if calls[0] == 5 and is_instance_valid(meddled):
					deeds[deed].call(plant)
			for frame in 40:
				if frame == 20 and place == &"_scatter_hidden":
					viewer.position.x += 400.0
				await process_frame
			Plant.hooks.clear()
			if is_instance_valid(meddled):
				check_once(meddled, {}, "%s: after deed %d" % [place, deed])
			check(calls[0] >= 5, "%s: deed %d is done" % [place, deed])
			if is_instance_valid(meddled):
				meddled.free()
			await clean()
	check_equal(Performance.get_monitor(Performance.OBJECT_ORPHAN_NODE_COUNT), 0.0, "orphans")
