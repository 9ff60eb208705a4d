// What a game changes about what a TerrainScatter3D shows, and who hears of it.

#include "nodes/gameplay/instance_answers.hpp"
#include "nodes/scatter/terrain_scatter_3d.hpp"

#include <godot_cpp/core/class_db.hpp>
#include <godot_cpp/core/memory.hpp>

#include <span>
#include <string>
#include <utility>
#include <vector>

using namespace godot;

namespace thicket {

namespace {

const char *signal_of(InstanceChangeKind kind) {
	switch (kind) {
		case InstanceChangeKind::removed: return "instance_removed";
		case InstanceChangeKind::restored: return "instance_restored";
		case InstanceChangeKind::added: return "instance_added";
		case InstanceChangeKind::data: return "instance_data_changed";
	}
	return "";
}

Rect area_of(const InstanceChange &change, const PointSet &set) {
	if (!is_added(change.id)) {
		return cell_rect(set, change.id);
	}
	const glm::dvec2 place{change.added.position.x, change.added.position.z};
	return {place, place};
}

/// What stands in one state and not in the one that takes its place loses its body at once. Null for no state.
void drop_changed(std::span<NearRing *const> rings, const InstanceState *before, const InstanceState *after) {
	const auto drop = [rings](std::uint64_t id) {
		for (NearRing *ring : rings) {
			ring->drop(id);
		}
	};
	for (const std::uint64_t id : after != nullptr ? after->removed_ids() : std::vector<std::uint64_t>()) {
		if (before == nullptr || !before->removed(id)) {
			drop(id);
		}
	}
	for (const std::uint64_t id : before != nullptr ? before->added_ids() : std::vector<std::uint64_t>()) {
		if (after == nullptr || after->added(id) == nullptr) {
			drop(id);
		}
	}
}

} // namespace

/// The place in the list of the layer that an id names; -1 for none.
std::int64_t TerrainScatter3D::place_of(std::uint64_t id) const {
	const std::span<const QueryLayer> layers = world_->layers();
	for (std::size_t place = 0; place < layers.size(); ++place) {
		if (layers[place].wanted && layers[place].set.layer == layer_of(id)) {
			return static_cast<std::int64_t>(place);
		}
	}
	return -1;
}

/// Refuses a state whose ids mean other points.
Status TerrainScatter3D::check_state(const ScatterState &state) const {
	for (std::size_t place = 0; place < world_->layers().size(); ++place) {
		const QueryLayer &layer = world_->layers()[place];
		const std::uint64_t stamp = state.state().stamp(layer.set.layer);
		if (layer.wanted && stamp != 0 && stamp != stamp_of(layer.set)) {
			return {ErrorCode::foreign, "state of layer", static_cast<double>(place)};
		}
	}
	return {};
}

void TerrainScatter3D::set_state(const Ref<ScatterState> &p_state) {
	if (p_state == state_) {
		return;
	}
	if (p_state.is_valid()) {
		if (const Status status = check_state(*p_state.ptr()); !status.ok()) {
			report("TerrainScatter3D", status);
			return;
		}
	}
	const Ref<ScatterState> before = state_;
	if (state_.is_valid()) {
		state_->remove_listener(&state_watch_);
	}
	state_ = p_state;
	if (state_.is_valid()) {
		state_->add_listener(&state_watch_);
	}
	claim_layers();
	const InstanceState *state = state_.is_valid() ? &state_->state() : nullptr;
	world_->set_state(state);
	stream_.display().set_state(state);
	stream_.display().mark_all();
	drop_changed(rings_, before.is_valid() ? &before->state() : nullptr, state);
	schedule_patch();
}

/// From now on the state takes in nothing that was made for other points.
void TerrainScatter3D::claim_layers() {
	for (std::uint32_t place = 0; state_.is_valid() && place < world_->layers().size(); ++place) {
		if (world_->layers()[place].wanted) {
			static_cast<void>(claim(place)); // What is refused is a problem of the node, and shown as such.
		}
	}
}

Status TerrainScatter3D::claim(std::uint32_t place) {
	if (state_.is_null()) {
		set_state(Ref<ScatterState>(memnew(ScatterState)));
	}
	const PointSet &set = world_->layers()[place].set;
	const Status status = state_->claim(set.layer, stamp_of(set));
	return status.ok() ? status : Status{ErrorCode::foreign, "state of layer", static_cast<double>(place)};
}

bool TerrainScatter3D::remove_instance(int64_t p_id) {
	const std::vector<PlacedInstance> found = find_by_id("remove_instance", p_id, false);
	return !found.empty() && remove_found(found.front());
}

bool TerrainScatter3D::remove_found(const PlacedInstance &instance) {
	if (const Status status = claim(instance.layer); !status.ok()) {
		report("TerrainScatter3D", status);
		return false;
	}
	const double regrowth = layer_list_.snapshots()[instance.layer]->gameplay.regrowth_time;
	return state_->remove(script_id(instance.id), regrowth > 0.0 ? state_->get_time() + regrowth : 0.0);
}

PackedInt64Array TerrainScatter3D::remove_in_sphere(
		const Vector3 &p_center, double p_radius, const PackedInt32Array &p_layers, const Callable &p_predicate) {
	std::vector<std::uint64_t> removed;
	for (const PlacedInstance &instance :
			find_in_sphere("remove_in_sphere", p_center, p_radius, p_layers, p_predicate)) {
		// Who hears of the one before may have changed the layers.
		if (instance.layer < layer_list_.snapshots().size() && remove_found(instance)) {
			removed.push_back(instance.id);
		}
	}
	return packed_ids(removed);
}

bool TerrainScatter3D::restore_instance(int64_t p_id) {
	if (state_.is_null() || !state_->is_removed(p_id)) {
		return false;
	}
	find_by_id("restore_instance", p_id, true); // Its tile is known then, for the signal.
	return state_->restore(p_id);
}

int64_t TerrainScatter3D::add_instance(int64_t p_layer, const Transform3D &p_transform, int64_t p_mesh) {
	if (!prepare_query("add_instance")) {
		return 0;
	}
	Status status;
	if (p_layer < 0 || p_layer >= static_cast<int64_t>(world_->layers().size()) ||
			!world_->layers()[static_cast<std::size_t>(p_layer)].wanted) {
		status = {ErrorCode::out_of_range, "layer", static_cast<double>(p_layer)};
	} else if (p_mesh < 0 || p_mesh >= static_cast<int64_t>(max_meshes)) {
		status = {ErrorCode::out_of_range, "mesh", static_cast<double>(p_mesh)};
	} else {
		status = claim(static_cast<std::uint32_t>(p_layer));
	}
	std::uint64_t id = 0;
	if (status.ok()) {
		AddedInstance added = to_added(p_transform, world_offset_);
		added.layer = world_->layers()[static_cast<std::size_t>(p_layer)].set.layer;
		added.mesh = static_cast<std::uint8_t>(p_mesh);
		status = state_->add(added, id);
	}
	report("TerrainScatter3D.add_instance", status);
	return status.ok() ? script_id(id) : 0;
}

bool TerrainScatter3D::set_instance_data(int64_t p_id, const Variant &p_data) {
	const std::vector<PlacedInstance> found = find_by_id("set_instance_data", p_id, true);
	if (found.empty()) {
		return false;
	}
	if (const Status status = claim(found.front().layer); !status.ok()) {
		report("TerrainScatter3D", status);
		return false;
	}
	return state_->set_instance_data(p_id, p_data);
}

Variant TerrainScatter3D::get_instance_data(int64_t p_id) const {
	return state_.is_valid() ? state_->get_instance_data(p_id) : Variant();
}

void TerrainScatter3D::state_changed(std::span<const InstanceChange> changes) {
	for (const InstanceChange &change : changes) {
		const std::int64_t place = place_of(change.id);
		if (place < 0) {
			continue;
		}
		const auto layer = static_cast<std::uint32_t>(place);
		if (running_ && change.kind != InstanceChangeKind::data) {
			stream_.display().mark(layer, area_of(change, world_->layers()[layer].set));
			for (NearRing *ring : rings_) {
				ring->drop(change.id);
			}
		}
	}
	world_->touch();
	schedule_patch();
	const std::vector<InstanceChange> told(changes.begin(), changes.end()); // Who hears of one may make others.
	for (const InstanceChange &change : told) {
		if (const std::int64_t place = place_of(change.id); place >= 0) {
			emit_change(change, static_cast<std::uint32_t>(place));
		}
	}
}

/// Only where it is known where the instance stands: a million removals that come at once make no tiles.
void TerrainScatter3D::emit_change(const InstanceChange &change, std::uint32_t place) {
	std::vector<PlacedInstance> found;
	if (is_added(change.id) && change.kind != InstanceChangeKind::data) {
		found.push_back(to_placed(change.added, change.id, place));
	} else if (const Status status = world_->ask_known(
					   [&](const InstanceQuery &query) { return query.by_id_even_removed(change.id, found); });
			   !status.ok()) {
		return;
	}
	if (!found.empty()) {
		emit_signal(signal_of(change.kind), script_id(change.id), static_cast<int64_t>(found.front().layer),
				to_engine(found.front(), world_offset_));
	}
}

/// The picture follows before the frame is drawn, once for all changes up to then.
void TerrainScatter3D::schedule_patch() {
	if (running_ && !std::exchange(patch_scheduled_, true)) {
		call_deferred("_patch");
	}
}

void TerrainScatter3D::patch_now() {
	patch_scheduled_ = false;
	stream_.display().patch();
}

void TerrainScatter3D::bind_changes() {
	using Self = TerrainScatter3D;
	ClassDB::bind_method(D_METHOD("set_state", "state"), &Self::set_state);
	ClassDB::bind_method(D_METHOD("get_state"), &Self::get_state);
	ClassDB::bind_method(D_METHOD("set_body_group", "group"), &Self::set_body_group);
	ClassDB::bind_method(D_METHOD("get_body_group"), &Self::get_body_group);
	ClassDB::bind_method(D_METHOD("remove_instance", "id"), &Self::remove_instance);
	ClassDB::bind_method(D_METHOD("restore_instance", "id"), &Self::restore_instance);
	ClassDB::bind_method(D_METHOD("remove_in_sphere", "center", "radius", "layers", "predicate"),
			&Self::remove_in_sphere, DEFVAL(PackedInt32Array()), DEFVAL(Callable()));
	ClassDB::bind_method(D_METHOD("add_instance", "layer", "transform", "mesh"), &Self::add_instance, DEFVAL(0));
	ClassDB::bind_method(D_METHOD("set_instance_data", "id", "data"), &Self::set_instance_data);
	ClassDB::bind_method(D_METHOD("get_instance_data", "id"), &Self::get_instance_data);
	ClassDB::bind_method(D_METHOD("_patch"), &Self::patch_now);
	ADD_GROUP("Gameplay", "");
	ADD_PROPERTY(PropertyInfo(Variant::OBJECT, "state", PROPERTY_HINT_RESOURCE_TYPE, "ScatterState"), "set_state",
			"get_state");
	ADD_PROPERTY(PropertyInfo(Variant::STRING_NAME, "body_group"), "set_body_group", "get_body_group");
	for (const char *name : {"instance_removed", "instance_restored", "instance_added", "instance_data_changed"}) {
		ADD_SIGNAL(MethodInfo(name, PropertyInfo(Variant::INT, "id"), PropertyInfo(Variant::INT, "layer"),
				PropertyInfo(Variant::TRANSFORM3D, "transform")));
	}
}

} // namespace thicket
