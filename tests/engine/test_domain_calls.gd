extends "domain_harness.gd"
## Tests calls to PoissonSampler.sample_domain while it runs: progress, threads, and scripts that fail. Also tests input
## that it rejects.


func test_progress() -> void:
	for method in METHODS:
		var area := area_for(method)
		var listener := Listener.new()
		var start := Time.get_ticks_usec()
		var points := make(method).sample_domain(area, listener.record)
		var elapsed := Time.get_ticks_usec() - start
		var count := listener.get_report_count()
		check(count >= 2, "%s: called %d times in %d us" % [label(method), count, elapsed])
		check(count <= elapsed / 15000.0 + 2, "%s: called %d times in %d us" % [label(method), count, elapsed])
		for index in range(1, count):
			check(listener.fractions[index] >= listener.fractions[index - 1], label(method) + ": fractions never fall")
			check(listener.points[index] >= listener.points[index - 1], label(method) + ": the number of points never falls")
		check(listener.fractions[0] >= 0.0, label(method) + ": the first fraction") # 0 if no point was found before the first report.
		check_equal(listener.fractions[-1], 1.0, label(method) + ": the last fraction")
		check_equal(listener.points[-1], points.size(), label(method) + ": the last number of points")
		for thread in listener.threads:
			check_equal(thread, OS.get_thread_caller_id(), label(method) + ": on the calling thread")
		check(points == make(method).sample_domain(area), label(method) + ": the same without a callback")


func test_a_short_call_reports_its_end() -> void:
	for method in METHODS:
		var listener := Listener.new()
		var exact := make(method).sample_domain_exact(0.0, 0.0, 4.0, 3.0, listener.record)
		check_equal(listener.fractions[-1], 1.0, label(method))
		check_equal(listener.points[-1], exact.size(), label(method))


func test_one_call_at_a_time() -> void:
	for method in METHODS:
		var sampler := make(method)
		var area := area_for(method)
		var expected := sampler.sample_domain(area)
		var results: Array = []
		var listener := Listener.new()
		listener.on_report = func(_fraction: float) -> void:
			if results.is_empty():
				results.push_back(sampler.sample(SMALL).ids.size())
				results.push_back(sampler.sample_domain(SMALL).size())
				results.push_back(sampler.sample_exact(0.0, 0.0, 5.0, 5.0).x.size())
				results.push_back(sampler.sample_domain_exact(0.0, 0.0, 5.0, 5.0).y.size())
		check(sampler.sample_domain(area, listener.record) == expected, label(method) + ": the call continues")
		check_equal(results, [0, 0, 0, 0], label(method) + ": points returned by calls during the call")
		var messages := "\n".join(errors.take())
		for name: String in ["sample", "sample_domain", "sample_exact", "sample_domain_exact"]:
			check("PoissonSampler.%s() was called during another call" % name in messages, "'%s' in: %s" % [name, messages])


func test_one_thread_at_a_time() -> void:
	var sampler := make(PoissonSampler.METHOD_HIERARCHICAL)
	var expected := sampler.sample_domain(area_for(sampler.method))
	var listener := Listener.new()
	var thread := Thread.new()
	thread.start(func() -> PackedVector2Array: return sampler.sample_domain(area_for(sampler.method), listener.record))
	while listener.get_report_count() == 0:
		OS.delay_usec(500)
	check_equal(sampler.sample_domain(SMALL).size(), 0, "a call from a second thread")
	check_error(["PoissonSampler.sample_domain()", "another thread"], "a call from a second thread")
	check(thread.wait_to_finish() == expected, "the points of the first call")
	check(sampler.sample_domain(SMALL).size() > 300, "a call after the first one has returned")


