#pragma once

#include "core/base/planet.hpp"
#include "core/base/status.hpp"
#include "core/base/trigonometry.hpp"
#include "core/rules/curve_table.hpp"

#include <glm/vec3.hpp>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>

namespace thicket {

/// The number of floats in an instance's transform: a 3 x 4 matrix in row-major order, with the
/// position in the last column. This is the layout of Godot's RenderingServer.multimesh_set_buffer
/// for TRANSFORM_3D. See InstanceData for the data that may follow.
inline constexpr std::size_t transform_floats = 12;

/// Determines the transform of an instance at its point. Random values depend only on the
/// instance's id and the seed. Each property uses its own random number, so changing one property
/// does not affect the other properties.
struct Placement {
	/// Rotation about the instance's up axis, uniform in [min, max]; -360 to 360.
	double min_yaw_degrees = 0.0;
	double max_yaw_degrees = 360.0;
	/// Scale, the same on all axes, uniform in [min, max]; min_placement_scale to
	/// max_placement_scale.
	double min_scale = 1.0;
	double max_scale = 1.0;
	/// Direction of the up axis, from 0 (upright) to 1 (along the ground's normal).
	double align_to_normal = 0.0;
	/// Meters upward; negative values sink the instance into the ground. |offset| <= 1e4.
	double height_offset = 0.0;

	/// Angle in degrees by which the instance is tilted away from its up axis (see align_to_normal)
	/// in a random direction, uniform in [min, max]; 0 to 90.
	double min_tilt_degrees = 0.0;
	double max_tilt_degrees = 0.0;

	/// Distance in meters by which the instance is moved along the ground's normal, independent of
	/// align_to_normal and the tilt. Negative values sink it into the ground. |offset| <= 1e4. On a
	/// slope, this also moves the instance sideways from its point.
	double offset_along_normal = 0.0;

	/// Maps the number that selects the scale to a fraction of the range from min_scale to
	/// max_scale. If null, the number is the fraction. Comparison is by address, not by content.
	std::shared_ptr<const CurveTable> scale_curve{};

	friend bool operator==(const Placement &, const Placement &) = default;
};

inline constexpr double min_placement_scale = 1e-4;
inline constexpr double max_placement_scale = 1e4;
/// Meters. This limit applies to height_offset and offset_along_normal.
inline constexpr double max_height_offset = 1e4;

/// Returns an error for values that are not finite or outside the ranges above, and for a minimum
/// above its maximum.
Status validate(const Placement &placement);

/// The up direction at positions relative to an origin: world y, or on a planet, the direction away
/// from its center.
struct UpField {
	bool away = false;           ///< True on a planet.
	glm::dvec3 from_center{0.0}; ///< On a planet, the origin relative to the planet's center.

	UpField() = default;
	UpField(const Planet &planet, const glm::dvec3 &origin) :
			away(planet.exists()), from_center(away ? origin - planet.center : glm::dvec3(0.0)) {}

	/// Returns the up direction, a unit vector, at a position relative to the origin. `away` must
	/// be true.
	glm::dvec3 at(const glm::vec3 &position) const { return Planet::up(from_center + glm::dvec3(position)); }
};

/// An instance hangs if the y component of its up axis is below this number: the axis is then more
/// than 120 degrees from straight up.
inline constexpr double overhang = -0.5;

/// If the squared length of the mean of two unit vectors is below this number, the vectors are
/// opposite, and their mean has no direction.
inline constexpr double no_direction = 1e-12;

/// Writes an instance's transform except for the position, and returns the scale. The function
/// applies the scale and the yaw, then the tilt and the alignment to the ground. Tilt and alignment
/// are the shortest rotations to their direction, except for an instance that hangs. Up to
/// rounding, the basis is a rotation with a uniform scale. `normal` must be of unit length, and
/// `placement` must be valid. On a planet, the position in `r_transform` must already be written.
/// The scale is selected by `scale_number` (see InstanceData::scale), or by a random number. `heading` is
/// an additional rotation about the up axis.
float write_basis(const Placement &placement, std::uint64_t seed, std::uint64_t id, glm::vec3 normal,
		std::span<float, transform_floats> r_transform, const UpField &up = {},
		std::optional<double> scale_number = std::nullopt, const std::optional<Rotation> &heading = std::nullopt);

/// Writes only the position of a transform.
inline void write_position(glm::vec3 position, std::span<float, transform_floats> r_transform) {
	r_transform[3] = position.x;
	r_transform[7] = position.y;
	r_transform[11] = position.z;
}

/// Returns the rotation that results from two rotations.
inline Rotation combined(const Rotation &a, const Rotation &b) {
	return {a.cosine * b.cosine - a.sine * b.sine, a.sine * b.cosine + a.cosine * b.sine};
}

/// Returns `position` moved by `offset` meters along `normal`.
glm::vec3 moved_along(glm::vec3 normal, double offset, glm::vec3 position);

/// Returns `position` moved by the placement's offset_along_normal.
inline glm::vec3 standing_position(const Placement &placement, glm::vec3 normal, glm::vec3 position) {
	const double offset = placement.offset_along_normal;
	if (offset == 0.0) {
		// Without an offset, the normal is not needed.
		return position;
	}
	return moved_along(normal, offset, position);
}

} // namespace thicket
