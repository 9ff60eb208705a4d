extends "domain_harness.gd"
## PoissonSampler.cancel: a call under way ends within 50 milliseconds, whatever it is doing, and gives nothing.

## Four million points.
const HUGE := Rect2(-1000, 0, 2400, 2400)
## The promise, and how often it is tried: others may be at work on the machine, for a moment or for a second.
const CANCEL_USEC := 50000
const TRIES := 3
const ROUNDS := 4


## From the first sign of life, which comes with most of the work still to do, in each precision.
func test_cancel_from_progress() -> void:
	for method in METHODS:
		for precise: bool in [false, true]:
			var sampler := make(method)
			sampler.double_precision = precise
			check_promise(label(method), func() -> int:
				var listener := Listener.new()
				listener.on_report = func(_fraction: float) -> void: sampler.cancel()
				var points := sampler.sample_domain(HUGE, listener.record)
				var elapsed := Time.get_ticks_usec() - listener.times[-1]
				check_equal(points.size(), 0, label(method) + ": nothing comes out")
				check_equal(listener.get_report_count(), 1, label(method) + ": nor is there more to hear")
				return elapsed)
			check_no_error(label(method) + " cancelled")
			check(sampler.sample_domain(SMALL).size() > 300, label(method) + ": the next call works")


## That a call which returns microseconds keeps the promise: once at least in a round of tries.
func check_promise(what: String, measure: Callable) -> void:
	var all: Array[PackedInt64Array] = []
	for round in ROUNDS:
		var times: PackedInt64Array = []
		for each in TRIES:
			times.push_back(measure.call())
		all.push_back(times)
		times = times.duplicate()
		times.sort()
		if times[0] < CANCEL_USEC:
			check(true, what)
			return
		OS.delay_msec(1000)
	check(false, "%s: %s us" % [what, all])


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


## While the work goes on, from outside.
func test_cancel_from_another_thread() -> void:
	for method in METHODS:
		for words: int in [1, 3, 8]:
			check_promise("%s on a thread, at word %d" % [label(method), words], func() -> int:
				var sampler := make(method)
				var listener := Listener.new()
				var thread := Thread.new()
				thread.start(func() -> PackedVector2Array: return sampler.sample_domain(HUGE, listener.record))
				while listener.get_report_count() < words:
					OS.delay_usec(500)
				var start := Time.get_ticks_usec()
				sampler.cancel()
				var points: PackedVector2Array = thread.wait_to_finish()
				var elapsed := Time.get_ticks_usec() - start
				check_equal(points.size(), 0, label(method) + ": nothing comes out")
				check(not 1.0 in listener.fractions, label(method) + ": never said that it is done")
				return elapsed)
			check_no_error(label(method) + " cancelled")


## A call that is silent does not look whether it is cancelled either. The first choices touch fresh memory all over, for
## which the system needs a thousand times longer than for memory that it has at hand.
func test_never_silent_for_long() -> void:
	for method in METHODS:
		check_promise(label(method) + " silent", func() -> int:
			var sampler := make(method)
			var listener := Listener.new()
			var words: Array[int] = [0]
			listener.on_report = func(_fraction: float) -> void:
				words[0] += 1
				if words[0] > 50:
					sampler.cancel()
			var longest := 0
			var last := Time.get_ticks_usec()
			sampler.sample_domain(HUGE, listener.record)
			for time in listener.times:
				longest = maxi(longest, time - last)
				last = time
			return longest)


## So early that memory is still being got and squares are still being made. Whoever cancels cannot know that the call has
## begun, so asks again and again.
func test_cancel_at_once() -> void:
	for method in METHODS:
		for delay: int in [0, 10, 60, 250]:
			check_promise("%s after %d ms" % [label(method), delay],
					func() -> int: return cancel_after(make(method), delay))
			check_no_error(label(method) + " cancelled")


## Microseconds from the first of many cancels to the end of the call.
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
	check_equal((thread.wait_to_finish() as PackedVector2Array).size(), 0, label(sampler.method) + ": nothing comes out")
	return elapsed


func test_cancelled_windows() -> void:
	check_promise("sample", func() -> int:
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
		check_equal(window.ids.size() + window.ranks.size() + window.positions.size(), 0, "nothing comes out")
		check(sampler.sample(SMALL).ids.size() > 300, "the next call works")
		return elapsed)
	check_no_error("cancelled windows")


func test_a_cancel_before_the_call_is_none() -> void:
	for method in METHODS:
		var sampler := make(method)
		var expected := sampler.sample_domain(SMALL)
		sampler.cancel()
		check(sampler.sample_domain(SMALL) == expected, label(method))
		sampler.cancel()
		check(sampler.sample(SMALL).ids.size() > 300, "a window")
