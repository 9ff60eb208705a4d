#pragma once

#include "core/base/floating_point.hpp"
#include "core/base/trigonometry.hpp"

#include <glm/vec3.hpp>

#include <limits>
#include <optional>

namespace thicket {

/// One range with its falloff, prepared for queries.
class PreparedRange {
public:
	PreparedRange() = default; ///< No limits.

	/// `min_open` and `max_open` disable a limit along with its falloff.
	PreparedRange(double min, bool min_open, double max, bool max_open, double falloff);

	/// The density for a value, 0 to 1; 0 for NAN.
	double density(double value) const;

	/// Whether every finite value passes.
	bool open() const { return min_open_ && max_open_; }

private:
	double min_ = 0.0;
	double max_ = 0.0;
	double falloff_ = 0.0;
	bool min_open_ = true;
	bool max_open_ = true;
};

/// A range of slopes in degrees. Computing an angle costs as much as all other queries of the ground, so it is skipped where the sides of
/// its triangle suffice to decide.
class SlopeRange : public PreparedRange {
public:
	static constexpr double steepest = 90.0;

	SlopeRange() = default; ///< No limits.

	/// Slopes from `min` to `max`, 0 to 90 degrees. A limit at its end of this range has no effect.
	SlopeRange(double min, double max, double falloff);

	/// The density for the slope of an upward normal, bit-identical to density(slope_degrees(normal)).
	double density_of(glm::vec3 normal) const {
		const std::optional<double> known = density_without_angle(normal);
		return known.has_value() ? *known : density(slope_degrees(normal));
	}

	/// The density, if it can be decided without the angle.
	std::optional<double> density_without_angle(glm::vec3 normal) const {
		const double x = normal.x;
		const double y = normal.y;
		const double z = normal.z;
		const double across = x * x + z * z;
		const double up = y * y;
		if (across >= all_from_ * up && across <= all_to_ * up) {
			// The angle lies between the limits by more than any rounding error.
			return 1.0;
		}
		if (across < none_below_ * up || across > none_above_ * up) {
			// The angle lies beyond a limit by more than any rounding error.
			return 0.0;
		}
		return std::nullopt;
	}

private:
	// Squares of tangents, with a margin wider than any rounding error. Between the first two the density is 1, beyond the other two it
	// is 0.
	double all_from_ = 0.0;
	double all_to_ = std::numeric_limits<double>::infinity();
	double none_below_ = 0.0;
	double none_above_ = std::numeric_limits<double>::infinity();
};

} // namespace thicket
