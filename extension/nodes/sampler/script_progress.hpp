#pragma once

#include "core/base/progress.hpp"

#include <godot_cpp/variant/callable.hpp>
#include <godot_cpp/variant/variant.hpp>

#include <atomic>
#include <chrono>
#include <cstdint>

namespace thicket {

/// Reports the progress of a call to a script. The callable receives a fraction from 0 to 1 that
/// never decreases, and the number of points found so far. It runs on the calling thread, at most
/// once every 15 milliseconds. If it cannot be called, prints one error and continues without
/// reports.
class ScriptProgress {
public:
	/// Creates reports for `p_callable`. Error messages name `p_owner`. An empty callable receives
	/// none.
	ScriptProgress(const char *p_owner, const godot::Callable &p_callable);

	/// Returns the Progress to pass to a sampler, valid during the lifetime of this object. The
	/// Progress does not report a fraction of 1; call `finish` at the end.
	Progress progress(const std::atomic<bool> *p_cancel);

	/// Calls the callable one last time, with a fraction of 1.
	void finish(std::uint64_t p_points);

private:
	using Clock = std::chrono::steady_clock;

	void update(double p_fraction, std::uint64_t p_points);
	void call(double p_fraction, std::uint64_t p_points);

	const char *owner_;
	godot::Variant callable_;
	bool is_enabled_;               ///< False without a callable, and after a call has failed.
	double fraction_ = 0.0;         ///< The last reported fraction.
	Clock::time_point next_report_; ///< The earliest time of the next report.
};

} // namespace thicket
