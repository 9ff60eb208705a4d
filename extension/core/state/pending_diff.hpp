#pragma once

#include "core/state/change_log.hpp"
#include "core/state/instance_state.hpp"
#include "core/state/state_changes.hpp"

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

namespace thicket {

/// A diff that any thread applies to a copy, while the state that will receive it stays in use. See InstanceState::queue_diff.
class PendingDiff {
public:
	/// `bytes` must outlive this object.
	PendingDiff(std::span<const std::uint8_t> bytes, const DiffLimits &limits) : bytes_(bytes), limits_(limits) {}

	/// Whether `work` can be called. False until all earlier queued diffs are finished.
	bool can_work() const { return base_.has_value(); }

	/// Does the slow part. Call once, on any thread. The state's own thread may use the state meanwhile.
	void work();

	/// The result of `work`, valid if the state has not changed meanwhile. Only the thread that called `work` may call
	/// this.
	const StateChanges &changes() const { return changes_; }

	/// Ends `work` within some milliseconds; its result is then invalid. May be called from any thread.
	void cancel() { cancel_ = true; }

private:
	friend class InstanceState;

	/// Enables `work`, with the content at the time when the diff was queued and the current log of the state.
	void start_from(InstanceState base, const ChangeLog &log, std::uint64_t revision) noexcept;

	std::span<const std::uint8_t> bytes_;
	DiffLimits limits_;
	std::size_t steps_before_ = 0; ///< Number of recorded steps made before this diff was queued.
	std::optional<InstanceState> base_;
	std::optional<InstanceState> next_; ///< The base with the diff applied.
	ChangeLog log_;                     ///< The state's log, up to `revision_`.
	std::uint64_t revision_ = 0;        ///< Revision of the state when `log_` was taken.
	std::uint64_t first_note_ = 0;      ///< The revision of `next_` before the diff.
	StateChanges changes_;
	Status status_;
	std::atomic<bool> cancel_ = false;
};

} // namespace thicket
