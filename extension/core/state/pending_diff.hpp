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

/// A diff that is applied beside the state that it is for, on any thread: see InstanceState::queue_diff.
class PendingDiff {
public:
	/// `bytes` stay as long as this does.
	PendingDiff(std::span<const std::uint8_t> bytes, const DiffLimits &limits) : bytes_(bytes), limits_(limits) {}

	/// Whether `work` can be called: not before those that were queued earlier are finished.
	bool can_work() const { return base_.has_value(); }

	/// Does what takes long. Once, on any thread, whatever the state's own thread does with the state meanwhile.
	void work();

	/// What `work` has found, as long as nothing was done to the state meanwhile. For who has worked.
	const StateChanges &changes() const { return changes_; }

	/// `work` ends within some milliseconds from now, and does nothing of use. From any thread.
	void cancel() { cancel_ = true; }

private:
	friend class InstanceState;

	/// From now on it can work: with the content as it was when the diff was queued, and the state's log as it is.
	void start_from(InstanceState base, const ChangeLog &log, std::uint64_t revision) noexcept;

	std::span<const std::uint8_t> bytes_;
	DiffLimits limits_;
	std::size_t steps_before_ = 0; ///< Of those that the state records: made before this was queued.
	std::optional<InstanceState> base_;
	std::optional<InstanceState> next_; ///< The base with the diff applied.
	ChangeLog log_;                     ///< The state's, up to `revision_`.
	std::uint64_t revision_ = 0;        ///< Of the state when `log_` was taken.
	std::uint64_t first_note_ = 0;      ///< The revision of `next_` before the diff.
	StateChanges changes_;
	Status status_;
	std::atomic<bool> cancel_ = false;
};

} // namespace thicket
