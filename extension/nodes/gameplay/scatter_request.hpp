#pragma once

#include "nodes/common/guard.hpp"
#include "nodes/gameplay/scatter_instances.hpp"

#include <godot_cpp/classes/ref.hpp>
#include <godot_cpp/classes/ref_counted.hpp>

#include <functional>
#include <utility>

namespace thicket {

/// A query whose tiles are made by workers. It completes in a later frame than it was made in, whatever happens: refused, canceled
/// or left behind by its node it completes with nothing found.
class ScatterRequest : public godot::RefCounted {
	GDCLASS(ScatterRequest, godot::RefCounted)
	THICKET_GUARDED_METHODS

public:
	bool is_completed() const { return completed_; }
	bool is_canceled() const { return canceled_; }

	/// Nothing found until it is completed.
	godot::Ref<ScatterInstances> get_result() const;

	/// It will not be answered. False if it is completed already.
	bool cancel();

	// For nodes.

	/// `withdraw` is called when it is canceled.
	void begin(std::function<void()> withdraw) { withdraw_ = std::move(withdraw); }

	/// Emits `completed(result)`. Does nothing the second time.
	void complete(const godot::Ref<ScatterInstances> &p_result);

	/// Completes without an answer, and tells when the scripts that run now are done.
	void give_up();

protected:
	static void _bind_methods();

private:
	void tell(const godot::Ref<ScatterRequest> &p_self);

	godot::Ref<ScatterInstances> result_;
	std::function<void()> withdraw_;
	bool completed_ = false;
	bool canceled_ = false;
};

} // namespace thicket
