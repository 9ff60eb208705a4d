extends "harness.gd"
## Tests that baked navigation meshes exclude the instances in their area, whether their tiles are loaded or not.

const CELL := 0.125  ## The cell size and cell height in meters.
const AGENT := 0.5   ## The agent's radius in meters.
const TRUNK := 0.4   ## The layer's instance_radius in meters.
const SIDE := 48.0   ## The edge length of the ground in meters. The ground is centered at the origin.
const ERROR := 0.2   ## The tolerance in meters for the simplified outline of a baked mesh and the size of its cells.


func solid_layer(radius := 5.0) -> ScatterLayer:
	var layer := make_layer(radius)
	layer.collision_shape = ScatterLayer.COLLISION_CYLINDER
	layer.instance_radius = TRUNK
	layer.instance_height = 4.0
	return layer


## Adds a region to the tree, with a flat ground whose top is at height 0.
func make_region(side := SIDE) -> NavigationRegion3D:
	var mesh := NavigationMesh.new()
	mesh.cell_size = CELL
	mesh.cell_height = CELL
	mesh.agent_radius = AGENT
	mesh.agent_height = 1.5
	mesh.agent_max_climb = 0.25
	mesh.edge_max_error = 1.0
	mesh.geometry_parsed_geometry_type = NavigationMesh.PARSED_GEOMETRY_STATIC_COLLIDERS
	var region := NavigationRegion3D.new()
	region.navigation_mesh = mesh
	root.add_child(region)
	NavigationServer3D.map_set_cell_size(region.get_navigation_map(), CELL)
	NavigationServer3D.map_set_cell_height(region.get_navigation_map(), CELL)
	region.add_child(make_floor(side))
	return region


func make_floor(side: float) -> StaticBody3D:
	var box := BoxShape3D.new()
	box.size = Vector3(side, 1, side)
	var shape := CollisionShape3D.new()
	shape.shape = box
	var body := StaticBody3D.new()
	body.name = "Floor"
	body.position.y = -0.5
	body.add_child(shape)
	return body


## Adds a scatter as a child of the region. It ends up without a viewer, so no tiles are loaded.
func plant(region: NavigationRegion3D, layers: Array[ScatterLayer]) -> TerrainScatter3D:
	var scatter := make_scatter(layers, ScatterGroundFlat.new(), make_viewer(Vector3(1e5, 0, 0)))
	scatter.reparent(region, false)
	scatter.viewers = []
	return scatter


func bake(region: NavigationRegion3D) -> NavigationMesh:
	region.bake_navigation_mesh(false)
	return region.navigation_mesh


## Returns the obstructions that parsing the region's source geometry finds.
func obstructions(region: NavigationRegion3D) -> Array:
	var data := NavigationMeshSourceGeometryData3D.new()
	NavigationServer3D.parse_source_geometry_data(region.navigation_mesh, data, region)
	return data.get_projected_obstructions()


## Returns the distance on the map, in meters, from a position to the nearest polygon of a mesh. Returns 0 inside a polygon.
## If `height` is not NAN, only polygons within a meter of that height are included.
func clearance(mesh: NavigationMesh, at: Vector2, height := NAN) -> float:
	var minimum := INF
	var vertices := mesh.get_vertices()
	for index in mesh.get_polygon_count():
		if absf(vertices[mesh.get_polygon(index)[0]].y - height) > 1.0:
			continue
		var outline := PackedVector2Array()
		for corner in mesh.get_polygon(index):
			outline.push_back(Vector2(vertices[corner].x, vertices[corner].z))
		if Geometry2D.is_point_in_polygon(at, outline):
			return 0.0
		for corner in outline.size():
			var nearest := Geometry2D.get_closest_point_to_segment(at, outline[corner - 1], outline[corner])
			minimum = minf(minimum, nearest.distance_to(at))
	return minimum


## Checks that the mesh keeps a distance of the instance's radius plus the agent's radius from every instance, and at most about two cells
## more. Skips instances near the border. Returns the number of instances that were checked.
func check_left_out(mesh: NavigationMesh, found: ScatterInstances, context: String, radius := TRUNK, to_mesh := Transform3D.IDENTITY) -> int:
	var seen := 0
	for index in found.size():
		var at := on_map(to_mesh * found.get_transform(index))
		if maxf(absf(at.x), absf(at.y)) < SIDE * 0.5 - 2.5:
			seen += 1
			var free := clearance(mesh, at)
			var expected := radius * found.get_transform(index).basis.get_scale().x + AGENT
			check(free > expected - ERROR and free < expected * 1.04 + 2.0 * CELL + ERROR,
					"%s: %.3f m free around %s instead of %.3f" % [context, free, at, expected])
	return seen