func test_many_threads_on_one_sampler() -> void:
	var sampler := make(PoissonSampler.METHOD_WAVEFRONT)
	var expected := sampler.sample_domain(SMALL)
	var work := func(number: int) -> int:
		var wrong := 0
		for round in 100:
			var points := sampler.sample_domain(SMALL)
			wrong += int(points != expected and points.size() > 0)
			if (round + number) % 7 == 0:
				sampler.cancel()
		return wrong
	var threads: Array[Thread] = []
	for index in 6:
		threads.push_back(Thread.new())
		threads[index].start(work.bind(index))
	for thread in threads:
		check_equal(thread.wait_to_finish(), 0, "either all points or none")
	for message in errors.take():
		check("another thread" in message, message)
	check(sampler.sample_domain(SMALL) == expected, "the sampler still works")


func test_changes_take_effect_in_the_next_call() -> void:
	for method in METHODS:
		var area := area_for(method)
		var expected := make(method).sample_domain(area)
		var sampler := make(method)
		var listener := Listener.new()
		listener.on_report = func(_fraction: float) -> void:
			sampler.radius = 9.0
			sampler.seed = 77
			sampler.progressive_levels = 2
			sampler.method = PoissonSampler.METHOD_WAVEFRONT
			sampler.double_precision = true
		check(sampler.sample_domain(area, listener.record) == expected, label(method) + ": the points match the old properties")
		check(sampler.sample_domain(area).size() < expected.size() / 20.0, label(method) + ": the next call uses the new ones")


class Passing extends Object:
	var report_count := 0

	func record(_fraction: float, _points: int) -> void:
		report_count += 1


func test_progress_callbacks_that_fail() -> void:
	for method in METHODS:
		var area := area_for(method)
		var sampler := make(method)
		var expected := sampler.sample_domain(area)
		var broken: Array[Callable] = [
			func(_fraction: float) -> void: pass,
			func() -> void: pass,
			func(_fraction: Node, _points: int) -> void: pass,
			Callable(self, "no_such_method"),
			Callable(PoissonSampler, "new"),
		]
		for progress in broken:
			check(sampler.sample_domain(area, progress) == expected, "%s: all points with %s" % [label(method), progress])
			check_error(["PoissonSampler.progress cannot be called"], "%s" % progress)
		var failing := func(_fraction: float, _points: int) -> void:
			var nothing: Node = null
			nothing.name = "fails"
		check(sampler.sample_domain(area, failing) == expected, label(method) + ": all points, script failed")
		check(errors.take().size() > 0, label(method) + ": the engine printed an error")


## A sampler continues if the listener is freed after the first report.
func test_a_progress_callback_whose_object_is_freed() -> void:
	for method in METHODS:
		var area := area_for(method)
		area.size *= 2.0
		var expected := make(method).sample_domain(area)
		var passing := Passing.new()
		var thread := Thread.new()
		var record := passing.record
		thread.start(func() -> PackedVector2Array: return make(method).sample_domain(area, record))
		while passing.report_count == 0:
			OS.delay_usec(500)
		OS.delay_usec(500)
		passing.free()
		check(thread.wait_to_finish() == expected, label(method) + ": all points")
		check_error(["PoissonSampler.progress cannot be called", "anymore"], label(method))


var held: PoissonSampler


## A sampler stays alive until its call returns.
func test_releasing_the_sampler_during_the_call() -> void:
	for method in METHODS:
		var area := area_for(method)
		var expected := make(method).sample_domain(area)
		held = make(method)
		var watched: WeakRef = weakref(held)
		var alive: Array[bool] = []
		var points := held.sample_domain(area, func(_fraction: float, _points: int) -> void:
			held = null
			alive.push_back(watched.get_ref() != null))
		check(points == expected, label(method) + ": all points")
		check(alive.size() > 0 and not false in alive, label(method) + ": alive during the call: %s" % [alive])
		check(watched.get_ref() == null, label(method) + ": freed afterwards")


func refuse(sampler: PoissonSampler, rect: Rect2, words: Array) -> void:
	var context := "%s in %s" % [label(sampler.method), rect]
	check_equal(sampler.sample_domain(rect).size(), 0, context)
	check_error(words, context)
	var min := Vector2(rect.position)
	var exact := sampler.sample_domain_exact(min.x, min.y, min.x + rect.size.x, min.y + rect.size.y)
	check_equal(exact.x.size() + exact.y.size(), 0, context + ", exact")
	check_error(words, context + ", exact")


