extends "collision_harness.gd"
## Tests layers that grow on the models of other layers, such as moss on boulders. Covers removals, additions, moves, saved states, queries,
## changes to the models and to the boulders' settings, and invalid settings.

const STONES := 0
const MOSS := 1
const RADIUS := 1.0 ## The radius of a boulder in meters.


func make_boulder(radius := RADIUS) -> SphereMesh:
	var mesh := SphereMesh.new()
	mesh.radius = radius
	mesh.height = 2.0 * radius
	return mesh


func make_stones() -> ScatterLayer:
	var layer := make_layer(6.0)
	layer.resource_name = "Stones"
	layer.meshes = [make_boulder()]
	layer.view_distance = 60.0
	layer.min_yaw_degrees = 0.0
	layer.max_yaw_degrees = 0.0
	return layer


func make_moss(host: Variant = "Stones") -> ScatterLayer:
	var layer := make_layer(0.25)
	layer.resource_name = "Moss"
	layer.on_surfaces = true
	layer.surface_layers = [host]
	layer.max_slope_degrees = 180.0
	layer.align_to_normal = 1.0
	layer.tile_size = 12.0
	layer.view_distance = 30.0
	return layer


func make_mossy(layers: Array[ScatterLayer] = [make_stones(), make_moss()]) -> TerrainScatter3D:
	viewer = make_viewer()
	var scatter := make_scatter(layers, ScatterGroundFlat.new(), viewer)
	scatter.state = ScatterState.new()
	return scatter


## Returns the distance of a position from the surface of the nearest boulder.
func distance_to(stones: Array, position: Vector3) -> float:
	var minimum := INF
	for stone: Transform3D in stones:
		minimum = minf(minimum, absf(stone.origin.distance_to(position) - RADIUS * stone.basis.y.length()))
	return minimum


func check_on(stones: Array, moss: Dictionary[int, Transform3D], context: String) -> void:
	for id in moss:
		if not check(distance_to(stones, moss[id].origin) < 0.01, "%s: moss at %s is on no boulder" % [context, moss[id].origin]):
			return


func nearest_to(standing: Dictionary[int, Transform3D], point: Vector3) -> int:
	var best := 0
	for id in standing:
		if best == 0 or standing[id].origin.distance_to(point) < standing[best].origin.distance_to(point):
			best = id
	return best


## Returns the IDs of `standing` within a distance of a position.
func near(standing: Dictionary[int, Transform3D], point: Vector3, distance: float) -> Array[int]:
	var result: Array[int] = []
	for id in standing:
		if standing[id].origin.distance_to(point) < distance:
			result.push_back(id)
	return result


func test_moss_grows_on_boulders() -> void:
	var scatter := make_mossy()
	await settle(scatter)
	var stones := instances(scatter, STONES)
	var moss := instances(scatter, MOSS)
	check(stones.size() > 20 and moss.size() > 3000, "%d boulders, %d moss" % [stones.size(), moss.size()])
	check_on(stones.values(), moss, "at first")
	var stone := stones[nearest_to(stones, Vector3.ZERO)]
	var on_stone := near(moss, stone.origin, RADIUS + 0.01)
	var expected := 4.0 * PI * RADIUS * RADIUS * 0.547 / (PI * 0.25 * 0.25 / 4.0)
	check(absf(on_stone.size() - expected) < 0.08 * expected, "%d on a boulder, expected about %.0f" % [on_stone.size(), expected])
	for id in on_stone:
		var outwards := (moss[id].origin - stone.origin).normalized()
		if not check(moss[id].basis.y.dot(outwards) > 0.99, "moss points away from its boulder"):
			break
	check_equal(scatter.get_problems().size(), 0, "problems: %s" % scatter.get_problems())
	var ray := scatter.query_ray(stone.origin + Vector3(0.0, 9.0, 0.0), stone.origin, "Moss")
	check(ray != null and on_stone.has(ray.id), "a ray meets the moss on the boulder")
	check_equal(scatter.query_sphere(stone.origin, RADIUS + 0.01, "Moss").ids.size(), on_stone.size(), "instances of moss that a query finds on the boulder")
	scatter.layers[MOSS].max_slope_degrees = 45.0
	await settle(scatter)
	moss = instances(scatter, MOSS)
	check_on(stones.values(), moss, "with a slope rule")
	check(moss.values().all(func(at: Transform3D) -> bool: return at.basis.y.y > 0.7), "a slope rule permits moss only on top of boulders")