func within(side := SIDE) -> Rect2:
	return Rect2(-side / 2, -side / 2, side, side)


func test_a_bake_leaves_out_every_trunk() -> void:
	var region := make_region()
	var scatter := plant(region, [solid_layer()])
	var before := bake(region)
	check(scatter.get_shown_tiles(scatter.layers[0]).is_empty(), "no tiles are loaded")
	var found := scatter.query_rect(within())
	var seen := check_left_out(before, found, "unloaded")
	check(seen > 40, "%d trunks" % seen)
	check(clearance(before, Vector2(1.3, 1.7)) == 0.0 or found.size() > 0, "some ground is left")
	var viewer := make_viewer()
	scatter.viewers = [scatter.get_path_to(viewer)]
	await settle(scatter)
	check(not scatter.get_shown_tiles(scatter.layers[0]).is_empty(), "loaded")
	var vertices := before.get_vertices()
	check(bake(region).get_vertices() == vertices, "loaded tiles do not change the baked mesh")
	scatter.visible = false
	check(bake(region).get_vertices() == vertices, "hiding the node does not change the baked mesh")


## An instance blocks only the level on which it is placed.
func test_levels_of_a_layer_on_surfaces() -> void:
	const UPPER := 6.0
	var region := make_region()
	var upper := make_floor(SIDE)
	upper.position.y += UPPER
	region.add_child(upper)
	for body in region.get_children():
		body.add_to_group(&"levels")
	var ground := ScatterGroundMeshes.new()
	ground.group = &"levels"
	var layer := solid_layer()
	layer.on_surfaces = true
	layer.instance_height = 1.0
	var scatter := plant(region, [layer])
	scatter.ground = ground
	await frames(10)
	var mesh := bake(region)
	var found := scatter.query_rect(within())
	var blocked := {0.0: 0, UPPER: 0}
	var open := {0.0: 0, UPPER: 0}
	for index in found.size():
		var at := on_map(found.get_transform(index))
		if maxf(absf(at.x), absf(at.y)) > SIDE * 0.5 - 2.5:
			continue
		var own := snappedf(found.get_position(index).y, UPPER)
		var other := UPPER - own
		blocked[own] += int(clearance(mesh, at, own) > TRUNK + AGENT - ERROR)
		open[other] += int(clearance(mesh, at, other) == 0.0)
	for height: float in blocked:
		check(blocked[height] > 30, "at %.0f m, %d instances block the level on which they are placed" % [height, blocked[height]])
		check(open[height] > 20, "at %.0f m, the level is open at %d positions where an instance is on the other level" % [height, open[height]])
	check_equal(blocked[0.0] + blocked[UPPER], checked(found), "every instance blocks its level")


func checked(found: ScatterInstances) -> int:
	var count := 0
	for index in found.size():
		var at := on_map(found.get_transform(index))
		count += int(maxf(absf(at.x), absf(at.y)) <= SIDE * 0.5 - 2.5)
	return count


func test_a_stem_thinner_than_a_cell_is_left_out() -> void:
	var layer := solid_layer()
	layer.instance_radius = 0.01
	var region := make_region()
	var scatter := plant(region, [layer])
	check(check_left_out(bake(region), scatter.query_rect(within()), "thin", 0.01) > 40, "thin stems")


func test_paths_avoid_instances() -> void:
	var region := make_region()
	var scatter := plant(region, [solid_layer()])
	bake(region)
	var found := scatter.query_rect(within())
	var map := region.get_navigation_map()
	var from := Vector3(-SIDE / 2 + 1, 0, -SIDE / 2 + 1)
	await until(func() -> bool: return NavigationServer3D.map_get_path(map, from, -from, true).size() > 2, "a path exists")
	var path := NavigationServer3D.map_get_path(map, from, -from, true)
	check(path[-1].distance_to(-from) < 1.0, "the path reaches its end: %s" % path[-1])
	var minimum := INF
	for index in found.size():
		for step in range(1, path.size()):
			var nearest := Geometry3D.get_closest_point_to_segment(found.get_position(index), path[step - 1], path[step])
			minimum = minf(minimum, Vector2(nearest.x - found.get_position(index).x, nearest.z - found.get_position(index).z).length())
	check(minimum > TRUNK + AGENT - ERROR, "the path keeps a distance of %.3f m from trunks" % minimum)
	check(minimum < 4.0, "the path passes close to trees")