func test_rejected_rectangles() -> void:
	for method in METHODS:
		var sampler := make(method)
		var expected := sampler.sample_domain(SMALL)
		for bad: float in [NAN, INF, -INF]:
			refuse(sampler, Rect2(0, bad, 5, 5), ["PoissonSampler.rect must be finite", str(bad)])
		for bad: int in [0, -4]:
			refuse(sampler, Rect2(3, 4, 5, bad), ["PoissonSampler.rect.size must be positive, got %d" % bad])
			refuse(sampler, Rect2(3, 4, bad, 5), ["PoissonSampler.rect.size must be positive, got %d" % bad])
		refuse(sampler, Rect2(0, 0, NAN, 5), ["PoissonSampler.rect.size must be finite, got nan"])
		refuse(sampler, Rect2(0, 0, 5, INF), ["PoissonSampler.rect.size must be finite, got inf"])
		refuse(sampler, Rect2(0, 0, 1e6, 1e6), ["PoissonSampler.rect", "requires too many points, got 6"])
		refuse(sampler, Rect2(-1e30, -1e30, 3e30, 3e30), ["PoissonSampler.rect", "e+"])
		sampler.toroidal = true
		if method == PoissonSampler.METHOD_TILES:
			refuse(sampler, SMALL, ["PoissonSampler.toroidal", "METHOD_TILES", "true"])
		else:
			refuse(sampler, Rect2(0, 0, 3.5, 30), ["PoissonSampler.rect.size is out of range, got 3.5", "toroidal", "4 radii"])
			sampler.toroidal = false
			refuse(sampler, Rect2(0, 0, 131200, 2), ["PoissonSampler.rect.size is out of range, got 131200", "131072", "double_p"])
		sampler.toroidal = false
		check(sampler.sample_domain(SMALL) == expected, label(method) + ": the sampler still works")
	var tiles := make(PoissonSampler.METHOD_TILES)
	refuse(tiles, Rect2(6e6, 0, 5, 5), ["PoissonSampler.rect must be between", "got 6000"])


func test_wide_domains_of_double_precision() -> void:
	var sampler := make(PoissonSampler.METHOD_HIERARCHICAL)
	sampler.double_precision = true
	check(sampler.sample_domain_exact(0.0, 0.0, 131200.0, 0.5).x.size() > 60000, "131200 radii")


func test_rejected_properties() -> void:
	var sampler := PoissonSampler.new()
	check_equal(sampler.method, PoissonSampler.METHOD_TILES, "the default")
	sampler.method = PoissonSampler.METHOD_ACCUMULATOR
	sampler.cell_size = 2.5
	for bad: int in [-1, 5, 1 << 40, -(1 << 62)]:
		sampler.set("method", bad)
		check_error(["PoissonSampler.method must be between 0 and "], "method %d" % bad)
	for bad: float in [-0.5, 1000.5, -1e300]:
		sampler.cell_size = bad
		check_error(["PoissonSampler.cell_size must be between 0 and 1000, got " + ("-" if bad < 0.0 else "1000.5")], "cells of %s" % bad)
	for bad: float in [NAN, INF, -INF]:
		sampler.cell_size = bad
		check_error(["PoissonSampler.cell_size must be finite, between 0 and 1000, got %s" % bad], "cells of %s" % bad)
	check_equal(sampler.method, PoissonSampler.METHOD_ACCUMULATOR, "the method stays")
	check_equal(sampler.cell_size, 2.5, "the cell size stays")
	check_equal(ClassDB.class_get_enum_constants("PoissonSampler", "Method").size(), 5, "methods")


func test_rejected_arguments() -> void:
	var sampler := PoissonSampler.new()
	for wrong: Array in [[], [SMALL, Callable(), 3], [SMALL, 3]]:
		check(sampler.callv("sample_domain", wrong) == null, "%s are rejected" % [wrong])
		check_error(["PoissonSampler::sample_domain"], "%s" % [wrong])