func test_felled_boulders_take_their_moss_along() -> void:
	var scatter := make_mossy()
	await settle(scatter)
	var stones := instances(scatter, STONES)
	var before := instances(scatter, MOSS)
	var felled := nearest_to(stones, Vector3.ZERO)
	var point := stones[felled].origin
	var single := nearest_to(before, point + Vector3(0.0, RADIUS, 0.0))
	check(scatter.remove_instance(single), "a single moss is removed")
	await settle(scatter)
	check_equal(instances(scatter, MOSS).size(), before.size() - 1, "one less")
	var tiles_made: int = scatter.get_stats()["tiles_made"]
	check(scatter.remove_instance(felled), "a boulder is removed")
	check_equal(scatter.query_sphere(point, RADIUS + 0.01, "Moss").ids.size(), 0, "moss that a query finds immediately after the removal")
	await until(func() -> bool: return near(instances(scatter, MOSS), point, RADIUS + 0.01).is_empty(), "the moss disappears")
	await settle(scatter)
	check(scatter.get_stats()["tiles_made"] - tiles_made <= 9, "only tiles near the boulder are regenerated: %d" % (scatter.get_stats()["tiles_made"] - tiles_made))
	var after := instances(scatter, MOSS)
	for id in before:
		if before[id].origin.distance_to(point) > RADIUS + 13.0 * 0.25 and not check(after.has(id), "moss on other boulders stays"):
			break
	var saved := scatter.state.to_bytes()
	check(scatter.restore_instance(felled), "the boulder is restored")
	await settle(scatter)
	after = instances(scatter, MOSS)
	before.erase(single)
	check_equal(after, before, "moss after the boulder was restored, without the removed single instance")
	scatter.state = ScatterState.new()
	await settle(scatter)
	check(instances(scatter, MOSS).has(single), "a new state restores the single instance")
	check_equal(scatter.state.from_bytes(saved), OK, "loaded")
	await settle(scatter)
	check(near(instances(scatter, MOSS), point, RADIUS + 0.01).is_empty(), "with the saved state, no moss grows at the removed boulder")


func test_the_first_change_regenerates_only_near_tiles() -> void:
	var scatter := make_mossy()
	scatter.state = null
	await settle(scatter)
	var tiles_made: int = scatter.get_stats()["tiles_made"]
	check(scatter.remove_instance(nearest_to(instances(scatter, STONES), Vector3.ZERO)), "removed")
	check(scatter.state != null, "the first change creates a state")
	await settle(scatter)
	tiles_made = scatter.get_stats()["tiles_made"] - tiles_made
	check(tiles_made > 0 and tiles_made <= 9, "%d tiles are regenerated" % tiles_made)


func test_boulders_that_a_game_places_and_moves() -> void:
	var stones := make_stones()
	stones.density = 0.0
	var scatter := make_mossy([stones, make_moss()])
	await settle(scatter)
	check_equal(instances(scatter, MOSS).size(), 0, "no boulder, no moss")
	var at := Transform3D(Basis.from_scale(Vector3.ONE * 2.0), Vector3(3.0, 5.0, 1.0))
	var id := scatter.add_instance("Stones", at)
	await settle(scatter)
	var moss := instances(scatter, MOSS)
	check(moss.size() > 500, "moss on the new boulder: %d" % moss.size())
	check_on([at], moss, "on a placed boulder")
	at.origin += Vector3(9.0, 3.0, 0.0)
	id = scatter.set_instance_transform(id, at)
	await settle(scatter)
	var moved := instances(scatter, MOSS)
	check(absf(moved.size() - moss.size()) < 0.1 * moss.size(), "about as much moss is on the moved boulder: %d" % moved.size())
	check_on([at], moved, "on a moved boulder")
	scatter.remove_instance(id)
	await settle(scatter)
	check_equal(instances(scatter, MOSS).size(), 0, "removed")