func test_changes_by_a_game() -> void:
	var region := make_region()
	var scatter := plant(region, [solid_layer()])
	var found := scatter.query_sphere(Vector3.ZERO, 15.0)
	var gone := on_map(found.get_transform(0))
	check(clearance(bake(region), gone) > TRUNK, "the tree is an obstacle")
	scatter.remove_instance(found.get_id(0))
	check(clearance(bake(region), gone) == 0.0, "a removed tree is not an obstacle")
	scatter.restore_instance(found.get_id(0))
	check(clearance(bake(region), gone) > TRUNK, "a restored tree is an obstacle")
	var id := scatter.add_instance(scatter.layers[0], Transform3D(Basis(), Vector3(gone.x + 1.5, 0, gone.y)))
	check(clearance(bake(region), gone + Vector2(1.5, 0)) > TRUNK, "a hand-placed tree is an obstacle")
	scatter.remove_instance(id)
	check(clearance(bake(region), gone + Vector2(1.7, 0)) == 0.0, "and removed")


func test_scale_tilt_and_height() -> void:
	var layer := solid_layer()
	layer.density = 0.0
	layer.instance_height = 10.0
	var region := make_region()
	var scatter := plant(region, [layer])
	scatter.add_instance(scatter.layers[0], Transform3D(Basis.from_scale(Vector3(4, 1, 4)), Vector3(-12, 0, 0)))
	# This instance leans toward x by 45 degrees.
	scatter.add_instance(scatter.layers[0], Transform3D(Basis(Vector3.BACK, -PI / 4), Vector3(0, 0, 0)))
	scatter.add_instance(scatter.layers[0], Transform3D(Basis.from_scale(Vector3.ONE * 0.5), Vector3(12, 0, 0)))
	# This instance is above the agents' height.
	scatter.add_instance(scatter.layers[0], Transform3D(Basis(), Vector3(0, 3, 12)))
	scatter.add_instance(scatter.layers[0], Transform3D(Basis(), Vector3(0, -12, -12))) # This instance ends below the agents.
	scatter.add_instance(scatter.layers[0], Transform3D(Basis(), Vector3(12, 1, 12)))  # This instance obstructs agents.
	var mesh := bake(region)
	var wide := clearance(mesh, Vector2(-12, 0))
	check(absf(wide - (4 * TRUNK + AGENT)) < 2 * CELL + ERROR, "scaled: %.3f m" % wide)
	check(clearance(mesh, Vector2(-1.3, 0)) == 0.0, "free on the far side of a leaning instance")
	check(clearance(mesh, Vector2(1.4, 0)) > AGENT, "not free where an agent would hit its head")
	check(clearance(mesh, Vector2(6.0, 0)) == 0.0, "free below a high part")
	var small := clearance(mesh, Vector2(12, 0))
	check(absf(small - (0.5 * TRUNK + AGENT)) < 2 * CELL + ERROR, "scaled down: %.3f m" % small)
	check(clearance(mesh, Vector2(0, 12)) == 0.0, "too high to be an obstacle")
	check(clearance(mesh, Vector2(0, -12)) == 0.0, "too deep to be an obstacle")
	check(clearance(mesh, Vector2(12, 12)) > TRUNK, "an obstacle at head height")


## Instances with an extreme scale are ignored and reported, regardless of their position and number.
func test_giant_instances_are_ignored() -> void:
	var region := make_region()
	var scatter := plant(region, [solid_layer()])
	scatter.state = ScatterState.new()
	var expected := obstructions(region).size()
	check(expected > 40, "%d trunks" % expected)
	var giant := Basis.from_scale(Vector3.ONE * 1e6)
	var first := scatter.add_instance(scatter.layers[0], Transform3D(giant, Vector3(3, 0, 2)))
	check(obstructions(region).size() == expected, "all instances except the giant are obstructions")
	check_error(["hand-placed instance %d of layer 0" % first, "1000 m", "smaller scale"], "one giant")
	scatter.add_instance(scatter.layers[0], Transform3D(giant, Vector3(50000, 0, 0)))
	check(obstructions(region).size() == expected, "all instances except both giants are obstructions")
	check_error(["%d and 1 more of layer 0" % first], "two giants")
	# An instance as large as a rock is not ignored, even if it reaches into the baked area from far outside.
	scatter.remove_instances(scatter.state.get_added())
	scatter.state.clear()
	check(obstructions(region).size() == expected, "as before")
	scatter.add_instance(scatter.layers[0], Transform3D(Basis.from_scale(Vector3(200, 1, 200)), Vector3(90, 0, 0)))
	check(obstructions(region).size() == expected + 1, "a large instance is an obstruction")
	check(clearance(bake(region), Vector2(20, 0)) > 5.0, "a large instance blocks agents")


