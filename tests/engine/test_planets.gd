extends "planet_harness.gd"
## Tests a planet: even density from pole to pole, upright instances, tiles only on the viewer's side, queries, removals, bodies, altitudes,
## hand-placed instances, explanations and invalid settings.

const PLANET := 2000.0
const DENSITY := 0.547 / (PI * 0.25 * SPACING * SPACING) ## The number of points per square meter of surface.
const PLACES := [90.0, 75.0, 60.0, 45.0, 30.0, 15.0, 5.0, 0.0, -20.0, -45.0, -70.0, -90.0] ## Degrees of latitude.


func test_a_walk_around_a_planet() -> void:
	put_planet(PLANET)
	viewer = make_viewer(direction(90.0) * (PLANET + 2.0))
	var scatter := make_scatter([make_grower()], make_ground(PLANET), viewer)
	check_equal(scatter.get_problems().size(), 0, "problems: %s" % scatter.get_problems())
	var all: Array[int] = []
	var mean := 0.0
	for latitude: float in PLACES:
		var foot := direction(latitude) * PLANET
		viewer.global_position = foot + direction(latitude) * 2.0
		var before := Time.get_ticks_msec()
		await settle(scatter)
		var msec := Time.get_ticks_msec() - before
		var standing := instances(scatter, 0)
		var here := near(standing, foot, 50.0)
		var off := 0.0
		for id in here:
			off = maxf(off, here[id].basis.y.angle_to(here[id].origin))
		var share := here.size() / (DENSITY * PI * 50.0 * 50.0)
		print("latitude %4.0f: %d of %d within 50 m (%.3f of a plane), off radial %.4f degrees, %d tiles, %d ms" % [
			latitude, here.size(), standing.size(), share, rad_to_deg(off), scatter.get_stats().tiles, msec])
		check(absf(share - 1.0) < 0.02, "latitude %.0f: the density must match a plane, got %.3f of it" % [latitude, share])
		check(rad_to_deg(off) < 0.001, "latitude %.0f: instances are upright, got %.4f degrees" % [latitude, rad_to_deg(off)])
		# A disc with a radius of 100 m, plus the tiles at its border.
		check(standing.size() < 3.0 * DENSITY * PI * 100.0 * 100.0, "latitude %.0f: the far side is not loaded, got %d instances" % [latitude, standing.size()])
		# On a plane, 17 tiles of 64 m touch a disc with a radius of 108 m, on average.
		check(scatter.get_stats().tiles < 17 * 2.5, "latitude %.0f: not many more tiles than on a plane: %d" % [latitude, scatter.get_stats().tiles])
		mean += share / PLACES.size()
		all.push_back(standing.size())
	check(absf(mean - 1.0) < 0.01, "the mean density must match a plane, got %.4f of it" % mean)
	check(all.max() < 1.6 * all.min(), "all positions load about as many instances, got %s" % [all])
	check_equal(scatter.get_stats()["waiting"], 0, "no tile is waiting")


func test_queries_removals_and_bodies_around_a_walker() -> void:
	put_planet(PLANET)
	var layer := make_grower(4.0)
	layer.collision_shape = ScatterLayer.COLLISION_CYLINDER
	layer.collision_distance = DISTANCE
	layer.instance_radius = 0.5
	layer.instance_height = 3.0
	viewer = make_viewer()
	var scatter := make_scatter([layer], make_ground(PLANET), viewer)
	scatter.state = ScatterState.new()
	for latitude: float in [0.0, -90.0, 45.0]:
		var foot := direction(latitude) * PLANET
		viewer.global_position = foot + direction(latitude) * 2.0
		await settle(scatter)
		var expected := near(instances(scatter, 0), foot, 30.0)
		var found := scatter.query_sphere(foot, 30.0)
		check_equal(found.ids.size(), expected.size(), "latitude %.0f: a sphere query finds as many instances" % latitude)
		check(Array(found.ids).all(func(found_id: int) -> bool: return expected.has(found_id)), "latitude %.0f: the query finds the same IDs" % latitude)
		await frames(10)
		await physics_frame
		var solid := bodies(scatter, foot)
		var close := near(instances(scatter, 0), viewer.global_position, DISTANCE)
		check(close.size() > 30 and close.keys().all(func(close_id: int) -> bool: return solid.has(close_id)), "latitude %.0f: %d bodies for %d near instances" % [
			latitude, solid.size(), close.size()])
		var id: int = close.keys()[0]
		var up := close[id].origin.normalized()
		var side := up.cross(Vector3(0.3, 0.2, 0.9)).normalized()
		var hit := cast(close[id].origin + 2.0 * up + 3.0 * side, close[id].origin + 2.0 * up)
		check(not hit.is_empty() and scatter.get_body_instance(hit["rid"]) == id, "latitude %.0f: the body points away from the center" % latitude)
		var ray := scatter.query_ray(close[id].origin + 10.0 * up, close[id].origin)
		check(ray != null and ray.id == id, "latitude %.0f: a ray from above hits the instance" % latitude)
		var nearest := scatter.query_nearest(close[id].origin + 0.1 * up, 10.0)
		check(nearest != null and nearest.id == id, "latitude %.0f: it is the nearest instance" % latitude)
		check(scatter.remove_instance(id), "latitude %.0f: the instance is removed" % latitude)
		await settle(scatter)
		check(not instances(scatter, 0).has(id), "latitude %.0f: the removed instance is not drawn" % latitude)
		var answer := scatter.explain_position(foot + up)[0]
		check(answer.standing or not str(answer.reason).is_empty(), "latitude %.0f: the position is explained" % latitude)


