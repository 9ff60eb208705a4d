extends "harness.gd"
## Base class for the tests of ScatterRegion3D. Provides regions, a field to put them in, and checks of the remaining instances.

const BEYOND := 0.001 # Tolerance in meters for single-precision rounding at these distances.


func make_region(shape: ScatterRegion3D.Shape, exclude := true) -> ScatterRegion3D:
	var region := ScatterRegion3D.new()
	region.shape = shape
	region.exclude = exclude
	return region


func make_field(layers := 1) -> TerrainScatter3D:
	var list: Array[ScatterLayer] = []
	for index in layers:
		var layer := make_layer(1.5)
		layer.resource_name = "layer %d" % index
		list.push_back(layer)
	return make_scatter(list, ScatterGroundFlat.new(), make_viewer())


## Checks that exactly the instances of `before` for which `stays` returns true remain, unmoved. More than 50 must remain, and more than 20
## must be removed.
func check_kept(scatter: TerrainScatter3D, before: Dictionary[int, Transform3D], stays: Callable, context: String) -> void:
	var after := instances(scatter, 0)
	var wrong := 0
	var kept_count := 0
	for id in before:
		var stands := after.has(id)
		kept_count += int(stands)
		wrong += int(stands != stays.call(before[id].origin) or (stands and after[id] != before[id]))
	check_equal(wrong, 0, context + ": wrong instances")
	check_equal(kept_count, after.size(), context + ": nothing new")
	check(kept_count > 50 and before.size() - kept_count > 20, "%s: %d of %d remain" % [context, kept_count, before.size()])


func distance_to_line(at: Vector2, line: PackedVector2Array) -> float:
	var nearest := INF
	for index in line.size() - 1:
		var closest := Geometry2D.get_closest_point_to_segment(at, line[index], line[index + 1])
		nearest = minf(nearest, at.distance_to(closest))
	return nearest


func within(region: ScatterRegion3D, at: Vector3) -> bool:
	var local := region.global_transform.affine_inverse() * at
	match region.shape:
		ScatterRegion3D.SHAPE_BOX:
			return (2.0 * local).abs().clamp(Vector3.ZERO, region.size) == (2.0 * local).abs()
		ScatterRegion3D.SHAPE_SPHERE:
			return at.distance_to(region.global_position) < region.radius
		ScatterRegion3D.SHAPE_CYLINDER:
			return Vector2(local.x, local.z).length() < region.radius and absf(local.y) < 0.5 * region.height
	return Geometry2D.is_point_in_polygon(Vector2(local.x, local.z), region.polygon)


func make_curve(points: PackedVector3Array) -> Curve3D:
	var curve := Curve3D.new()
	for point in points:
		curve.add_point(point, Vector3(-4, 0, -2), Vector3(4, 0, 2))
	return curve


func make_path(points: PackedVector3Array) -> Path3D:
	var path := Path3D.new()
	path.curve = make_curve(points)
	return path


## Checks that exactly the instances within 2.5 m of a path are removed.
func check_path(scatter: TerrainScatter3D, before: Dictionary[int, Transform3D], path: Path3D, context: String) -> void:
	await settle(scatter)
	var line: PackedVector2Array
	for point in path.curve.get_baked_points():
		var world := path.global_transform * point
		line.push_back(Vector2(world.x, world.z))
	var after := instances(scatter, 0)
	var gone_count := 0
	var wrong := 0
	for id in before:
		var distance := distance_to_line(on_map(before[id]), line)
		gone_count += int(not after.has(id))
		# The region's outline may deviate from the curve by 1 cm.
		wrong += int(not after.has(id) and distance > 2.5 + 0.011) + int(after.has(id) and distance < 2.5 - 0.011)
	check_equal(wrong, 0, context + ": wrong instances")
	check(gone_count > 20, "%s: %d were removed" % [context, gone_count])
