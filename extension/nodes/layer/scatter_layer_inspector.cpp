// Hides properties of a layer in the inspector while they do not apply. They are still stored.

#include "nodes/layer/scatter_layer.hpp"

#include <godot_cpp/core/object.hpp>

#include <array>
#include <cstddef>
#include <utility>

using namespace godot;

namespace thicket {

namespace {

/// Properties that may be hidden, each with a bit of hidden_properties(), in this order.
constexpr std::array hideable{
		"mesh_weights",
		"scale_curve",
		"noise_curve",
		"mask_texture_rect",
		"mask_texture_channel",
		"mask_texture_edge",
		"clump_coverage",
		"clump_softness",
		"proximity_distance",
		"proximity_curve",
		"color_gradient",
		"thin_begin",
		"thin_end",
		"thin_scale_up",
		"collision_distance",
		"collision_layer",
		"collision_mask",
		"physics_material",
		"affect_navigation_mesh",
		"scene_distance",
		"color_source",
		"color_source_layer",
		"color_source_noise",
		"color_source_min",
		"color_source_max",
		"color_randomness",
		"variation_source",
		"variation_source_layer",
		"variation_source_noise",
		"variation_source_min",
		"variation_source_max",
		"variation_randomness",
};

/// The bits of hidden_properties() that hold the sources.
constexpr unsigned color_source_bits = 58;
constexpr unsigned variation_source_bits = 61;
static_assert(hideable.size() <= color_source_bits);

/// The range that the inspector shows for the ends of a source's range.
const char *range_hint(SourceKind kind) {
	switch (kind) {
		case SourceKind::height: return "-1000,9000,0.1,or_less,or_greater,suffix:m";
		case SourceKind::slope: return "0,90,0.1,degrees";
		case SourceKind::distance: return "0,200,0.01,or_greater,suffix:m";
		default: return "0,1,0.001";
	}
}

/// Whether the property with this prefix is an end of a source's range.
bool is_range(const StringName &p_name, const char *p_start) {
	return p_name == StringName(String(p_start) + "_source_min") ||
			p_name == StringName(String(p_start) + "_source_max");
}

} // namespace

std::uint64_t ScatterLayer::hidden_properties() const {
	const bool proximity = !links_.proximity_layer.empty();
	const bool thinned = lod_.thin_density < 1.0;
	const bool colliding = gameplay_.collision.shape != BodyShape::none;
	const SourceKind color = settings_.instance_data.color.kind;
	const SourceKind variation = settings_.instance_data.variation.kind;
	// Properties that are set stay visible even if they are unused, because a warning mentions them.
	const std::array<bool, hideable.size()> shown{
			meshes_.size() > 1 || mesh_weights_.size() > 0,
			settings_.placement.min_scale != settings_.placement.max_scale || resource("scale_curve").is_valid(),
			resource("noise").is_valid() || resource("noise_curve").is_valid(),
			resource("mask_texture").is_valid(),
			resource("mask_texture").is_valid(),
			resource("mask_texture").is_valid(),
			settings_.rules.clumping.size > 0.0,
			settings_.rules.clumping.size > 0.0,
			proximity,
			proximity || resource("proximity_curve").is_valid(),
			settings_.instance_data.use_colors || resource("color_gradient").is_valid(),
			thinned,
			thinned || lod_.thin_end > 0.0,
			thinned || lod_.scale_compensation,
			colliding,
			colliding,
			colliding,
			colliding || physics_material_.is_valid(),
			colliding,
			scene_.is_valid(),
			settings_.instance_data.use_colors || color != SourceKind::random,
			color == SourceKind::distance || !links_.color_layer.empty(),
			color == SourceKind::noise || resource("color_source_noise").is_valid(),
			color != SourceKind::random,
			color != SourceKind::random,
			color != SourceKind::random,
			settings_.instance_data.use_custom_data || variation != SourceKind::random,
			variation == SourceKind::distance || !links_.variation_layer.empty(),
			variation == SourceKind::noise || resource("variation_source_noise").is_valid(),
			variation != SourceKind::random,
			variation != SourceKind::random,
			variation != SourceKind::random,
	};
	// The units of the ranges depend on the sources, so a changed source must refresh the inspector, too.
	std::uint64_t hidden = static_cast<std::uint64_t>(color) << color_source_bits |
			static_cast<std::uint64_t>(variation) << variation_source_bits;
	for (std::size_t i = 0; i < shown.size(); ++i) {
		hidden |= std::uint64_t{!shown[i]} << i;
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
	if (is_range(p_property.name, "color")) {
		p_property.hint_string = range_hint(settings_.instance_data.color.kind);
	} else if (is_range(p_property.name, "variation")) {
		p_property.hint_string = range_hint(settings_.instance_data.variation.kind);
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
