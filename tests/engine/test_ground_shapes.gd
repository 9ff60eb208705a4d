extends "terrain_harness.gd"
## Tests ground from the collision shapes of static bodies, from GridMaps and from CSG nodes in the group of a ScatterGroundMeshes. The
## ground is updated when these nodes change.

const RADIUS := 1.0
const DENSITY := 0.547 / (PI * 0.25) ## The number of points per square meter of surface at a radius of 1 m.

var made: Array[Node] = []


func put(node: Node3D, at := Vector3.ZERO) -> Node3D:
	node.position = at
	node.add_to_group(&"shapes")
	root.add_child(node)
	made.push_back(node)
	return node


func put_body(shape: Shape3D, at := Vector3.ZERO) -> StaticBody3D:
	var body := StaticBody3D.new()
	var collision := CollisionShape3D.new()
	collision.shape = shape
	body.add_child(collision)
	return put(body, at)


func make_growing(all_sides := true) -> TerrainScatter3D:
	var ground := ScatterGroundMeshes.new()
	ground.group = &"shapes"
	var layer := make_layer(RADIUS)
	layer.on_surfaces = all_sides
	layer.max_slope_degrees = 180.0 if all_sides else 45.0
	layer.tile_size = 16.0
	layer.view_distance = 40.0
	return make_scatter([layer], ground, make_viewer())


func clean() -> void:
	for node in made:
		if is_instance_valid(node):
			node.free()
	made.clear()
	await super()


func check_count(scatter: TerrainScatter3D, area: float, context: String) -> void:
	var count := instances(scatter, 0).size()
	var expected := area * DENSITY
	# Borders and edges have more points per area.
	check(count > 0.92 * expected and count < 1.15 * expected, "%s has %d instances, expected about %.0f" % [context, count, expected])


func box_shape(size: Vector3) -> BoxShape3D:
	var shape := BoxShape3D.new()
	shape.size = size
	return shape


func test_every_shape_of_a_body_is_covered() -> void:
	var sphere := SphereShape3D.new()
	sphere.radius = 6.0
	var capsule := CapsuleShape3D.new()
	capsule.radius = 3.0
	capsule.height = 12.0
	var cylinder := CylinderShape3D.new()
	cylinder.radius = 5.0
	cylinder.height = 8.0
	var hull := ConvexPolygonShape3D.new()
	var corners := PackedVector3Array()
	for corner in 8:
		corners.push_back(Vector3(10 if corner & 1 else 0, 4 if corner & 2 else 0, 8 if corner & 4 else 0))
	hull.points = corners
	var faces := ConcavePolygonShape3D.new()
	var plane := PlaneMesh.new()
	plane.size = Vector2(16, 16)
	faces.set_faces(plane.get_faces())
	var map := HeightMapShape3D.new()
	map.map_width = 21
	map.map_depth = 17
	var areas: Dictionary[Shape3D, float] = {
		box_shape(Vector3(10, 4, 8)): 2.0 * (40.0 + 80.0 + 32.0), sphere: 4.0 * PI * 36.0, capsule: 2.0 * PI * 3.0 * 12.0,
		cylinder: 2.0 * PI * 5.0 * 13.0, hull: 2.0 * (40.0 + 80.0 + 32.0), faces: 256.0, map: 320.0,
	}
	for shape in areas:
		put_body(shape)
		var scatter := make_growing()
		await settle(scatter)
		check_count(scatter, areas[shape], shape.get_class())
		check_equal(scatter.get_problems().size(), 0, "problems: %s" % scatter.get_problems())
		await clean()


func test_only_the_top_of_a_body_without_on_surfaces() -> void:
	put_body(box_shape(Vector3(20, 6, 20)))
	var scatter := make_growing(false)
	await settle(scatter)
	check_count(scatter, 400.0, "the top")
	for transform: Transform3D in instances(scatter, 0).values():
		check(absf(transform.origin.y - 3.0) < 1e-4, "an instance must be on the top, not at %s" % transform.origin)


func test_changed_shapes_are_detected() -> void:
	var body := put_body(box_shape(Vector3(16, 2, 16)))
	var scatter := make_growing(false)
	await settle(scatter)
	check_count(scatter, 256.0, "a box")
	(body.get_child(0) as CollisionShape3D).shape.size = Vector3(20, 2, 20)
	await settle(scatter)
	check_count(scatter, 400.0, "a resized box")
	var second := CollisionShape3D.new()
	second.shape = box_shape(Vector3(10, 2, 20))
	second.position.x = 15.0
	body.add_child(second)
	await settle(scatter)
	check_count(scatter, 600.0, "a body with a second shape")
	second.disabled = true
	await settle(scatter)
	check_count(scatter, 400.0, "a body with a disabled shape")
	second.free()
	body.position.y = 5.0
	await settle(scatter)
	for transform: Transform3D in instances(scatter, 0).values():
		check(absf(transform.origin.y - 6.0) < 1e-4, "an instance must move with the body, not be at %s" % transform.origin)
	body.remove_from_group(&"shapes")
	await settle(scatter)
	check_equal(instances(scatter, 0).size(), 0, "instances after the body has left the group")


