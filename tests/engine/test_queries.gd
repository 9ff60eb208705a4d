extends "harness.gd"
## What a scatter answers equals what a scan of the generated tiles finds, whatever is loaded.

const FLOATS := 2e-3 ## Meters by which a float may be off at these places.
const AREA := Rect2(-96, -96, 192, 192) ## Whole tiles of all layers.

## All that stands by a scan, an entry of each array for each instance.
class Scan:
	var ids: PackedInt64Array
	var layers: PackedInt32Array
	var meshes: PackedInt32Array
	var transforms: Array[Transform3D]

	## Adds all tiles of a layer that lie in `area`, made one by one.
	func add(scatter: TerrainScatter3D, layer: int, area: Rect2) -> void:
		var size := scatter.layers[layer].tile_size
		for x in range(roundi(area.position.x / size), roundi(area.end.x / size)):
			for z in range(roundi(area.position.y / size), roundi(area.end.y / size)):
				var built := scatter.build_rect(layer, Rect2(x * size, z * size, size, size))
				for mesh in built.get_mesh_count():
					_add_mesh(layer, mesh, built.get_origin(), built.get_ids(mesh), built.get_buffer(mesh))

	func _add_mesh(layer: int, mesh: int, origin: Vector3, mesh_ids: PackedInt64Array,
			buffer: PackedFloat32Array) -> void:
		var stride := buffer.size() / maxi(mesh_ids.size(), 1)
		for index in mesh_ids.size():
			ids.push_back(mesh_ids[index])
			layers.push_back(layer)
			meshes.push_back(mesh)
			transforms.push_back(TilePlace.read(buffer, index * stride, origin))

	func without(gone: PackedInt64Array) -> Scan:
		var result := Scan.new()
		for index in ids.size():
			if not gone.has(ids[index]):
				result.ids.push_back(ids[index])
				result.layers.push_back(layers[index])
				result.meshes.push_back(meshes[index])
				result.transforms.push_back(transforms[index])
		return result


class TilePlace:
	## The transform whose 12 floats start at a place of a buffer.
	static func read(floats: PackedFloat32Array, at: int, origin := Vector3.ZERO) -> Transform3D:
		return Transform3D(
				Vector3(floats[at], floats[at + 4], floats[at + 8]),
				Vector3(floats[at + 1], floats[at + 5], floats[at + 9]),
				Vector3(floats[at + 2], floats[at + 6], floats[at + 10]),
				origin + Vector3(floats[at + 3], floats[at + 7], floats[at + 11]))


## Leaning trees, and ferns that stand off their points and keep away from trees. Tiles of 32 and 24 meters.
func make_wood(viewer: Node3D) -> TerrainScatter3D:
	var trees := make_layer(4.0)
	trees.resource_name = "trees"
	trees.layer_id = 3
	trees.meshes = [BoxMesh.new(), SphereMesh.new()]
	trees.min_scale = 0.6
	trees.max_scale = 1.7
	trees.max_tilt_degrees = 20.0
	trees.instance_radius = 0.5
	trees.instance_height = 9.0
	var ferns := make_layer(1.6)
	ferns.layer_id = 4
	ferns.tile_size = 24.0
	ferns.align_to_normal = 1.0
	ferns.offset_along_normal = -1.2
	ferns.spacing = {"trees": 1.5}
	ferns.instance_radius = 0.7
	ferns.instance_height = 0.8
	ferns.use_custom_data = true
	var noise := FastNoiseLite.new()
	noise.frequency = 0.02
	var ground := ScatterTerrainNoise.new()
	ground.noise = noise
	ground.amplitude = 9.0
	return make_scatter([trees, ferns], ground, viewer)


func scan(scatter: TerrainScatter3D) -> Scan:
	var result := Scan.new()
	result.add(scatter, 0, AREA)
	result.add(scatter, 1, AREA)
	return result


