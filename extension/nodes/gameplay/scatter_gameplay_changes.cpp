// This file contains the methods of ScatterGameplay that change instances and emit the signals of
// these changes.

#include "nodes/common/editor.hpp"
#include "nodes/gameplay/scatter_gameplay.hpp"

#include "nodes/common/property_check.hpp"
#include "nodes/gameplay/instance_answers.hpp"
#include "nodes/gameplay/script_queries.hpp"

#include <godot_cpp/core/error_macros.hpp>
#include <godot_cpp/core/memory.hpp>

#include <map>
#include <utility>

using namespace godot;

namespace thicket {

namespace {

/// The number of signals that are emitted before the time is checked again.
constexpr std::size_t signals_per_time_check = 16;

/// Sets a variable and restores its previous value at the end of the scope, even after an
/// exception.
template <typename T>
class ScopedValue {
public:
	ScopedValue(T &r_variable, T value) : variable_(r_variable), previous_value_(std::exchange(r_variable, value)) {}
	~ScopedValue() { variable_ = previous_value_; }
	ScopedValue(const ScopedValue &) = delete;
	ScopedValue &operator=(const ScopedValue &) = delete;

private:
	T &variable_;
	T previous_value_;
};

std::size_t size_of(const Ref<ScatterState> &p_state) {
	return p_state.is_valid() ? p_state->state().removed_count() + p_state->state().added_count() : 0;
}

} // namespace

/// Returns the index of the layer that an ID belongs to; -1 if there is none.
std::int64_t ScatterGameplay::layer_index_of(std::uint64_t id) const {
	const std::span<const QueryLayer> layers = world_.layers();
	for (std::size_t index = 0; index < layers.size(); ++index) {
		if (layers[index].wanted && layers[index].set.layer == layer_of(id)) {
			return static_cast<std::int64_t>(index);
		}
	}
	return -1;
}

Status ScatterGameplay::check_state(const ScatterState &state) const {
	for (std::size_t index = 0; index < world_.layers().size(); ++index) {
		const QueryLayer &layer = world_.layers()[index];
		if (layer.wanted && state.state().is_foreign(layer.set.layer, stamp_of(layer.set))) {
			return {ErrorCode::foreign, "state of layer", static_cast<double>(index)};
		}
	}
	return {};
}

void ScatterGameplay::set_state(const Ref<ScatterState> &p_state) {
	if (!alive()) {
		return;
	}
	if (p_state == state_) {
		// Already applied.
		return;
	}
	if (p_state.is_valid()) {
		if (const Status status = check_state(*p_state.ptr()); !status.ok()) {
			report("TerrainScatter3D", status);
			return;
		}
	}
	const bool is_game = !in_editor();
	const bool use_copy = p_state.is_valid() && p_state->is_copied_at_runtime() && is_game;
	if (p_state.is_valid() && is_game && !use_copy) {
		p_state->warn_if_cached();
	}
	const Ref<ScatterState> previous = std::exchange(state_, use_copy ? p_state->copy() : p_state);
	if (previous.is_valid()) {
		previous->remove_listener(this);
	}
	if (state_.is_valid()) {
		state_->add_listener(shared_from_this());
	}
	for (const UnreportedChanges &unreported : backlog_) {
		host_->free_on_worker(unreported.changes);
	}
	backlog_.clear();
	claim_layers();
	const InstanceState *state = state_.is_valid() ? &state_->state() : nullptr;
	world_.set_state(state);
	host_->set_overlay(state);
	const std::size_t change_count = size_of(previous) + size_of(state_);
	if (running_ && change_count > max_per_call) {
		host_->redraw_all_later(); // Bodies and scenes are also updated step by step.
	} else if (running_ && change_count > 0) {
		for (NearRing *ring : rings_) {
			ring->drop_if([this](std::uint64_t id) { return is_no_longer_placed(id); });
		}
		host_->redraw_all();
	}
}

/// Binds the state to the point sets of all layers. The state then rejects changes that were made
/// for other point sets.
void ScatterGameplay::claim_layers() {
	for (std::uint32_t layer = 0; state_.is_valid() && layer < world_.layers().size(); ++layer) {
		if (world_.layers()[layer].wanted) {
			static_cast<void>(claim(layer)); // An error is displayed as a problem of the node.
		}
	}
}

/// Binds the state to a layer's point set. Creates a state if there is none yet. Returns an error
/// if the state already belongs to another point set.
Status ScatterGameplay::claim(std::uint32_t layer) {
	if (state_.is_null()) {
		set_state(Ref<ScatterState>(memnew(ScatterState)));
	}
	const PointSet &set = world_.layers()[layer].set;
	const double cell_side = set.in_rows ? 0.0 : id_cell_side(set); // Rows have no cells.
	const Status status = state_->claim(set.layer, stamp_of(set), cell_side, set.on_surface ? surface_id_steps : 1);
	return status.ok() ? status : Status{ErrorCode::foreign, "state of layer", static_cast<double>(layer)};
}

bool ScatterGameplay::remove_instance(int64_t p_id) {
	return !remove_all(find_by_id("remove_instance", p_id, false)).empty();
}

PackedInt64Array ScatterGameplay::remove_in_sphere(
		const Vector3 &p_center, double p_radius, const Variant &p_layers, const Callable &p_predicate) {
	std::vector<PlacedInstance> matches;
	find_in_sphere(*this, {"remove_in_sphere", p_layers, p_predicate}, p_center, p_radius).instances.read_all(matches);
	return packed_ids(remove_all(matches));
}

/// Removes instances and returns the IDs of those that existed. The scripts that ran during the
/// search may have changed the layers, so each layer is checked again.
std::vector<std::uint64_t> ScatterGameplay::remove_all(std::span<const PlacedInstance> instances, double until) {
	std::vector<Removal> removals;
	std::int64_t rejected_index = -1;
	for (const PlacedInstance &instance : instances) {
		const std::int64_t index = layer_index_of(instance.id);
		const bool is_listed = index >= 0 && static_cast<std::size_t>(index) < layers_.size();
		if (!is_listed || index == rejected_index || !alive()) {
			continue;
		}
		if (const Status status = claim(static_cast<std::uint32_t>(index)); !status.ok()) {
			report("TerrainScatter3D", status);
			rejected_index = index;
			continue;
		}
		const double regrowth = layers_[static_cast<std::size_t>(index)]->gameplay.regrowth_time;
		const double layer_until = regrowth > 0.0 ? state_->get_time() + regrowth : 0.0;
		removals.push_back({instance.id, until == regrowth_of_layer ? layer_until : until});
	}
	if (removals.empty()) {
		return {};
	}
	const Ref<ScatterState> state = state_;
	const ScopedValue changing(changing_instances_, instances);
	return state->remove_all(removals);
}

bool ScatterGameplay::displays(std::uint64_t id) const {
	const std::int64_t index = running_ ? layer_index_of(id) : -1;
	return index >= 0 && static_cast<std::size_t>(index) < layers_.size();
}

bool ScatterGameplay::remove_from(const ScatterState *state, std::uint64_t id, double until) {
	const bool is_removed = state->is_removed(script_id(id));
	if (is_removed && until == regrowth_of_layer) {
		return false;
	}
	const std::vector<PlacedInstance> matches = find_by_id("remove_instance", script_id(id), is_removed);
	return state_.ptr() == state && !remove_all(matches, until).empty();
}

bool ScatterGameplay::restore_instance(int64_t p_id) {
	const Ref<ScatterState> state = state_;
	return state.is_valid() && restore_in(state.ptr(), core_id(p_id));
}

bool ScatterGameplay::restore_in(const ScatterState *state, std::uint64_t id) {
	if (!state->is_removed(script_id(id))) {
		return false;
	}
	const std::vector<PlacedInstance> matches = find_by_id("restore_instance", script_id(id), true);
	const Ref<ScatterState> keep_alive = state_;
	const ScopedValue changing(changing_instances_, std::span(matches));
	return keep_alive.is_valid() && keep_alive.ptr() == state && keep_alive->restore_by_id(id);
}

int64_t ScatterGameplay::set_instance_transform(int64_t p_id, const Transform3D &p_transform) {
	const std::vector<PlacedInstance> matches = find_by_id("set_instance_transform", p_id, false);
	const std::int64_t layer = matches.empty() || !alive() ? -1 : layer_index_of(core_id(p_id));
	if (layer < 0) {
		return 0;
	}
	Status status = claim(static_cast<std::uint32_t>(layer));
	std::uint64_t id = 0;
	if (status.ok()) {
		AddedInstance placement = to_added(p_transform, world_frame());
		placement.layer = layer_of(core_id(p_id));
		placement.mesh = static_cast<std::uint8_t>(matches.front().mesh);
		const Ref<ScatterState> state = state_;
		status = state->move(core_id(p_id), placement, id);
	}
	report("TerrainScatter3D.set_instance_transform", status);
	return status.ok() ? script_id(id) : 0;
}

bool ScatterGameplay::set_instance_data(int64_t p_id, const Variant &p_data) {
	return set_data(core_id(p_id), !find_by_id("set_instance_data", p_id, true).empty(), p_data);
}

bool ScatterGameplay::set_data_in(const ScatterState *state, std::uint64_t id, const Variant &p_data) {
	const bool exists = !find_by_id("set_instance_data", script_id(id), true).empty();
	return state_.ptr() == state && set_data(id, exists, p_data);
}

/// Stores the data of an instance. Returns false if the instance does not exist.
bool ScatterGameplay::set_data(std::uint64_t id, bool exists, const Variant &p_data) {
	const std::int64_t layer = exists && alive() ? layer_index_of(id) : -1;
	if (layer < 0) {
		return false;
	}
	if (const Status status = claim(static_cast<std::uint32_t>(layer)); !status.ok()) {
		report("TerrainScatter3D", status);
		return false;
	}
	const Ref<ScatterState> state = state_;
	return state->set_data_by_id(id, p_data);
}

Variant ScatterGameplay::get_instance_data(int64_t p_id) const {
	return state_.is_valid() ? state_->get_instance_data(p_id) : Variant();
}

bool ScatterGameplay::is_no_longer_placed(std::uint64_t id) const {
	const InstanceState *state = world_.state();
	return is_added(id) ? state == nullptr || state->added(id) == nullptr : state != nullptr && state->removed(id);
}

void ScatterGameplay::state_changed(const SharedChanges &changes) {
	world_.touch();
	if (!running_) {
		return;
	}
	if (changes->size() > max_per_call) {
		redraw_later(*changes); // Bodies and scenes are also updated step by step.
		return;
	}
	std::size_t dropped_count = 0;
	changes->for_each([this, &dropped_count](const InstanceChange &change) {
		const std::int64_t index = layer_index_of(change.id);
		if (index >= 0 && change.kind != InstanceChangeKind::data) {
			const auto layer = static_cast<std::uint32_t>(index);
			host_->redraw(layer, area_of(change.id, change.added.position, layer));
			if (++dropped_count > max_dropped_at_once) {
				return; // The remaining bodies and scenes are removed step by step, nearest first.
			}
			for (NearRing *ring : rings_) {
				ring->drop(change.id);
			}
		}
	});
}

/// Redraws all tiles that may contain the changes, over the next frames.
void ScatterGameplay::redraw_later(const StateChanges &changes) {
	if (changes.size() > max_per_call * 16) {
		// Finding the areas of this many changes takes longer than checking all tiles.
		host_->redraw_all_later();
		return;
	}
	std::map<std::uint32_t, Rect> bounds;
	changes.for_each([&](const InstanceChange &change) {
		const std::int64_t index = layer_index_of(change.id);
		if (index >= 0 && change.kind != InstanceChangeKind::data) {
			const auto layer = static_cast<std::uint32_t>(index);
			const Rect area = area_of(change.id, change.added.position, layer);
			Rect &bound = bounds.try_emplace(layer, area).first->second;
			bound = united(bound, area);
		}
	});
	for (const auto &[layer, bound] : bounds) {
		host_->redraw_later(layer, bound);
	}
}

void ScatterGameplay::notify_changes(const SharedChanges &changes) {
	if (running_ && changes->size() > max_per_call) {
		backlog_.push_back({changes, 0});
		return;
	}
	const Ref<ScatterState> state = state_;
	for (std::size_t i = 0; i < changes->size(); ++i) {
		if (!alive() || !(state_ == state)) {
			return; // A signal handler has freed the node or set another state.
		}
		if (const InstanceChange *change = changes->at(i)) {
			notify(*change);
		}
	}
}

/// Returns false for a change that was undone or replaced by a later change that has been reported.
bool ScatterGameplay::still_applies(const InstanceChange &change) const {
	switch (change.kind) {
		case InstanceChangeKind::removed: return is_no_longer_placed(change.id);
		case InstanceChangeKind::restored:
		case InstanceChangeKind::added:
		case InstanceChangeKind::moved: return !is_no_longer_placed(change.id);
		case InstanceChangeKind::left: return false;
		case InstanceChangeKind::data: return true;
	}
	return false;
}

void ScatterGameplay::emit_backlog(std::chrono::steady_clock::time_point deadline) {
	for (std::size_t reported_count = 1; alive() && running_ && !backlog_.empty(); ++reported_count) {
		const SharedChanges changes = backlog_.front().changes;
		const InstanceChange *change = changes->at(backlog_.front().reported_count++);
		if (backlog_.front().reported_count == changes->size()) {
			host_->free_on_worker(backlog_.front().changes);
			backlog_.pop_front();
		}
		if (change != nullptr && still_applies(*change)) {
			notify(*change);
		}
		if (reported_count % signals_per_time_check == 0 && std::chrono::steady_clock::now() >= deadline) {
			return;
		}
	}
}

/// Returns the position and transform of an instance that this node is currently removing or
/// restoring; null for any other instance. Changes are reported in the order of
/// `changing_instances_`, so this function also discards the entries before the instance.
const PlacedInstance *ScatterGameplay::find_changing(std::uint64_t id) {
	while (!changing_instances_.empty() && changing_instances_.front().id != id) {
		changing_instances_ = changing_instances_.subspan(1);
	}
	return changing_instances_.empty() ? nullptr : &changing_instances_.front();
}

const StringName &ScatterGameplay::Signals::of(InstanceChangeKind kind) const {
	switch (kind) {
		case InstanceChangeKind::removed: return removed;
		case InstanceChangeKind::restored: return restored;
		case InstanceChangeKind::added: return added;
		case InstanceChangeKind::left: break;
		case InstanceChangeKind::moved: return moved;
		case InstanceChangeKind::data: return data;
	}
	return none;
}

/// Emits the signal of a change if the placement of the instance is known. Otherwise emits nothing:
/// generating tiles for changes from peers would take too long. Runs scripts.
void ScatterGameplay::notify(const InstanceChange &change) {
	const std::int64_t index = change.kind != InstanceChangeKind::left ? layer_index_of(change.id) : -1;
	if (index < 0) {
		return;
	}
	Transform3D transform;
	if (is_added(change.id) && change.kind != InstanceChangeKind::data) {
		transform = to_engine(change.added.basis, change.added.position, world_frame());
	} else if (const PlacedInstance *changing = find_changing(change.id)) {
		// The instance was found before the change.
		transform = to_engine(*changing, world_frame());
	} else {
		std::vector<PlacedInstance> matches;
		const Status status = world_.query_known(
				[&](const InstanceQuery &query) { return query.by_id_even_removed(change.id, matches); });
		if (!status.ok() || matches.empty()) {
			return;
		}
		transform = to_engine(matches.front(), world_frame());
	}
	host_->node()->emit_signal(signals_.of(change.kind), script_id(change.id),
			listed_layers_->at(static_cast<std::size_t>(index)), transform);
}

} // namespace thicket
