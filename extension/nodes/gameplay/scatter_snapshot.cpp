#include "nodes/gameplay/scatter_snapshot.hpp"

#include "nodes/common/property_check.hpp"
#include "nodes/gameplay/script_queries.hpp"

#include <godot_cpp/core/class_db.hpp>
#include <godot_cpp/core/memory.hpp>

#include <string>
#include <utility>
#include <vector>

using namespace godot;

namespace thicket {

Ref<ScatterSnapshot> ScatterSnapshot::of(
		std::shared_ptr<const InstanceSnapshot> snapshot, SharedLayers layers, const WorldFrame &frame) {
	const Ref<ScatterSnapshot> result(memnew(ScatterSnapshot));
	result->snapshot_ = std::move(snapshot);
	result->layers_ = std::move(layers);
	result->frame_ = frame;
	return result;
}

SharedLayers ScatterSnapshot::prepare(const char *p_method) const {
	if (snapshot_ == nullptr) {
		report(name_of(p_method).c_str(),
				Status::missing("world", "Create the snapshot from a node that has a ground and layers"));
	}
	return layers_;
}

bool ScatterSnapshot::answer(const char *p_method, const PreparedQuery &query) const {
	// Hold the snapshot, because a predicate may release this object.
	const std::shared_ptr<const InstanceSnapshot> current = snapshot_;
	const Status status = current->answer(query);
	report(name_of(p_method).c_str(), status);
	return status.ok();
}

Ref<ScatterInstances> ScatterSnapshot::query_rect(
		const Rect2 &p_rect, const Variant &p_layers, const Callable &p_predicate) const {
	return answer_rect(*this, {"query_rect", p_layers, p_predicate}, p_rect);
}

Ref<ScatterInstances> ScatterSnapshot::query_sphere(
		const Vector3 &p_center, double p_radius, const Variant &p_layers, const Callable &p_predicate) const {
	return answer_sphere(*this, {"query_sphere", p_layers, p_predicate}, p_center, p_radius);
}

Ref<ScatterInstance> ScatterSnapshot::query_ray(
		const Vector3 &p_from, const Vector3 &p_to, const Variant &p_layers, const Callable &p_predicate) const {
	return answer_ray(*this, {"query_ray", p_layers, p_predicate}, p_from, p_to);
}

Ref<ScatterInstance> ScatterSnapshot::query_nearest(
		const Vector3 &p_position, double p_max_distance, const Variant &p_layers, const Callable &p_predicate) const {
	// A predicate may release this object.
	const Ref<ScatterSnapshot> self(const_cast<ScatterSnapshot *>(this));
	return answer_nearest(*this, {"query_nearest", p_layers, p_predicate}, p_position, p_max_distance);
}

Ref<ScatterInstance> ScatterSnapshot::get_instance(int64_t p_id) const {
	return answer_id(*this, "get_instance", p_id);
}

bool ScatterSnapshot::has_instance(int64_t p_id) const {
	std::vector<PlacedInstance> matches;
	return prepare("has_instance") != nullptr &&
			answer("has_instance", [&](const InstanceQuery &query) { return query.by_id(core_id(p_id), matches); }) &&
			!matches.empty();
}

Variant ScatterSnapshot::get_instance_data(int64_t p_id) const {
	const InstanceState *state = snapshot_ != nullptr ? snapshot_->state() : nullptr;
	return state != nullptr ? decoded(state->data(core_id(p_id))) : Variant();
}

void ScatterSnapshot::_bind_methods() {
	using Self = ScatterSnapshot;
	bind_guarded<&Self::query_rect>(
			D_METHOD("query_rect", "rect", "layers", "predicate"), DEFVAL(Array()), DEFVAL(Callable()));
	bind_guarded<&Self::query_sphere>(
			D_METHOD("query_sphere", "center", "radius", "layers", "predicate"), DEFVAL(Array()), DEFVAL(Callable()));
	bind_guarded<&Self::query_ray>(
			D_METHOD("query_ray", "from", "to", "layers", "predicate"), DEFVAL(Array()), DEFVAL(Callable()));
	bind_guarded<&Self::query_nearest>(D_METHOD("query_nearest", "position", "max_distance", "layers", "predicate"),
			DEFVAL(Array()), DEFVAL(Callable()));
	bind_guarded<&Self::get_instance>(D_METHOD("get_instance", "id"));
	bind_guarded<&Self::has_instance>(D_METHOD("has_instance", "id"));
	bind_guarded<&Self::get_instance_data>(D_METHOD("get_instance_data", "id"));
}

} // namespace thicket
