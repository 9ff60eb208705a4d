#pragma once

#include "core/base/status.hpp"
#include "nodes/biome/scatter_biome_map.hpp"
#include "nodes/drawing/tile_display.hpp"
#include "nodes/ground/scatter_ground.hpp"
#include "nodes/layer/scatter_layer.hpp"
#include "nodes/scatter/scatter_viewers.hpp"

#include <godot_cpp/classes/node3d.hpp>
#include <godot_cpp/variant/packed_string_array.hpp>
#include <godot_cpp/variant/typed_array.hpp>

#include <glm/vec3.hpp>

#include <span>

namespace thicket {

/// Returns a message that explains why a ground cannot be used; empty if it can. Null is reported
/// as a missing ground.
godot::String problem_of_ground(const godot::Ref<ScatterGround> &p_ground);

/// These functions add a message for each problem with a node's ground or layers. `p_layers` must
/// be in order of priority. `has_water` is true if the node or a biome has water. `p_biomes` may be
/// null.
void add_ground_problems(const godot::Ref<ScatterGround> &p_ground, godot::PackedStringArray &r_problems);
void add_layer_problems(const godot::TypedArray<ScatterLayer> &p_layers, const godot::Ref<ScatterGround> &p_ground,
		bool has_water, const ScatterBiomeMap *p_biomes, godot::PackedStringArray &r_problems);

/// Returns true if the global transform of a node in the tree is not the identity, because
/// instances do not move with the node. `offset` is the world position of the engine's origin.
/// Accepts a translation by -`offset`, because a node that has moved with a recentered scene still
/// matches its instances.
bool is_displaced(const godot::Node3D &node, glm::dvec3 offset);
void add_transform_problem(const godot::Node3D &node, glm::dvec3 offset, godot::PackedStringArray &r_problems);

/// Adds the problems of a node with local coordinates: its scale and a ground that does not move
/// with it.
void add_local_problems(
		const godot::Node3D &node, const godot::Ref<ScatterGround> &p_ground, godot::PackedStringArray &r_problems);

/// Adds the problems that keep a node in the tree from streaming around its viewers. `viewer_status` is
/// the error of the first viewer that is out of range, if any.
void add_viewer_problems(const godot::Node3D &node, const ViewerSettings &viewers, const Status &viewer_status,
		godot::PackedStringArray &r_problems);

/// Adds a message if more multimeshes with instance uniforms are displayed than the Compatibility
/// renderer supports. The renderer prints an error for each additional one and draws it with the
/// default values of its shader.
void add_uniform_problem(
		const TileDisplay &display, std::span<const SharedSnapshot> layers, godot::PackedStringArray &r_problems);

/// Returns a message for each feature that does not work because an export has stripped its
/// resource. `biomes` may be null.
godot::PackedStringArray stripped_problems(const godot::TypedArray<ScatterLayer> &p_layers,
		const godot::Ref<ScatterGround> &p_ground, const ScatterBiomeMap *biomes);

} // namespace thicket
