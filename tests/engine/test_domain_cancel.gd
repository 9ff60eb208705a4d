extends "domain_harness.gd"
## Tests PoissonSampler.cancel: at any stage, a running call returns without points. The core's tests of progress check how much
## work calls do between checks for cancellation, and tests/bench/cancel.gd measures the time.

## An area that contains about four million points.
const HUGE := Rect2(-1000, 0, 2400, 2400)


## Cancels from the first report, when most of the work remains, with single and double precision.
func test_cancel_from_progress() -> void:
	for method in METHODS:
		for precise: bool in [false, true]:
			var sampler := make(method)
			sampler.double_precision = precise
			var listener := Listener.new()
			listener.on_report = func(_fraction: float) -> void: sampler.cancel()
			check_equal(sampler.sample_domain(HUGE, listener.record).size(), 0, label(method) + ": returns nothing")
			check_equal(listener.get_report_count(), 1, label(method) + ": no more reports")
			check_no_error(label(method) + " canceled")
			check(sampler.sample_domain(SMALL).size() > 300, label(method) + ": the next call works")


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


## Cancels from another thread while the call is running. Each report waits until the main thread lets it return, so at most one more
## report follows.
func test_cancel_from_another_thread() -> void:
	for method in METHODS:
		for reports: int in [1, 3, 8]:
			var sampler := make(method)
			var listener := Listener.new()
			var reached := Semaphore.new()
			var continued := Semaphore.new()
			listener.on_report = func(_fraction: float) -> void:
				if listener.get_report_count() == reports:
					reached.post()
					continued.wait()
			var thread := Thread.new()
			thread.start(func() -> PackedVector2Array: return sampler.sample_domain(HUGE, listener.record))
			reached.wait()
			sampler.cancel()
			continued.post()
			var points: PackedVector2Array = thread.wait_to_finish()
			listener.on_report = Callable() # The function refers to the listener, which would never be freed.
			check_equal(points.size(), 0, "%s: returns nothing after report %d" % [label(method), reports])
			check_equal(listener.get_report_count(), reports, label(method) + ": no more reports")
			check_no_error(label(method) + " canceled")


## Cancels so early that the call is still allocating memory and creating squares. The canceling thread cannot detect whether the
## call has started, so it cancels repeatedly.
func test_immediate_cancel() -> void:
	for method in METHODS:
		for delay: int in [0, 10, 60, 250]:
			var sampler := make(method)
			var listener := Listener.new()
			var returned: int = cancel_repeatedly(sampler, delay,
					func() -> int: return sampler.sample_domain(HUGE, listener.record).size())
			check_equal(returned, 0, "%s after %d ms: returns nothing" % [label(method), delay])
			check(not 1.0 in listener.fractions, label(method) + ": never reports its end")
			check_no_error(label(method) + " canceled")


## Calls on another thread and cancels repeatedly from `delay` milliseconds on. Returns the result of the call.
func cancel_repeatedly(sampler: PoissonSampler, delay: int, call: Callable) -> Variant:
	var started := Semaphore.new()
	var thread := Thread.new()
	thread.start(func() -> Variant:
		started.post()
		return call.call())
	started.wait()
	OS.delay_msec(delay)
	while thread.is_alive():
		sampler.cancel()
		OS.delay_usec(200)
	return thread.wait_to_finish()


func test_canceled_windows() -> void:
	var sampler := PoissonSampler.new()
	var window: PoissonPoints = cancel_repeatedly(sampler, 30, func() -> PoissonPoints: return sampler.sample(HUGE))
	check_equal(window.ids.size() + window.ranks.size() + window.positions.size(), 0, "returns nothing")
	check(sampler.sample(SMALL).ids.size() > 300, "the next call works")
	check_no_error("canceled windows")


func test_canceling_before_the_call_has_no_effect() -> void:
	for method in METHODS:
		var sampler := make(method)
		var expected := sampler.sample_domain(SMALL)
		sampler.cancel()
		check(sampler.sample_domain(SMALL) == expected, label(method))
		sampler.cancel()
		check(sampler.sample(SMALL).ids.size() > 300, "a window")
