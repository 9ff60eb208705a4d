extends "planet_harness.gd"
## Tests planets that appear, move, spin, are combined with other ground or are rebuilt.


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
