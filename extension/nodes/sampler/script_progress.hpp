#pragma once

#include "core/base/progress.hpp"

#include <godot_cpp/variant/callable.hpp>
#include <godot_cpp/variant/variant.hpp>

#include <atomic>
#include <chrono>
#include <cstdint>

namespace thicket {

/// Reports the progress of a call to a script: a fraction from 0 to 1 that never falls, and the number of points found
/// until then. Reports at most about every 15 milliseconds, on the thread that makes the call. A callable that cannot
/// be called prints one error and is not called again; the work continues without it.
class ScriptProgress {
public:
	/// Errors name `p_owner`. An empty callable gets no reports.
	ScriptProgress(const char *p_owner, const godot::Callable &p_callable);

	/// The interface for progress and cancellation that a sampler uses. Valid as long as this object lives. Does not
	/// report the end, because `finish` does.
	Progress progress(const std::atomic<bool> *p_cancel);

	/// Calls it once more, with a fraction of 1.
	void finish(std::uint64_t p_points);

private:
	using Clock = std::chrono::steady_clock;

	void update(double p_fraction, std::uint64_t p_points);
	void call(double p_fraction, std::uint64_t p_points);

	const char *owner_;
	godot::Variant callable_;
	bool wanted_;
	double fraction_ = 0.0; ///< The last one that the script received.
	Clock::time_point due_; ///< The time of the next possible report.
};

} // namespace thicket