## Compares an answer with all of a scan for which `depth` (meters inside, negative outside) is above 0, to within
## floats. Returns how many there are.
func check_answer(answer: ScatterInstances, all: Scan, layers: PackedInt32Array, depth: Callable, what: String) -> int:
	var ids := answer.ids
	var place := {}
	for index in ids.size():
		place[ids[index]] = index
	var wrong := 0
	for index in all.ids.size():
		var wanted := layers.is_empty() or layers.has(all.layers[index])
		var inside: float = depth.call(all.transforms[index].origin) if wanted else -1.0
		var at: int = place.get(all.ids[index], -1)
		if at < 0:
			wrong += int(inside > FLOATS)
			continue
		var stands := TilePlace.read(answer.transforms, at * 12)
		wrong += int(inside < -FLOATS or answer.get_layer(at) != all.layers[index] or
				answer.get_mesh(at) != all.meshes[index] or stands.basis != all.transforms[index].basis or
				stands.origin.distance_to(all.transforms[index].origin) > FLOATS or
				answer.positions[at] != stands.origin or answer.get_position(at) != stands.origin or
				answer.get_transform(at) != stands or answer.get_id(at) != all.ids[index])
		place.erase(all.ids[index])
	check(wrong == 0 and place.is_empty(), "%s: %d wrong, %d too many of %d" % [what, wrong, place.size(), ids.size()])
	var of_layers := answer.layers
	for index in range(1, ids.size()):
		if of_layers[index - 1] == of_layers[index] and ids[index - 1] >= ids[index]:
			check(false, what + ": sorted by id")
	return ids.size()


## Where a ray first touches an instance's cylinder, as a share of its way; 2 for nowhere.
func first_touch(layer: ScatterLayer, at: Transform3D, from: Vector3, to: Vector3) -> float:
	var inverse := at.affine_inverse()
	var start := inverse * from
	var way := inverse * to - start
	var shares: Array[float] = [0.0, -start.y / way.y, (layer.instance_height - start.y) / way.y]
	var a := way.x * way.x + way.z * way.z
	var b := start.x * way.x + start.z * way.z
	var c := start.x * start.x + start.z * start.z - layer.instance_radius ** 2
	shares.push_back((-b - sqrt(b * b - a * c)) / a if b * b > a * c else 2.0)
	var first := 2.0
	for share in shares:
		var touch := start + share * way
		var inside := touch.y > -1e-4 and touch.y < layer.instance_height + 1e-4 and \
				Vector2(touch.x, touch.z).length() < layer.instance_radius + 1e-4
		if share >= 0.0 and share <= 1.0 and inside:
			first = minf(first, share)
	return first


func check_ray(scatter: TerrainScatter3D, all: Scan, from: Vector3, to: Vector3, layers: PackedInt32Array) -> bool:
	var first := 2.0
	var id := 0
	for index in all.ids.size():
		if layers.is_empty() or layers.has(all.layers[index]):
			var touch := first_touch(scatter.layers[all.layers[index]], all.transforms[index], from, to)
			if touch < first:
				first = touch
				id = all.ids[index]
	var hit := scatter.query_ray(from, to, layers)
	var same: bool = hit.is_empty() if first > 1.0 else \
			not hit.is_empty() and absf(hit["distance"] - first * from.distance_to(to)) < 0.01 and \
			(hit["position"] as Vector3).distance_to(from.lerp(to, first)) < 0.01
	check(same, "a ray from %s to %s meets %d at %f: %s" % [from, to, id, first, hit])
	return first <= 1.0


func check_nearest(scatter: TerrainScatter3D, all: Scan, at: Vector3, distance: float,
		layers: PackedInt32Array) -> bool:
	var best := INF
	var id := 0
	for index in all.ids.size():
		var to := all.transforms[index].origin.distance_to(at)
		if (layers.is_empty() or layers.has(all.layers[index])) and to < best:
			best = to
			id = all.ids[index]
	if absf(best - distance) < FLOATS:
		return false
	var found := scatter.query_nearest(at, distance, layers)
	var same: bool = found == null if best > distance else \
			found != null and found.id == id and absf(found.distance - best) < FLOATS
	check(same, "nearest to %s is %d, %f m away: %s" % [at, id, best, found])
	return best < distance


