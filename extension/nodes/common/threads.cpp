#include "nodes/common/threads.hpp"

#include <godot_cpp/classes/os.hpp>
#include <godot_cpp/classes/project_settings.hpp>
#include <godot_cpp/classes/worker_thread_pool.hpp>

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <thread>
#include <vector>

using namespace godot;

namespace thicket {

namespace {

std::atomic<std::thread::id> main_thread;

} // namespace

bool has_threads() {
	const Variant setting = ProjectSettings::get_singleton()->get_setting("threading/worker_pool/max_threads", -1);
	return OS::get_singleton()->has_feature("threads") && static_cast<int64_t>(setting) != 0;
}

void remember_main_thread() { main_thread.store(std::this_thread::get_id(), std::memory_order_relaxed); }

bool on_main_thread() noexcept { return std::this_thread::get_id() == main_thread.load(std::memory_order_relaxed); }

std::size_t spare_thread_count() {
	if (!has_threads()) {
		return 0;
	}
	const std::size_t cores = std::thread::hardware_concurrency();
	return std::clamp<std::size_t>(cores, 2, 9) - 1; // Leaves one core for the calling thread.
}

void EngineThreads::run(const std::function<void(std::size_t index)> &work) {
	struct Task {
		const std::function<void(std::size_t index)> *work;
		std::size_t index;
		std::int64_t task_id;

		static void call(void *p_task) {
			const Task &task = *static_cast<Task *>(p_task);
			(*task.work)(task.index);
		}
	};
	std::vector<Task> tasks;
	for (std::size_t index = 1; index <= count_; ++index) {
		tasks.push_back({&work, index, -1});
	}
	WorkerThreadPool *pool = WorkerThreadPool::get_singleton();
	for (Task &task : tasks) {
		task.task_id = pool->add_native_task(&Task::call, &task, true, "Thicket sampler");
	}
	work(0);
	for (const Task &task : tasks) {
		pool->wait_for_task_completion(task.task_id);
	}
}

} // namespace thicket
