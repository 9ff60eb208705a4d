extends "collision_harness.gd"
## Tests a planet: even density from pole to pole, upright instances, tiles only on the viewer's side, queries, removals, bodies, altitudes,
## moved planets, regions, hand-placed instances and invalid settings.

const PLANET := 2000.0
const SPACING := 2.0
const DENSITY := 0.547 / (PI * 0.25 * SPACING * SPACING) ## The number of points per square meter of surface.
const PLACES := [90.0, 75.0, 60.0, 45.0, 30.0, 15.0, 5.0, 0.0, -20.0, -45.0, -70.0, -90.0] ## Degrees of latitude.


## Adds a sphere of ground. The distance of its flat facets from the sphere is less than a hundredth of the radius.
func put_planet(planet_radius: float, center := Vector3.ZERO, segments := 256) -> MeshInstance3D:
	var mesh := SphereMesh.new()
	mesh.radius = planet_radius
	mesh.height = 2.0 * planet_radius
	mesh.radial_segments = segments
	@warning_ignore("integer_division")
	mesh.rings = segments / 2
	var instance := MeshInstance3D.new()
	instance.mesh = mesh
	instance.position = center
	instance.add_to_group(&"ground")
	root.add_child(instance)
	return instance


func make_ground(planet_radius: float, center := Vector3.ZERO) -> ScatterGroundMeshes:
	var ground := ScatterGroundMeshes.new()
	ground.group = &"ground"
	ground.planet_radius = planet_radius
	ground.planet_center = center
	return ground


func make_grower(spacing := SPACING) -> ScatterLayer:
	var layer := make_layer(spacing)
	layer.on_surfaces = true
	layer.tile_size = 64.0
	layer.view_distance = 100.0
	return layer


func direction(latitude: float) -> Vector3:
	return Vector3(cos(deg_to_rad(latitude)), sin(deg_to_rad(latitude)), 0.0).rotated(Vector3.UP, 0.3)


func clean() -> void:
	for node in get_nodes_in_group(&"ground"):
		node.free()
	await super()


## Returns the transforms within `reach` meters of a position.
func near(standing: Dictionary[int, Transform3D], at: Vector3, reach: float) -> Dictionary[int, Transform3D]:
	var result: Dictionary[int, Transform3D] = {}
	for id in standing:
		if standing[id].origin.distance_to(at) < reach:
			result[id] = standing[id]
	return result


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


func test_a_planet_that_is_set_later() -> void:
	put_planet(100.0, Vector3.ZERO, 128)
	var layer := make_grower()
	layer.tile_size = 16.0
	layer.view_distance = 60.0
	var ground := make_ground(0.0)
	viewer = make_viewer(Vector3(101.0, 0.0, 0.0))
	var scatter := make_scatter([layer], ground, viewer)
	await settle(scatter)
	var id: int = near(instances(scatter, 0), Vector3(100.0, 0.0, 0.0), 5.0).keys()[0]
	check(instances(scatter, 0)[id].basis.y.angle_to(Vector3.UP) < 1e-4, "without a planet, up is world y")
	ground.planet_radius = 100.0
	await settle(scatter)
	check(instances(scatter, 0)[id].basis.y.angle_to(Vector3.RIGHT) < 0.06, "the same instance points away from the center now")
	var tile := scatter.get_tile(layer, Vector2i(6, 0))
	check(tile.get_ids(0).size() > 100, "a tile contains all cubes of its column")
	check_equal(tile.get_buffer(0).size(), 12 * tile.get_ids(0).size(), "the tile's buffer has a transform for each instance")
	check(tile.get_multimeshes(0).size() > 1, "several multimeshes draw the tile")
	var moon := put_planet(8.0, Vector3(135.0, 0.0, 0.0), 32)
	await until(func() -> bool: return near(instances(scatter, 0), moon.position, 9.0).size() > 20, "a moon far above the ground has plants")
	await settle(scatter)
	var on_moon := near(instances(scatter, 0), moon.position, 9.0)
	check(on_moon.values().all(func(at: Transform3D) -> bool: return at.basis.y.angle_to(at.origin) < 1e-3), "the moon's plants point away from the planet")
	moon.free()
	await until(func() -> bool: return near(instances(scatter, 0), Vector3(135.0, 0.0, 0.0), 9.0).is_empty(), "the freed moon has no plants")
	ground.planet_radius = 0.0
	await settle(scatter)
	check(instances(scatter, 0)[id].basis.y.angle_to(Vector3.UP) < 1e-4, "up is world y again")


