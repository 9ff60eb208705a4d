#pragma once

#include "core/base/floating_point.hpp"
#include "core/base/trigonometry.hpp"

#include <glm/vec3.hpp>

#include <limits>
#include <optional>

namespace thicket {

/// A range of values with a linear falloff inside its limits, prepared for queries.
class PreparedRange {
public:
	PreparedRange() = default; ///< Creates a range without limits.

	/// Creates a range. `has_no_min` and `has_no_max` disable a limit along with its falloff.
	PreparedRange(double min, bool has_no_min, double max, bool has_no_max, double falloff);

	/// Returns the density for `value`, 0 to 1, or 0 for NAN.
	double density(double value) const;

	/// Returns true if both limits are disabled, so that every finite value has density 1.
	bool is_unlimited() const { return has_no_min_ && has_no_max_; }

private:
	double min_ = 0.0;
	double max_ = 0.0;
	double falloff_ = 0.0;
	bool has_no_min_ = true;
	bool has_no_max_ = true;
};

/// A range of slopes in degrees. Computing an angle costs as much as all other ground rules
/// together, so it is skipped where the tangent alone decides.
class SlopeRange : public PreparedRange {
public:
	static constexpr double steepest_top = 90.0;      ///< Steepest ground that is seen from above.
	static constexpr double steepest_surface = 180.0; ///< Steepest surface: a ceiling.

	SlopeRange() = default; ///< Creates a range without limits.

	/// Creates a range of slopes from `min` to `max`, each 0 to `steepest` degrees. A minimum of 0
	/// and a maximum of `steepest` have no effect. With steepest_top, all normals must point up.
	/// With steepest_surface, normals may point anywhere, and limits are a thousandth of a degree
	/// wider.
	SlopeRange(double min, double max, double falloff, double steepest = steepest_top);

	/// Returns the density for the slope of a normal, bit-identical to
	/// density(slope_degrees(normal)).
	double density_of(glm::vec3 normal) const {
		const std::optional<double> known = may_point_down_ ? std::nullopt : density_without_angle(normal);
		return known.has_value() ? *known : density(slope_degrees(normal));
	}

	/// Returns the density for a normal that points up, if it can be determined without computing
	/// the angle.
	std::optional<double> density_without_angle(glm::vec3 normal) const {
		const double x = normal.x;
		const double y = normal.y;
		const double z = normal.z;
		const double horizontal = x * x + z * z;
		const double up = y * y;
		if (horizontal >= all_from_ * up && horizontal <= all_to_ * up) {
			// The angle is inside the limits by more than any rounding error.
			return 1.0;
		}
		if (horizontal < none_below_ * up || horizontal > none_above_ * up) {
			// The angle is outside a limit by more than any rounding error.
			return 0.0;
		}
		return std::nullopt;
	}

private:
	// Squared tangents, with a margin wider than any rounding error. The density is 1 from
	// `all_from_` to `all_to_`, and 0 below `none_below_` and above `none_above_`.
	double all_from_ = 0.0;
	double all_to_ = std::numeric_limits<double>::infinity();
	double none_below_ = 0.0;
	double none_above_ = std::numeric_limits<double>::infinity();
	bool may_point_down_ = false; ///< True if normals may point down, so that tangents are ambiguous.
};

} // namespace thicket
