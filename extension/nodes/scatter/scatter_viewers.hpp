#pragma once

#include "core/base/world_frame.hpp"
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

/// The node's settings for viewers.
struct ViewerSettings {
	/// The paths of the viewers, relative to the node. Empty for active_cameras.
	godot::TypedArray<godot::NodePath> paths;
	godot::PackedFloat32Array distance_scales; ///< The distance scales by viewer index. Missing entries are 1.
};

/// The ground at which orthogonal cameras are aimed.
struct ViewGround {
	const Terrain *terrain = nullptr; ///< The ground; null if sampling it would run a script.
	/// The approximate ground height in world meters. Used if `terrain` is null.
	std::function<double()> level;
};

/// The current viewers in world space.
struct CurrentViewers {
	std::vector<Viewer> viewers;
	/// The position of each viewer; for an orthogonal camera, the point at which it is aimed.
	std::vector<glm::dvec3> positions;
	std::vector<std::uint64_t> ids; ///< The instance ID of each viewer.
};

/// Finds the viewers of `node`, which must be in the tree. `frame` is the world position of the
/// engine's origin in meters. Skips viewers that are not in the tree or whose x or z is not finite.
///
/// An orthogonal camera shows objects at the same size regardless of distance. Its viewer is
/// therefore placed above the point at which the camera is aimed. A perspective camera at that
/// height would show objects at the same size.
CurrentViewers find_viewers(
		const godot::Node3D &node, const ViewerSettings &settings, const WorldFrame &frame, const ViewGround &ground);

/// Returns true if a node in the tree can be a viewer, because its global x and z are finite.
bool has_position(const godot::Node3D &viewer);

/// Returns the viewers of a node without `paths`. In a game, this is the current camera of the
/// node's viewport; in the editor, the camera of each visible 3D viewport.
std::vector<godot::Camera3D *> active_cameras(const godot::Node3D &node);

/// The world positions around which bodies and scenes are created: the viewers, and all Node3Ds in
/// `p_group` unless its name is empty.
std::vector<glm::dvec3> find_near_centers(const godot::Node3D &node, const CurrentViewers &viewers,
		const godot::StringName &p_group, const WorldFrame &frame);

} // namespace thicket
