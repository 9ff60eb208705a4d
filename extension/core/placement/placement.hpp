#pragma once

#include "core/base/status.hpp"
#include "core/rules/curve_table.hpp"

#include <glm/vec3.hpp>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

namespace thicket {

/// Floats of an instance's transform: a 3 x 4 matrix, row by row, the last column the position; what Godot's
/// RenderingServer.multimesh_set_buffer takes for TRANSFORM_3D. See InstanceData for what may follow it.
inline constexpr std::size_t transform_floats = 12;

/// How an instance stands on its point. Random parts come from the instance's id and the seed, each from a word of its
/// own, so that changing one setting leaves all others as they were.
struct Placement {
	double min_yaw_degrees = 0.0; ///< Rotation about the instance's own up axis, uniform in [min, max]; -360 to 360.
	double max_yaw_degrees = 360.0;
	double min_scale =
			1.0; ///< Uniform in [min, max], the same on all axes; min_placement_scale to max_placement_scale.
	double max_scale = 1.0;
	double align_to_normal = 0.0; ///< 0 stands upright, 1 along the normal, in between by the normalized mean; 0 to 1.
	double height_offset = 0.0;   ///< Meters along world y, negative sinks into the ground; |offset| <= 1e4.

	/// Degrees by which the instance leans away from its own up axis (see align_to_normal), uniform in [min, max], in a
	/// direction of its own; 0 to 90.
	double min_tilt_degrees = 0.0;
	double max_tilt_degrees = 0.0;

	/// Meters along the normal of the ground, whatever align_to_normal and the tilt make of the instance itself; negative
	/// sinks into the ground; |offset| <= 1e4. On a slope this moves the instance sideways too, off its point.
	double offset_along_normal = 0.0;

	/// Maps the uniform random number, 0 to 1, to the share of the way from min_scale to max_scale. Null: the straight line, all
	/// scales as likely as each other. Two placements are equal only if they share the curve itself.
	std::shared_ptr<const CurveTable> scale_curve{};

	friend bool operator==(const Placement &, const Placement &) = default;
};

inline constexpr double min_placement_scale = 1e-4;
inline constexpr double max_placement_scale = 1e4;
inline constexpr double max_height_offset = 1e4; ///< Of offset_along_normal too.

/// Refuses what is not finite, outside the ranges above, or a minimum above its maximum.
Status validate(const Placement &placement);

/// Writes all of an instance's transform but the position, as `write_transform` does. Returns the scale.
float write_basis(const Placement &placement, std::uint64_t seed, std::uint64_t id, glm::vec3 normal,
		std::span<float, transform_floats> r_transform);

/// Writes the position of an instance, nothing else.
inline void write_position(glm::vec3 position, std::span<float, transform_floats> r_transform) {
	r_transform[3] = position.x;
	r_transform[7] = position.y;
	r_transform[11] = position.z;
}

/// `position`, `offset` meters along a normal that points up.
glm::vec3 moved_along(glm::vec3 normal, double offset, glm::vec3 position);

/// `position` with the placement's offset along the normal added to it.
inline glm::vec3 standing_position(const Placement &placement, glm::vec3 normal, glm::vec3 position) {
	const double offset = placement.offset_along_normal;
	if (offset == 0.0) {
		// Fast path: whatever the normal, the position stays.
		return position;
	}
	return moved_along(normal, offset, position);
}

/// Writes the transform of an instance: yaw about its own up axis, then the tilt away from it, then the alignment to
/// the ground, both by the shortest way, and the scale; `position` with the offset along the normal added to it. The
/// basis is orthogonal with columns of length scale, and no mirror image, to a float's rounding. `normal` must be
/// finite and point up (y > 0). Returns the scale. `placement` must be valid.
float write_transform(const Placement &placement, std::uint64_t seed, std::uint64_t id, glm::vec3 normal,
		glm::vec3 position, std::span<float, transform_floats> r_transform);

} // namespace thicket