func test_altitudes_slopes_and_offsets() -> void:
	put_planet(80.0, Vector3(500.0, 20.0, -300.0), 128)
	put_planet(90.0, Vector3(500.0, 20.0, -300.0), 128)
	var center := Vector3(500.0, 20.0, -300.0)
	var layer := make_grower()
	layer.tile_size = 32.0
	layer.view_distance = 300.0
	layer.max_slope_degrees = 10.0
	layer.height_offset = -0.5
	viewer = make_viewer(center)
	var scatter := make_scatter([layer], make_ground(80.0, center), viewer)
	await settle(scatter)
	var both := instances(scatter, 0).size()
	layer.min_height = 5.0
	await settle(scatter)
	var standing := instances(scatter, 0)
	var expected := DENSITY * 4.0 * PI * 90.0 * 90.0
	check(absf(standing.size() - expected) < 0.02 * expected, "above the minimum altitude, only the outer sphere has instances: %d, expected about %d" % [standing.size(), expected])
	check(absf(both - standing.size() - expected * 64.0 / 81.0) < 0.02 * expected, "without a minimum altitude, the inner sphere has instances, too: %d in all" % both)
	var bad := standing.values().filter(func(at: Transform3D) -> bool: return absf(at.origin.distance_to(center) - 89.5) > 0.15)
	check_equal(bad.size(), 0, "instances that are not sunk by half a meter")
	layer.min_slope_degrees = 9.0
	await settle(scatter)
	check_equal(instances(scatter, 0).size(), 0, "the ground has no steep slopes")


func test_moss_grows_on_pillars_all_around() -> void:
	put_planet(100.0, Vector3.ZERO, 128)
	var pillars := make_grower(30.0)
	pillars.resource_name = "Pillars"
	var box := BoxMesh.new()
	box.size = Vector3(4.0, 60.0, 4.0)
	pillars.meshes = [box]
	var moss := make_grower(1.0)
	moss.surface_layers = ["Pillars"]
	moss.max_slope_degrees = 20.0
	for layer: ScatterLayer in [pillars, moss]:
		layer.tile_size = 32.0
		layer.view_distance = 60.0
	viewer = make_viewer()
	var scatter := make_scatter([pillars, moss], make_ground(100.0), viewer)
	for latitude: float in [90.0, 0.0, -90.0]:
		viewer.global_position = direction(latitude) * 120.0
		await settle(scatter)
		var grown := instances(scatter, 1)
		check(grown.size() > 50, "latitude %.0f: %d tufts of moss" % [latitude, grown.size()])
		var low := grown.values().filter(func(at: Transform3D) -> bool: return absf(at.origin.length() - 130.0) > 0.5)
		check_equal(low.size(), 0, "latitude %.0f: the moss is on the ends of the pillars" % latitude)


func test_hand_placed_instances_have_an_altitude() -> void:
	put_planet(100.0, Vector3.ZERO, 64)
	var layer := make_grower(4.0)
	layer.use_colors = true
	layer.color_value = ScatterValueSource.new()
	layer.color_value.source = ScatterValueSource.SOURCE_HEIGHT
	layer.color_value.max_value = 20.0
	layer.color_value.gradient = Gradient.new() # From black to white.
	viewer = make_viewer(Vector3(101.0, 0.0, 0.0))
	var scatter := make_scatter([layer], make_ground(100.0), viewer)
	scatter.state = ScatterState.new()
	await settle(scatter)
	for up: Vector3 in [Vector3.RIGHT, Vector3.DOWN, Vector3(0.6, 0.0, -0.8)]:
		var id := scatter.add_instance(layer, Transform3D(Basis(), up * 105.0))
		var tile := scatter.build_rect(layer, Rect2(up.x * 105.0 - 1.0, up.z * 105.0 - 1.0, 2.0, 2.0))
		var index := tile.get_ids(0).find(id)
		if check(index >= 0, "the instance at %s is in the tile" % up):
			check(absf(tile.get_buffer(0)[16 * index + 12] - 0.25) < 0.005, "at %s, an altitude of 5 of 20 m: %f" % [up, tile.get_buffer(0)[16 * index + 12]])