func test_moss_depends_on_the_boulders_settings_and_models() -> void:
	var scatter := make_mossy()
	var stones := scatter.layers[STONES]
	await settle(scatter)
	for change: Array in [["seed", 0], ["max_scale", 1.5], ["density", 0.5], ["height_offset", 0.7]]:
		if change[0] == "seed":
			scatter.seed = 77
		else:
			stones.set(change[0], change[1])
		await settle(scatter)
		var moss := instances(scatter, MOSS)
		check(moss.size() > 500, "moss after a change to %s: %d" % [change[0], moss.size()])
		check_on(instances(scatter, STONES).values(), moss, change[0])
	stones.max_scale = 1.0
	var mesh: SphereMesh = stones.meshes[0]
	mesh.radius = 0.5
	mesh.height = 1.0
	await settle(scatter)
	var ids := instances(scatter, MOSS)
	var half := instances(scatter, STONES).values().map(func(at: Transform3D) -> Transform3D: return at.scaled_local(Vector3.ONE * 0.5))
	check_on(half, ids, "smaller models")
	check(ids.size() > 200, "instances of moss on smaller models: %d" % ids.size())
	scatter.layers = [scatter.layers[MOSS]] as Array[ScatterLayer]
	await settle(scatter)
	check_equal(instances(scatter, 0).size(), 0, "instances of a layer whose boulders are missing")
	check("Stones" in str(scatter.get_problems()), "a missing layer is reported: %s" % scatter.get_problems())


func test_the_result_does_not_depend_on_tiles() -> void:
	var scatter := make_mossy()
	await settle(scatter)
	var area := Rect2(-12.0, -12.0, 24.0, 24.0)
	var whole := scatter.query_rect(area, "Moss").ids
	scatter.layers[MOSS].tile_size = 7.0
	await settle(scatter)
	var parts := scatter.query_rect(area, "Moss").ids
	whole.sort()
	parts.sort()
	check(whole.size() > 500, "%d found" % whole.size())
	check_equal(parts, whole, "instances in smaller tiles")
	var snapshot := scatter.make_snapshot()
	scatter.remove_instance(nearest_to(instances(scatter, STONES), Vector3.ZERO))
	check_equal(snapshot.query_rect(area, "Moss").ids.size(), whole.size(), "instances that a query of the snapshot finds")


func test_references_and_mistakes() -> void:
	var moss := make_moss()
	var stones := make_stones()
	var scatter := make_mossy([stones, moss])
	await settle(scatter)
	stones.resource_name = "Rocks"
	await settle(scatter)
	check_equal(moss.surface_layers, ["Rocks"], "the reference is updated to the new name")
	check(instances(scatter, MOSS).size() > 1000, "the moss still grows after the layer was renamed")
	moss.surface_layers = [stones]
	check_equal(moss.surface_layers, ["Rocks"], "a layer is stored by its name")
	check(moss.surface_layers.is_read_only(), "the list is read-only")
	moss.on_surfaces = false
	check("on_surfaces is off" in str(scatter.get_problems()), str(scatter.get_problems()))
	moss.on_surfaces = true
	moss.surface_layers = ["Rocks", "Moss", "Logs", ""]
	var problems := "\n".join(scatter.get_problems())
	check("\"Moss\"" in problems and "\"Logs\"" in problems and "without a layer's name" in problems, problems)
	moss.surface_layers = ["Rocks"]
	stones.meshes = []
	await settle(scatter)
	check_equal(instances(scatter, MOSS).size(), 0, "no meshes, no moss")
	check("have no triangles" in str(scatter.get_problems()), str(scatter.get_problems()))
	var huge := make_boulder()
	huge.rings = 400
	huge.radial_segments = 400
	stones.meshes = [huge]
	await settle(scatter)
	check_equal(instances(scatter, MOSS).size(), 0, "instances on a model with too many triangles")
	check("100000" in str(scatter.get_problems()), str(scatter.get_problems()))
	scatter.layers = [moss, stones] as Array[ScatterLayer]
	check("not before this layer" in str(scatter.get_problems()), str(scatter.get_problems()))


