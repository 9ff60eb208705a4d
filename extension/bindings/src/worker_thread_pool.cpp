#include <godot_cpp/classes/worker_thread_pool.hpp>

namespace godot {

int64_t WorkerThreadPool::add_native_task(
		void (*p_function)(void *), void *p_userdata, bool p_high_priority, const String &p_description) {
	return gdextension_interface::worker_thread_pool_add_native_task(
			_owner, p_function, p_userdata, p_high_priority, p_description._native_ptr());
}

} // namespace godot
