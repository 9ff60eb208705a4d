#pragma once

#include "core/base/status.hpp"
#include "nodes/biome/scatter_biome_map.hpp"
#include "nodes/layer/scatter_layer.hpp"
#include "nodes/scatter/scatter_viewers.hpp"
#include "nodes/drawing/tile_display.hpp"
#include "nodes/ground/scatter_ground.hpp"

#include <godot_cpp/classes/node3d.hpp>
#include <godot_cpp/variant/packed_string_array.hpp>
#include <godot_cpp/variant/typed_array.hpp>

#include <glm/vec3.hpp>

#include <span>

namespace thicket {

/// Adds one sentence for each problem that keeps a node's ground and layers from being displayed as they should. The
/// layers are in order of priority. `has_water` is true if there is any water.
void add_ground_problems(const godot::Ref<ScatterGround> &p_terrain, godot::PackedStringArray &r_problems);
void add_layer_problems(const godot::TypedArray<ScatterLayer> &p_layers, const godot::Ref<ScatterGround> &p_terrain,
		bool has_water, godot::PackedStringArray &r_problems);

/// True if a node in the tree is moved, turned or scaled, by its own transform or by a parent's. Its instances do not
/// follow. A node that has moved by the opposite of `offset`, the world position of the engine's origin, still matches
/// its instances.
bool is_displaced(const godot::Node3D &node, glm::dvec3 offset);
void add_transform_problem(const godot::Node3D &node, glm::dvec3 offset, godot::PackedStringArray &r_problems);

/// Adds the problems that keep a node in the tree from streaming around its viewers. `refused` is the error of a viewer that is out of
/// range.
void add_viewer_problems(const godot::Node3D &node, const ViewerSettings &viewers, const Status &refused,
		godot::PackedStringArray &r_problems);

/// Adds a sentence if more multimeshes with instance uniforms are displayed than the Compatibility renderer supports.
/// For each one beyond its limit, the renderer prints an error and draws it with the defaults of its shader.
void add_uniform_problem(
		const TileDisplay &display, std::span<const SharedSnapshot> layers, godot::PackedStringArray &r_problems);

/// One sentence for each feature that cannot work because an export has stripped its resource. `biomes` may be null.
godot::PackedStringArray stripped_problems(const godot::TypedArray<ScatterLayer> &p_layers,
		const godot::Ref<ScatterGround> &p_terrain, const ScatterBiomeMap *biomes);

} // namespace thicket
