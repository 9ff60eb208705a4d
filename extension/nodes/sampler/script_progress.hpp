#pragma once

#include "core/base/progress.hpp"

#include <godot_cpp/variant/callable.hpp>
#include <godot_cpp/variant/variant.hpp>

#include <atomic>
#include <chrono>
#include <cstdint>

namespace thicket {

/// Tells a script how far a call is: with a fraction from 0 to 1 that never falls and the number of points so far, about
/// every 15 milliseconds at most, on the thread that makes the call. A callable that cannot be called prints one error
/// and is left alone from then on; the work goes on without it.
class ScriptProgress {
public:
	/// `p_owner` is named in the error. An empty callable wants to know nothing.
	ScriptProgress(const char *p_owner, const godot::Callable &p_callable);

	/// What a sampler tells, for as long as this object lives, and what ends it. The end is left to `finish`.
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
	double fraction_ = 0.0; ///< The last one that the script was told.
	Clock::time_point due_; ///< When it may be told again.
};

} // namespace thicket
