#pragma once

#include "core/base/status.hpp"
#include "nodes/biome/scatter_biome_map.hpp"
#include "nodes/layer/scatter_layer.hpp"
#include "nodes/scatter/scatter_viewers.hpp"
#include "nodes/scatter/tile_display.hpp"
#include "nodes/ground/scatter_ground.hpp"

#include <godot_cpp/classes/node3d.hpp>
#include <godot_cpp/variant/packed_string_array.hpp>
#include <godot_cpp/variant/typed_array.hpp>

#include <glm/vec3.hpp>

#include <span>

namespace thicket {

/// Adds what keeps a node's terrain and layers from showing what they should, a sentence each. The layers are in the order in
/// which they give way to each other; `has_water` says whether there is any water.
void add_ground_problems(const godot::Ref<ScatterGround> &p_terrain, godot::PackedStringArray &r_problems);
void add_layer_problems(const godot::TypedArray<ScatterLayer> &p_layers, const godot::Ref<ScatterGround> &p_terrain,
		bool has_water, godot::PackedStringArray &r_problems);

/// Whether a node in the tree is moved, turned or scaled, by itself or by its parents, where its instances are not. A node that has
/// moved against `offset`, where the engine's origin is in the world, is where its instances are.
bool is_displaced(const godot::Node3D &node, glm::dvec3 offset);
void add_transform_problem(const godot::Node3D &node, glm::dvec3 offset, godot::PackedStringArray &r_problems);

/// What keeps a node in the tree from streaming around its viewers. `refused` is the error of one that is out of reach.
void add_viewer_problems(const godot::Node3D &node, const ViewerSettings &viewers, const Status &refused,
		godot::PackedStringArray &r_problems);

/// The Compatibility renderer prints an error for each multimesh with instance uniforms beyond its limit, and draws it with the defaults of its
/// shader: adds a sentence if more are displayed.
void add_uniform_problem(
		const TileDisplay &display, std::span<const SharedSnapshot> layers, godot::PackedStringArray &r_problems);

/// What cannot work because an export has stripped it, a sentence each. `biomes` may be null.
godot::PackedStringArray stripped_problems(const godot::TypedArray<ScatterLayer> &p_layers,
		const godot::Ref<ScatterGround> &p_terrain, const ScatterBiomeMap *biomes);

} // namespace thicket