func test_slopes() -> void:
	var region := make_region()
	var body := region.get_node(^"Floor") as StaticBody3D
	var shape := ConcavePolygonShape3D.new()
	var rise := 0.5
	var a := Vector3(-20, -20 * rise, -20)
	var b := Vector3(20, 20 * rise, -20)
	var c := Vector3(20, 20 * rise, 20)
	var d := Vector3(-20, -20 * rise, 20)
	shape.set_faces(PackedVector3Array([a, b, c, a, c, d]))
	body.position = Vector3.ZERO
	(body.get_child(0) as CollisionShape3D).shape = shape
	var layer := solid_layer()
	layer.instance_radius = 1.5
	layer.instance_height = 0.3
	layer.density = 0.0
	var scatter := plant(region, [layer])
	for x in range(-10, 11, 10):
		scatter.add_instance(scatter.layers[0], Transform3D(Basis(), Vector3(x, x * rise, 0)))
	var mesh := bake(region)
	for x in range(-10, 11, 10):
		for angle in 16:
			var side := Vector2.from_angle(angle * TAU / 16) * 1.4
			check(clearance(mesh, Vector2(x, 0) + side) > 0.2, "a flat stone on a slope, at %s" % side)


func test_only_instances_in_the_baked_area_count() -> void:
	var region := make_region()
	var scatter := plant(region, [solid_layer()])
	var all := obstructions(region).size()
	var stands := scatter.query_rect(within()).size()
	check(all >= stands and all < stands * 1.5, "%d obstructions for %d instances on the ground" % [all, stands])
	region.move_child(scatter, 0)
	check_equal(obstructions(region).size(), all, "obstructions if the scatter comes before the ground")
	var below := Node3D.new()
	region.add_child(below)
	below.add_child(Node.new())
	check_equal(obstructions(region).size(), all, "obstructions if other nodes come after the scatter")
	region.navigation_mesh.filter_baking_aabb = AABB(Vector3(-5, -1, -5), Vector3(10, 4, 10))
	var some := obstructions(region).size()
	check(some > 0 and some <= scatter.query_rect(within(13)).size(), "%d obstructions are in the box" % some)
	region.navigation_mesh.filter_baking_aabb_offset = Vector3(3e4, 0, 0)
	var far := obstructions(region).size()
	check(far > 0 and far < 20, "%d obstructions are in a box far from the ground" % far)
	region.navigation_mesh.filter_baking_aabb_offset = Vector3(0, 50, 0)
	check_equal(obstructions(region).size(), 0, "obstructions in a box above the trees")
	region.navigation_mesh.filter_baking_aabb = AABB()
	region.get_node(^"Floor").free()
	check_equal(obstructions(region).size(), 0, "obstructions without ground, where the baked area would be unlimited")
	region.add_child(make_floor(1e5))
	check_equal(obstructions(region).size(), 0, "obstructions in an area with too many instances")
	check_error(["TerrainScatter3D", "navigation", "rect"], "an area with too many instances")


func test_source_geometry_modes() -> void:
	var region := make_region()
	var scatter := plant(region, [solid_layer()])
	var all := obstructions(region).size()
	var mesh := region.navigation_mesh
	scatter.reparent(root, false)
	check_equal(obstructions(region).size(), 0, "obstructions of a scatter outside of the region")
	mesh.geometry_source_geometry_mode = NavigationMesh.SOURCE_GEOMETRY_GROUPS_EXPLICIT
	mesh.geometry_source_group_name = "walls"
	region.get_node(^"Floor").add_to_group("walls")
	check_equal(obstructions(region).size(), 0, "obstructions of a scatter that is not in the group")
	scatter.add_to_group("walls")
	check_equal(obstructions(region).size(), all, "obstructions of a scatter in the group")
	mesh.geometry_source_geometry_mode = NavigationMesh.SOURCE_GEOMETRY_GROUPS_WITH_CHILDREN
	check_equal(obstructions(region).size(), all, "obstructions of a scatter in the group, in the mode with children")
	scatter.remove_from_group("walls")
	region.add_to_group("walls")
	scatter.reparent(region, false)
	check_equal(obstructions(region).size(), all, "obstructions of a scatter below a node in the group")
	scatter.add_to_group("walls")
	check_equal(obstructions(region).size(), all, "obstructions if the scatter and its parent are in the group")
	scatter.remove_from_group("walls")
	region.get_node(^"Floor").remove_from_group("walls")
	region.position = Vector3(7, 0, -3)
	region.rotation.y = 0.6
	var turned := bake(region)
	var found := scatter.query_rect(Rect2(-40, -40, 80, 80))
	check(check_left_out(turned, found, "turned", TRUNK, region.global_transform.affine_inverse()) > 40, "a rotated region")


