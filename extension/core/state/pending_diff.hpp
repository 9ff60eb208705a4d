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

/// A diff that a worker thread applies to a copy of a state while the state remains usable. See
/// InstanceState::queue_diff.
class PendingDiff {
public:
	/// Creates a diff that has not been queued yet. `bytes` must outlive this object.
	PendingDiff(std::span<const std::uint8_t> bytes, const DiffLimits &limits) : bytes_(bytes), limits_(limits) {}

	/// Returns true if `work` may be called. The result is false until all diffs queued earlier are
	/// finished.
	bool can_work() const { return base_.has_value(); }

	/// Applies the diff to the copy, which is the slow part. Call this function once, on any
	/// thread. The thread of the state may keep using the state.
	void work();

	/// Returns the changes found by `work`, valid if the state has not changed since. Call this
	/// function only on the thread that called `work`.
	const StateChanges &changes() const { return changes_; }

	/// Makes `work` return within a few milliseconds with an invalid result. Any thread may call
	/// this method.
	void cancel() { cancel_ = true; }

private:
	friend class InstanceState;

	/// Enables `work`. `base` is the content to which the diff is applied; `log` and `revision` are
	/// the state's current ones.
	void start_from(InstanceState base, const ChangeLog &log, std::uint64_t revision) noexcept;

	std::span<const std::uint8_t> bytes_;
	DiffLimits limits_;
	std::size_t steps_before_ = 0; ///< Number of steps in the journal when this diff was queued.
	std::optional<InstanceState> base_;
	std::optional<InstanceState> next_; ///< The base with the diff applied.
	ChangeLog log_;                     ///< The state's log, up to `revision_`.
	std::uint64_t revision_ = 0;        ///< Revision of the state when `log_` was taken.
	std::uint64_t base_revision_ = 0;   ///< The revision of `next_` before the diff was applied.
	StateChanges changes_;
	Status status_;
	std::atomic<bool> cancel_ = false;
};

} // namespace thicket