## Returns the largest angle between the up axes of instances and the directions away from a center, in degrees.
func off_radial(standing: Dictionary[int, Transform3D], center: Vector3) -> float:
	var off := 0.0
	for id in standing:
		off = maxf(off, standing[id].basis.y.angle_to(standing[id].origin - center))
	return rad_to_deg(off)


func test_a_planet_that_spins_and_a_world_that_is_recentered() -> void:
	var spinner := Node3D.new()
	spinner.position = Vector3(500.0, 30.0, 0.0)
	root.add_child(spinner)
	var planet := put_planet(100.0, Vector3.ZERO, 128)
	planet.reparent(spinner, false)
	var layer := make_grower()
	layer.tile_size = 16.0
	layer.view_distance = 50.0
	viewer = make_viewer(spinner.position + Vector3(0.0, -101.0, 0.0))
	var scatter := make_scatter([layer], make_ground(100.0), viewer)
	scatter.reparent(spinner, false)
	scatter.local_coords = true
	scatter.viewers = [scatter.get_path_to(viewer)]
	for turn: float in [0.0, 1.0, PI]:
		spinner.rotation.z = turn
		await settle(scatter)
		var found := scatter.query_sphere(viewer.position, 40.0)
		var below: Dictionary[int, Transform3D] = {}
		for index in found.size():
			below[found.get_id(index)] = found.get_transform(index)
		check(below.size() > 500, "turned by %.1f: %d instances near the viewer" % [turn, below.size()])
		check(off_radial(below, spinner.position) < 0.01, "turned by %.1f: upright, got %.4f degrees" % [turn, off_radial(below, spinner.position)])
	scatter.free()
	spinner.free()
	planet = put_planet(100.0, Vector3.ZERO, 128)
	viewer.position = Vector3(0.0, 0.0, 101.0)
	scatter = make_scatter([layer], make_ground(100.0), viewer)
	await settle(scatter)
	var before := near(instances(scatter, 0), Vector3(0.0, 0.0, 100.0), 20.0)
	var shift := Vector3(3000.0, -200.0, 700.0)
	planet.position -= shift
	viewer.position -= shift
	scatter.world_offset = shift
	await settle(scatter)
	var after := near(instances(scatter, 0), Vector3(0.0, 0.0, 100.0) - shift, 20.0)
	check(before.size() > 200 and before.keys().all(func(id: int) -> bool: return after.has(id)), "the same instances: %d, %d" % [before.size(), after.size()])
	check(off_radial(after, -shift) < 0.01, "still upright, got %.4f degrees" % off_radial(after, -shift))


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


func make_region(shape: ScatterRegion3D.Shape, up: Vector3, altitude := 0.0) -> ScatterRegion3D:
	var region := ScatterRegion3D.new()
	region.shape = shape
	var side := up.cross(Vector3(0.3, 0.2, 0.9)).normalized()
	region.transform = Transform3D(Basis(side, up, side.cross(up)), up * (100.0 + altitude))
	return region


## Checks that a region removes exactly the instances for which `is_inside` returns true, and that they return without it. Instances for which
## `is_border` returns true may be on either side.
func check_region(scatter: TerrainScatter3D, region: ScatterRegion3D, is_inside: Callable, context: String, is_border := Callable()) -> void:
	var before := instances(scatter, 0)
	scatter.add_child(region)
	await settle(scatter)
	check_equal(region.get_problems().size(), 0, "%s: problems: %s" % [context, region.get_problems()])
	var after := instances(scatter, 0)
	var inside := 0
	var wrong := 0
	for id in before:
		var removed: bool = is_inside.call(before[id].origin)
		inside += int(removed)
		wrong += int(removed == after.has(id) and not (is_border.is_valid() and is_border.call(before[id].origin)))
	check(inside > 50 and inside < before.size() / 2.0, "%s: %d of %d instances are inside" % [context, inside, before.size()])
	check_equal(wrong, 0, "%s: instances on the wrong side of the border" % context)
	scatter.remove_child(region)
	await settle(scatter)
	check_equal(instances(scatter, 0).size(), before.size(), "%s: all instances return without the region" % context)


