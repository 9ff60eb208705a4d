#include "nodes/explain/scatter_explanation.hpp"

#include "nodes/common/bind_value.hpp"
#include "nodes/common/convert.hpp"
#include "nodes/common/property_check.hpp"

#include <godot_cpp/core/class_db.hpp>
#include <godot_cpp/core/memory.hpp>

#include <cmath>
#include <utility>

using namespace godot;

namespace thicket {

Ref<ScatterExplanation> ScatterExplanation::of(
		LayerExplanation explanation, const Ref<ScatterLayer> &p_layer, const WorldFrame &frame) {
	const Ref<ScatterExplanation> result(memnew(ScatterExplanation));
	result->explanation_ = std::move(explanation);
	result->layer_ = p_layer;
	result->frame_ = frame;
	return result;
}

Vector3 ScatterExplanation::get_position() const { return to_engine(explanation_.position, frame_); }

Vector3 ScatterExplanation::get_point_position() const {
	const float height = explanation_.rules.at_point.ground.height;
	const glm::dvec2 point = explanation_.rules.point.position;
	return to_engine(
			glm::dvec3(point.x, std::isfinite(height) ? double{height} : explanation_.position.y, point.y), frame_);
}

namespace {

/// Returns true if `p_index` is below `p_count`. Otherwise prints an error. `p_hint` names the
/// method that returns the count.
bool check_below(const char *p_method, int64_t p_index, int64_t p_count, const char *p_hint) {
	if (p_index >= 0 && p_index < p_count) {
		return true;
	}
	if (p_count == 0) {
		ERR_PRINT(vformat(
				"ScatterExplanation.%s has no index %d, because the list is empty; %s", p_method, p_index, p_hint));
	} else {
		report((std::string("ScatterExplanation.") + p_method).c_str(),
				Status::out_of_range("index", p_index, between(0, p_count - 1, p_hint)));
	}
	return false;
}

} // namespace

bool ScatterExplanation::check_index(const char *p_method, int64_t p_index) const {
	return check_below(p_method, p_index, get_rule_count(), "see get_rule_count()");
}

bool ScatterExplanation::check_mesh(const char *p_method, int64_t p_index) const {
	return check_below(p_method, p_index, get_mesh_count(), "see get_mesh_count()");
}

double ScatterExplanation::get_mesh_density(int64_t p_index) const {
	return check_mesh("get_mesh_density", p_index)
			? explanation_.rules.meshes[static_cast<std::size_t>(p_index)].density
			: 0.0;
}

double ScatterExplanation::get_mesh_probability(int64_t p_index) const {
	return check_mesh("get_mesh_probability", p_index)
			? explanation_.rules.meshes[static_cast<std::size_t>(p_index)].probability
			: 0.0;
}

String ScatterExplanation::get_mesh_sentence(int64_t p_index) const {
	return check_mesh("get_mesh_sentence", p_index)
			? String::utf8(explanation_.mesh_messages[static_cast<std::size_t>(p_index)].c_str())
			: String();
}

StringName ScatterExplanation::get_rule_name(int64_t p_index) const {
	return check_index("get_rule_name", p_index)
			? StringName(explanation_.messages[static_cast<std::size_t>(p_index)].rule.c_str())
			: StringName();
}

double ScatterExplanation::get_rule_value(int64_t p_index) const {
	return check_index("get_rule_value", p_index)
			? explanation_.rules.at_position.factors[static_cast<std::size_t>(p_index)].value
			: 0.0;
}

double ScatterExplanation::get_rule_min(int64_t p_index) const {
	return check_index("get_rule_min", p_index) ? explanation_.messages[static_cast<std::size_t>(p_index)].min : 0.0;
}

double ScatterExplanation::get_rule_max(int64_t p_index) const {
	return check_index("get_rule_max", p_index) ? explanation_.messages[static_cast<std::size_t>(p_index)].max : 0.0;
}

double ScatterExplanation::get_rule_density(int64_t p_index) const {
	return check_index("get_rule_density", p_index)
			? explanation_.rules.at_position.factors[static_cast<std::size_t>(p_index)].density
			: 0.0;
}

String ScatterExplanation::get_rule_sentence(int64_t p_index) const {
	return check_index("get_rule_sentence", p_index)
			? String::utf8(explanation_.messages[static_cast<std::size_t>(p_index)].message.c_str())
			: String();
}

void ScatterExplanation::_bind_methods() {
	using Self = ScatterExplanation;
	bind_guarded<&Self::get_layer>(D_METHOD("get_layer"));
	bind_guarded<&Self::get_layer_name>(D_METHOD("get_layer_name"));
	bind_guarded<&Self::get_position>(D_METHOD("get_position"));
	bind_guarded<&Self::get_reason>(D_METHOD("get_reason"));
	bind_guarded<&Self::get_refused_by>(D_METHOD("get_refused_by"));
	bind_guarded<&Self::get_density>(D_METHOD("get_density"));
	bind_guarded<&Self::is_allowed>(D_METHOD("is_allowed"));
	bind_guarded<&Self::is_standing>(D_METHOD("is_standing"));
	bind_guarded<&Self::is_shown>(D_METHOD("is_shown"));
	bind_guarded<&Self::get_id>(D_METHOD("get_id"));
	bind_guarded<&Self::get_point_position>(D_METHOD("get_point_position"));
	bind_guarded<&Self::get_distance>(D_METHOD("get_distance"));
	bind_guarded<&Self::get_rank>(D_METHOD("get_rank"));
	bind_guarded<&Self::get_point_density>(D_METHOD("get_point_density"));
	bind_guarded<&Self::get_mesh>(D_METHOD("get_mesh"));
	bind_guarded<&Self::get_mesh_count>(D_METHOD("get_mesh_count"));
	bind_guarded<&Self::get_mesh_density>(D_METHOD("get_mesh_density", "index"));
	bind_guarded<&Self::get_mesh_probability>(D_METHOD("get_mesh_probability", "index"));
	bind_guarded<&Self::get_mesh_sentence>(D_METHOD("get_mesh_sentence", "index"));
	bind_guarded<&Self::get_rule_count>(D_METHOD("get_rule_count"));
	bind_guarded<&Self::get_rule_name>(D_METHOD("get_rule_name", "index"));
	bind_guarded<&Self::get_rule_value>(D_METHOD("get_rule_value", "index"));
	bind_guarded<&Self::get_rule_min>(D_METHOD("get_rule_min", "index"));
	bind_guarded<&Self::get_rule_max>(D_METHOD("get_rule_max", "index"));
	bind_guarded<&Self::get_rule_density>(D_METHOD("get_rule_density", "index"));
	bind_guarded<&Self::get_rule_sentence>(D_METHOD("get_rule_sentence", "index"));
	const char *owner = "ScatterExplanation";
	bind_value(owner, PropertyInfo(Variant::OBJECT, "layer", PROPERTY_HINT_RESOURCE_TYPE, "ScatterLayer"), "get_layer");
	bind_value(owner, PropertyInfo(Variant::STRING, "layer_name"), "get_layer_name");
	bind_value(owner, PropertyInfo(Variant::VECTOR3, "position"), "get_position");
	bind_value(owner, PropertyInfo(Variant::STRING, "reason"), "get_reason");
	bind_value(owner, PropertyInfo(Variant::STRING_NAME, "refused_by"), "get_refused_by");
	bind_value(owner, PropertyInfo(Variant::FLOAT, "density"), "get_density");
	bind_value(owner, PropertyInfo(Variant::BOOL, "allowed"), "is_allowed");
	bind_value(owner, PropertyInfo(Variant::BOOL, "standing"), "is_standing");
	bind_value(owner, PropertyInfo(Variant::BOOL, "shown"), "is_shown");
	bind_value(owner, PropertyInfo(Variant::INT, "id"), "get_id");
	bind_value(owner, PropertyInfo(Variant::VECTOR3, "point_position"), "get_point_position");
	bind_value(owner, PropertyInfo(Variant::FLOAT, "distance"), "get_distance");
	bind_value(owner, PropertyInfo(Variant::FLOAT, "rank"), "get_rank");
	bind_value(owner, PropertyInfo(Variant::FLOAT, "point_density"), "get_point_density");
	bind_value(owner, PropertyInfo(Variant::INT, "mesh"), "get_mesh");
}

} // namespace thicket
