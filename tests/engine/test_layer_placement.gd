extends "rules_harness.gd"
## Tests the transforms and colors of instances: each property changes only one aspect.


## Returns the scale of an instance, which must be the same along all axes.
func scale_of(place: Transform3D) -> float:
	var size := place.basis.get_scale()
	check(is_equal_approx(size.x, size.y) and is_equal_approx(size.y, size.z), "uneven scale %s" % size)
	return size.x


## Checks that `before` and `after` have the same instances at the same positions.
func check_same_places(before: Dictionary, after: Dictionary, context: String) -> void:
	check(before.size() > 1000 and before.size() == after.size() and before.has_all(after.keys()), context + ": the same instances")
	var moved := 0
	for id: int in before:
		moved += int(before[id][0].origin != after[id][0].origin)
	check_equal(moved, 0, context + ": at the same positions")


func test_tilt() -> void:
	var layer := make_layer()
	var scatter := scatter_on_hillside(layer)
	for aligned: float in [0.0, 1.0]:
		layer.align_to_normal = aligned
		layer.min_tilt_degrees = 0.0
		layer.max_tilt_degrees = 0.0
		await settle(scatter)
		var before := instances(scatter)
		layer.max_tilt_degrees = 30.0
		layer.min_tilt_degrees = 10.0
		await settle(scatter)
		var after := instances(scatter)
		check_same_places(before, after, "tilt")
		var smallest := 180.0
		var largest := 0.0
		for id: int in before:
			var angle := rad_to_deg(before[id][0].basis.y.angle_to(after[id][0].basis.y))
			smallest = minf(smallest, angle)
			largest = maxf(largest, angle)
		check(smallest > 9.98 and smallest < 10.2 and largest > 29.8 and largest < 30.02, "the tilt ranges from %s to %s degrees" % [smallest, largest])


func test_scale_curve() -> void:
	var layer := make_layer()
	layer.min_scale = 1.0
	layer.max_scale = 3.0
	var scatter := scatter_on_hillside(layer)
	await settle(scatter)
	var before := instances(scatter)
	var square := Curve.new()
	for step in 65:
		var x := step / 64.0
		square.add_point(Vector2(x, x * x), 2.0 * x, 2.0 * x)
	layer.scale_curve = square
	await settle(scatter)
	var after := instances(scatter)
	check_same_places(before, after, "scale")
	var wrong := 0
	for id: int in before:
		var even := (scale_of(before[id][0]) - 1.0) / 2.0
		wrong += int(absf(scale_of(after[id][0]) - (1.0 + 2.0 * even * even)) > 1e-3)
	check_equal(wrong, 0, "instances whose scale does not match the curve")
	square.clear_points()
	await settle(scatter)
	check(instances(scatter) == before, "a curve without points has no effect")


func test_offset_along_normal() -> void:
	var layer := make_layer()
	var scatter := scatter_on_hillside(layer)
	await settle(scatter)
	var before := instances(scatter)
	layer.offset_along_normal = -0.5
	await settle(scatter)
	var after := instances(scatter)
	check(before.size() == after.size() and before.has_all(after.keys()), "the same instances")
	var wrong := 0
	for id: int in before:
		var placed: Transform3D = before[id][0]
		var expected := placed.origin - 0.5 * scatter.ground.get_normal(placed.origin)
		wrong += int(expected.distance_to(after[id][0].origin) > 1e-3 or after[id][0].basis != placed.basis)
	check_equal(wrong, 0, "instances at a wrong position")


func test_colors_and_custom_data() -> void:
	var layer := make_layer()
	layer.density = 0.5
	layer.min_scale = 1.0
	layer.max_scale = 2.0
	var scatter := scatter_on_hillside(layer)
	await settle(scatter)
	var plain := instances(scatter)
	check_equal(plain.values()[0][1].size(), 0, "without colors and data, the buffer contains only transforms")
	layer.use_colors = true
	await settle(scatter)
	var white := instances(scatter)
	check_same_places(plain, white, "colors")
	check_equal(white.values()[0][1], PackedFloat32Array([1, 1, 1, 1]), "colors are white without a gradient")
	var gradient := Gradient.new()
	gradient.set_color(0, Color(1, 0, 0, 1))
	gradient.set_color(1, Color(0, 1, 0, 1))
	layer.color_value = ScatterValueSource.new()
	layer.color_value.gradient = gradient
	layer.use_custom_data = true
	await settle(scatter)
	var looks := instances(scatter)
	check_same_places(plain, looks, "colors and data")
	var sums := [0.0, 0.0, 0.0, 0.0]
	var wrong := 0
	for id: int in looks:
		var more: PackedFloat32Array = looks[id][1]
		wrong += int(more.size() != 8 or looks[id][0] != plain[id][0])
		wrong += int(absf(more[0] + more[1] - 1.0) > 0.01 or more[2] != 0.0 or more[3] != 1.0)
		wrong += int(more[6] < 0.0 or more[6] > 1.0 or absf(more[7] - scale_of(looks[id][0])) > 2e-3)
		sums[0] += more[0]
		sums[1] += more[4]
		sums[2] += more[5]
		sums[3] += more[6]
	check_equal(wrong, 0, "wrong numbers in %d instances" % looks.size())
	for sum: float in sums:
		check(absf(sum / looks.size() - 0.5) < 0.03, "mean of a uniform distribution: %s" % [sum / looks.size()])
	layer.use_colors = false
	layer.use_custom_data = false
	await settle(scatter)
	check(instances(scatter) == plain, "without colors and data, the instances are as before")
