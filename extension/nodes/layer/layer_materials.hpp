#pragma once

#include "nodes/layer/layer_snapshot.hpp"

#include <godot_cpp/classes/material.hpp>
#include <godot_cpp/classes/ref.hpp>

#include <span>
#include <vector>

namespace thicket {

/// Returns the materials that a layer is drawn with, without duplicates or nulls. If there is a
/// material override, returns only the override. Otherwise returns those of all surfaces of its
/// meshes, their LODs and their shadow meshes.
std::vector<godot::Ref<godot::Material>> materials_of(const LayerDrawing &drawing);

/// Returns the materials of all layers whose shader has a uniform with this name and type, in the
/// order of the layers and without duplicates.
std::vector<godot::Ref<godot::Material>> materials_with(
		std::span<const SharedSnapshot> layers, const char *p_uniform, godot::Variant::Type p_type);

/// Returns true if any of the shaders declares an instance uniform or includes the add-on's
/// scatter_scale.gdshaderinc.
bool use_instance_uniforms(std::span<const godot::Ref<godot::Material>> materials);

/// Returns the largest distance in world meters by which any of the materials may move a vertex, at
/// most max_cull_margin. Ignores materials without the uniforms of foliage.gdshaderinc. For all
/// others, the distance is max(wind_sway, 0) * strength + max(wind_flutter, 0) * strength +
/// max(bend_reach, 0).
///
/// The strength is 2 or the material's wind_strength, whichever is larger, because a
/// ScatterFoliageWorld may set any value up to 2 at any time. A parameter that is not set has the
/// shader's default. Without a renderer, the defaults are unknown, so the result is 0.
double sway_reach(std::span<const godot::Ref<godot::Material>> materials);
inline constexpr double max_cull_margin = 16384.0; ///< The maximum of extra_cull_margin in meters.

} // namespace thicket
