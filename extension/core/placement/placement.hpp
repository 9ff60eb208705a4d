#pragma once

#include "core/base/status.hpp"
#include "core/rules/curve_table.hpp"

#include <glm/vec3.hpp>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

namespace thicket {

/// The number of floats of an instance's transform: a 3 x 4 matrix, row by row, with the position in the last column. This is the layout of
/// Godot's RenderingServer.multimesh_set_buffer for TRANSFORM_3D. See InstanceData for the data that may follow it.
inline constexpr std::size_t transform_floats = 12;

/// How an instance is placed on its point. Random parts come from the instance's id and the seed. Each uses its own random word, so
/// changing one setting leaves all others unchanged.
struct Placement {
	double min_yaw_degrees = 0.0; ///< Rotation about the instance's own up axis, uniform in [min, max]; -360 to 360.
	double max_yaw_degrees = 360.0;
	/// Uniform in [min, max], the same on all axes; min_placement_scale to max_placement_scale.
	double min_scale = 1.0;
	double max_scale = 1.0;
	double align_to_normal = 0.0; ///< 0 is upright, 1 follows the normal, in between the normalized mean; 0 to 1.
	double height_offset = 0.0;   ///< Meters along world y, negative sinks it into the ground; |offset| <= 1e4.

	/// The angle in degrees by which the instance leans away from its own up axis (see align_to_normal), uniform in
	/// [min, max], in a random direction; 0 to 90.
	double min_tilt_degrees = 0.0;
	double max_tilt_degrees = 0.0;

	/// The distance in meters that the instance is moved along the normal of the ground, regardless of align_to_normal
	/// and the tilt. Negative values sink it into the ground; |offset| <= 1e4. On a slope this also moves the instance
	/// sideways, off its point.
	double offset_along_normal = 0.0;

	/// Maps the uniform random number, 0 to 1, to the share of the way from min_scale to max_scale. Null means a
	/// straight line: all scales are equally likely. Two placements are equal only if they share the same curve.
	std::shared_ptr<const CurveTable> scale_curve{};

	friend bool operator==(const Placement &, const Placement &) = default;
};

inline constexpr double min_placement_scale = 1e-4;
inline constexpr double max_placement_scale = 1e4;
inline constexpr double max_height_offset = 1e4; ///< Also for offset_along_normal.

/// Refuses values that are not finite or outside the ranges above, and a minimum above its maximum.
Status validate(const Placement &placement);

/// Writes an instance's transform except for the position. Applies the yaw about the instance's own up axis, then the
/// tilt away from this axis and the alignment to the ground, both by the shortest rotation, and the scale. Up to a
/// float's rounding, the basis is orthogonal, its columns have the length of the scale, and it is not a mirror image.
/// `normal` must be finite and point up (y > 0). Returns the scale. `placement` must be valid.
float write_basis(const Placement &placement, std::uint64_t seed, std::uint64_t id, glm::vec3 normal,
		std::span<float, transform_floats> r_transform);

/// Writes only the position of an instance.
inline void write_position(glm::vec3 position, std::span<float, transform_floats> r_transform) {
	r_transform[3] = position.x;
	r_transform[7] = position.y;
	r_transform[11] = position.z;
}

/// `position`, moved by `offset` meters along a normal that points up.
glm::vec3 moved_along(glm::vec3 normal, double offset, glm::vec3 position);

/// `position` plus the placement's offset along the normal.
inline glm::vec3 standing_position(const Placement &placement, glm::vec3 normal, glm::vec3 position) {
	const double offset = placement.offset_along_normal;
	if (offset == 0.0) {
		// The position is unchanged, whatever the normal.
		return position;
	}
	return moved_along(normal, offset, position);
}

} // namespace thicket
