#pragma once

#include "nodes/layer/scatter_layer.hpp"
#include "nodes/terrain/scatter_terrain.hpp"

#include <godot_cpp/variant/packed_string_array.hpp>
#include <godot_cpp/variant/typed_array.hpp>

namespace thicket {

/// Adds what keeps a node's terrain and layers from showing what they should, a sentence each. The layers are in the order in
/// which they give way to each other; `has_water` says whether there is any water.
void add_terrain_problems(const godot::Ref<ScatterTerrain> &p_terrain, godot::PackedStringArray &r_problems);
void add_layer_problems(const godot::TypedArray<ScatterLayer> &p_layers, const godot::Ref<ScatterTerrain> &p_terrain,
		bool has_water, godot::PackedStringArray &r_problems);

} // namespace thicket
