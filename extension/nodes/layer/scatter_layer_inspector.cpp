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
constexpr std::array hideable{
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

static_assert(hideable.size() <= 64);

} // namespace

std::uint64_t ScatterLayer::hidden_properties() const {
	const bool proximity = !links_.proximity_layer.empty();
	const bool varying_scale = settings_.placement.min_scale != settings_.placement.max_scale;
	const bool aligned = rows_.is_valid() && rows_->is_aligning_to_rows();
	const bool thinned = lod_.thin_density < 1.0;
	const bool colliding = gameplay_.collision.shape != BodyShape::none;
	// An unused property stays visible if it is set, because a warning mentions it.
	const std::array<bool, hideable.size()> visible{
			rows_.is_null(),
			rows_.is_null(),
			!aligned,
			!aligned,
			meshes_.size() > 1 || mesh_weights_.size() > 0,
			meshes_.size() > 1 || !mesh_expressions_.empty(),
			varying_scale || resource("scale_curve").is_valid(),
			varying_scale || scale_value_.is_valid(),
			resource("noise").is_valid() || resource("noise_curve").is_valid(),
			resource("mask_texture").is_valid(),
			resource("mask_texture").is_valid(),
			resource("mask_texture").is_valid(),
			settings_.set.on_surface || !links_.surface_layers.empty(),
			settings_.rules.clumping.size > 0.0,
			settings_.rules.clumping.size > 0.0,
			proximity,
			proximity || resource("proximity_curve").is_valid(),
			settings_.instance_data.use_colors || color_value_.is_valid(),
			settings_.instance_data.use_custom_data || variation_value_.is_valid(),
			thinned,
			thinned || lod_.thin_end > 0.0,
			thinned || lod_.scale_compensation,
			colliding,
			colliding,
			colliding,
			colliding || physics_material_.is_valid(),
			colliding,
			scene_.is_valid(),
	};
	std::uint64_t hidden = 0;
	for (std::size_t i = 0; i < visible.size(); ++i) {
		hidden |= std::uint64_t{!visible[i]} << i;
	}
	return hidden;
}

void ScatterLayer::_validate_property(PropertyInfo &p_property) const {
	const std::uint64_t hidden = hidden_properties();
	for (std::size_t i = 0; i < hideable.size(); ++i) {
		if (((hidden >> i) & 1U) != 0 && p_property.name == StringName(hideable[i])) {
			p_property.usage &= ~static_cast<std::uint32_t>(PROPERTY_USAGE_EDITOR);
		}
	}
}

void ScatterLayer::changed() {
	const std::uint64_t hidden = hidden_properties();
	if (std::exchange(hidden_, hidden) != hidden) {
		notify_property_list_changed();
	}
	emit_changed();
}

} // namespace thicket
