extends RefCounted
## Collects the statistics of the scatter in each frame, for the overlay and for the screenshot run.

## The number of frames over which the median and the 99th percentile are computed.
const WINDOW := 1200

## If true, new frames are ignored, and the quantiles do not change.
var frozen := false

var _microseconds := PackedFloat64Array()
var _next_index := 0
var _last_stats := {}


## Adds the statistics of the last frame.
func sample(stats: Dictionary) -> void:
	_last_stats = stats
	if frozen:
		return
	var value := float(stats.get("frame_usec", 0))
	if _microseconds.size() < WINDOW:
		_microseconds.append(value)
		return
	_microseconds[_next_index] = value
	_next_index = (_next_index + 1) % WINDOW


## Removes all frames.
func clear() -> void:
	_microseconds.clear()
	_next_index = 0


## Returns a quantile of the time on the main thread, in microseconds. The given [param fraction] of the frames, from 0 to 1, did not exceed this
## time. Returns 0 before the first frame.
func quantile(fraction: float) -> float:
	if _microseconds.is_empty():
		return 0.0
	var sorted := _microseconds.duplicate()
	sorted.sort()
	return sorted[clampi(ceili(fraction * sorted.size()) - 1, 0, sorted.size() - 1)]


## Returns the number of points that one worker samples per second, averaged over all tiles since the start. Returns 0 before the first tile.
func points_per_second() -> float:
	var worker_usec := float(_last_stats.get("worker_usec", 0))
	return float(_last_stats.get("points_sampled", 0)) / worker_usec * 1e6 if worker_usec > 0.0 else 0.0


## Returns the statistics as a few lines of text.
func text() -> String:
	return "\n".join([
		"%s tiles, %s pending" % [_last_stats.get("tiles", 0), int(_last_stats.get("waiting", 0)) + int(_last_stats.get("pending",
				0))],
		"%s instances" % grouped(int(_last_stats.get("instances", 0))),
		"%s points per second and thread" % grouped(int(points_per_second())),
		"main thread: median %.0f µs, p99 %.0f µs per frame" % [quantile(0.5), quantile(0.99)],
	])


## Returns a number with thin spaces as thousands separators.
static func grouped(value: int) -> String:
	var digits := str(value)
	for position in range(digits.length() - 3, 0, -3):
		digits = digits.insert(position, " ")
	return digits
