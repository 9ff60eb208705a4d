#pragma once

#include <atomic>
#include <cstdint>
#include <functional>

namespace thicket {

/// Whether somebody has raised the flag, on any thread; null for nobody.
inline bool is_cancelled(const std::atomic<bool> *cancel) {
	return cancel != nullptr && cancel->load(std::memory_order_relaxed);
}

/// Lets a long call be watched and ended.
struct Progress {
	/// Raised from any thread, it ends the call with ErrorCode::cancelled: soon, the call says how soon.
	const std::atomic<bool> *cancel = nullptr;
	/// Called on the calling thread, at least every few milliseconds, with the finished fraction (0 to 1, never falling) and
	/// the points so far. May raise `cancel`. Must not throw.
	std::function<void(double fraction, std::uint64_t points)> report;

	bool cancelled() const { return is_cancelled(cancel); }
};

} // namespace thicket
