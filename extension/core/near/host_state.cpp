#include "core/near/host_state.hpp"

#include "core/base/guard.hpp"

#include <cstddef>

namespace thicket {

Status SharedState::complete() const {
	const std::lock_guard lock(mutex_);
	const Status status = complete_ ? Status() : state_.complete();
	complete_ = complete_ || status.ok();
	return status;
}

Status HostState::add_placed(const Rect &rect, std::vector<HostInstance> &r_instances) const {
	const InstanceState &state = state_->state();
	if (state.added_count() == 0) {
		return {};
	}
	std::vector<std::uint64_t> ids;
	Status status = state_->complete();
	if (status.ok()) {
		status = state.added_in(layer_, rect, ids);
	}
	if (!status.ok()) {
		return status;
	}
	for (const std::uint64_t id : ids) {
		const AddedInstance &added = *state.added(id);
		r_instances.push_back({id, added.mesh, added.position, glm::dmat3(added.basis)});
	}
	return {};
}

} // namespace thicket