func test_settings_of_layers() -> void:
	var region := make_region()
	var layer := solid_layer()
	var grass := make_layer(1.0)
	plant(region, [grass, layer])
	var all := obstructions(region).size()
	check(all > 40 and all < 150, "only trees: %d" % all)
	layer.affect_navigation_mesh = false
	check_equal(obstructions(region).size(), 0, "obstructions of a layer with affect_navigation_mesh disabled")
	layer.affect_navigation_mesh = true
	layer.collision_distance = 0.0
	check_equal(obstructions(region).size(), all, "without bodies")
	layer.collision_layer = 4
	check_equal(obstructions(region).size(), all, "obstructions of a layer on another physics layer")
	region.navigation_mesh.geometry_collision_mask = 3
	check_equal(obstructions(region).size(), 0, "obstructions on a physics layer that the bake excludes")
	region.navigation_mesh.geometry_parsed_geometry_type = NavigationMesh.PARSED_GEOMETRY_MESH_INSTANCES
	region.navigation_mesh.filter_baking_aabb = AABB(Vector3(-24, -1, -24), Vector3(48, 4, 48))
	check_equal(obstructions(region).size(), all, "the mask has no effect on mesh instances")


func test_world_offset() -> void:
	var region := make_region()
	var scatter := plant(region, [solid_layer()])
	scatter.world_offset = Vector3(81920, 0, -4096)
	check(check_left_out(bake(region), scatter.query_rect(within()), "far away") > 40, "moved")


func test_nodes_are_added_and_removed_between_bakes() -> void:
	var region := make_region()
	region.navigation_mesh.filter_baking_aabb = AABB(Vector3(-24, -1, -24), Vector3(48, 4, 48))
	var scatter := plant(region, [solid_layer()])
	var other := plant(region, [solid_layer(7.0)])
	var both := obstructions(region).size()
	region.remove_child(other)
	var one := obstructions(region).size()
	check(one > 0 and one < both, "one of the two nodes still has obstructions: %d of %d" % [one, both])
	region.add_child(other)
	check_equal(obstructions(region).size(), both, "both again")
	scatter.free()
	check_equal(obstructions(region).size(), both - one, "obstructions after one node was freed")
	other.layers = []
	check_equal(obstructions(region).size(), 0, "without layers")
	other.layers = [solid_layer()]
	other.ground = null
	check_equal(obstructions(region).size(), 0, "obstructions without a ground")
	other.free()
	check(clearance(bake(region), Vector2.ZERO) == 0.0, "the baked mesh has no hole")


## A ground that removes a node from the tree and frees it during a query.
class FreeingGround extends ScatterGround:
	var node: TerrainScatter3D
	var armed := false

	func _get_heights(positions: PackedVector2Array) -> PackedFloat32Array:
		if armed and node != null:
			armed = false
			node.get_parent().remove_child(node)
			node.queue_free()
		var heights := PackedFloat32Array()
		heights.resize(positions.size())
		return heights


func test_a_script_may_free_the_node_in_a_bake() -> void:
	var region := make_region()
	var scatter := plant(region, [solid_layer()])
	var freeing := FreeingGround.new()
	scatter.ground = freeing
	var all := obstructions(region).size()
	check(all > 40, "the scatter has more than 40 obstructions")
	scatter.regenerate()
	freeing.node = scatter
	freeing.armed = true
	obstructions(region)
	check(not freeing.armed, "the ground was queried")
	await frames(2)
	check(not is_instance_valid(scatter), "the node is freed")
	check(clearance(bake(region), Vector2.ZERO) == 0.0, "bakes still work")


func test_bakes_in_a_thread() -> void:
	var region := make_region()
	var scatter := plant(region, [solid_layer()])
	var done: Array[bool] = [false]
	region.bake_finished.connect(func() -> void: done[0] = true)
	region.bake_navigation_mesh(true)
	await until(func() -> bool: return done[0], "the bake is finished")
	check(check_left_out(region.navigation_mesh, scatter.query_rect(within()), "threaded") > 40, "all instances are left out")