func test_a_shape_without_triangles_is_rejected_with_its_name() -> void:
	put_body(box_shape(Vector3(16, 2, 16)))
	var scatter := make_growing()
	await settle(scatter)
	var endless := put_body(WorldBoundaryShape3D.new())
	endless.get_child(0).name = &"Endless"
	await settle(scatter)
	check("Endless" in "\n".join(scatter.get_problems()), "a problem names the shape: %s" % scatter.get_problems())
	check_error(["Endless", "has no triangles"], "a shape without triangles")
	check(instances(scatter, 0).size() > 100, "the other shape stays ground")


func make_library() -> MeshLibrary:
	var library := MeshLibrary.new()
	for item in 2:
		var box := BoxMesh.new()
		box.size = Vector3(4, 2 + 2 * item, 4)
		library.create_item(item)
		library.set_item_mesh(item, box)
	return library


func test_the_cells_of_a_grid_are_ground_and_changes_are_detected() -> void:
	var grid := GridMap.new()
	grid.mesh_library = make_library()
	grid.cell_size = Vector3(4, 4, 4)
	grid.cell_center_y = false
	for x in 5:
		for z in 5:
			grid.set_cell_item(Vector3i(x, 0, z), 0)
	put(grid)
	var scatter := make_growing(false)
	await settle(scatter)
	check_count(scatter, 400.0, "5 x 5 cells")
	check(instances(scatter, 0).values().all(func(at: Transform3D) -> bool: return absf(at.origin.y - 1.0) < 1e-4), "on low cells")
	for z in 5:
		grid.set_cell_item(Vector3i(0, 0, z), GridMap.INVALID_CELL_ITEM)
		grid.set_cell_item(Vector3i(4, 0, z), 1)
	await create_timer(0.2).timeout
	await settle(scatter)
	check_count(scatter, 320.0, "4 x 5 cells")
	var high := instances(scatter, 0).values().filter(func(at: Transform3D) -> bool: return absf(at.origin.y - 2.0) < 1e-4)
	check(high.size() > 40, "%d instances are on the high cells" % high.size())
	grid.clear()
	await create_timer(0.2).timeout
	await settle(scatter)
	check_equal(instances(scatter, 0).size(), 0, "instances on an empty grid")


func test_csg_is_ground_and_changes_are_detected() -> void:
	var solid := CSGBox3D.new()
	solid.size = Vector3(20, 2, 20)
	var hole := CSGBox3D.new()
	hole.size = Vector3(10, 4, 10)
	hole.operation = CSGShape3D.OPERATION_SUBTRACTION
	solid.add_child(hole)
	put(solid)
	await create_timer(0.1).timeout
	var scatter := make_growing(false)
	await settle(scatter)
	check_count(scatter, 300.0, "a box with a hole")
	hole.size = Vector3(10, 4, 16)
	await create_timer(0.2).timeout
	await settle(scatter)
	check_count(scatter, 240.0, "a box with a larger hole")


## A cell can mirror its mesh. Its front then stays its front.
func test_mirrored_cells_keep_their_front() -> void:
	var plane := PlaneMesh.new()
	plane.size = Vector2(4, 4)
	var library := MeshLibrary.new()
	for item in 2:
		library.create_item(item)
		library.set_item_mesh(item, plane)
		library.set_item_mesh_transform(item, Transform3D(Basis.from_scale(Vector3(1.0 - 2.0 * item, 1, 1)), Vector3.ZERO))
	var grid := GridMap.new()
	grid.mesh_library = library
	grid.cell_size = Vector3(4, 4, 4)
	grid.cell_center_y = false
	for x in 6:
		for z in 4:
			grid.set_cell_item(Vector3i(x, 0, z), int(x >= 3))
	put(grid)
	var scatter := make_growing()
	scatter.layers[0].max_slope_degrees = 45.0
	await settle(scatter)
	check_count(scatter, 6.0 * 4.0 * 16.0, "the upper sides of all cells")
	var mirrored := instances(scatter, 0).values().filter(func(at: Transform3D) -> bool: return at.origin.x > 12.0)
	check(mirrored.size() > 100, "%d instances on mirrored cells" % mirrored.size())
