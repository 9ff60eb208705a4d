extends "bench.gd"
## Measures the time from PoissonSampler.cancel to the end of the call, with each method, at several stages of a call that would return four
## million points. Prints rows of a Markdown table.
##   tools/godot --headless --path demo_project --script tests/bench/cancel.gd [-- ROUNDS]
##
## Times are wall time. They include the time that the system takes to free the call's memory.

const HUGE := Rect2(-1000, 0, 2400, 2400)
const DEFAULT_ROUNDS := 9
const DELAYS_MSEC: Array[int] = [0, 10, 60, 250] ## From the start of the call to the first cancel.


func run() -> String:
	var rounds := rounds_or(DEFAULT_ROUNDS)
	var methods := ClassDB.class_get_enum_constants("PoissonSampler", "Method")
	for method in methods.size():
		for delay in DELAYS_MSEC:
			var times: Array = []
			for round in rounds:
				var sampler := PoissonSampler.new()
				sampler.method = method as PoissonSampler.Method
				times.push_back(_cancel_after(sampler, delay))
			row("cancel %s after %d ms" % [methods[method], delay], times, "µs")
	return ""


## Cancels repeatedly, because a cancel before the call begins has no effect.
func _cancel_after(sampler: PoissonSampler, delay: int) -> int:
	var thread := Thread.new()
	thread.start(func() -> PackedVector2Array: return sampler.sample_domain(HUGE))
	OS.delay_msec(delay)
	var start := Time.get_ticks_usec()
	while thread.is_alive():
		sampler.cancel()
		OS.delay_usec(200)
	var elapsed := Time.get_ticks_usec() - start
	thread.wait_to_finish()
	return elapsed
