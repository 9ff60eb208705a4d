// This file contains the methods of ScatterState that notify listeners and scripts of changes, and
// those that apply diffs on a thread.

#include "nodes/common/convert.hpp"
#include "nodes/common/engine_arrays.hpp"
#include "nodes/gameplay/scatter_state.hpp"
#include "nodes/gameplay/state_refusal.hpp"

#include <algorithm>
#include <utility>

using namespace godot;

namespace thicket {

namespace {

/// The number of changes above which a list is freed on a thread.
constexpr std::size_t many_changes = 16384;

/// Appends the IDs of the changes to `r_ids`.
void add_ids(std::span<const InstanceChange> changes, PackedInt64Array &r_ids) {
	const int64_t first = r_ids.size();
	r_ids = resized_copy(r_ids, first + static_cast<int64_t>(changes.size()));
	std::ranges::transform(changes, writable(r_ids).subspan(static_cast<std::size_t>(first)).begin(),
			[](const InstanceChange &change) { return script_id(change.id); });
}

} // namespace

ScatterState::~ScatterState() {
	for (const std::shared_ptr<DiffTask> &diff : diffs_) {
		diff->cancel();
	}
}

std::vector<std::shared_ptr<StateListener>> ScatterState::listeners() const {
	std::vector<std::shared_ptr<StateListener>> result;
	for (const std::weak_ptr<StateListener> &listener : listeners_) {
		if (std::shared_ptr<StateListener> locked = listener.lock()) {
			result.push_back(std::move(locked));
		}
	}
	return result;
}

void ScatterState::notify(std::vector<InstanceChange> changes) {
	if (!changes.empty()) {
		const auto shared = std::make_shared<StateChanges>();
		shared->list = std::move(changes);
		update_listeners({shared, nullptr});
	}
	notify_scripts();
}

void ScatterState::update_listeners(UnreportedChanges unreported) {
	if (unreported.changes != nullptr) {
		// state_changed() runs no scripts, so the list cannot change during the loop.
		for (const std::weak_ptr<StateListener> &listener : listeners_) {
			if (const std::shared_ptr<StateListener> locked = listener.lock()) {
				locked->state_changed(unreported.changes);
			}
		}
	}
	unreported_.push_back(std::move(unreported));
}

void ScatterState::notify_scripts() {
	if (notifying_ || unreported_.empty()) {
		return; // Called by a signal handler. The outer call reports this change, too.
	}
	const Ref<ScatterState> self(this); // A handler may release the last other reference.
	notifying_ = true;
	while (!unreported_.empty()) {
		UnreportedChanges next = std::move(unreported_.front());
		unreported_.pop_front();
		report_now(next);
		if (next.diff != nullptr || next.changes->size() > many_changes) {
			// Free them on a thread, to avoid a hitch.
			deferred_free_.free_on_worker({std::move(next.changes), std::move(next.diff)});
		}
	}
	notifying_ = false;
}

void ScatterState::report_now(const UnreportedChanges &unreported) {
	if (unreported.changes != nullptr) {
		for (const std::shared_ptr<StateListener> &listener : listeners()) {
			const auto is_same = [&listener](const std::weak_ptr<StateListener> &other) {
				return !other.owner_before(listener) && !listener.owner_before(other);
			};
			if (std::ranges::any_of(listeners_, is_same)) { // A signal handler may have removed the listener.
				listener->notify_changes(unreported.changes);
			}
		}
		const StateChanges &changes = *unreported.changes;
		if (unreported.diff == nullptr) {
			emit_signal(instances_changed_, ids_of_changes(changes.list));
		} else {
			// The diff's thread has already listed all other IDs.
			add_ids(changes.replacements, unreported.diff->ids);
			emit_signal(instances_changed_, unreported.diff->ids);
		}
		emit_changed();
	}
	if (unreported.diff != nullptr) {
		unreported.diff->notify(unreported.error);
	}
}

void ScatterState::add_listener(const std::shared_ptr<StateListener> &listener) {
	remove_listener(listener.get());
	listeners_.push_back(listener);
}

void ScatterState::remove_listener(const StateListener *listener) {
	const bool had_listeners = !listeners_.empty();
	std::erase_if(listeners_, [listener](const std::weak_ptr<StateListener> &other) {
		const std::shared_ptr<StateListener> locked = other.lock();
		return locked == nullptr || locked.get() == listener;
	});
	if (had_listeners && listeners_.empty()) {
		state_.release_claims();
	}
}

void ScatterState::apply_diff_async(const PackedByteArray &p_diff, const Callable &p_callback) {
	const auto task = std::make_shared<DiffTask>(p_diff, p_callback);
	task->queue_status = state_.queue_diff(task->bytes(), task->diff, limits());
	diffs_.push_back(task);
	if (diffs_.size() == 1) {
		start_diff();
	}
}

void ScatterState::start_diff() {
	if (diffs_.empty()) {
		return;
	}
	DiffTask &first = *diffs_.front();
	if (first.can_work()) {
		first.start(this);
	} else {
		call_deferred("_finish_diffs");
	}
}

void ScatterState::finish_first_diff() {
	const std::shared_ptr<DiffTask> first = std::move(diffs_.front());
	diffs_.pop_front();
	deferred_free_.forget(first->take_task());
	const auto changes = std::make_shared<StateChanges>();
	const Status status = first->diff != nullptr ? state_.finish_pending_diff(*changes) : first->queue_status;
	const Error error = report_outcome("apply_diff_async", status);
	update_listeners({changes->size() > 0 ? changes : nullptr, first, error});
}

void ScatterState::finish_diffs() {
	if (diffs_.empty()) {
		return; // wait_for_diffs() has already finished all diffs.
	}
	const DiffTask &first = *diffs_.front();
	if (!first.can_work() || first.is_done()) {
		finish_first_diff();
		start_diff();
		notify_scripts();
	}
}

void ScatterState::wait_for_diffs() {
	while (!diffs_.empty()) {
		DiffTask &first = *diffs_.front();
		if (first.can_work()) {
			first.finish();
		}
		finish_first_diff();
	}
}

} // namespace thicket
