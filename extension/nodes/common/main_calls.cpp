#include "nodes/common/main_calls.hpp"

#include "nodes/common/engine_arrays.hpp"
#include "nodes/common/guard.hpp"
#include "nodes/common/script_call.hpp"

#include <godot_cpp/variant/array.hpp>
#include <godot_cpp/variant/callable.hpp>

#include <atomic>
#include <cstring>
#include <mutex>
#include <utility>
#include <vector>

using namespace godot;

namespace thicket {

namespace {

std::mutex mutex;
std::vector<Variant> calls;          ///< Callables with bound arguments. Guarded by `mutex`.
std::atomic<bool> has_calls = false; ///< True if `calls` is not empty. Avoids locking.

} // namespace

void call_on_main_thread(const Object *p_object, const char *method, std::span<const Variant> arguments) noexcept {
	guarded_call(method, [&] {
		Array bound_arguments;
		for (const Variant &argument : arguments) {
			append(bound_arguments, argument);
		}
		Callable callable(const_cast<Object *>(p_object), StringName(std::strrchr(method, '.') + 1));
		const std::lock_guard lock(mutex);
		calls.push_back(Variant(callable.bindv(bound_arguments)));
		has_calls = true;
	});
}

void make_main_thread_calls() {
	if (!has_calls.load(std::memory_order_relaxed)) {
		// Most frames have no queued calls.
		return;
	}
	std::vector<Variant> queued_calls;
	{
		const std::lock_guard lock(mutex);
		queued_calls = std::exchange(calls, {});
		has_calls = false;
	}
	for (Variant &callable : queued_calls) {
		Variant result;
		static_cast<void>(call_script(callable, "call", result));
	}
}

void drop_main_thread_calls() {
	const std::lock_guard lock(mutex);
	calls.clear();
	has_calls = false;
}

} // namespace thicket