## Asks random questions of all kinds; within the middle of AREA, so that the scan holds all that may be an answer.
func check_all(scatter: TerrainScatter3D, all: Scan, random: RandomNumberGenerator, what: String) -> void:
	var counts := {"rect": 0, "sphere": 0, "hits": 0, "near": 0}
	for round in 14:
		var layers: PackedInt32Array = [[], [], [0], [1], [1, 0]][random.randi() % 5]
		var at := Vector3(random.randf_range(-50, 50), random.randf_range(-4, 20), random.randf_range(-50, 50))
		var rect := Rect2(at.x, at.z, random.randf_range(0, 30), random.randf_range(0, 30))
		counts["rect"] += check_answer(scatter.query_rect(rect, layers), all, layers, func(place: Vector3) -> float:
			return minf(minf(place.x - rect.position.x, rect.end.x - place.x),
					minf(place.z - rect.position.y, rect.end.y - place.z)), "%s: %s" % [what, rect])
		var radius := random.randf_range(0.5, 30)
		counts["sphere"] += check_answer(scatter.query_sphere(at, radius, layers), all, layers,
				func(place: Vector3) -> float: return radius - place.distance_to(at), "%s: sphere" % what)
		var mark := all.transforms[random.randi() % all.ids.size()].origin.clamp(-50 * Vector3.ONE, 50 * Vector3.ONE)
		var away := Vector3(random.randf_range(-1, 1), random.randf_range(0, 0.5), random.randf_range(-1, 1))
		var from := mark + away * random.randf_range(0, 30)
		counts["hits"] += int(check_ray(scatter, all, from, mark - away * 10.0, layers))
		counts["near"] += int(check_nearest(scatter, all, at, random.randf_range(0.5, 20), layers))
		var any := random.randi() % all.ids.size()
		var found := scatter.get_instance(all.ids[any])
		check(found != null and found.id == all.ids[any] and found.layer == all.layers[any] and
				found.mesh == all.meshes[any] and not found.added and scatter.has_instance(all.ids[any]) and
				found.position.distance_to(all.transforms[any].origin) < FLOATS, "by id")
	check(counts["rect"] > 200 and counts["sphere"] > 500 and counts["hits"] > 2 and counts["near"] > 2,
			"%s: answers %s" % [what, counts])


func test_answers_are_those_of_a_scan() -> void:
	var random := RandomNumberGenerator.new()
	random.seed = 4
	var viewer := make_viewer(Vector3(5000, 0, 0))
	var scatter := make_wood(viewer)
	var all := scan(scatter)
	check(all.ids.size() > 4000, "%d instances" % all.ids.size())
	check_all(scatter, all, random, "nothing loaded")
	viewer.global_position = Vector3.ZERO
	await settle(scatter)
	check(scatter.get_shown_tiles(0).size() > 8, "loaded")
	check_all(scatter, all, random, "loaded")
	viewer.global_position = Vector3(0, 0, -9000)
	await settle(scatter)
	check_all(scatter, all, random, "dropped")
	scatter.regenerate()
	viewer.global_position = Vector3(20, 0, 5)
	await settle(scatter)
	check_all(scatter, all, random, "loaded again")
	var gone := PackedInt64Array()
	for index in range(0, all.ids.size(), 3):
		gone.push_back(all.ids[index])
		scatter.remove_instance(all.ids[index])
	all = all.without(gone)
	check_all(scatter, all, random, "a third removed")
	check(scatter.get_instance(gone[5]) == null and not scatter.has_instance(gone[6]), "nor are they found by id")
	for index in 20:
		var at := Transform3D(Basis.from_euler(Vector3(0.3, index, 0.1)).scaled(Vector3.ONE * 1.5),
				Vector3(random.randf_range(-40, 40), random.randf_range(0, 15), random.randf_range(-40, 40)))
		all.ids.push_back(scatter.add_instance(0, at, 1))
		all.layers.push_back(0)
		all.meshes.push_back(1)
		all.transforms.push_back(at)
	for index in 20:
		var at := all.transforms[-1 - index]
		check_ray(scatter, all, at * Vector3(5, 3, 1), at * Vector3(-5, 3, -1), [])
	var found: PackedInt64Array = scatter.query_rect(Rect2(-60, -60, 120, 120), [0]).ids
	check(Array(all.ids.slice(-20)).all(func(id: int) -> bool: return found.has(id)), "hand-placed")


