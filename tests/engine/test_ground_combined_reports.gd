extends "combined_harness.gd"
## Tests what a ScatterGroundCombined reports about its grounds: errors of a script, statistics, and whether they move with a node. Also tests
## that it re-reads all of them.

## A script that may only be called on the main thread. While it is broken, it returns one height for any number of positions.
class FailingScript extends ScatterGround:
	var broken := false

	func _get_heights(positions: PackedVector2Array) -> PackedFloat32Array:
		var heights := PackedFloat32Array()
		heights.resize(1 if broken else positions.size())
		return heights


## A script's error names the script's method, whether the script fails while tiles are generated or while they are re-checked.
func test_a_script_that_fails_is_reported() -> void:
	var script := FailingScript.new()
	script.broken = true
	var scatter := make_scatter([make_layer()], combine([make_terrain(), script, make_terrain(0.1)]), make_viewer())
	await settle(scatter)
	check_error(["_get_heights"], "a tile cannot be generated")
	check("_get_heights" in str(scatter.get_problems()), "problems while tiles are generated: %s" % scatter.get_problems())
	script.broken = false
	scatter.regenerate()
	await settle(scatter)
	check_equal(scatter.get_problems().size(), 0, "problems after the script was fixed: %s" % scatter.get_problems())
	var before := digests(scatter, 0)
	script.broken = true
	await until(func() -> bool: return "_get_heights" in str(scatter.get_problems()), "a re-check reports the script")
	check_error(["re-check of the ground", "_get_heights"], "a re-check")
	check_equal(digests(scatter, 0), before, "a failed re-check changes no tile")


## refresh_ground re-reads all grounds, even those whose content has changed without a signal.
func test_refresh_ground_reads_all_grounds_again() -> void:
	var plane := PlaneMesh.new()
	plane.size = Vector2(BRIDGE, BRIDGE)
	var mesh := ArrayMesh.new()
	mesh.add_surface_from_arrays(Mesh.PRIMITIVE_TRIANGLES, plane.get_mesh_arrays())
	put_bridge().mesh = mesh
	var terrain := make_terrain()
	var scatter := make_scatter([make_layer()], combine([terrain, make_bridges()]), make_viewer())
	await settle(scatter)
	plane.center_offset.y = 2.0
	RenderingServer.mesh_clear(mesh.get_rid())
	RenderingServer.mesh_add_surface_from_arrays(mesh.get_rid(), RenderingServer.PRIMITIVE_TRIANGLES, plane.get_mesh_arrays())
	(terrain.image as Image).fill(Color(3.0, 0.0, 0.0))
	scatter.refresh_ground()
	await settle(scatter)
	check_heights(scatter, func(at: Vector3) -> float: return HEIGHT + 2.0 if is_on_bridge(at) else 3.0)


## The statistics add up the work of all grounds.
func test_statistics_count_all_grounds() -> void:
	put_bridge()
	put_bridge(3.0).add_to_group(&"other")
	var others := make_bridges()
	others.group = &"other"
	var scatter := make_scatter([make_layer()], combine([make_bridges(), others, make_terrain()]), make_viewer())
	await settle(scatter)
	check_equal(scatter.get_stats()["ground_reads"], 3, "meshes read by the first ground, which has two, and by the second")


## With local_coords, a combination moves with the node only if all of its grounds do.
func test_local_coordinates_need_grounds_that_move_with_the_node() -> void:
	var bridge := put_bridge()
	var ship := Node3D.new()
	root.add_child(ship)
	bridge.reparent(ship)
	var ground := combine([make_bridges(), ScatterGroundFlat.new()])
	var viewer := make_viewer()
	var scatter := make_scatter([make_layer()], ground, viewer)
	scatter.local_coords = true
	scatter.reparent(ship)
	viewer.reparent(ship)
	scatter.viewers = [scatter.get_path_to(viewer)]
	await settle(scatter)
	check_equal(scatter.get_problems().size(), 0, "problems: %s" % scatter.get_problems())
	var area := Rect2(-4.0, -4.0, 8.0, 8.0)
	var before := scatter.query_rect(area)
	check(before.size() > 8, "%d instances" % before.size())
	ship.position = Vector3(0.0, 30.0, 0.0)
	await frames(20)
	await settle(scatter)
	var after := scatter.query_rect(area)
	check_equal(after.ids, before.ids, "the same instances after the ship has moved")
	for index in after.size():
		check(absf(after.get_position(index).y - 30.0 - before.get_position(index).y) < 1e-3, "an instance moves with the ship")
	ground.grounds = [make_bridges(), ScatterGroundColliders.new()]
	await frames(2)
	check("a ScatterGroundCombined does not move with the node" in str(scatter.get_problems()), "problems: %s" % scatter.get_problems())
