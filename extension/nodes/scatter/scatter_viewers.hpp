#pragma once

#include "core/streaming/tile_streamer.hpp"
#include "core/terrain/terrain.hpp"

#include <godot_cpp/classes/camera3d.hpp>
#include <godot_cpp/classes/node3d.hpp>
#include <godot_cpp/variant/node_path.hpp>
#include <godot_cpp/variant/packed_float32_array.hpp>
#include <godot_cpp/variant/string_name.hpp>
#include <godot_cpp/variant/typed_array.hpp>

#include <glm/vec3.hpp>

#include <cstdint>
#include <functional>
#include <vector>

namespace thicket {

/// The viewers that a node streams around.
struct ViewerSettings {
	godot::TypedArray<godot::NodePath> paths;  ///< Relative to the node; empty for active_cameras.
	godot::PackedFloat32Array distance_scales; ///< By the viewer's index; missing entries are 1.
};

/// The ground that orthogonal cameras look at.
struct ViewGround {
	const Terrain *terrain = nullptr; ///< Null for ground that would run a script.
	std::function<double()> level;    ///< World meters: the approximate height of the ground.
};

/// The current viewers, in the world.
struct FoundViewers {
	std::vector<Viewer> viewers;
	std::vector<glm::dvec3> places; ///< The position of each viewer; for an orthogonal camera, the point it looks at.
	std::vector<std::uint64_t> ids; ///< The object ID of each viewer in the engine.
};

/// Finds the viewers of `node`, which is in the tree. `offset` is the world position of the engine's origin. Leaves out
/// viewers that are not in the tree, and viewers whose x or z is not finite.
///
/// An orthogonal camera shows objects in the same size at any distance. So its viewer is placed above the point that
/// the camera looks at, at the height from which a perspective camera would show objects in that size.
FoundViewers find_viewers(
		const godot::Node3D &node, const ViewerSettings &settings, glm::dvec3 offset, const ViewGround &ground);

/// Whether a node in the tree may be a viewer: its x and z are finite.
bool has_place(const godot::Node3D &viewer);

/// The camera of the viewport; in the editor, the camera of each visible 3D viewport. A node without `paths` uses these
/// as viewers.
std::vector<godot::Camera3D *> active_cameras(const godot::Node3D &node);

/// The world positions around which bodies and scenes are placed: the viewers, and all Node3Ds of a group (empty for no
/// group).
std::vector<glm::dvec3> find_near_centers(
		const godot::Node3D &node, const FoundViewers &viewers, const godot::StringName &p_group, glm::dvec3 offset);

} // namespace thicket