func test_positions_on_models_are_explained() -> void:
	var moss := make_moss()
	moss.max_slope_degrees = 60.0
	moss.spacing = {"Stones": 0.1}
	var scatter := make_mossy([make_stones(), moss])
	await settle(scatter)
	var standing := instances(scatter, MOSS)
	var stones := instances(scatter, STONES)
	var stone := stones[nearest_to(stones, Vector3.ZERO)].origin
	for id in near(standing, stone, RADIUS + 0.01).slice(0, 20):
		var found := scatter.explain_position(standing[id].origin, "Moss")[0]
		check(found.standing and found.id == id, "the moss at %s: %s" % [standing[id].origin, found.reason])
		check(found.position.distance_to(standing[id].origin) < 0.01, "the explained position is on the model")
	var below := scatter.explain_position(stone + Vector3(0.0, -RADIUS, 0.0), "Moss")[0]
	check(not below.standing and "slope" in str(below.reason).to_lower(), "the lower side is too steep: %s" % below.reason)
	var away := scatter.explain_position(stone + Vector3(0.0, RADIUS + 1.0, 0.0), "Moss")[0]
	check(not away.standing and "model" in away.reason, "no model is near: %s" % away.reason)


func test_mushrooms_on_logs_on_stones() -> void:
	var logs := make_moss()
	logs.resource_name = "Logs"
	logs.radius = 1.0
	logs.meshes = [make_boulder(0.2)]
	var mushrooms := make_moss("Logs")
	mushrooms.radius = 0.1
	mushrooms.view_distance = 14.0
	var scatter := make_mossy([make_stones(), logs, mushrooms])
	await settle(scatter)
	var standing := instances(scatter, 2)
	check(standing.size() > 300, "%d mushrooms" % standing.size())
	var stones := instances(scatter, STONES)
	var felled := nearest_to(stones, Vector3.ZERO)
	check(near(standing, stones[felled].origin, RADIUS + 0.45).size() > 50, "mushrooms near a boulder")
	scatter.remove_instance(felled)
	await settle(scatter)
	check_equal(near(instances(scatter, 2), stones[felled].origin, RADIUS + 0.45).size(), 0, "mushrooms that stay after the boulder was removed")


func test_other_models_and_models_that_cannot_be_read() -> void:
	var stones := make_stones()
	var scatter := make_mossy([stones, make_moss()])
	await settle(scatter)
	var box := BoxMesh.new()
	stones.meshes = [box]
	await settle(scatter)
	var moss := instances(scatter, MOSS)
	check(moss.size() > 500, "moss on boxes: %d" % moss.size())
	var standing := instances(scatter, STONES).values()
	for id in moss:
		var at := moss[id].origin
		if not check(standing.any(func(stone: Transform3D) -> bool: return box.get_aabb().grow(0.01).has_point(stone.affine_inverse() * at)), "moss at %s is on a box" % at):
			break
	stones.meshes = [box, null]
	await settle(scatter)
	check(instances(scatter, MOSS).size() > 200, "moss on the boxes next to an empty entry: %d" % instances(scatter, MOSS).size())
	check_equal(scatter.get_problems().size(), 0, "problems: %s" % scatter.get_problems())
	var arrays := box.get_mesh_arrays()
	var vertices: PackedVector3Array = arrays[Mesh.ARRAY_VERTEX]
	vertices[0].x = NAN
	arrays[Mesh.ARRAY_VERTEX] = vertices
	var broken := ArrayMesh.new()
	broken.add_surface_from_arrays(Mesh.PRIMITIVE_TRIANGLES, arrays)
	errors.take() # The engine may print an error about the mesh.
	stones.meshes = [broken]
	await settle(scatter)
	check_equal(instances(scatter, MOSS).size(), 0, "instances on a mesh with a vertex that is not finite")
	check("nothing grows on ScatterLayer.meshes[0]: " in str(scatter.get_problems()) and "finite" in str(scatter.get_problems()), str(scatter.get_problems()))


## Layers without names refer to each other directly, but never in a circle.
func test_layers_without_names_do_not_form_a_circle() -> void:
	var stones := make_stones()
	stones.resource_name = ""
	var moss := make_moss(stones)
	moss.resource_name = ""
	check_equal(moss.surface_layers, [stones], "a layer without a name is stored itself")
	stones.surface_layers = [moss]
	check_error(["ScatterLayer.surface_layers"], "a circle of two layers")
	check(stones.surface_layers.is_empty(), "the list is kept")
