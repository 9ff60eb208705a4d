extends "domain_harness.gd"
## Tests PoissonSampler.sample_domain: the point sets that each method returns.

## Points per squared radius in an infinite set: a coverage of 0.547070, divided by the area of a disk with half the radius.
const DENSITY := 0.547070 / (PI / 4.0)
const RECT := Rect2(-7.5, 3.25, 60.0, 37.0)


## Stores points in cells that are one radius wide, for lookups of neighbors.
class Grid:
	var cells := {}
	var radius: float
	var period: Vector2

	## Creates a grid of `points`. If the period is finite, points repeat after one period on each axis.
	func _init(points: PackedVector2Array, spacing: float, repeats_after := Vector2.INF) -> void:
		radius = spacing
		period = repeats_after
		for point in points:
			cells.get_or_add(Vector2i((point / radius).floor()), []).push_back(point)

	## Returns the distance from a position to the nearest other point, or twice the radius if none is near.
	func nearest(position: Vector2) -> float:
		var found := 2.0 * radius
		for image in images(position):
			var cell := Vector2i((image / radius).floor())
			for y in range(-1, 2):
				for x in range(-1, 2):
					for point: Vector2 in cells.get(cell + Vector2i(x, y), []):
						if point != position:
							found = minf(found, image.distance_to(point))
		return found

	func images(position: Vector2) -> PackedVector2Array:
		if period == Vector2.INF:
			return [position]
		var result := PackedVector2Array()
		for y in range(-1, 2):
			for x in range(-1, 2):
				result.push_back(position + period * Vector2(x, y))
		return result


## Checks that no two points are closer than the radius, and that all are inside the rectangle. If the set is maximal, checks at random
## positions that no other point would fit.
func check_set(points: PackedVector2Array, rect: Rect2, radius: float, period: Vector2, maximal: bool, context: String) -> void:
	var grid := Grid.new(points, radius, period)
	# Tolerance for rounding to single precision.
	var rounding := 4e-7 * (absf(rect.position.x) + absf(rect.position.y) + rect.size.x + rect.size.y)
	var closest := INF
	var outside := 0
	for point in points:
		closest = minf(closest, grid.nearest(point))
		outside += int(not rect.has_point(point))
	check(closest >= radius - rounding, "%s: two points %.9f apart, radius %.9f" % [context, closest, radius])
	check_equal(outside, 0, context + ": points outside")
	if not maximal:
		return
	var random := RandomNumberGenerator.new()
	random.seed = 3
	var farthest := 0.0
	for index in 4000:
		var position := rect.position + rect.size * Vector2(random.randf(), random.randf())
		farthest = maxf(farthest, grid.nearest(position))
	check(farthest <= radius + rounding, "%s: no point within %.9f of a position, radius %.9f" % [context, farthest, radius])


func check_count(count: int, area: float, tolerance: float, context: String) -> void:
	var expected := DENSITY * area
	check(absf(count / expected - 1.0) < tolerance, "%s: %d points, about %d expected" % [context, count, expected])


func test_every_method_fills_the_rectangle() -> void:
	for method in METHODS:
		for precise: bool in [false, true]:
			var context := label(method) + (" double" if precise else "")
			var sampler := make(method)
			sampler.double_precision = precise
			var points := sampler.sample_domain(RECT)
			# Points at an edge have no neighbors beyond it, so there are more of them. METHOD_TILES has no such edges.
			check_count(points.size(), RECT.get_area(), 0.07, context)
			# A window of an infinite set need not be maximal, because points beyond its edge cover a part of it.
			var maximal := method != PoissonSampler.METHOD_NAIVE and method != PoissonSampler.METHOD_TILES
			check_set(points, RECT, 1.0, Vector2.INF, maximal, context)


