#include "nodes/gameplay/scatter_request.hpp"

#include <godot_cpp/core/class_db.hpp>
#include <godot_cpp/core/memory.hpp>

#include <utility>

using namespace godot;

namespace thicket {

Ref<ScatterInstances> ScatterRequest::get_result() const {
	return result_.is_valid() ? result_ : Ref<ScatterInstances>(memnew(ScatterInstances));
}

bool ScatterRequest::cancel() {
	if (completed_) {
		return false;
	}
	canceled_ = true;
	if (const auto withdraw = std::exchange(withdraw_, {})) {
		withdraw();
	}
	give_up();
	return true;
}

void ScatterRequest::complete(const Ref<ScatterInstances> &p_result) {
	if (std::exchange(completed_, true)) {
		return;
	}
	withdraw_ = {};
	result_ = p_result;
	tell(this);
}

void ScatterRequest::give_up() {
	if (!std::exchange(completed_, true)) {
		withdraw_ = {};
		call_deferred("_tell", Ref<ScatterRequest>(this)); // Held by the call: whoever awaits the signal holds nothing.
	}
}

void ScatterRequest::tell(const Ref<ScatterRequest> &) { emit_signal("completed", get_result()); }

void ScatterRequest::_bind_methods() {
	using Self = ScatterRequest;
	bind_guarded<&Self::is_completed>(D_METHOD("is_completed"));
	bind_guarded<&Self::is_canceled>(D_METHOD("is_canceled"));
	bind_guarded<&Self::get_result>(D_METHOD("get_result"));
	bind_guarded<&Self::cancel>(D_METHOD("cancel"));
	bind_guarded<&Self::tell>(D_METHOD("_tell", "request"));
	ADD_SIGNAL(MethodInfo(
			"completed", PropertyInfo(Variant::OBJECT, "result", PROPERTY_HINT_RESOURCE_TYPE, "ScatterInstances")));
}

} // namespace thicket
