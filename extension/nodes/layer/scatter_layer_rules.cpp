// This file contains the properties of ScatterLayer in the group Rules, which determine the points
// of a layer's set that get an instance.

#include "nodes/common/engine_arrays.hpp"
#include "nodes/layer/expression_text.hpp"
#include "nodes/layer/scatter_layer_properties.hpp"

#include <utility>

using namespace godot;

namespace thicket {

namespace {

constexpr SwitchProperty on_surfaces{"on_surfaces", "is_on_surfaces", &PointSet::on_surface};
constexpr NumberProperty min_slope_degrees{
		"min_slope_degrees", &Rules::min_slope_degrees, 0.0, 180.0, PROPERTY_HINT_RANGE, "0,180,0.1,degrees"};
constexpr NumberProperty max_slope_degrees{
		"max_slope_degrees", &Rules::max_slope_degrees, 0.0, 180.0, PROPERTY_HINT_RANGE, "0,180,0.1,degrees"};
constexpr NumberProperty slope_falloff_degrees{
		"slope_falloff_degrees", &Rules::slope_falloff_degrees, 0.0, 90.0, PROPERTY_HINT_RANGE, "0,90,0.1,degrees"};
constexpr NumberProperty min_height{"min_height", &Rules::min_height, -unlimited_height, unlimited_height,
		PROPERTY_HINT_RANGE, "-1000,9000,0.1,or_less,or_greater,suffix:m"};
constexpr NumberProperty max_height{"max_height", &Rules::max_height, -unlimited_height, unlimited_height,
		PROPERTY_HINT_RANGE, "-1000,9000,0.1,or_less,or_greater,suffix:m"};
constexpr NumberProperty height_falloff{"height_falloff", &Rules::height_falloff, 0.0, unlimited_height,
		PROPERTY_HINT_RANGE, "0,1000,0.01,or_greater,exp,suffix:m"};
constexpr NumberProperty min_water_depth{"min_water_depth", &Rules::min_water_depth, -unlimited_height,
		unlimited_height, PROPERTY_HINT_RANGE, "-100,100,0.01,or_less,or_greater,suffix:m"};
constexpr NumberProperty max_water_depth{"max_water_depth", &Rules::max_water_depth, -unlimited_height,
		unlimited_height, PROPERTY_HINT_RANGE, "-100,100,0.01,or_less,or_greater,suffix:m"};
constexpr NumberProperty water_depth_falloff{"water_depth_falloff", &Rules::water_depth_falloff, 0.0, unlimited_height,
		PROPERTY_HINT_RANGE, "0,100,0.01,or_greater,exp,suffix:m"};
constexpr NumberProperty clump_size{"clump_size", &Clumping::size, 0.0, max_clump_size, PROPERTY_HINT_RANGE,
		"0,1000,0.01,or_greater,exp,suffix:m", min_clump_size};
constexpr NumberProperty clump_coverage{
		"clump_coverage", &Clumping::coverage, 0.0, 1.0, PROPERTY_HINT_RANGE, "0,1,0.001"};
constexpr NumberProperty clump_softness{
		"clump_softness", &Clumping::softness, 0.0, 1.0, PROPERTY_HINT_RANGE, "0,1,0.001"};
constexpr NumberProperty edge_feather{"edge_feather", &Rules::edge_feather, 0.0, max_edge_feather, PROPERTY_HINT_RANGE,
		"0,100,0.01,or_greater,exp,suffix:m"};

constexpr ResourceProperty density_over_height{"density_over_height", &Rules::height_curve, curve_table};
constexpr ResourceProperty density_over_slope{"density_over_slope", &Rules::slope_curve, curve_table};
constexpr ResourceProperty noise{"noise", &LayerTables::noise_source, noise_copy};
constexpr ResourceProperty noise_curve{"noise_curve", &LayerTables::noise_curve, curve_table};

} // namespace

void ScatterLayer::set_ground_textures(const PackedInt32Array &p_textures) {
	if (p_textures.size() > max_texture + 1) {
		report(ScatterLayer::class_name,
				Status::wrong_size("ground_textures", p_textures.size(), at_most(max_texture + 1, "entries")));
		return;
	}
	for (const int32_t texture : p_textures) {
		if (!accept_number(ScatterLayer::class_name, "ground_textures", texture, 0.0, max_texture)) {
			return;
		}
	}
	ground_textures_ = p_textures;
	mark_changed();
}

PackedInt32Array ScatterLayer::get_ground_textures() const { return ground_textures_; }

void ScatterLayer::set_density_expression(const String &p_text) {
	SharedExpression expression = settings_.rules.expression;
	if (compile_text("ScatterLayer.density_expression", p_text, expression) &&
			expression != settings_.rules.expression) {
		settings_.rules.expression = std::move(expression);
		mark_changed();
	}
}

String ScatterLayer::get_density_expression() const { return text_of(settings_.rules.expression); }

void ScatterLayer::watch_density_rules(bool p_watch) {
	for (const Ref<ScatterRule> &rule : density_rules_) {
		watch(rule.ptr(), "changed", this, "_density_rule_changed", p_watch);
	}
}

void ScatterLayer::set_density_rules(const TypedArray<ScatterRule> &p_rules) {
	if (p_rules.size() > static_cast<int64_t>(max_density_rules)) {
		report(ScatterLayer::class_name,
				Status::wrong_size("density_rules", p_rules.size(), at_most(max_density_rules, "entries")));
		return;
	}
	std::vector<Ref<ScatterRule>> rules;
	for (int64_t i = 0; i < p_rules.size(); ++i) {
		rules.emplace_back(p_rules[i]);
	}
	watch_density_rules(false);
	density_rules_ = std::move(rules);
	watch_density_rules(true);
	density_rule_changed();
}

TypedArray<ScatterRule> ScatterLayer::get_density_rules() const {
	TypedArray<ScatterRule> result;
	for (const Ref<ScatterRule> &rule : density_rules_) {
		append(result, rule);
	}
	result.make_read_only();
	return result;
}

void ScatterLayer::density_rule_changed() {
	density_rules_outdated_ = true;
	mark_changed();
}

/// Replaces the rules in the settings. Runs the scripts of the rules, which may change this layer.
void ScatterLayer::remake_density_rules() {
	density_rules_outdated_ = false;
	const std::vector<Ref<ScatterRule>> rules = density_rules_; // A script may change the list.
	std::vector<SharedDensityRule> new_rules;
	std::vector<std::string> names;
	for (const Ref<ScatterRule> &rule : rules) {
		if (SharedDensityRule new_rule = rule.is_valid() ? rule->make_rule() : nullptr) {
			new_rules.push_back(std::move(new_rule));
			names.push_back(rule->display_name());
		}
	}
	settings_.rules.density_rules = std::move(new_rules);
	density_rule_names_ = std::move(names);
}

void ScatterLayer::bind_rules() {
	ADD_GROUP("Rules", "");
	bind_guarded<&ScatterLayer::set_density_expression>(D_METHOD("set_density_expression", "text"));
	bind_guarded<&ScatterLayer::get_density_expression>(D_METHOD("get_density_expression"));
	add_layer_property(PropertyUse::placement,
			PropertyInfo(Variant::STRING, "density_expression", PROPERTY_HINT_PLACEHOLDER_TEXT,
					"smoothstep(900, 1200, height)"),
			"set_density_expression", "get_density_expression");
	bind_guarded<&ScatterLayer::set_density_rules>(D_METHOD("set_density_rules", "rules"));
	bind_guarded<&ScatterLayer::get_density_rules>(D_METHOD("get_density_rules"));
	bind_guarded<&ScatterLayer::density_rule_changed>(ThreadUse::relayed, D_METHOD("_density_rule_changed"));
	add_layer_property(PropertyUse::placement,
			PropertyInfo(Variant::ARRAY, "density_rules", PROPERTY_HINT_ARRAY_TYPE,
					vformat("%d/%d:ScatterRule", Variant::OBJECT, PROPERTY_HINT_RESOURCE_TYPE)),
			"set_density_rules", "get_density_rules");
	ADD_SUBGROUP("Height", "");
	bind_number<min_height>();
	bind_number<max_height>();
	bind_number<height_falloff>();
	bind_resource<density_over_height>();
	ADD_SUBGROUP("Slope", "");
	bind_number<min_slope_degrees>();
	bind_number<max_slope_degrees>();
	bind_number<slope_falloff_degrees>();
	bind_resource<density_over_slope>();
	ADD_SUBGROUP("Water", "");
	bind_number<min_water_depth>();
	bind_number<max_water_depth>();
	bind_number<water_depth_falloff>();
	ADD_SUBGROUP("Ground", "");
	bind_switch<on_surfaces>();
	bind_hosts();
	bind_guarded<&ScatterLayer::set_ground_textures>(D_METHOD("set_ground_textures", "textures"));
	bind_guarded<&ScatterLayer::get_ground_textures>(D_METHOD("get_ground_textures"));
	add_layer_property(PropertyUse::placement, PropertyInfo(Variant::PACKED_INT32_ARRAY, "ground_textures"),
			"set_ground_textures", "get_ground_textures");
	ADD_SUBGROUP("Noise", "");
	bind_resource<noise>();
	bind_resource<noise_curve>();
	bind_masks();
	ADD_SUBGROUP("Clumping", "clump_");
	bind_number<clump_size>();
	bind_number<clump_coverage>();
	bind_number<clump_softness>();
	ADD_SUBGROUP("Edge", "edge_");
	bind_number<edge_feather>();
}

} // namespace thicket
