#include "nodes/gameplay/diff_task.hpp"

#include "nodes/common/convert.hpp"
#include "nodes/common/guard.hpp"
#include "nodes/common/script_call.hpp"
#include "nodes/common/threads.hpp"

#include <godot_cpp/classes/worker_thread_pool.hpp>
#include <godot_cpp/core/error_macros.hpp>

#include <utility>

using namespace godot;

namespace thicket {

namespace {

using UnneededObjects = std::vector<std::shared_ptr<const void>>;

void free_objects(void *p_objects) { delete static_cast<UnneededObjects *>(p_objects); }

} // namespace

PackedInt64Array ids_of_changes(std::span<const InstanceChange> changes) {
	const auto id_of = [](const InstanceChange &change) {
		return script_id(change.id);
	};
	return packed<PackedInt64Array>(changes, id_of);
}

DiffTask::DiffTask(const PackedByteArray &p_diff, const Callable &p_callback) :
		bytes_(p_diff), callback_(p_callback.is_null() ? Variant() : Variant(p_callback)) {}

std::span<const std::uint8_t> DiffTask::bytes() const { return span_of(bytes_); }

void DiffTask::start(Object *p_owner) {
	owner_ = p_owner;
	auto task_reference = std::make_unique<std::shared_ptr<DiffTask>>(shared_from_this());
	if (has_threads()) {
		// Use a high priority, because low-priority tile tasks may keep their threads busy for a
		// long time.
		task_ = WorkerThreadPool::get_singleton()->add_native_task(
				&DiffTask::run, task_reference.release(), true, "Thicket diff");
	} else {
		run(task_reference.release());
	}
}

void DiffTask::run(void *p_task) {
	const std::unique_ptr<std::shared_ptr<DiffTask>> task_reference(static_cast<std::shared_ptr<DiffTask> *>(p_task));
	DiffTask &task = **task_reference;
	task.work();
	const std::lock_guard lock(task.mutex_);
	if (task.owner_ != nullptr) {
		task.owner_->call_deferred("_finish_diffs");
	}
}

void DiffTask::work() {
	diff->work();
	guarded_call("ScatterState.apply_diff_async", [this] { ids = ids_of_changes(diff->changes().list); });
	is_done_.store(true, std::memory_order_release);
}

void DiffTask::finish() {
	if (task_ >= 0) {
		WorkerThreadPool::get_singleton()->wait_for_task_completion(task_);
		task_ = -1;
	} else if (!is_done()) {
		work();
	}
}

void DiffTask::cancel() {
	callback_ = Variant();
	if (diff != nullptr) {
		diff->cancel();
	}
	{
		const std::lock_guard lock(mutex_);
		owner_ = nullptr;
	}
	if (task_ >= 0) {
		WorkerThreadPool::get_singleton()->wait_for_task_completion(task_);
		task_ = -1;
	}
}

void DiffTask::notify(Error error) {
	Variant callback = std::exchange(callback_, Variant());
	if (callback.get_type() == Variant::NIL) {
		return;
	}
	const Variant argument(static_cast<int64_t>(error));
	Variant result;
	const GDExtensionCallErrorType call_error = call_script(callback, "call", result, argument);
	if (call_error != GDEXTENSION_CALL_OK && call_error != GDEXTENSION_CALL_ERROR_INSTANCE_IS_NULL) {
		ERR_PRINT("ScatterState.apply_diff_async: callback must take (error: Error), and could not be called.");
	}
}

DeferredFree::~DeferredFree() {
	for (const std::int64_t task : tasks_) {
		WorkerThreadPool::get_singleton()->wait_for_task_completion(task);
	}
}

void DeferredFree::forget_completed_tasks() {
	WorkerThreadPool *pool = WorkerThreadPool::get_singleton();
	std::erase_if(tasks_, [pool](std::int64_t task) {
		if (!pool->is_task_completed(task)) {
			return false;
		}
		// Make the pool forget the task. The call returns immediately, because the task is
		// completed.
		pool->wait_for_task_completion(task);
		return true;
	});
}

void DeferredFree::forget(std::int64_t task) {
	if (task >= 0) {
		tasks_.push_back(task);
	}
}

void DeferredFree::free_on_worker(UnneededObjects objects) {
	if (!has_threads()) {
		return;
	}
	forget_completed_tasks();
	tasks_.reserve(tasks_.size() + 1);
	auto task_reference = std::make_unique<UnneededObjects>(std::move(objects));
	tasks_.push_back(WorkerThreadPool::get_singleton()->add_native_task(
			&free_objects, task_reference.release(), false, "Thicket deferred free"));
}

} // namespace thicket
