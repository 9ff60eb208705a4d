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

/// A diff (the changes of a state as bytes, from a peer) that ScatterState.apply_diff_async has
/// received. The task exists until its callback is called. A task of the engine's WorkerThreadPool
/// processes the diff. If the pool has no threads, `start` processes it immediately. All other work
/// happens on the main thread.
class DiffTask : public std::enable_shared_from_this<DiffTask> {
public:
	DiffTask(const godot::PackedByteArray &p_diff, const godot::Callable &p_callback);

	/// Returns the bytes that `apply_diff_async` received.
	std::span<const std::uint8_t> bytes() const;

	/// Returns true if the diff can be processed: earlier diffs are finished, and there is enough
	/// memory.
	bool can_work() const { return diff != nullptr && diff->can_work(); }

	/// Processes the diff in the pool, then defers a call to `p_owner`'s method `_finish_diffs`.
	/// Call `start` only once, and only if `can_work` is true.
	void start(godot::Object *p_owner);
	bool is_done() const { return is_done_.load(std::memory_order_acquire); }

	/// Waits until the diff is processed. If no thread has started on it, processes it on the
	/// calling thread.
	void finish();

	/// Discards the result. May wait a few milliseconds for the thread that processes the diff.
	void cancel();

	/// Calls the callback, if there is one, with `error` and releases it. The callback is a script,
	/// which may change or free anything.
	void notify(godot::Error error);

	/// Returns the pool's task ID to a caller that will wait for the task itself. Returns -1 if
	/// there is no task or if the ID has already been taken.
	std::int64_t take_task() { return std::exchange(task_, -1); }

	/// The processed diff. Null if memory was insufficient; `queue_status` is then the error.
	std::shared_ptr<PendingDiff> diff;
	Status queue_status;
	godot::PackedInt64Array ids; ///< The instance IDs of all changes, once the diff is processed.

private:
	static void run(void *p_task);
	void work();

	const godot::PackedByteArray bytes_;
	/// The callback; null if there is none. Released on the main thread, along with its bound
	/// arguments.
	godot::Variant callback_;
	std::mutex mutex_; ///< Guards the following members.
	godot::Object *owner_ = nullptr;
	std::atomic<bool> is_done_ = false;
	std::int64_t task_ = -1;
};

/// Frees large objects on the engine's WorkerThreadPool, because freeing a hundred megabytes would
/// exceed the frame budget. Use it only on the main thread.
class DeferredFree {
public:
	DeferredFree() = default;
	~DeferredFree();
	DeferredFree(const DeferredFree &) = delete;
	DeferredFree &operator=(const DeferredFree &) = delete;

	/// Frees the objects once nothing else references them. Frees them immediately if the pool has
	/// no threads.
	void free_on_worker(std::vector<std::shared_ptr<const void>> objects);

	/// Releases a pool task once it has ended. Ignores -1.
	void forget(std::int64_t task);

private:
	void forget_completed_tasks();

	std::vector<std::int64_t> tasks_; ///< Tasks that have not been released yet.
};

} // namespace thicket
