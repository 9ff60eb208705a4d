extends "harness.gd"
## Tests PoissonSampler.sample_surface and PoissonSampler.sample_faces.

const DENSITY := 0.547070 / (PI / 4.0) ## The number of points on an area of one squared radius.


func make_sphere(radius: float) -> SphereMesh:
	var sphere := SphereMesh.new()
	sphere.radius = radius
	sphere.height = 2.0 * radius
	sphere.radial_segments = 96
	sphere.rings = 48
	return sphere


func make_sampler(radius := 1.0) -> PoissonSampler:
	var sampler := PoissonSampler.new()
	sampler.seed = 5
	sampler.radius = radius
	return sampler


func nearest_of(positions: PackedVector3Array) -> float:
	var found := INF
	for index in positions.size():
		for other in range(index + 1, positions.size()):
			found = minf(found, positions[index].distance_to(positions[other]))
	return found


func test_a_sphere_is_covered_evenly() -> void:
	var points := make_sampler().sample_surface(make_sphere(8.0))
	var expected := 4.0 * PI * 64.0 * DENSITY
	check(absf(points.size() - expected) < 0.05 * expected, "%d points, about %d expected" % [points.size(), expected])
	check(nearest_of(points.positions) > 0.99999, "no two points are closer than the radius: %f" % nearest_of(points.positions))
	var below := 0
	for index in points.size():
		below += int(points.positions[index].y < 0.0)
		check(points.normals[index].dot(points.positions[index].normalized()) > 0.99, "normals point to the outside")
	check(absf(below - 0.5 * points.size()) < 0.05 * points.size(), "%d of %d points are below the middle" % [below, points.size()])
	check_equal(points.ids.size(), points.size(), "each point has an id")
	check_equal(points.ranks.size(), points.size(), "each point has a rank")
	check_equal(points.faces.size(), points.size(), "each point has a face")


func test_faces_produce_the_same_points_as_their_mesh() -> void:
	var mesh := make_sphere(5.0)
	var points := make_sampler().sample_surface(mesh)
	var arrays := mesh.surface_get_arrays(0)
	var corners: PackedVector3Array
	for index: int in arrays[Mesh.ARRAY_INDEX]:
		corners.push_back(arrays[Mesh.ARRAY_VERTEX][index])
	var of_faces := make_sampler().sample_faces(corners)
	check(of_faces.positions == points.positions, "positions")
	check(of_faces.normals == points.normals, "normals")
	check(of_faces.faces == points.faces, "faces")


func test_windows_divide_a_surface() -> void:
	var sampler := make_sampler()
	var transform := Transform3D(Basis(Vector3(1, 2, 3).normalized(), 0.7), Vector3(100, 20, -30))
	var whole := sampler.sample_surface(make_sphere(6.0), transform)
	var found := {}
	for x in 2:
		for y in 2:
			var corner := Vector3(100 + 7 * (x - 1), 20 + 7 * (y - 1), -37)
			for id in sampler.sample_surface(make_sphere(6.0), transform, AABB(corner, Vector3(7, 7, 14))).ids:
				check(not found.has(id), "each point is in only one window")
				found[id] = true
	check_equal(found.size(), whole.size(), "points of all windows together")
	for id in whole.ids:
		check(found.has(id), "the point %d is in a window" % id)


func test_mirrored_meshes_have_outer_normals() -> void:
	var points := make_sampler().sample_surface(make_sphere(5.0), Transform3D(Basis.from_scale(Vector3(-1, 1, 1)), Vector3.ZERO))
	for index in points.size():
		check(points.normals[index].dot(points.positions[index]) > 0.0, "a normal points to the outside")


func test_a_face_leads_back_to_its_triangle() -> void:
	var faces := make_sphere(5.0).get_faces()
	var points := make_sampler().sample_faces(faces)
	for index in points.size():
		var first := 3 * points.faces[index]
		var plane := Plane(faces[first], faces[first + 1], faces[first + 2])
		check(absf(plane.distance_to(points.positions[index])) < 1e-4, "the point is on its face")


func test_bad_input_is_rejected() -> void:
	var sampler := make_sampler()
	check(sampler.sample_surface(null).is_empty(), "no mesh, no points")
	check_error(["mesh"], "a rejected call")
	var lines := ArrayMesh.new()
	var arrays := []
	arrays.resize(Mesh.ARRAY_MAX)
	arrays[Mesh.ARRAY_VERTEX] = PackedVector3Array([Vector3.ZERO, Vector3.RIGHT])
	lines.add_surface_from_arrays(Mesh.PRIMITIVE_LINES, arrays)
	check(sampler.sample_surface(lines).is_empty(), "no points on lines")
	check_error(["PRIMITIVE_TRIANGLES"], "a rejected call")
	check(sampler.sample_faces([Vector3.ZERO, Vector3.RIGHT]).is_empty(), "no points on a part of a triangle")
	check_error(["indices"], "a rejected call")
	check(sampler.sample_faces([Vector3.ZERO, Vector3.RIGHT, Vector3(0, NAN, 1)]).is_empty(), "no points without a position")
	check_error(["vertices"], "a rejected call")
	check(sampler.sample_surface(make_sphere(1.0), Transform3D(), AABB(Vector3.ZERO, -Vector3.ONE)).is_empty(), "no points in a negative box")
	check_error(["window"], "a rejected call")
