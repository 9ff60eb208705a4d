#pragma once

#include "nodes/common/threads.hpp"

#include <godot_cpp/classes/worker_thread_pool.hpp>

#include <atomic>
#include <cstdint>
#include <utility>

namespace thicket {

/// Runs one piece of work at a time on the engine's WorkerThreadPool, or synchronously if there are
/// no worker threads. `Work` needs a member `run(const std::atomic<bool> *cancel)` that does not
/// throw. Call all methods on the main thread.
template <class Work>
class WorkerTask {
public:
	WorkerTask() = default;
	~WorkerTask() {
		cancel();
		finish(true);
	}
	WorkerTask(const WorkerTask &) = delete;
	WorkerTask &operator=(const WorkerTask &) = delete;

	/// Starts the work; the task must not be busy. If `synchronous` is true, runs the work to
	/// completion on the calling thread.
	void start(Work work, bool synchronous = false) {
		work_ = std::move(work);
		cancelled_ = false;
		busy_ = true;
		if (!synchronous && has_threads()) {
			task_ = godot::WorkerThreadPool::get_singleton()->add_native_task(
					&WorkerTask::run, this, false, "Thicket ground");
		} else {
			run(this);
		}
	}

	bool busy() const { return busy_; }

	/// Returns true exactly once, when the work is done and `take` may be called. If `wait` is
	/// true, first waits for the work. Returns false if the task is idle or was canceled.
	bool finish(bool wait) {
		godot::WorkerThreadPool *pool = godot::WorkerThreadPool::get_singleton();
		if (!busy_ || (task_ >= 0 && !wait && !pool->is_task_completed(task_))) {
			return false;
		}
		if (task_ >= 0) {
			pool->wait_for_task_completion(task_); // Frees a completed task in the pool.
			task_ = -1;
		}
		busy_ = false;
		if (cancelled_) {
			work_ = {};
			return false;
		}
		return true;
	}

	Work take() { return std::exchange(work_, {}); }

	/// Abandons the current work. The task stays busy until the worker stops and `finish` is
	/// called.
	void cancel() { cancelled_ = true; }

private:
	static void run(void *p_task) {
		auto &task = *static_cast<WorkerTask *>(p_task);
		task.work_.run(&task.cancelled_);
	}

	Work work_; ///< Owned by the worker until its task has ended.
	std::atomic<bool> cancelled_ = false;
	std::int64_t task_ = -1;
	bool busy_ = false;
};

} // namespace thicket
