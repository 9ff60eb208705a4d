extends "planet_harness.gd"
## Tests regions on a planet: they extend along the direction away from its center. Also tests their problems, and the map that the editor's gizmos use.


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


## The editor's gizmos use the map of a region's planet, which follows a moved planet.
func test_maps_of_regions() -> void:
	var planet := Node3D.new()
	root.add_child(planet)
	put_planet(100.0, Vector3.ZERO, 64).reparent(planet, false)
	var scatter := make_scatter([make_grower()], make_ground(100.0), make_viewer(Vector3(0.0, 101.0, 0.0)))
	scatter.reparent(planet, false)
	scatter.local_coords = true
	var place := Transform3D(Basis(Vector3(1.0, 2.0, 3.0).normalized(), 1.0), Vector3(300.0, -20.0, 50.0))
	for up: Vector3 in [Vector3.UP, Vector3.DOWN, Vector3(0.6, 0.0, -0.8)]:
		planet.transform = place
		var center := Vector3(scatter._get_planet()[0], scatter._get_planet()[1], scatter._get_planet()[2])
		check(center.distance_to(place.origin) < 1e-3, "the center of the moved planet: %s" % center)
		var region := make_region(ScatterRegion3D.SHAPE_POLYGON, up)
		region.polygon = PackedVector2Array([Vector2(-9.0, -9.0), Vector2(9.0, -9.0), Vector2(9.0, 9.0), Vector2(-9.0, 9.0)])
		scatter.add_child(region)
		for shape: ScatterRegion3D.Shape in [ScatterRegion3D.SHAPE_POLYGON, ScatterRegion3D.SHAPE_BOX]:
			region.shape = shape
			var positions := PackedVector3Array()
			for index in 8:
				positions.append(region.global_transform * Vector3(3.0 * index, 0.0, -2.0 * index))
			var found := region._to_planet_map(positions)
			var places := PackedVector2Array()
			for at in found:
				places.append(Vector2(at.x, at.z))
			var ups := region._from_planet_map(places)
			for index in positions.size():
				var height := sqrt(maxf(0.0, 1e4 - places[index].length_squared()))
				var expected := place.origin.direction_to(positions[index])
				if shape == ScatterRegion3D.SHAPE_BOX: # Its shadow is along up.
					check(absf(places[index].length() - region.to_local(positions[index]).length()) < 1e-3, "%s: lengths in the shadow of a box" % up)
					expected = place.origin.direction_to(positions[index] + region.global_basis.y * (height - 100.0))
				check(ups[index].distance_to(expected) < 1e-4, "%s: position %d of shape %d is toward %s, expected %s" % [up, index, shape, ups[index], expected])
				check(found[index].y >= 1.0 and found[index].y < 1.1, "%s: the scale: %f" % [up, found[index].y])
		region.position = Vector3.ZERO
		check(region._to_planet_map(PackedVector3Array([Vector3.ONE])).is_empty(), "a box at the center has no map")
		check(region._from_planet_map(PackedVector2Array([Vector2.ONE])).is_empty(), "no directions, either")
		region.free()
	planet.free()