func test_a_server_without_viewers_answers_alike() -> void:
	var scatter := make_wood(make_viewer())
	await settle(scatter)
	var server := make_wood(make_viewer())
	server.viewers = []
	check(server.get_shown_tiles(0).is_empty(), "nothing is loaded")
	for rect: Rect2 in [Rect2(-20, -20, 40, 40), Rect2(3e4, -7e5, 30, 30)]:
		var answer := scatter.query_rect(rect)
		check(answer.size() > 200, "%d in %s" % [answer.size(), rect])
		check(content_of(answer) == content_of(server.query_rect(rect)), "the same in %s" % rect)
	await frames(10)
	check(server.get_shown_tiles(0).is_empty(), "and nothing was put on show for it")
	var lonely := TerrainScatter3D.new()
	lonely.seed = scatter.seed
	lonely.layers = scatter.layers
	lonely.terrain = scatter.terrain
	check(content_of(lonely.query_sphere(Vector3.ZERO, 20.0)) == content_of(scatter.query_sphere(Vector3.ZERO, 20.0)),
			"outside of the tree")
	lonely.free()


func test_predicates_are_asked_for_answers_only() -> void:
	var scatter := make_wood(make_viewer())
	var asked := PackedInt64Array()
	var odd := func(id: int, layer: int, at: Transform3D) -> bool:
		asked.push_back(id)
		check(layer == 0 and at == scatter.get_instance(id).transform, "what a predicate is told of %d" % id)
		return id % 2 == 1
	var rect := Rect2(-20, -20, 40, 40)
	var all: PackedInt64Array = scatter.query_rect(rect, [0]).ids
	var found: PackedInt64Array = scatter.query_rect(rect, [0], odd).ids
	check(asked == all and all.size() > 30, "asked for all answers once, in their order")
	var accepted := Array(all).filter(func(id: int) -> bool: return id % 2 == 1)
	check(found == PackedInt64Array(accepted), "those that it accepts")
	asked.clear()
	var nearest := scatter.query_nearest(Vector3(3, 5, 4), 40.0, [0], odd)
	check(nearest.id == asked[-1] and nearest.id % 2 == 1, "nearest: asked until one is accepted")
	var distances: Array = Array(asked).map(func(id: int) -> float:
		return scatter.get_instance(id).position.distance_to(Vector3(3, 5, 4)))
	var sorted := distances.duplicate()
	sorted.sort()
	check(distances == sorted, "nearest: asked by distance")
	var removed := scatter.remove_in_sphere(Vector3.ZERO, 15.0, [0], odd)
	check(removed.size() > 3 and Array(removed).all(func(id: int) -> bool: return id % 2 == 1), "those removed")
	check(not scatter.has_instance(removed[0]), "removed")
	scatter.query_rect(rect, [0], func(_id: int) -> bool: return true)
	check_error(["TerrainScatter3D.query_rect", "predicate"], "too few parameters")
	scatter.query_rect(rect, [0], func(_id: int, _layer: int, _at: Transform3D) -> int: return 1)
	check_error(["predicate", "bool"], "no bool")


