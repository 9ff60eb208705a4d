#pragma once

#include "nodes/layer/layer_snapshot.hpp"

#include <godot_cpp/classes/material.hpp>
#include <godot_cpp/classes/ref.hpp>

#include <span>
#include <vector>

namespace thicket {

/// The materials that a layer is drawn with, each once, none of them null: its override, or those of all surfaces of its meshes, of
/// their LODs and of what casts their shadows.
std::vector<godot::Ref<godot::Material>> materials_of(const LayerDrawing &drawing);

/// True if the shader of one of these declares an instance uniform, or includes the add-on's scatter_scale.gdshaderinc.
bool use_instance_uniforms(std::span<const godot::Ref<godot::Material>> materials);

/// How far shaders with the uniforms of foliage.gdshaderinc may move a vertex, meters of the world, for the material that moves it
/// farthest: max(wind_sway, 0) * strength + max(wind_flutter, 0) * strength + max(bend_reach, 0), where the strength is 2 or the material's
/// own wind_strength, whichever is larger, because a ScatterFoliageWorld may set any up to 2 at any time. A parameter that is not set has the
/// shader's default. 0 for other materials, and without a renderer, which knows the defaults; max_cull_margin at most.
double sway_reach(std::span<const godot::Ref<godot::Material>> materials);
inline constexpr double max_cull_margin = 16384.0; ///< Meters.

} // namespace thicket