## Regions that ignore height extend along the direction away from the center, at every latitude, and have no effect on the far side.
func test_regions_at_every_latitude() -> void:
	put_planet(100.0, Vector3.ZERO, 128)
	var layer := make_grower(1.5)
	layer.tile_size = 32.0
	layer.view_distance = 300.0
	viewer = make_viewer()
	var scatter := make_scatter([layer], make_ground(100.0), viewer)
	await settle(scatter)
	for latitude: float in [90.0, 50.0, 0.0, -90.0]:
		var up := direction(latitude)
		var region := make_region(ScatterRegion3D.SHAPE_CYLINDER, up, 20.0)
		region.radius = 12.0
		region.height = 1.0
		region.ignore_height = true
		await check_region(scatter, region, func(at: Vector3) -> bool:
			return at.dot(up) > 0.0 and 120.0 * (at.normalized() - up * up.dot(at.normalized())).length() < 12.0, "cylinder at %.0f" % latitude)
		region.shape = ScatterRegion3D.SHAPE_BOX
		region.size = Vector3(30.0, 1.0, 18.0)
		var axes := region.basis
		await check_region(scatter, region, func(at: Vector3) -> bool:
			var local := axes.inverse() * (120.0 * at.normalized())
			return local.y > 0.0 and absf(local.x) < 15.0 and absf(local.z) < 9.0, "box at %.0f" % latitude)
		region.shape = ScatterRegion3D.SHAPE_POLYGON
		region.polygon = PackedVector2Array([Vector2(-14.0, -14.0), Vector2(14.0, -14.0), Vector2(14.0, 14.0), Vector2(-14.0, 14.0)])
		# Corners that are 20 m above the ground are seen from the center in the stereographic projection of the region's middle.
		var corner := 200.0 * 14.0 / (120.0 + Vector3(14.0, 120.0, 14.0).length())
		await check_region(scatter, region, func(at: Vector3) -> bool:
			var local := axes.inverse() * at.normalized()
			return local.y > -0.9 and maxf(absf(local.x), absf(local.z)) * 200.0 / (1.0 + local.y) < corner, "polygon at %.0f" % latitude)
		region.free()
		var path := Path3D.new()
		path.curve = Curve3D.new()
		var side := up.cross(Vector3(0.3, 0.2, 0.9)).normalized()
		for step in 121:
			path.curve.add_point(100.0 * up.rotated(side, deg_to_rad(step - 60.0)))
		scatter.add_child(path)
		region = make_region(ScatterRegion3D.SHAPE_PATH, up)
		region.path = NodePath("../" + path.name)
		region.width = 6.0
		var ends := PackedVector3Array([up.rotated(side, deg_to_rad(60.0)), up.rotated(side, deg_to_rad(-60.0))])
		await check_region(scatter, region, func(at: Vector3) -> bool:
			var there := at.normalized()
			var beside := absf(there.dot(side)) < 0.03 and there.angle_to(up) < deg_to_rad(60.0)
			return beside or there.distance_to(ends[0]) < 0.03 or there.distance_to(ends[1]) < 0.03, "path at %.0f" % latitude,
			# The scale of the map changes by 2 % across a rounded end, which is a circle on the map.
			func(at: Vector3) -> bool:
				var distance := minf(at.normalized().distance_to(ends[0]), at.normalized().distance_to(ends[1]))
				return absf(distance - 0.03) < 0.0006)
		region.free()
		path.free()


func test_regions_without_area_are_reported() -> void:
	put_planet(100.0, Vector3.ZERO, 64)
	var ground := make_ground(100.0)
	viewer = make_viewer(Vector3(0.0, 101.0, 0.0))
	var scatter := make_scatter([make_grower()], ground, viewer)
	var region := make_region(ScatterRegion3D.SHAPE_CYLINDER, Vector3.UP)
	scatter.add_child(region)
	region.position = Vector3.ZERO
	check_equal(region.get_problems().size(), 0, "with its own height, a region works at the center: %s" % region.get_problems())
	region.ignore_height = true
	check("center" in str(region.get_problems()) and "ignore_height" in str(region.get_problems()), "there is no up at the center: %s" % region.get_problems())
	await settle(scatter)
	check_error(["planet's center", "ignore_height"], "the center")
	region.shape = ScatterRegion3D.SHAPE_POLYGON
	region.polygon = PackedVector2Array([Vector2(-9.0, -9.0), Vector2(9.0, -9.0), Vector2(9.0, 9.0), Vector2(-9.0, 9.0)])
	region.position = Vector3(100.0, 0.0, 0.0)
	check("is too steep on the planet" in str(region.get_problems()), "a steep polygon: %s" % region.get_problems())
	region.rotation.z = -PI / 2.0
	check_equal(region.get_problems().size(), 0, "no problems with an upright polygon: %s" % region.get_problems())
	region.rotation.z = 0.0
	ground.planet_radius = 0.0
	check_equal(region.get_problems().size(), 0, "no problems without a planet: %s" % region.get_problems())


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


