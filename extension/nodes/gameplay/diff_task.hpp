#pragma once

#include "core/state/pending_diff.hpp"

#include <godot_cpp/classes/global_constants.hpp>
#include <godot_cpp/classes/object.hpp>
#include <godot_cpp/variant/callable.hpp>
#include <godot_cpp/variant/packed_byte_array.hpp>
#include <godot_cpp/variant/packed_int64_array.hpp>
#include <godot_cpp/variant/variant.hpp>

#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <span>
#include <utility>
#include <vector>

namespace thicket {

godot::PackedInt64Array ids_of_changes(std::span<const InstanceChange> changes);

/// A diff between ScatterState.apply_diff_async and its callback, and the work on it: on the engine's WorkerThreadPool, or at once
/// where that has no threads. All but the work on the main thread.
class DiffTask : public std::enable_shared_from_this<DiffTask> {
public:
	DiffTask(const godot::PackedByteArray &p_diff, const godot::Callable &p_callback);

	/// As `apply_diff_async` got it.
	std::span<const std::uint8_t> bytes() const;

	/// Whether it can be worked on: not before those that were called for earlier are finished, and not without memory for it.
	bool can_work() const { return diff != nullptr && diff->can_work(); }

	/// Works, then has `p_owner` do `_finish_diffs` in its next idle time. Once, if it can be worked on.
	void start(godot::Object *p_owner);
	bool done() const { return done_.load(std::memory_order_acquire); }

	/// Works until it is done: waits for the thread that does, or does so itself.
	void finish();

	/// Nobody wants what comes of it. Waits some milliseconds for the thread.
	void cancel();

	/// Calls the callback, which may do anything, and forgets it.
	void tell(godot::Error error);

	/// The pool's number of the task, once, for who asks the pool about it in the stead of this; -1 for none.
	std::int64_t take_task() { return std::exchange(task_, -1); }

	std::shared_ptr<PendingDiff> diff; ///< Null where there was no memory for one: then `refused` says so.
	Status refused;
	godot::PackedInt64Array ids; ///< Of all changes, once it is done.

private:
	static void run(void *p_task);
	void work();

	const godot::PackedByteArray bytes_;
	godot::Variant callback_; ///< Null for none. Goes on the main thread, and with it what a script has bound to it.
	std::mutex mutex_;        ///< Of what follows.
	godot::Object *owner_ = nullptr;
	std::atomic<bool> done_ = false;
	std::int64_t task_ = -1;
};

/// Lets go of what is large on the engine's WorkerThreadPool: to free a hundred megabytes takes longer than a frame may. Main thread only.
class Leavings {
public:
	Leavings() = default;
	~Leavings();
	Leavings(const Leavings &) = delete;
	Leavings &operator=(const Leavings &) = delete;

	/// At once where there are no threads.
	void let_go(std::vector<std::shared_ptr<const void>> unneeded);

	/// Has the pool forget a task that has ended or soon will; -1 for none.
	void forget(std::int64_t task);

private:
	void forget_those_that_ended();

	std::vector<std::int64_t> tasks_; ///< Those that the pool has not been asked about since they ended.
};

} // namespace thicket
