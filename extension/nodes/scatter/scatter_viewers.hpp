#pragma once

#include "core/streaming/tile_streamer.hpp"

#include <godot_cpp/classes/node3d.hpp>
#include <godot_cpp/variant/node_path.hpp>
#include <godot_cpp/variant/packed_float32_array.hpp>
#include <godot_cpp/variant/string_name.hpp>
#include <godot_cpp/variant/typed_array.hpp>

#include <glm/vec3.hpp>

#include <span>
#include <vector>

namespace thicket {

/// Whom a node streams around.
struct ViewerSettings {
	godot::TypedArray<godot::NodePath>
			paths; ///< From the node; none for the active camera, in the editor the editor's own.
	godot::PackedFloat32Array distance_scales; ///< By the viewer's index; 1 where there is none.
};

/// The viewers as they stand now, in the world. `node` is in the tree, and `offset` where the engine's origin is in the world.
/// Those that are not in the tree, and those whose x or z is not finite, are left out.
std::vector<Viewer> find_viewers(const godot::Node3D &node, const ViewerSettings &settings, glm::dvec3 offset);

/// Whether a node in the tree may be a viewer: its x and z are finite.
bool has_place(const godot::Node3D &viewer);

/// Whether there is a camera for a node without `paths` to stream around.
bool has_camera(const godot::Node3D &node);

/// The world positions around which bodies and scenes stand: those of the viewers, and of all Node3Ds of a group (empty for none).
std::vector<glm::dvec3> find_near_centers(const godot::Node3D &node, std::span<const Viewer> viewers,
		const godot::StringName &p_group, glm::dvec3 offset);

} // namespace thicket
