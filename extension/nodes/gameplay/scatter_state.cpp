#include "nodes/gameplay/scatter_state.hpp"

#include "core/base/check.hpp"
#include "nodes/common/convert.hpp"
#include "nodes/common/engine_arrays.hpp"
#include "nodes/gameplay/instance_answers.hpp"
#include "nodes/gameplay/state_refusal.hpp"

#include <godot_cpp/core/class_db.hpp>
#include <godot_cpp/core/error_macros.hpp>
#include <godot_cpp/core/memory.hpp>

#include <algorithm>
#include <string>
#include <utility>

using namespace godot;

namespace thicket {

namespace {

/// Encodes a value as bytes; null becomes no bytes. Returns false for an object and for a value of
/// more than `max_encoded_size` bytes.
bool encode(const Variant &p_value, PackedByteArray &r_bytes) {
	constexpr int64_t max_encoded_size = 1 << 24;
	r_bytes = PackedByteArray();
	if (p_value.get_type() == Variant::NIL) {
		return true;
	}
	if (p_value.get_type() == Variant::OBJECT) {
		return false;
	}
	for (int64_t capacity = 256; capacity <= max_encoded_size; capacity *= 16) {
		resize(r_bytes, capacity);
		const int64_t size = r_bytes.encode_var(0, p_value, false);
		if (size >= 0) {
			r_bytes = resized_copy(r_bytes, size);
			return true;
		}
	}
	return false;
}

} // namespace

bool ScatterState::remove(int64_t p_id, double p_until) {
	if (p_until != regrowth_of_layer &&
			report_outcome("remove", check_range("until", p_until, 0.0, max_state_time)) != OK) {
		return false;
	}
	const std::uint64_t id = core_id(p_id);
	if (const std::shared_ptr<StateListener> node = node_for(id)) {
		return node->remove_from(this, id, p_until);
	}
	const Removal removal{id, std::max(p_until, 0.0)};
	return p_id != 0 && !remove_all(std::span(&removal, 1)).empty();
}

std::vector<std::uint64_t> ScatterState::remove_all(std::span<const Removal> removals) {
	std::vector<InstanceChange> changes;
	std::vector<std::uint64_t> ids;
	// Reserve first: a later allocation failure would leave changes unreported.
	changes.reserve(removals.size());
	ids.reserve(removals.size());
	for (const auto &[id, until] : removals) {
		InstanceChange change{id, InstanceChangeKind::removed, {}};
		if (const AddedInstance *added = state_.added(id)) {
			change.added = *added;
		}
		const StateChange outcome = state_.remove(id, until);
		if (report_outcome("remove", outcome.status) != OK) {
			break; // The other removals would fail as well.
		}
		if (outcome) {
			changes.push_back(change);
			ids.push_back(id);
		}
	}
	notify(std::move(changes));
	return ids;
}

bool ScatterState::restore(int64_t p_id) {
	const std::uint64_t id = core_id(p_id);
	const std::shared_ptr<StateListener> node = node_for(id);
	return node != nullptr ? node->restore_in(this, id) : restore_by_id(id);
}

bool ScatterState::restore_by_id(std::uint64_t id) {
	const InstanceChange change{id, InstanceChangeKind::restored, {}};
	const StateChange outcome = state_.restore(id);
	report_outcome("restore", outcome.status);
	if (outcome) {
		notify({change});
	}
	return outcome.changed;
}

bool ScatterState::is_removed(int64_t p_id) const { return state_.removed(core_id(p_id)); }

Status ScatterState::add(const AddedInstance &instance, std::uint64_t &r_id) {
	const Status status = state_.add(instance, r_id);
	if (status.ok()) {
		const InstanceChange change{r_id, InstanceChangeKind::added, *state_.added(r_id)};
		notify({change});
	}
	return status;
}

Status ScatterState::add_all(std::span<const AddedInstance> instances, std::vector<std::uint64_t> &r_ids) {
	std::vector<InstanceChange> changes;
	const Status status = state_.add_all(instances, r_ids, changes);
	notify(std::move(changes));
	return status;
}

Status ScatterState::move(std::uint64_t id, const AddedInstance &instance, std::uint64_t &r_id) {
	std::vector<InstanceChange> changes;
	const Status status = state_.move(id, instance, r_id, changes);
	notify(std::move(changes));
	return status;
}

bool ScatterState::set_instance_data(int64_t p_id, const Variant &p_data) {
	const std::uint64_t id = core_id(p_id);
	const std::shared_ptr<StateListener> node = node_for(id);
	return node != nullptr ? node->set_data_in(this, id, p_data) : set_data_by_id(id, p_data);
}

bool ScatterState::set_data_by_id(std::uint64_t id, const Variant &p_data) {
	PackedByteArray bytes;
	const std::uint64_t revision = state_.revision();
	Status status{ErrorCode::corrupt, "data", 0.0, {}, {}, "Use values that var_to_bytes() can encode, not objects"};
	if (id == 0) {
		status = Status::missing("id", "Pass the id of an instance, which is never 0");
	} else if (encode(p_data, bytes)) {
		status = state_.set_data(id, span_of(bytes));
	}
	if (report_outcome("set_instance_data", status) != OK) {
		return false;
	}
	if (state_.revision() == revision) {
		return true;
	}
	InstanceChange change{id, InstanceChangeKind::data, {}};
	if (const AddedInstance *added = state_.added(id)) {
		change.added = *added;
	}
	notify({change});
	return true;
}

Variant ScatterState::get_instance_data(int64_t p_id) const { return decoded(state_.data(core_id(p_id))); }

bool ScatterState::find_layer_ids(const char *p_method, const Variant &p_layers, std::vector<int> &r_ids) const {
	// Names refer to these layers. The passed layers are appended; index -1 is a single layer that
	// is not in a list.
	TypedArray<ScatterLayer> candidates = layers_of_nodes();
	const bool is_list = p_layers.get_type() == Variant::ARRAY;
	const Array passed_layers = is_list ? static_cast<Array>(p_layers) : Array();
	for (int64_t index = is_list ? 0 : -1; index < passed_layers.size(); ++index) {
		if (const Ref<ScatterLayer> layer = index < 0 ? p_layers : passed_layers[index]; layer.is_valid()) {
			append(candidates, layer);
		}
	}
	std::vector<std::uint32_t> indices;
	String problem = find_layers(candidates, p_layers, indices);
	for (std::size_t i = 0; problem.is_empty() && i < indices.size(); ++i) {
		const Ref<ScatterLayer> layer = candidates[indices[i]];
		r_ids.push_back(static_cast<int>(layer->own_id()));
		if (r_ids.back() < 0) {
			problem = "A ScatterLayer without a layer_id has no instances: add it to a node, or set its layer_id.";
		}
	}
	if (!problem.is_empty()) {
		ERR_PRINT(String("ScatterState.") + String(p_method) + String(": ") + problem);
	}
	std::ranges::sort(r_ids);
	r_ids.erase(std::unique(r_ids.begin(), r_ids.end()), r_ids.end());
	return problem.is_empty();
}

Ref<ScatterLayer> ScatterState::layer_with_id(std::uint16_t layer_id) const {
	const TypedArray<ScatterLayer> layers = layers_of_nodes();
	for (int64_t index = 0; index < layers.size(); ++index) {
		if (const Ref<ScatterLayer> layer = layers[index]; layer.is_valid() && layer->own_id() == layer_id) {
			return layer;
		}
	}
	return {};
}

TypedArray<ScatterLayer> ScatterState::layers_of_nodes() const {
	TypedArray<ScatterLayer> result;
	for (const std::shared_ptr<StateListener> &node : listeners()) {
		const SharedLayers layers = node->layers();
		for (std::size_t index = 0; index < static_cast<std::size_t>(layers->size()); ++index) {
			append(result, layers->at(index));
		}
	}
	return result;
}

std::shared_ptr<StateListener> ScatterState::node_for(std::uint64_t id) const {
	for (const std::shared_ptr<StateListener> &node : listeners()) {
		if (node->displays(id)) {
			return node;
		}
	}
	return nullptr;
}

PackedInt64Array ScatterState::ids_of(const char *p_method, const Variant &p_layers,
		std::vector<std::uint64_t> (InstanceState::*list_ids)(int) const) const {
	std::vector<int> layer_ids;
	if (!find_layer_ids(p_method, p_layers, layer_ids)) {
		return {};
	}
	if (layer_ids.empty()) {
		return packed_ids((state_.*list_ids)(-1));
	}
	std::vector<std::uint64_t> result;
	for (const int layer_id : layer_ids) {
		const std::vector<std::uint64_t> instance_ids = (state_.*list_ids)(layer_id);
		result.insert(result.end(), instance_ids.begin(), instance_ids.end());
	}
	return packed_ids(result);
}

PackedInt64Array ScatterState::get_removed(const Variant &p_layers) const {
	return ids_of("get_removed", p_layers, &InstanceState::removed_ids);
}

PackedInt64Array ScatterState::get_added(const Variant &p_layers) const {
	return ids_of("get_added", p_layers, &InstanceState::added_ids);
}

int64_t ScatterState::get_removed_count() const { return static_cast<int64_t>(state_.removed_count()); }

int64_t ScatterState::get_added_count() const { return static_cast<int64_t>(state_.added_count()); }

PackedByteArray ScatterState::to_bytes() const {
	std::vector<std::uint8_t> bytes;
	report_outcome("to_bytes", state_.save(bytes));
	return packed_bytes(bytes);
}

Error ScatterState::from_bytes(const PackedByteArray &p_bytes) {
	wait_for_diffs();
	std::vector<InstanceChange> changes;
	const Error error = report_outcome("from_bytes", state_.load(span_of(p_bytes), changes));
	notify(std::move(changes));
	return error;
}

PackedByteArray ScatterState::diff_since(int64_t p_revision, bool p_ordered) const {
	std::vector<std::uint8_t> bytes;
	const auto revision = static_cast<std::uint64_t>(std::max<int64_t>(p_revision, 0));
	report_outcome("diff_since", state_.diff_since(revision, bytes, p_ordered));
	return packed_bytes(bytes);
}

PackedByteArray ScatterState::diff_of(const PackedInt64Array &p_ids) const {
	std::vector<std::uint64_t> ids;
	for (int64_t index = 0; index < p_ids.size(); ++index) {
		ids.push_back(core_id(p_ids[index]));
	}
	std::vector<std::uint8_t> bytes;
	report_outcome("diff_of", state_.diff_of(ids, bytes));
	return packed_bytes(bytes);
}

Error ScatterState::apply_diff(const PackedByteArray &p_diff) {
	wait_for_diffs();
	std::vector<InstanceChange> changes;
	const Error error = report_outcome("apply_diff", state_.apply(span_of(p_diff), changes, limits()));
	notify(std::move(changes));
	return error;
}

Error ScatterState::merge(const Ref<ScatterState> &p_other) {
	if (p_other.is_null()) {
		return report_outcome("merge", Status::missing("other", "Pass a ScatterState"));
	}
	wait_for_diffs();
	std::vector<InstanceChange> changes;
	const Error error = report_outcome("merge", state_.merge(p_other->state_, changes));
	notify(std::move(changes));
	return error;
}

void ScatterState::clear() {
	wait_for_diffs();
	std::vector<InstanceChange> changes;
	report_outcome("clear", state_.clear(changes));
	notify(std::move(changes));
}

int64_t ScatterState::get_revision() const { return static_cast<int64_t>(state_.revision()); }

int64_t ScatterState::get_digest() const { return static_cast<int64_t>(state_.digest()); }

double ScatterState::get_time() const { return state_.time(); }

void ScatterState::advance(double p_seconds) {
	std::vector<InstanceChange> changes;
	report_outcome("advance", state_.advance(p_seconds, changes));
	notify(std::move(changes));
}

void ScatterState::advance_in_frame(double seconds, std::uint64_t frame) {
	if (std::exchange(frame_, frame) != frame) {
		advance(seconds);
	}
}

void ScatterState::set_data(const PackedByteArray &p_bytes) {
	if (p_bytes.is_empty()) {
		clear();
	} else {
		from_bytes(p_bytes);
	}
}

PackedByteArray ScatterState::get_data() const {
	const bool is_blank =
			state_.removed_count() + state_.added_count() + state_.data_count() == 0 && state_.time() == 0.0;
	return is_blank ? PackedByteArray() : to_bytes();
}

Ref<ScatterState> ScatterState::copy() const {
	const Ref<ScatterState> result(memnew(ScatterState));
	result->set_data(get_data());
	result->diff_limits_ = diff_limits_;
	return result;
}

void ScatterState::_bind_methods() {
	using Self = ScatterState;
	bind_guarded<&Self::remove>(D_METHOD("remove", "id", "until"), DEFVAL(regrowth_of_layer));
	bind_guarded<&Self::restore>(D_METHOD("restore", "id"));
	bind_guarded<&Self::is_removed>(D_METHOD("is_removed", "id"));
	bind_guarded<&Self::set_instance_data>(D_METHOD("set_instance_data", "id", "data"));
	bind_guarded<&Self::get_instance_data>(D_METHOD("get_instance_data", "id"));
	bind_guarded<&Self::get_removed>(D_METHOD("get_removed", "layers"), DEFVAL(Array()));
	bind_guarded<&Self::get_added>(D_METHOD("get_added", "layers"), DEFVAL(Array()));
	bind_guarded<&Self::get_removed_count>(D_METHOD("get_removed_count"));
	bind_guarded<&Self::get_added_count>(D_METHOD("get_added_count"));
	bind_guarded<&Self::from_bytes>(D_METHOD("from_bytes", "bytes"));
	bind_guarded<&Self::to_bytes>(D_METHOD("to_bytes"));
	bind_guarded<&Self::save_to_file>(D_METHOD("save_to_file", "path"));
	bind_guarded<&Self::load_from_file>(D_METHOD("load_from_file", "path"));
	bind_guarded<&Self::diff_since>(D_METHOD("diff_since", "revision", "ordered"), DEFVAL(true));
	bind_guarded<&Self::diff_of>(D_METHOD("diff_of", "ids"));
	bind_guarded<&Self::apply_diff>(D_METHOD("apply_diff", "diff"));
	bind_guarded<&Self::apply_diff_async>(
			ThreadUse::main, D_METHOD("apply_diff_async", "diff", "callback"), DEFVAL(Callable()));
	bind_guarded<&Self::finish_diffs>(ThreadUse::relayed, D_METHOD("_finish_diffs"));
	bind_guarded<&Self::merge>(D_METHOD("merge", "other"));
	bind_guarded<&Self::merge_diff>(D_METHOD("merge_diff", "diff"));
	bind_guarded<&Self::inspect_diff>(D_METHOD("inspect_diff", "diff"));
	bind_guarded<&Self::get_origin>(D_METHOD("get_origin"));
	bind_guarded<&Self::get_known_revision>(D_METHOD("get_known_revision", "origin"));
	bind_guarded<&Self::get_missing_since>(D_METHOD("get_missing_since", "diff"));
	bind_guarded<&Self::set_diff_limits>(D_METHOD("set_diff_limits", "limits"));
	bind_guarded<&Self::get_diff_limits>(D_METHOD("get_diff_limits"));
	bind_guarded<&Self::clear>(D_METHOD("clear"));
	bind_guarded<&Self::get_revision>(D_METHOD("get_revision"));
	bind_guarded<&Self::get_digest>(D_METHOD("get_digest"));
	bind_guarded<&Self::get_time>(D_METHOD("get_time"));
	bind_guarded<&Self::advance>(D_METHOD("advance", "seconds"));
	bind_guarded<&Self::set_copy_at_runtime>(D_METHOD("set_copy_at_runtime", "copy_at_runtime"));
	bind_guarded<&Self::is_copied_at_runtime>(D_METHOD("is_copied_at_runtime"));
	bind_guarded<&Self::set_data>(D_METHOD("set_data", "bytes"));
	bind_guarded<&Self::get_data>(D_METHOD("get_data"));
	ADD_PROPERTY(PropertyInfo(Variant::PACKED_BYTE_ARRAY, "data", PROPERTY_HINT_NONE, "", PROPERTY_USAGE_STORAGE),
			"set_data", "get_data");
	ADD_PROPERTY(PropertyInfo(Variant::BOOL, "copy_at_runtime"), "set_copy_at_runtime", "is_copied_at_runtime");
	ADD_PROPERTY(
			PropertyInfo(Variant::OBJECT, "diff_limits", PROPERTY_HINT_RESOURCE_TYPE, ScatterDiffLimits::class_name),
			"set_diff_limits", "get_diff_limits");
	ADD_SIGNAL(MethodInfo("instances_changed", PropertyInfo(Variant::PACKED_INT64_ARRAY, "ids")));
}

} // namespace thicket
