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

/// A diff between ScatterState.apply_diff_async and its callback. The engine's WorkerThreadPool processes the diff; if
/// the pool has no threads, the caller does so immediately. All other work happens on the main thread.
class DiffTask : public std::enable_shared_from_this<DiffTask> {
public:
	DiffTask(const godot::PackedByteArray &p_diff, const godot::Callable &p_callback);

	/// The bytes that `apply_diff_async` received.
	std::span<const std::uint8_t> bytes() const;

	/// True if the work can start: earlier calls are finished, and there is enough memory.
	bool can_work() const { return diff != nullptr && diff->can_work(); }

	/// Processes the diff, then defers a call of `p_owner`'s `_finish_diffs` to idle time. Call it only once, and only if `can_work`.
	void start(godot::Object *p_owner);
	bool done() const { return done_.load(std::memory_order_acquire); }

	/// Finishes the work: waits for the thread that processes the diff, or processes it on the calling thread.
	void finish();

	/// Discards the result. Waits some milliseconds for the thread.
	void cancel();

	/// Calls the callback, which may do anything, and releases it.
	void tell(godot::Error error);

	/// Returns the pool's task number once, to a caller that waits for the task itself; -1 if there is no task.
	std::int64_t take_task() { return std::exchange(task_, -1); }

	std::shared_ptr<PendingDiff> diff; ///< Null if there was no memory for one; `refused` then has the error.
	Status refused;
	godot::PackedInt64Array ids; ///< For all changes, once it is done.

private:
	static void run(void *p_task);
	void work();

	const godot::PackedByteArray bytes_;
	godot::Variant callback_; ///< Null if there is none. Released on the main thread, with its bound arguments.
	std::mutex mutex_;        ///< Guards the following members.
	godot::Object *owner_ = nullptr;
	std::atomic<bool> done_ = false;
	std::int64_t task_ = -1;
};

/// Frees large objects on the engine's WorkerThreadPool, because freeing a hundred megabytes takes longer than a frame
/// may. Main thread only.
class Leavings {
public:
	Leavings() = default;
	~Leavings();
	Leavings(const Leavings &) = delete;
	Leavings &operator=(const Leavings &) = delete;

	/// Frees them immediately if there are no threads.
	void let_go(std::vector<std::shared_ptr<const void>> unneeded);

	/// Makes the pool forget a task that has ended or soon will; -1 for none.
	void forget(std::int64_t task);

private:
	void forget_those_that_ended();

	std::vector<std::int64_t> tasks_; ///< Tasks that the pool has not yet been queried about since they ended.
};

} // namespace thicket
