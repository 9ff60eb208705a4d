#pragma once

#include <atomic>
#include <cstdint>
#include <functional>

namespace thicket {

/// Returns true if any thread has set the flag. A null pointer means that the call cannot be
/// canceled.
inline bool is_cancelled(const std::atomic<bool> *cancel) {
	return cancel != nullptr && cancel->load(std::memory_order_relaxed);
}

/// Lets a caller monitor and cancel a long call.
struct Progress {
	/// A flag that any thread may set to end the call with ErrorCode::cancelled. Each function
	/// documents how soon it ends.
	const std::atomic<bool> *cancel = nullptr;
	/// Called on the calling thread at least every few milliseconds. `fraction` is the finished
	/// fraction of the work (0 to 1, never decreasing), and `points` the number of points generated
	/// so far. May set `cancel`. Must not throw.
	std::function<void(double fraction, std::uint64_t points)> report;

	bool cancelled() const { return is_cancelled(cancel); }
};

} // namespace thicket