func test_rectangles_of_all_shapes() -> void:
	for rect: Rect2 in [Rect2(0, 0, 200, 1.5), Rect2(-3, -200, 0.75, 150), Rect2(5, 5, 0.25, 0.25), Rect2(-20, -20, 40, 40)]:
		for method in METHODS:
			var maximal := method != PoissonSampler.METHOD_NAIVE and method != PoissonSampler.METHOD_TILES
			check_set(make(method).sample_domain(rect), rect, 1.0, Vector2.INF, maximal, "%s in %s" % [label(method), rect])
	var alone := make(PoissonSampler.METHOD_HIERARCHICAL).sample_domain(Rect2(5, 5, 0.25, 0.25))
	check_equal(alone.size(), 1, "points in a rectangle smaller than a disk")


func test_seeds() -> void:
	for method in METHODS:
		var sampler := make(method)
		var first := sampler.sample_domain(RECT)
		check(sampler.sample_domain(RECT) == first, label(method) + ": the same again")
		check(make(method).sample_domain(RECT) == first, label(method) + ": the same from another object")
		check(make(method, 2).sample_domain(RECT) != first, label(method) + ": a different seed")
		check(make(method, -1).sample_domain(RECT) != make(method, 0).sample_domain(RECT), label(method) + ": a negative seed")
		sampler.radius = 1.5
		var wider := sampler.sample_domain(RECT)
		check_count(wider.size(), RECT.get_area() / 1.5 ** 2, 0.1, label(method) + " radius 1.5")
		sampler.radius = 1.0
		check(sampler.sample_domain(RECT) == first, label(method) + ": the same after another radius was used")


func test_only_some_properties_affect_the_points() -> void:
	for method in SINGLE:
		var sampler := make(method)
		var origin := Rect2(Vector2.ZERO, RECT.size)
		var first := sampler.sample_domain(origin)
		var moved := sampler.sample_domain(RECT)
		check_equal(moved.size(), first.size(), label(method) + ": as many at another position")
		var largest := 0.0
		for index in first.size():
			largest = maxf(largest, (moved[index] - RECT.position).distance_to(first[index]))
		check(largest < 1e-4, label(method) + ": the same at another position, up to rounding: %.9f" % largest)
		for width: float in [0.5, 3.0, 20.0, 1000.0]:
			sampler.cell_size = width
			check(sampler.sample_domain(origin) == first, "%s: the same with cells of %s r" % [label(method), width])
		sampler.cell_size = 0.0
		sampler.progressive_levels = 3
		check(sampler.sample_domain(origin) == first, label(method) + ": ignores levels")
		sampler.toroidal = true
		check(sampler.sample_domain(origin) != first, label(method) + ": a torus is a different set")


func test_tiles_are_the_infinite_set() -> void:
	var sampler := make(PoissonSampler.METHOD_TILES)
	for levels in [1, 3]:
		sampler.progressive_levels = levels
		sampler.double_precision = levels == 3
		check(sampler.sample_domain(RECT) == sampler.sample(RECT).positions, "sample_domain equals sample")
		var exact := sampler.sample_domain_exact(-7.5, 3.25, 52.5, 40.25)
		var window := sampler.sample_exact(-7.5, 3.25, 52.5, 40.25)
		check(exact.x == window.x and exact.y == window.y, "sample_domain_exact equals sample_exact")
	# In a strip of 1000 km, corners of blocks exceed 32 bits during the computation.
	sampler.progressive_levels = 1
	check_count(sampler.sample_domain(Rect2(-5e5, 0, 1e6, 0.5)).size(), 5e5, 0.02, "a long strip")


func test_torus() -> void:
	for method in SINGLE:
		for rect: Rect2 in [Rect2(0, 0, 32, 32), Rect2(100, -50, 45.5, 7.25), Rect2(0, 0, 4, 4)]:
			var sampler := make(method)
			sampler.toroidal = true
			var points := sampler.sample_domain(rect)
			var maximal := method != PoissonSampler.METHOD_NAIVE
			check_set(points, rect, 1.0, rect.size, maximal, "%s around %s" % [label(method), rect])
		var large := make(method)
		large.toroidal = true
		# A torus has no edges, so it has the density of an infinite set. The naive method stops early and leaves gaps.
		check_count(large.sample_domain(Rect2(0, 0, 120, 90)).size(), 10800.0, 0.06 if method == PoissonSampler.METHOD_NAIVE else 0.015,
				"%s around a large torus" % label(method))