func test_requests_are_answered_by_workers() -> void:
	var scatter := make_wood(make_viewer())
	scatter.viewers = []
	await frames(2)
	var rect := Rect2(900, -40, 70, 90)
	var first := scatter.request_rect(rect)
	var second := scatter.request_sphere(Vector3(-2000, 0, 0), 40.0, [1])
	var third := scatter.request_rect(Rect2(3000, 3000, 60, 60))
	var completed := {}
	for request: ScatterRequest in [first, second, third]:
		var number := request.get_instance_id()
		request.completed.connect(func(result: ScatterInstances) -> void: completed[number] = result)
	check(not first.is_completed() and first.get_result().is_empty(), "not answered at once")
	check(third.cancel(), "one is canceled")
	check(not third.cancel() and third.is_canceled() and third.is_completed(), "once")
	check(completed.is_empty(), "nobody is told at once")
	await until(func() -> bool: return completed.size() == 3, "all are completed")
	await frames(10)
	check(third.get_result().is_empty() and completed[third.get_instance_id()].is_empty(), "a canceled one without an answer")
	check(first.is_completed() and not first.is_canceled() and not first.cancel(), "what is answered cannot be canceled")
	check(completed[first.get_instance_id()] == first.get_result(), "the result is kept")
	check(content_of(first.get_result()) == content_of(scatter.query_rect(rect)), "as if asked directly")
	check(content_of(second.get_result()) == content_of(scatter.query_sphere(Vector3(-2000, 0, 0), 40.0, [1])), "the sphere, too")
	check(first.get_result().size() > 1000, "many instances")
	check(scatter.get_shown_tiles(0).is_empty(), "nothing was put on show")
	var id := first.get_result().get_id(7)
	var fourth := scatter.request_rect(rect)
	scatter.remove_instance(id)
	var warm: ScatterInstances = await fourth.completed
	check(warm.size() == first.get_result().size() - 1 and not warm.ids.has(id), "what was removed in between is left out")
	var awaited: ScatterInstances = await scatter.request_sphere(Vector3(100, 0, 0), 20.0).completed
	check(content_of(awaited) == content_of(scatter.query_sphere(Vector3(100, 0, 0), 20.0)), "awaited in one line")


func test_nobody_waits_for_ever() -> void:
	var scatter := make_wood(make_viewer())
	await frames(2)
	var far := Rect2(5000, 5000, 300, 300)
	check((await scatter.request_rect(Rect2(0, 0, -1, 1)).completed).is_empty(), "a refused one")
	check_error(["request_rect", "rect"], "a refused one")
	check((await scatter.request_sphere(Vector3.ZERO, 5.0, "nothing").completed).is_empty(), "one of no layer")
	check_error(["request_sphere", "nothing"], "one of no layer")
	var canceled := scatter.request_rect(far)
	canceled.cancel()
	check((await canceled.completed).is_empty(), "a canceled one")
	for deed: Callable in [
			func() -> void: root.remove_child(scatter),
			func() -> void: root.add_child(scatter),
			func() -> void: scatter.terrain = null,
			func() -> void: scatter.free()]:
		if scatter.terrain == null:
			scatter.terrain = ScatterTerrainFlat.new()
		var left := [false]
		scatter.request_rect(far).completed.connect(func(_found: ScatterInstances) -> void: left[0] = true)
		deed.call()
		await until(func() -> bool: return left[0], "a request whose node went away")
	await frames(2)


func test_tiles_of_another_size_are_not_taken_for_those_asked_for() -> void:
	var scatter := make_wood(make_viewer())
	scatter.viewers = []
	await frames(2)
	for turn in 12:
		var rect := Rect2(-100, -100, 200, 200) # Where tiles of both sizes have the same numbers.
		var request := scatter.request_rect(rect, [0])
		await frames(1 + turn % 4) # Workers are at it.
		scatter.layers[0].tile_size = 24.0 if turn % 2 == 0 else 40.0
		await until(request.is_completed, "an answer")
		var expected := PackedInt64Array()
		for ids: PackedInt64Array in ids_of(scatter.build_rect(0, rect)):
			expected.append_array(ids)
		var got := request.get_result().ids
		got.sort()
		expected.sort()
		check(got == expected, "turn %d: %d instances, %d stand there" % [turn, got.size(), expected.size()])