## The editor's tools use these methods of the node.
func test_up_and_lines_that_meet_the_ground() -> void:
	put_planet(100.0, Vector3.ZERO, 128)
	var ground := make_ground(100.0)
	viewer = make_viewer(Vector3(0.0, 101.0, 0.0))
	var scatter := make_scatter([make_grower()], ground, viewer)
	await settle(scatter)
	check_equal(scatter._get_planet(), PackedFloat64Array([0.0, 0.0, 0.0, 100.0]), "the center and the radius")
	for up: Vector3 in [Vector3.UP, Vector3.DOWN, Vector3.RIGHT, Vector3(0.6, 0.0, -0.8)]:
		check(scatter._up_at(up * 120.0).distance_to(up) < 1e-5, "up at %s: %s" % [up, scatter._up_at(up * 120.0)])
		var hit := scatter._hit_surface(up * 150.0, up * 50.0)
		if check(hit.size() == 2, "a line from above hits the ground at %s" % up):
			check(hit[0].distance_to(up * 100.0) < 0.2 and hit[1].distance_to(up) < 0.05, "the hit is on the surface and has its normal: %s" % [hit])
		check(scatter._hit_surface(up * 150.0, up * 120.0).is_empty(), "a line that ends above %s hits nothing" % up)
	scatter.ground = ScatterGroundFlat.new()
	await settle(scatter)
	check_equal(scatter._up_at(Vector3.RIGHT), Vector3.UP, "up without a planet")
	check(scatter._get_planet().is_empty(), "no planet")
	check(scatter._hit_surface(Vector3.UP, Vector3.DOWN).is_empty(), "a line hits nothing on ground without surfaces")


## An explanation does not mention instances that were placed by hand on the opposite side.
func test_explanations_on_all_sides() -> void:
	put_planet(100.0, Vector3.ZERO, 128)
	var layer := make_grower()
	viewer = make_viewer(Vector3(0.0, -101.0, 0.0))
	var scatter := make_scatter([layer], make_ground(100.0), viewer)
	scatter.state = ScatterState.new()
	await settle(scatter)
	var seen := 0
	for index in 40:
		var up := Vector3(0.01 * index, -1.0, 0.004 * index).normalized()
		var explanation := scatter.explain_position(scatter._hit_surface(up * 150.0, up * 50.0)[0], layer)[0]
		check(explanation.position.distance_to(up * 100.0) < 0.2 and explanation.shown, "below: %s at %s" % [explanation.reason, explanation.position])
		seen += int(explanation.refused_by == &"")
	check_equal(seen, 40, "explanations of visible instances")
	for side: float in [1.0, -1.0]:
		scatter.add_instance(layer, Transform3D(Basis(), Vector3(0.3, 100.0 * side, 0.0)))
		var mentioned := "One was placed by hand" in scatter.explain_position(Vector3.DOWN * 100.0, layer)[0].reason
		check_equal(mentioned, side < 0.0, "an instance at y = %.0f" % (100.0 * side))


func test_problems_and_bad_settings() -> void:
	put_planet(100.0, Vector3.ZERO, 64)
	var ground := make_ground(100.0)
	for bad: float in [-1.0, NAN, INF, 1e9]:
		ground.planet_radius = bad
		check_error(["planet_radius", "ScatterGroundMeshes"], "a radius of %s" % bad)
	ground.planet_center = Vector3(0.0, NAN, 0.0)
	check_error(["planet_center.y"], "a center that is not finite")
	check_equal(ground.planet_radius, 100.0, "the last valid radius stays")
	check_equal(ground.planet_center, Vector3.ZERO, "the last valid center stays")
	var layer := make_grower()
	layer.tile_size = 16.0
	layer.view_distance = 300.0
	var flat := make_layer()
	viewer = make_viewer(Vector3(0.0, 101.0, 0.0))
	var scatter := make_scatter([layer, flat], ground, viewer)
	await settle(scatter)
	var problems := "\n".join(scatter.get_problems())
	check("16 x tile_size" in problems and "got 300.0 m" in problems, "the view distance is too long: %s" % problems)
	check("without on_surfaces, planet_radius has no effect" in problems, "a layer that is not on surfaces: %s" % problems)
	var other := make_ground(50.0, Vector3(0.0, 3.0, 0.0))
	var combined := ScatterGroundCombined.new()
	combined.grounds = [ground, other]
	scatter.ground = combined
	scatter.layers = [layer]
	layer.view_distance = 100.0
	await settle(scatter)
	problems = "\n".join(scatter.get_problems())
	check("different planet_radius" in problems, "two planets in one ground: %s" % problems)
	other.planet_radius = 0.0
	check_equal(scatter.get_problems().size(), 0, "one planet: %s" % scatter.get_problems())
	await settle(scatter)
	var off := 0.0
	var standing := instances(scatter, 0)
	for id in standing:
		off = maxf(off, standing[id].basis.y.angle_to(standing[id].origin))
	check(standing.size() > 500 and off < 1e-4, "the combined ground uses its part's planet: %d instances, %f off" % [standing.size(), off])
