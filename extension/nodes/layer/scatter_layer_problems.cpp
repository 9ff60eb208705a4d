// This file finds likely mistakes in a layer, for the editor's configuration warnings.

#include "core/placement/edge_probes.hpp"
#include "nodes/common/stripped.hpp"
#include "nodes/layer/scatter_layer_properties.hpp"

using namespace godot;

namespace thicket {

namespace {

/// Returns true if a curve has the default domain, which is rarely correct for the property's unit.
bool has_default_domain(const Ref<Curve> &p_curve) {
	return p_curve->get_min_domain() == 0.0F && p_curve->get_max_domain() == 1.0F;
}

/// Adds the problems of a density curve and of its table. `p_domain` is the unit of the curve's
/// input, for messages.
void add_curve_problem(const char *p_name, const Ref<Curve> &p_curve, const std::shared_ptr<const CurveTable> &table,
		const char *p_domain, PackedStringArray &r_problems) {
	if (p_curve.is_null()) {
		return;
	}
	const String name = "ScatterLayer." + String(p_name);
	if (table == nullptr) {
		r_problems.push_back(name + String(" has no points, so it is not used. Add points, or clear it."));
		return;
	}
	if (table->largest() <= 0.0) {
		r_problems.push_back(name +
				String(" is 0 everywhere, so nothing is placed. Raise a point of the curve, or remove the curve."));
	}
	if (has_default_domain(p_curve)) {
		r_problems.push_back(name + String(" still has the default domain of 0 to 1, but its input is in ") + p_domain +
				String(". Set Min Domain and Max Domain."));
	}
}

} // namespace

void ScatterLayer::add_number_problems(PackedStringArray &r_problems) const {
	if (settings_.rules.clumping.size > 0.0 && settings_.rules.clumping.coverage <= 0.0) {
		r_problems.push_back("ScatterLayer.clump_coverage is 0, so nothing is placed. Increase clump_coverage, or set "
							 "clump_size to 0.");
	}
	const double points = point_density(point_set()) * range_.tile_size * range_.tile_size;
	if (settings_.rules.edge_feather > 0.0 && points * static_cast<double>(edge_probes) > max_tile_points) {
		r_problems.push_back("ScatterLayer.edge_feather samples the ground at " +
				String::num_int64(static_cast<int64_t>(edge_probes)) +
				" positions around each point, which is slow in tiles with this many points: lower tile_size.");
	}
}

void ScatterLayer::add_curve_problems(PackedStringArray &r_problems) const {
	add_curve_problem("density_over_height", resource("density_over_height"), settings_.rules.height_curve,
			"meters of height", r_problems);
	add_curve_problem("density_over_slope", resource("density_over_slope"), settings_.rules.slope_curve,
			"degrees of slope", r_problems);
	add_curve_problem(
			"noise_curve", resource("noise_curve"), tables_.noise_curve, "the range of noise, -1 to 1", r_problems);
	if (resource("noise_curve").is_valid() && resource("noise").is_null()) {
		r_problems.push_back(
				"ScatterLayer.noise_curve has no effect because noise is empty. Set noise, or remove noise_curve.");
	}
	if (const Ref<Curve> scale_curve = resource("scale_curve");
			scale_curve.is_valid() && scale_curve->get_point_count() == 0) {
		r_problems.push_back("ScatterLayer.scale_curve has no points, so it is not used. Add points, or clear it.");
	}
	if (resource("scale_curve").is_valid() && settings_.placement.min_scale == settings_.placement.max_scale) {
		r_problems.push_back(
				"ScatterLayer.scale_curve has no effect because min_scale equals max_scale. Change one of them.");
	}
}

void ScatterLayer::add_mask_problems(PackedStringArray &r_problems) const {
	if (mask_.is_valid() && mask_->blank() && mask_->get_background() >= 1.0) {
		r_problems.push_back("ScatterLayer.mask has no effect: it is not painted, and its background is 1. Paint on "
							 "it, or clear mask.");
	}
	if (mask_.is_valid() && mask_->blank() && mask_->get_background() <= 0.0) {
		r_problems.push_back(
				"Nothing is placed: ScatterLayer.mask is not painted, and its background is 0. Paint on it.");
	}
	if (tables_.image_missing && !is_stripped(tables_.mask_texture.texture)) {
		r_problems.push_back(mask_frame_.channel == ImageChannel::none
						? "ScatterLayer.mask_texture has no readable image, so its channels are 0 in expressions. Use "
						  "another texture."
						: "Nothing is placed: ScatterLayer.mask_texture has no readable image. Use another texture.");
	}
	const bool has_texture = tables_.mask_texture.texture.is_valid();
	if (used_mask_channels() != 0 && !has_texture) {
		r_problems.push_back("An expression uses mask_red, mask_green, mask_blue or mask_alpha, which is 0 everywhere "
							 "because ScatterLayer.mask_texture is empty. Set mask_texture, or remove the input.");
	}
	if (used_mask_channels() == 0 && has_texture && mask_frame_.channel == ImageChannel::none) {
		r_problems.push_back("ScatterLayer.mask_texture has no effect: mask_texture_channel is None, and no expression "
							 "uses a channel such as mask_red. Select a channel, use one in an expression, or clear "
							 "mask_texture.");
	}
}

void ScatterLayer::add_density_rule_problems(PackedStringArray &r_problems) const {
	for (const Ref<ScatterRule> &rule : density_rules_) {
		const String problem = rule.is_null() ? String("an entry is empty. Assign a ScatterRule, or remove the entry.")
											  : rule->problem();
		if (!problem.is_empty()) {
			r_problems.push_back(String("ScatterLayer.density_rules: ") + problem);
		}
	}
}

void ScatterLayer::add_neighbor_problems(PackedStringArray &r_problems) const {
	if (links_.spacing.count(LayerReference()) > 0) {
		r_problems.push_back("ScatterLayer.spacing has an entry without a layer's name. Remove the entry.");
	}
	if (!links_.proximity_layer.empty()) {
		add_curve_problem("proximity_curve", resource("proximity_curve"), links_.proximity_curve, "meters of distance",
				r_problems);
	} else if (resource("proximity_curve").is_valid()) {
		r_problems.push_back(
				"ScatterLayer.proximity_curve is not used: proximity_layer names no layer. Set proximity_layer.");
	}
}

void ScatterLayer::add_mesh_problems(PackedStringArray &r_problems) const {
	meshes_.add_problems(r_problems);
	if (mesh_weights_.size() > static_cast<int64_t>(meshes_.size())) {
		r_problems.push_back("ScatterLayer.mesh_weights has more entries than meshes. Remove the unused entries.");
	}
	if (mesh_expressions_.size() > meshes_.size()) {
		r_problems.push_back("ScatterLayer.mesh_density_expressions has more entries than meshes. Remove the unused "
							 "entries.");
	}
}

PackedStringArray ScatterLayer::problems() {
	read_models();
	PackedStringArray result;
	const Status status = check();
	if (!status.ok()) {
		result.push_back(sentence(ScatterLayer::class_name, status));
	}
	add_number_problems(result);
	add_curve_problems(result);
	add_mask_problems(result);
	add_density_rule_problems(result);
	add_neighbor_problems(result);
	add_host_problems(result);
	add_row_problems(result);
	add_mesh_problems(result);
	add_source_problems(result);
	add_lod_problems(result);
	add_gameplay_problems(result);
	add_stripped_problems(result);
	return result;
}

} // namespace thicket
