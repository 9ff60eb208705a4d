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

/// Whom a node streams around.
struct ViewerSettings {
	godot::TypedArray<godot::NodePath> paths;  ///< From the node; none for active_cameras.
	godot::PackedFloat32Array distance_scales; ///< By the viewer's index; 1 where there is none.
};

/// The ground that orthogonal cameras look at.
struct ViewGround {
	const Terrain *terrain = nullptr; ///< Null for ground that would run a script.
	std::function<double()> level;    ///< World meters: about how high the ground is.
};

/// The viewers as they stand now, in the world.
struct FoundViewers {
	std::vector<Viewer> viewers;
	std::vector<glm::dvec3> places; ///< Where each of them is; for an orthogonal camera, what it looks at.
	std::vector<std::uint64_t> ids; ///< Of each of them, as an object of the engine.
};

/// `node` is in the tree, and `offset` where the engine's origin is in the world. Those that are not in the tree, and those whose x or z
/// is not finite, are left out.
///
/// An orthogonal camera shows what it looks at in the same size from anywhere. So its viewer is above that, as high as a perspective camera
/// that shows it in that size.
FoundViewers find_viewers(
		const godot::Node3D &node, const ViewerSettings &settings, glm::dvec3 offset, const ViewGround &ground);

/// Whether a node in the tree may be a viewer: its x and z are finite.
bool has_place(const godot::Node3D &viewer);

/// The camera of the viewport, in the editor that of each 3D viewport that is visible: the viewers of a node without `paths`.
std::vector<godot::Camera3D *> active_cameras(const godot::Node3D &node);

/// The world positions around which bodies and scenes stand: those of the viewers, and of all Node3Ds of a group (empty for none).
std::vector<glm::dvec3> find_near_centers(
		const godot::Node3D &node, const FoundViewers &viewers, const godot::StringName &p_group, glm::dvec3 offset);

} // namespace thicket
