#pragma once

#include "nodes/common/guard.hpp"
#include "nodes/gameplay/scatter_instances.hpp"

#include <godot_cpp/classes/ref.hpp>
#include <godot_cpp/classes/ref_counted.hpp>

#include <mutex>

namespace thicket {

/// A query whose tiles are made by workers. It completes in a later frame than it was made in, whatever happens: refused, canceled
/// or left behind by its node it completes with nothing found. All methods may be called on any thread.
class ScatterRequest : public godot::RefCounted {
	GDCLASS(ScatterRequest, godot::RefCounted)
	THICKET_GUARDED_METHODS(any)

public:
	bool is_completed() const;
	bool is_canceled() const;

	/// Nothing found until it is completed.
	godot::Ref<ScatterInstances> get_result() const;

	/// It will not be answered. False if it is completed already.
	bool cancel();

	// For nodes.

	/// Emits `completed(result)`. Does nothing the second time.
	void complete(const godot::Ref<ScatterInstances> &p_result);

	/// Completes without an answer, and tells when the scripts that run now are done.
	void give_up();

protected:
	static void _bind_methods();

private:
	bool finish(const godot::Ref<ScatterInstances> &p_result, bool p_canceled);
	void tell_later();
	void tell(const godot::Ref<ScatterRequest> &p_self);

	mutable std::mutex mutex_; ///< For all that follows.
	godot::Ref<ScatterInstances> result_;
	bool completed_ = false;
	bool canceled_ = false;
};

} // namespace thicket
