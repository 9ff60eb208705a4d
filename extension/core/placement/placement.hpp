#pragma once

#include "core/base/status.hpp"

#include <glm/vec3.hpp>

#include <cstddef>
#include <cstdint>
#include <span>

namespace thicket {

/// Floats an instance in a buffer: a 3 x 4 matrix, row by row, the last column the position; what Godot's
/// RenderingServer.multimesh_set_buffer takes for TRANSFORM_3D without colours and custom data.
inline constexpr std::size_t floats_per_instance = 12;

/// How an instance stands on its point. Random parts come from the instance's id and the seed, each from a word of its
/// own, so that changing one setting leaves all others as they were.
struct Placement {
	double min_yaw_degrees = 0.0; ///< Rotation about the instance's own up axis, uniform in [min, max]; -360 to 360.
	double max_yaw_degrees = 360.0;
	double min_scale =
			1.0; ///< Uniform in [min, max], the same on all axes; min_placement_scale to max_placement_scale.
	double max_scale = 1.0;
	double align_to_normal = 0.0; ///< 0 stands upright, 1 along the normal, in between by the normalised mean; 0 to 1.
	double height_offset = 0.0;   ///< Metres along world y, negative sinks into the ground; |offset| <= 1e4.

	friend bool operator==(const Placement &, const Placement &) = default;
};

inline constexpr double min_placement_scale = 1e-4;
inline constexpr double max_placement_scale = 1e4;
inline constexpr double max_height_offset = 1e4;

/// Refuses what is not finite, outside the ranges above, or a minimum above its maximum.
Status validate(const Placement &placement);

/// Writes the transform of an instance: yaw about its own up axis, then the tilt, by the shortest way, and the scale;
/// `position` as it is. The basis is orthogonal with columns of length scale, and no mirror image, to a float's
/// rounding. `normal` must be finite and point up (y > 0). Returns the scale. `placement` must be valid.
float write_transform(const Placement &placement, std::uint64_t seed, std::uint64_t id, glm::vec3 normal,
		glm::vec3 position, std::span<float, floats_per_instance> r_transform);

} // namespace thicket