func test_layers_are_named_in_three_ways() -> void:
	var scatter := make_wood(make_viewer())
	scatter.layers[1].resource_name = "ferns"
	var rect := Rect2(-30, -30, 60, 60)
	var trees := content_of(scatter.query_rect(rect, [0]))
	var ferns := content_of(scatter.query_rect(rect, 1))
	var both := content_of(scatter.query_rect(rect))
	check(trees != ferns and both != ferns, "three answers")
	for reference: Variant in [0, "trees", &"trees", scatter.layers[0], [0], ["trees"], [scatter.layers[0]],
			PackedInt32Array([0]), PackedInt64Array([0]), PackedStringArray(["trees"])]:
		check(content_of(scatter.query_rect(rect, reference)) == trees, "trees as %s" % [reference])
	for references: Variant in [[0, 1], ["ferns", scatter.layers[0]], [1, "trees", 1], []]:
		check(content_of(scatter.query_rect(rect, references)) == both, "both as %s" % [references])
	var at := Transform3D(Basis(), Vector3(1, 20, 1))
	var id := scatter.add_instance("ferns", at)
	check_equal(scatter.get_instance(id).layer, 1, "a fern by hand")
	check_equal(scatter.query_nearest(at.origin, 2.0, "ferns").id, id, "the nearest fern")
	check(scatter.query_nearest(at.origin, 2.0, "trees") == null, "no tree")
	check_equal(scatter.remove_in_sphere(at.origin, 2.0, scatter.layers[1]).size(), 1, "removed by layer")
	for wrong: Variant in ["oaks", "", 2, -1, null, 0.5, [0, "oaks"], ScatterLayer.new(), Node]:
		check(scatter.query_rect(rect, wrong).is_empty(), "no layer %s" % [wrong])
		check_error(["TerrainScatter3D.query_rect", "ayer"], "no layer %s" % [wrong])
	check_equal(scatter.add_instance("oaks", at), 0, "no such layer")
	check_error(["TerrainScatter3D.add_instance", "\"oaks\""], "no such layer")


func test_bad_questions_are_refused() -> void:
	var scatter := make_wood(make_viewer())
	for rect: Rect2 in [Rect2(0, 0, -5, 5), Rect2(0, NAN, 5, 5), Rect2(0, 0, INF, 5), Rect2(-1e6, -1e6, 2e6, 2e6)]:
		check(scatter.query_rect(rect).is_empty(), "nothing in %s" % rect)
		check_error(["TerrainScatter3D.query_rect", "rect"], str(rect))
		scatter.request_rect(rect)
		check_error(["TerrainScatter3D.request_rect", "rect"], str(rect))
	for layers: PackedInt32Array in [[2], [-1], [0, 1, 70000]]:
		check(scatter.query_rect(Rect2(0, 0, 5, 5), layers).is_empty(), "no such layer")
		check_error(["TerrainScatter3D.query_rect", "layer"], "no such layer")
	scatter.query_sphere(Vector3(0, NAN, 0), 5.0)
	check_error(["TerrainScatter3D.query_sphere", "center", "finite"], "a center nowhere")
	scatter.query_sphere(Vector3.ZERO, -5.0)
	check_error(["TerrainScatter3D.query_sphere", "radius", "-5"], "a negative radius")
	check(scatter.query_ray(Vector3(INF, 0, 0), Vector3.ZERO).is_empty(), "no ray from nowhere")
	check_error(["TerrainScatter3D.query_ray", "from"], "a ray from nowhere")
	check(scatter.query_ray(Vector3.ZERO, Vector3(0, 0, 1e9)).is_empty(), "too long")
	check_error(["TerrainScatter3D.query_ray", "to", "too many"], "a ray around the world")
	check(scatter.query_nearest(Vector3.ZERO, NAN) == null, "no such distance")
	check_error(["TerrainScatter3D.query_nearest", "max_distance"], "no such distance")
	for id: int in [0, 1, -1, 1 << 62, -(1 << 63), (1 << 63) - 1]:
		check(scatter.get_instance(id) == null and not scatter.has_instance(id), "nothing has the id %d" % id)
	check_no_error("ids of nothing")
	scatter.terrain = null
	check(scatter.query_rect(Rect2(0, 0, 5, 5)).is_empty(), "no ground")
	check_error(["TerrainScatter3D.query_rect", "terrain", "missing"], "no ground")
	await frames(1)
