#include "nodes/gameplay/scatter_request.hpp"

#include <godot_cpp/core/class_db.hpp>
#include <godot_cpp/core/memory.hpp>

#include <utility>

using namespace godot;

namespace thicket {

bool ScatterRequest::is_completed() const {
	const std::lock_guard lock(mutex_);
	return completed_;
}

bool ScatterRequest::is_canceled() const {
	const std::lock_guard lock(mutex_);
	return canceled_;
}

Ref<ScatterInstances> ScatterRequest::get_result() const {
	const std::lock_guard lock(mutex_);
	return result_.is_valid() ? result_ : ScatterInstances::make_empty();
}

/// Stores the result. Returns false if the request has already been completed.
bool ScatterRequest::finish(const Ref<ScatterInstances> &p_result, bool p_canceled) {
	const std::lock_guard lock(mutex_);
	if (std::exchange(completed_, true)) {
		return false;
	}
	canceled_ = p_canceled;
	result_ = p_result;
	return true;
}

bool ScatterRequest::cancel() {
	const bool was_open = finish({}, true);
	if (was_open) {
		notify_later(); // The node detects the cancellation in its next frame.
	}
	return was_open;
}

void ScatterRequest::complete(const Ref<ScatterInstances> &p_result) {
	if (finish(p_result, false)) {
		notify(this);
	}
}

void ScatterRequest::abandon() {
	if (finish({}, false)) {
		notify_later();
	}
}

void ScatterRequest::notify_later() {
	// Pass the request to the call, to keep it alive. A script that awaits the signal does not.
	call_deferred("_tell", Ref<ScatterRequest>(this));
}

void ScatterRequest::notify(const Ref<ScatterRequest> &) { emit_signal("completed", get_result()); }

void ScatterRequest::_bind_methods() {
	using Self = ScatterRequest;
	bind_guarded<&Self::is_completed>(D_METHOD("is_completed"));
	bind_guarded<&Self::is_canceled>(D_METHOD("is_canceled"));
	bind_guarded<&Self::get_result>(D_METHOD("get_result"));
	bind_guarded<&Self::cancel>(D_METHOD("cancel"));
	bind_guarded<&Self::notify>(ThreadUse::relayed, D_METHOD("_tell", "request"));
	ADD_SIGNAL(MethodInfo(
			"completed", PropertyInfo(Variant::OBJECT, "result", PROPERTY_HINT_RESOURCE_TYPE, "ScatterInstances")));
}

} // namespace thicket
