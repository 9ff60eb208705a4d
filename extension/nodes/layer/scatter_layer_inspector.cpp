// This file hides properties of a layer that do not apply from the inspector. Their values are
// still stored.

#include "nodes/layer/scatter_layer.hpp"

#include <godot_cpp/core/object.hpp>

#include <array>
#include <cstddef>
#include <utility>

using namespace godot;

namespace thicket {

namespace {

/// Properties that may be hidden, in the order of their bits in hidden_properties().
constexpr std::array hideable_properties{
		"radius",
		"progressive_levels",
		"min_yaw_degrees",
		"max_yaw_degrees",
		"mesh_weights",
		"mesh_density_expressions",
		"scale_curve",
		"scale_value",
		"noise_curve",
		"mask_texture_rect",
		"mask_texture_channel",
		"mask_texture_edge",
		"surface_layers",
		"clump_coverage",
		"clump_softness",
		"proximity_distance",
		"proximity_curve",
		"color_value",
		"variation_value",
		"thin_begin",
		"thin_end",
		"thin_scale_up",
		"collision_distance",
		"collision_layer",
		"collision_mask",
		"physics_material",
		"affect_navigation_mesh",
		"scene_distance",
};

static_assert(hideable_properties.size() <= 64);

} // namespace

std::uint64_t ScatterLayer::hidden_properties() const {
	const bool has_proximity = !links_.proximity_layer.empty();
	const bool scale_varies = settings_.placement.min_scale != settings_.placement.max_scale;
	const bool aligns_to_rows = rows_.is_valid() && rows_->is_aligning_to_rows();
	const bool thins = lod_.thin_density < 1.0;
	const bool collides = gameplay_.collision.shape != BodyShape::none;
	// An unused property stays visible if it is set, because a warning mentions it.
	const std::array<bool, hideable_properties.size()> visible{
			rows_.is_null(),
			rows_.is_null(),
			!aligns_to_rows,
			!aligns_to_rows,
			meshes_.size() > 1 || mesh_weights_.size() > 0,
			meshes_.size() > 1 || !mesh_expressions_.empty(),
			scale_varies || resource("scale_curve").is_valid(),
			scale_varies || scale_value_.is_valid(),
			resource("noise").is_valid() || resource("noise_curve").is_valid(),
			resource("mask_texture").is_valid(),
			resource("mask_texture").is_valid(),
			resource("mask_texture").is_valid(),
			settings_.set.on_surface || !links_.surface_layers.empty(),
			settings_.rules.clumping.size > 0.0,
			settings_.rules.clumping.size > 0.0,
			has_proximity,
			has_proximity || resource("proximity_curve").is_valid(),
			settings_.instance_data.use_colors || color_value_.is_valid(),
			settings_.instance_data.use_custom_data || variation_value_.is_valid(),
			thins,
			thins || lod_.thin_end > 0.0,
			thins || lod_.scale_compensation,
			collides,
			collides,
			collides,
			collides || physics_material_.is_valid(),
			collides,
			scene_.is_valid(),
	};
	std::uint64_t hidden_bits = 0;
	for (std::size_t i = 0; i < visible.size(); ++i) {
		hidden_bits |= std::uint64_t{!visible[i]} << i;
	}
	return hidden_bits;
}

void ScatterLayer::_validate_property(PropertyInfo &p_property) const {
	const std::uint64_t hidden_bits = hidden_properties();
	for (std::size_t i = 0; i < hideable_properties.size(); ++i) {
		if (((hidden_bits >> i) & 1U) != 0 && p_property.name == StringName(hideable_properties[i])) {
			p_property.usage &= ~static_cast<std::uint32_t>(PROPERTY_USAGE_EDITOR);
		}
	}
}

void ScatterLayer::mark_changed() {
	const std::uint64_t hidden_bits = hidden_properties();
	if (std::exchange(hidden_properties_, hidden_bits) != hidden_bits) {
		notify_property_list_changed();
	}
	emit_changed();
}

} // namespace thicket
