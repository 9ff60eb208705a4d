extends "domain_harness.gd"
## Tests PoissonSampler.cancel: at any stage, a running call returns within 50 ms, without points.

## An area that contains about four million points.
const HUGE := Rect2(-1000, 0, 2400, 2400)
## The time limit in microseconds, on a machine that provides new memory quickly. Measurements are repeated, because other programs may
## delay them for up to a second.
const CANCEL_USEC := 50000
const TRIES := 3
const ROUNDS := 4


## Cancels from the first report, when most of the work remains, with single and double precision.
func test_cancel_from_progress() -> void:
	for method in METHODS:
		for precise: bool in [false, true]:
			var sampler := make(method)
			sampler.double_precision = precise
			check_cancellation(label(method), func() -> int:
				var listener := Listener.new()
				listener.on_report = func(_fraction: float) -> void: sampler.cancel()
				var points := sampler.sample_domain(HUGE, listener.record)
				var elapsed := Time.get_ticks_usec() - listener.times[-1]
				check_equal(points.size(), 0, label(method) + ": returns nothing")
				check_equal(listener.get_report_count(), 1, label(method) + ": no more reports")
				return elapsed)
			check_no_error(label(method) + " canceled")
			check(sampler.sample_domain(SMALL).size() > 300, label(method) + ": the next call works")


## Returns the time limit in microseconds under the machine's present load, measured by providing 32 MiB of new memory.
func get_limit() -> int:
	var start := Time.get_ticks_usec()
	var memory: PackedByteArray
	memory.resize(1 << 25)
	memory.fill(1)
	return maxi(CANCEL_USEC, 4 * (Time.get_ticks_usec() - start))


## Checks that `measure`, which returns microseconds, stays below the limit in at least one attempt. Retries for several rounds.
func check_cancellation(context: String, measure: Callable) -> void:
	var all: Array[PackedInt64Array] = []
	for round in ROUNDS:
		var times: PackedInt64Array = []
		for each in TRIES:
			times.push_back(measure.call())
		all.push_back(times)
		times = times.duplicate()
		times.sort()
		if times[0] < get_limit():
			check(true, context)
			return
		OS.delay_msec(1000)
	check(false, "%s: %s us" % [context, all])


func test_cancel_late() -> void:
	for method in METHODS:
		var sampler := make(method)
		var side := 60.0 if method == PoissonSampler.METHOD_NAIVE else 500.0
		for late: float in [0.6, 1.0]:
			var listener := Listener.new()
			listener.on_report = func(fraction: float) -> void:
				if fraction >= late:
					sampler.cancel()
			var exact := sampler.sample_domain_exact(0.0, 0.0, side, side, listener.record)
			check(exact.is_empty() and exact.x.is_empty() and exact.y.is_empty(), "%s at %s" % [label(method), late])
			check_equal(sampler.get_stats()["points"], 0, label(method) + ": no stats")


## Cancels from another thread while the call is running.
func test_cancel_from_another_thread() -> void:
	for method in METHODS:
		for reports: int in [1, 3, 8]:
			check_cancellation("%s on a thread, at report %d" % [label(method), reports], func() -> int:
				var sampler := make(method)
				var listener := Listener.new()
				var thread := Thread.new()
				thread.start(func() -> PackedVector2Array: return sampler.sample_domain(HUGE, listener.record))
				while listener.get_report_count() < reports:
					OS.delay_usec(500)
				var start := Time.get_ticks_usec()
				sampler.cancel()
				var points: PackedVector2Array = thread.wait_to_finish()
				var elapsed := Time.get_ticks_usec() - start
				check_equal(points.size(), 0, label(method) + ": returns nothing")
				check(not 1.0 in listener.fractions, label(method) + ": never reports its end")
				return elapsed)
			check_no_error(label(method) + " canceled")


## A call checks for cancellation when it reports, so it must report often. The first selections are the slowest, because they touch new
## memory. The system takes a thousand times longer to provide new memory than to access memory in use.
func test_reports_are_frequent() -> void:
	for method in METHODS:
		check_cancellation(label(method) + " without reports", func() -> int:
			var sampler := make(method)
			var listener := Listener.new()
			var reports: Array[int] = [0]
			listener.on_report = func(_fraction: float) -> void:
				reports[0] += 1
				if reports[0] > 50:
					sampler.cancel()
			var longest := 0
			var last := Time.get_ticks_usec()
			sampler.sample_domain(HUGE, listener.record)
			for time in listener.times:
				longest = maxi(longest, time - last)
				last = time
			return longest)


## Cancels so early that the call is still allocating memory and creating squares. The canceling thread cannot detect whether the
## call has started, so it cancels repeatedly.
func test_immediate_cancel() -> void:
	for method in METHODS:
		for delay: int in [0, 10, 60, 250]:
			check_cancellation("%s after %d ms" % [label(method), delay],
					func() -> int: return cancel_after(make(method), delay))
			check_no_error(label(method) + " canceled")


## Cancels repeatedly from `delay` milliseconds on. Returns the microseconds from the first cancel to the end of the call.
func cancel_after(sampler: PoissonSampler, delay: int) -> int:
	var started := Semaphore.new()
	var thread := Thread.new()
	thread.start(func() -> PackedVector2Array:
		started.post()
		return sampler.sample_domain(HUGE))
	started.wait()
	OS.delay_msec(delay)
	var start := Time.get_ticks_usec()
	while thread.is_alive():
		sampler.cancel()
		OS.delay_usec(200)
	var elapsed := Time.get_ticks_usec() - start
	check_equal((thread.wait_to_finish() as PackedVector2Array).size(), 0, label(sampler.method) + ": returns nothing")
	return elapsed


func test_canceled_windows() -> void:
	check_cancellation("sample", func() -> int:
		var sampler := PoissonSampler.new()
		var thread := Thread.new()
		thread.start(func() -> PoissonPoints: return sampler.sample(HUGE))
		OS.delay_msec(30)
		var start := Time.get_ticks_usec()
		while thread.is_alive():
			sampler.cancel()
			OS.delay_usec(200)
		var elapsed := Time.get_ticks_usec() - start
		var window: PoissonPoints = thread.wait_to_finish()
		check_equal(window.ids.size() + window.ranks.size() + window.positions.size(), 0, "returns nothing")
		check(sampler.sample(SMALL).ids.size() > 300, "the next call works")
		return elapsed)
	check_no_error("canceled windows")


func test_canceling_before_the_call_has_no_effect() -> void:
	for method in METHODS:
		var sampler := make(method)
		var expected := sampler.sample_domain(SMALL)
		sampler.cancel()
		check(sampler.sample_domain(SMALL) == expected, label(method))
		sampler.cancel()
		check(sampler.sample(SMALL).ids.size() > 300, "a window")