## The editor's tools use these two methods of the node.
func test_up_and_lines_that_meet_the_ground() -> void:
	put_planet(100.0, Vector3.ZERO, 128)
	var ground := make_ground(100.0)
	viewer = make_viewer(Vector3(0.0, 101.0, 0.0))
	var scatter := make_scatter([make_grower()], ground, viewer)
	await settle(scatter)
	for up: Vector3 in [Vector3.UP, Vector3.DOWN, Vector3.RIGHT, Vector3(0.6, 0.0, -0.8)]:
		check(scatter._up_at(up * 120.0).distance_to(up) < 1e-5, "up at %s: %s" % [up, scatter._up_at(up * 120.0)])
		var hit := scatter._hit_surface(up * 150.0, up * 50.0)
		if check(hit.size() == 2, "a line from above hits the ground at %s" % up):
			check(hit[0].distance_to(up * 100.0) < 0.2 and hit[1].distance_to(up) < 0.05, "the hit is on the surface and has its normal: %s" % [hit])
		check(scatter._hit_surface(up * 150.0, up * 120.0).is_empty(), "a line that ends above %s hits nothing" % up)
	scatter.ground = ScatterGroundFlat.new()
	await settle(scatter)
	check_equal(scatter._up_at(Vector3.RIGHT), Vector3.UP, "up without a planet")
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


## A ground without a known distance from the planet's center limits no search for tiles: layers grow on it and on the planet.
func test_a_planet_combined_with_ground_of_unknown_extent() -> void:
	put_planet(100.0, Vector3.ZERO, 64)
	var heights := Image.create_empty(9, 9, false, Image.FORMAT_RF)
	heights.fill(Color(130.0, 0.0, 0.0))
	var plateau := ScatterGroundHeightmap.new()
	plateau.image = heights
	plateau.heights_in_meters = true
	plateau.rect = Rect2(-10.0, -10.0, 20.0, 20.0)
	var combined := ScatterGroundCombined.new()
	combined.grounds = [make_ground(100.0), plateau]
	viewer = make_viewer(Vector3(0.0, 115.0, 0.0))
	var scatter := make_scatter([make_grower()], combined, viewer)
	await settle(scatter)
	var counts := [0, 0]
	for at: Transform3D in instances(scatter, 0).values():
		counts[int(at.origin.y > 129.9)] += 1
	check(counts[0] > 500, "%d instances on the planet" % counts[0])
	check(counts[1] > 60, "%d instances on the plateau above it" % counts[1])
	check_equal(scatter.get_problems().size(), 0, "problems: %s" % scatter.get_problems())


## A node that reenters the tree has the same instances, although its ground must read the planet again.
func test_a_node_leaves_and_reenters_the_tree() -> void:
	put_planet(100.0, Vector3.ZERO, 64)
	viewer = make_viewer(Vector3(0.0, 101.0, 0.0))
	var scatter := make_scatter([make_grower()], make_ground(100.0), viewer)
	await settle(scatter)
	var before := instances(scatter, 0)
	check(before.size() > 500, "%d instances" % before.size())
	root.remove_child(scatter)
	await frames(3)
	root.add_child(scatter)
	await settle(scatter)
	check_equal(instances(scatter, 0) == before, true, "the same instances")


## A node that reenters the tree while a worker rebuilds the shared ground has all its instances once the ground is complete.
func test_a_node_reenters_the_tree_while_the_ground_is_rebuilt() -> void:
	var planet := put_planet(100.0, Vector3.ZERO, 64)
	var ground := make_ground(100.0)
	viewer = make_viewer(Vector3(0.0, 101.0, 0.0))
	var scatters: Array[TerrainScatter3D] = []
	for index in 2:
		scatters.push_back(make_scatter([make_grower()], ground, viewer))
	for scatter in scatters:
		await settle(scatter)
	root.remove_child(scatters[1])
	await frames(3)
	var reads: int = scatters[0].get_stats()["ground_reads"]
	(planet.mesh as SphereMesh).radial_segments = 1024
	(planet.mesh as SphereMesh).rings = 512
	await until(func() -> bool: return scatters[0].get_stats()["ground_reads"] > reads, "the planet's new mesh is read")
	check(not scatters[0].is_settled(), "the ground is being rebuilt")
	root.add_child(scatters[1])
	for scatter in scatters:
		await settle(scatter)
	var expected := instances(scatters[0], 0)
	check(expected.size() > 500, "%d instances" % expected.size())
	check_equal(instances(scatters[1], 0) == expected, true, "the same instances on both nodes")