func test_exact() -> void:
	for method in SINGLE:
		var sampler := make(method)
		sampler.double_precision = true
		var exact := sampler.sample_domain_exact(0.0, 0.0, 60.0, 37.0)
		var x: PackedFloat64Array = exact.x
		var y: PackedFloat64Array = exact.y
		var rounded := sampler.sample_domain(Rect2(0, 0, 60, 37))
		check(x.size() == rounded.size() and y.size() == x.size(), label(method) + ": as many as in single precision")
		var differing := 0
		var finer := 0
		for index in x.size():
			differing += int(Vector2(x[index], y[index]) != rounded[index])
			finer += int(rounded[index].x != x[index])
		check(differing <= 1, label(method) + ": rounds to the same points: %d differ" % differing)
		check(finer > x.size() * 0.9, label(method) + ": is more precise")
		sampler.double_precision = false
		var single := sampler.sample_domain_exact(0.0, 0.0, 60.0, 37.0)
		var plain := sampler.sample_domain(Rect2(0, 0, 60, 37))
		for index in plain.size():
			differing += int(plain[index].x != single.x[index] or plain[index].y != single.y[index])
		check(differing <= 1, label(method) + ": single precision rounds nothing at the origin")


## Without rounding, all distances are at least the radius, to the last bit.
func test_exact_distances() -> void:
	for method in SINGLE:
		var sampler := make(method, 5)
		sampler.double_precision = true
		var exact := sampler.sample_domain_exact(0.0, 0.0, 25.0, 25.0)
		var x: PackedFloat64Array = exact.x
		var y: PackedFloat64Array = exact.y
		var closest := INF
		for first in x.size():
			for second in first:
				closest = minf(closest, (x[first] - x[second]) ** 2 + (y[first] - y[second]) ** 2)
		check(closest >= 1.0, "%s: squared distance %.17f" % [label(method), closest])


func test_far_from_the_origin() -> void:
	for method in METHODS:
		var far := Rect2(3e6, -2e6, 40, 30)
		var points := make(method).sample_domain(far)
		check_count(points.size(), 1200.0, 0.1, label(method) + " far from the origin")
		var exact := make(method).sample_domain_exact(3e6, -2e6, 3e6 + 40.0, -2e6 + 30.0)
		check_equal(exact.size(), points.size(), label(method) + ": exact points")
		for rect: Rect2 in [far, Rect2(5e6, 5e6, 5, 5), Rect2(-0.1, -1e-30, 17.3, 9.1)]:
			for point in make(method).sample_domain(rect):
				if not rect.has_point(point):
					check(false, "%s: %s is not in %s" % [label(method), point, rect])
	for rect: Array in [[3e6, -2e6, 3e6 + 40.0, -2e6 + 30.0], [1e15, 1e15, 1e15 + 20.0, 1e15 + 20.0]]:
		var sampler := make(PoissonSampler.METHOD_HIERARCHICAL)
		sampler.double_precision = true
		var exact: PoissonPoints = sampler.sample_domain_exact.callv(rect)
		for index in exact.x.size():
			var inside: bool = exact.x[index] >= rect[0] and exact.x[index] < rect[2]
			if not inside or exact.y[index] < rect[1] or exact.y[index] >= rect[3]:
				check(false, "%s, %s is not in %s" % [exact.x[index], exact.y[index], rect])


