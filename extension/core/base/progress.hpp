#pragma once

#include <atomic>
#include <cstdint>
#include <functional>

namespace thicket {

/// True if the flag was raised, on any thread. A null pointer means that the call cannot be cancelled.
inline bool is_cancelled(const std::atomic<bool> *cancel) {
	return cancel != nullptr && cancel->load(std::memory_order_relaxed);
}

/// Lets a caller watch and cancel a long call.
struct Progress {
	/// A flag that any thread may raise to end the call with ErrorCode::cancelled. Each call documents how soon it
	/// ends.
	const std::atomic<bool> *cancel = nullptr;
	/// Called on the calling thread at least every few milliseconds, with the finished fraction (0 to 1, never falling) and the number of
	/// points generated until then. May raise `cancel`. Must not throw.
	std::function<void(double fraction, std::uint64_t points)> report;

	bool cancelled() const { return is_cancelled(cancel); }
};

} // namespace thicket
