#pragma once

#include "core/base/mutex.hpp"
#include "core/placement/host_layer.hpp"
#include "core/state/instance_state.hpp"

#include <cstdint>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

namespace thicket {

/// A copy of a game's state. Several threads may read it concurrently.
class SharedState {
public:
	/// Takes the result of InstanceState::share.
	explicit SharedState(InstanceState state) : state_(std::move(state)) {}

	const InstanceState &state() const { return state_; }

	/// Prepares the state for InstanceState::added_in. Call this function before that one. After a
	/// success, later calls have no effect.
	Status complete() const;

private:
	mutable InstanceState state_; ///< Only `complete` changes it, and only data that no query except added_in() reads.
	mutable Mutex mutex_;
	mutable bool complete_ = false; ///< Guarded by `mutex_`.
};

/// The changes in a SharedState to the instances of one layer, for layers that grow on its models.
class HostState final : public HostChanges {
public:
	HostState(std::shared_ptr<const SharedState> state, std::uint16_t layer) :
			state_(std::move(state)), layer_(layer) {}

	bool removed(std::uint64_t id) const override { return state_->state().removed(id); }
	Status add_placed(const Rect &rect, std::vector<HostInstance> &r_instances) const override;
	double max_scale() const override { return state_->state().max_added_scale(layer_); }

private:
	std::shared_ptr<const SharedState> state_;
	std::uint16_t layer_;
};

} // namespace thicket