func test_stats() -> void:
	var wide := Rect2(0, 0, 150, 100)
	for method in METHODS:
		var sampler := make(method)
		check_equal(sampler.get_stats()["points"], 0, "points before any call")
		var points := sampler.sample_domain(wide)
		var stats := sampler.get_stats()
		check_equal(stats["points"], points.size(), label(method) + ": points")
		check(stats["darts"] > points.size() and stats["workspace_bytes"] > points.size(), label(method) + ": darts, bytes")
		if method in SINGLE and method != PoissonSampler.METHOD_NAIVE:
			var squares := float(stats["squares"]) / points.size()
			check(squares > 8.5 and squares < 10.5, "%s: %.2f squares a point" % [label(method), squares])
			check(stats["selections"] >= stats["darts"] and stats["list_checks"] >= stats["selections"], "choices: %s" % stats)
		sampler.sample_domain(Rect2(0, 0, -1, 1))
		check_error(["PoissonSampler.rect.size", "-1"], "a rejected call")
		check_equal(sampler.get_stats(), stats, "stats after a rejected call")


func test_points() -> void:
	var sampler := make(PoissonSampler.METHOD_TILES)
	sampler.progressive_levels = 2
	var points := sampler.sample(Rect2(-7.5, 3.25, 60.0, 37.0))
	var exact := sampler.sample_exact(-7.5, 3.25, 52.5, 40.25)
	check(points.size() > 1000 and not points.is_empty(), "%d points" % points.size())
	check(points.ids == exact.ids and points.ranks == exact.ranks, "the same points")
	check(points.positions == exact.positions, "positions match those in single precision")
	check(points.x.is_empty() and points.y.is_empty(), "double precision only on request")
	for all: PoissonPoints in [points, exact]:
		check_equal(all.size(), all.positions.size(), "one position per point")
		for index: int in [0, 1, all.size() - 1]:
			check_equal(all.get_id(index), all.ids[index], "ID %d" % index)
			check_equal(all.get_position(index), all.positions[index], "position %d" % index)
			check_equal(all.get_rank(index), all.ranks[index], "rank %d" % index)
		for index: int in [-1, all.size(), 1 << 40]:
			check_equal(all.get_id(index), 0, "no ID %d" % index)
			check_error(["PoissonPoints.index must be between 0 and"], "ID %d" % index)
			check_equal(all.get_position(index), Vector2.ZERO, "no position %d" % index)
			check_error(["PoissonPoints.index must be between 0 and"], "position %d" % index)
			check_equal(all.get_rank(index), 0.0, "no rank %d" % index)
			check_error(["PoissonPoints.index must be between 0 and"], "rank %d" % index)
	check_equal(Vector2(exact.x[5], exact.y[5]), exact.positions[5], "x and y")
	# Compares a window large enough for threads to share the work with windows that are too small for that.
	var many := sampler.sample(Rect2(0.0, 0.0, 400.0, 300.0))
	check(many.size() > 1 << 16, "%d points" % many.size())
	check(many.positions == sampler.sample_domain(Rect2(0.0, 0.0, 400.0, 300.0)), "positions of many")
	var all_ids := PackedInt64Array()
	var all_ranks := PackedFloat32Array()
	for part in 4:
		var few := sampler.sample(Rect2(100.0 * part, 0.0, 100.0, 300.0))
		all_ids.append_array(few.ids)
		all_ranks.append_array(few.ranks)
	var ids := many.ids
	var ranks := many.ranks
	for array: Variant in [all_ids, all_ranks, ids, ranks]:
		array.sort()
	check(ids == all_ids and ranks == all_ranks, "IDs and ranks of many")
	var copy := points.ids
	copy[0] = 1
	check(points.ids[0] != 1 and points.get_id(0) != 1, "arrays are copies")
	var whole := make(PoissonSampler.METHOD_HIERARCHICAL).sample_domain_exact(0.0, 0.0, 60.0, 37.0)
	check(whole.ids.is_empty() and whole.ranks.is_empty(), "a domain's points have neither ids nor ranks")
	check_equal(whole.get_id(0), 0, "the id is 0")
	check_equal(whole.get_rank(0), 0.0, "the rank is 0")
	check_equal(whole.positions.size(), whole.size(), "positions of a domain")
	var none := sampler.sample(Rect2(0, 0, -1, 1))
	errors.take()
	check(none != null and none.is_empty() and none.positions.is_empty(), "a rejected call returns an empty object, not null")
	check(PoissonPoints.new().is_empty(), "a new object is empty")
