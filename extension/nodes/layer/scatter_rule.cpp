#include "nodes/layer/scatter_rule.hpp"

#include "core/placement/layer_graph.hpp"
#include "nodes/common/convert.hpp"
#include "nodes/common/script_answer.hpp"

#include <godot_cpp/core/class_db.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <span>

using namespace godot;

namespace thicket {

namespace {

constexpr ScriptMethod densities_method{"_get_densities", "_get_densities() result",
		"array of numbers from _get_densities()", "a PackedFloat32Array with a density from 0 to 1 for each position",
		Variant::FLOAT};
constexpr ScriptMethod bounds_method{"_get_density_bounds", "_get_density_bounds() result",
		"_get_density_bounds() result", "a Vector2 with the lowest and the highest density in the box, 0 to 1",
		Variant::VECTOR2};

/// A density rule that calls the script of a ScatterRule. Worker threads use it only if the script
/// declares itself thread-safe.
class ScriptRule final : public DensityRule {
public:
	ScriptRule(const Ref<ScatterRule> &p_script, bool thread_safe, bool has_bounds) :
			script_(p_script), thread_safe_(thread_safe), has_bounds_(has_bounds) {}

	bool is_thread_safe() const override { return thread_safe_; }

	Status sample(const DensityBatch &batch, std::span<float> r_densities) const override {
		const auto count = static_cast<std::int64_t>(batch.positions.size());
		const auto floats = [](const auto &vector) {
			return Vector3(static_cast<real_t>(vector.x), static_cast<real_t>(vector.y), static_cast<real_t>(vector.z));
		};
		PackedFloat32Array densities;
		const Status status = answers_.call(script_.ptr(), densities_method, count, densities,
				Variant(packed<PackedVector3Array>(batch.positions, floats)),
				Variant(packed<PackedVector3Array>(batch.normals, floats)), Variant(packed_floats(batch.slopes)),
				Variant(packed_floats(batch.weights)));
		if (!status.ok()) {
			return status;
		}
		const std::span<const float> returned_densities(densities.ptr(), r_densities.size());
		const auto invalid = std::ranges::find_if_not(
				returned_densities, [](float density) { return density >= 0.0F && density <= 1.0F; });
		if (invalid != returned_densities.end()) {
			const Vector3 position =
					floats(batch.positions[static_cast<std::size_t>(invalid - returned_densities.begin())]);
			return answers_.reject(script_.ptr(), densities_method,
					Status::out_of_range("density from _get_densities()", *invalid, between(0, 1),
							"Return a density from 0 to 1 for each position, for example with clampf()"),
					vformat("returned the density %s at %v", Variant(double{*invalid}), Variant(position)));
		}
		std::ranges::copy(returned_densities, r_densities.begin());
		return {};
	}

	Status find_closed(const Box3 &box, bool &r_closed) const override {
		r_closed = false;
		if (!has_bounds_) {
			return {};
		}
		const glm::dvec3 size = box.max - box.min;
		const AABB bounds(to_engine(box.min), to_engine(size));
		Variant owner(script_);
		Variant answer;
		const GDExtensionCallErrorType error = call_script(owner, bounds_method.name, answer, Variant(bounds));
		const bool is_vector = error == GDEXTENSION_CALL_OK && answer.get_type() == Variant::VECTOR2;
		const Vector2 range = is_vector ? static_cast<Vector2>(answer) : Vector2(-1.0F, -1.0F);
		if (!(range.x >= 0.0F && range.x <= range.y && range.y <= 1.0F)) {
			const bool is_null = answer.get_type() == Variant::NIL;
			return answers_.reject(script_.ptr(), bounds_method,
					Status::wrong_type(
							bounds_method.result, "Return a Vector2 with the lowest and the highest density"),
					is_null ? String("returned null, as it does after a script error")
							: vformat("returned %s", answer));
		}
		r_closed = range.y <= 0.0F;
		return {};
	}

	std::string problem(const Status &status) const override { return answers_.sentence(status).utf8().get_data(); }

private:
	Ref<ScatterRule> script_;
	bool thread_safe_;
	bool has_bounds_;
	mutable ScriptAnswers answers_;
};

} // namespace

SharedDensityRule ScatterRule::make_rule() {
	const Ref<ScatterRule> keep_alive(this); // The script may release the rule.
	if (!GDVIRTUAL_IS_OVERRIDDEN(_get_densities)) {
		return nullptr;
	}
	bool thread_safe = false;
	GDVIRTUAL_CALL(_is_thread_safe, thread_safe);
	return std::make_shared<const ScriptRule>(keep_alive, thread_safe, GDVIRTUAL_IS_OVERRIDDEN(_get_density_bounds));
}

std::string ScatterRule::display_name() {
	const String name = get_name();
	return (name.is_empty() ? short_script_name(this) : name).utf8().get_data();
}

String ScatterRule::problem() const {
	return GDVIRTUAL_IS_OVERRIDDEN(_get_densities)
			? String()
			: String("a ScatterRule has no effect: extend it with a script (a @tool script to see it in the editor) "
					 "that has _get_densities().");
}

std::string density_rule_problem(const LayerSettings &layer, const Status &status) {
	const LayerGraph graph(layer);
	for (const LayerGraph::Node &node : graph.nodes()) {
		for (const SharedDensityRule &rule : node.layer->rules.density_rules) {
			if (std::string problem = rule->problem(status); !problem.empty()) {
				return problem;
			}
		}
	}
	return {};
}

void ScatterRule::_bind_methods() {
	GDVIRTUAL_BIND(_get_densities, "positions", "normals", "slopes", "texture_weights");
	GDVIRTUAL_BIND(_get_density_bounds, "bounds");
	GDVIRTUAL_BIND(_is_thread_safe);
}

} // namespace thicket
