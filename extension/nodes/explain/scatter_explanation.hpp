#pragma once

#include "core/explain/rule_messages.hpp"
#include "nodes/common/convert.hpp"
#include "nodes/common/guard.hpp"
#include "nodes/layer/scatter_layer.hpp"

#include <godot_cpp/classes/ref.hpp>
#include <godot_cpp/classes/ref_counted.hpp>
#include <godot_cpp/variant/packed_string_array.hpp>
#include <godot_cpp/variant/string.hpp>
#include <godot_cpp/variant/string_name.hpp>
#include <godot_cpp/variant/vector3.hpp>

#include <glm/vec3.hpp>

#include <cstdint>
#include <string>
#include <vector>

namespace thicket {

/// The reasons why a layer has or does not have an instance at a position.
struct LayerExplanation {
	std::uint32_t layer = 0;
	std::string layer_name;
	glm::dvec3 position{0.0}; ///< The explained position in world meters, on the ground if there is any.

	/// The result of the rules, if they were evaluated. `messages` has one entry for each factor
	/// at that position.
	PositionExplanation rules;
	std::vector<RuleMessage> messages;
	/// For each mesh of the layer, a message about its share in the choice for the instance at the
	/// point. Empty without a choice, and if there is no point.
	std::vector<std::string> mesh_messages;
	RuleVerdict verdict;    ///< The outcome of the rules and of everything else that may prevent an instance.
	bool is_placed = false; ///< True if the point nearest to the position is an instance.
	bool is_drawn = false;  ///< True if that instance is drawn.
};

/// A LayerExplanation for scripts, as of the time of the call. If a rule index is out of range,
/// methods print an error and return a default value. Any thread may call any method.
class ScatterExplanation : public godot::RefCounted {
	GDCLASS(ScatterExplanation, godot::RefCounted)
	THICKET_GUARDED_METHODS(any)

public:
	/// `frame` relates the engine's space to the world.
	static godot::Ref<ScatterExplanation> of(
			LayerExplanation explanation, const godot::Ref<ScatterLayer> &p_layer, const WorldFrame &frame);

	godot::Ref<ScatterLayer> get_layer() const { return layer_; }
	godot::String get_layer_name() const { return godot::String::utf8(explanation_.layer_name.c_str()); }
	godot::Vector3 get_position() const;
	godot::String get_reason() const { return godot::String::utf8(explanation_.verdict.reason.c_str()); }
	godot::StringName get_refused_by() const { return explanation_.verdict.rule.c_str(); }
	double get_density() const { return explanation_.rules.at_position.density; }
	bool is_allowed() const { return explanation_.rules.is_allowed(); }
	bool is_standing() const { return explanation_.is_placed; }
	bool is_shown() const { return explanation_.is_drawn; }

	// These methods describe the point of the layer's set that is nearest to the position.
	int64_t get_id() const { return static_cast<int64_t>(explanation_.rules.point.id); }
	godot::Vector3 get_point_position() const;
	double get_distance() const { return explanation_.rules.distance; }
	double get_rank() const { return explanation_.rules.point.rank * 0x1p-32; }
	double get_point_density() const { return explanation_.rules.at_point.density; }

	// These methods describe how the mesh of the instance at the point was chosen.
	int64_t get_mesh() const { return static_cast<int64_t>(explanation_.rules.mesh); }
	int64_t get_mesh_count() const { return static_cast<int64_t>(explanation_.mesh_messages.size()); }
	double get_mesh_density(int64_t p_index) const;
	double get_mesh_probability(int64_t p_index) const;
	godot::String get_mesh_sentence(int64_t p_index) const;

	// These methods describe the layer's rules at the position.
	int64_t get_rule_count() const { return static_cast<int64_t>(explanation_.messages.size()); }
	godot::StringName get_rule_name(int64_t p_index) const;
	double get_rule_value(int64_t p_index) const;
	double get_rule_min(int64_t p_index) const;
	double get_rule_max(int64_t p_index) const;
	double get_rule_density(int64_t p_index) const;
	godot::String get_rule_sentence(int64_t p_index) const;

protected:
	static void _bind_methods();

private:
	bool check_index(const char *p_method, int64_t p_index) const;
	bool check_mesh(const char *p_method, int64_t p_index) const;

	LayerExplanation explanation_;
	godot::Ref<ScatterLayer> layer_;
	WorldFrame frame_;
};

} // namespace thicket
