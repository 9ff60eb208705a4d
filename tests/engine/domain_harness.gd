extends "harness.gd"
## Base class for the tests of PoissonSampler.sample_domain.

const METHODS: PackedInt32Array = [
	PoissonSampler.METHOD_TILES, PoissonSampler.METHOD_NAIVE, PoissonSampler.METHOD_HIERARCHICAL,
	PoissonSampler.METHOD_ACCUMULATOR, PoissonSampler.METHOD_WAVEFRONT,
]
## The methods that the paper describes.
const SINGLE: PackedInt32Array = [
	PoissonSampler.METHOD_NAIVE, PoissonSampler.METHOD_HIERARCHICAL, PoissonSampler.METHOD_ACCUMULATOR,
	PoissonSampler.METHOD_WAVEFRONT,
]
## A small area that every method samples quickly.
const SMALL := Rect2(0, 0, 30, 20)


## Records progress reports.
class Listener:
	var fractions: PackedFloat64Array
	var points: PackedInt64Array
	var threads: PackedInt64Array
	var times: PackedInt64Array
	var mutex := Mutex.new()
	var on_report := Callable() ## Called with the fraction of each report.

	func record(fraction: float, count: int) -> void:
		mutex.lock()
		fractions.push_back(fraction)
		points.push_back(count)
		threads.push_back(OS.get_thread_caller_id())
		times.push_back(Time.get_ticks_usec())
		mutex.unlock()
		if on_report.is_valid():
			on_report.call(fraction)

	func get_report_count() -> int:
		mutex.lock()
		var count := fractions.size()
		mutex.unlock()
		return count


func make(method: PoissonSampler.Method, number := 1, radius := 1.0) -> PoissonSampler:
	var sampler := PoissonSampler.new()
	sampler.method = method
	sampler.seed = number
	sampler.radius = radius
	return sampler


func label(method: int) -> String:
	return ClassDB.class_get_enum_constants("PoissonSampler", "Method")[method]


## Returns an area that the method samples in some tens of milliseconds.
func area_for(method: PoissonSampler.Method) -> Rect2:
	match method:
		PoissonSampler.METHOD_TILES: return Rect2(0, 0, 800, 400)
		PoissonSampler.METHOD_NAIVE: return Rect2(0, 0, 60, 50)
		_: return Rect2(0, 0, 250, 200)
