#include "core/rules/prepared_range.hpp"

#include "core/base/floating_point.hpp"
#include "core/base/trigonometry.hpp"

#include <algorithm>
#include <cmath>

namespace thicket {

namespace {

/// Within this many degrees of a limit, the angle itself is computed. `slope_degrees` is accurate
/// to 1e-7 degrees.
constexpr double margin = 1e-5;
/// Limits for all surfaces are wider by this angle in degrees, because a mesh that is rotated by a
/// right angle is not exactly vertical.
constexpr double surface_tolerance = 1e-3;
/// Above this angle in degrees, the tangent is too inaccurate to decide.
constexpr double last_tangent = 89.9;
constexpr double unlimited = std::numeric_limits<double>::infinity();

double squared_tangent(double degrees) {
	const Rotation rotation = rotation_by(degrees / 360.0);
	const double tangent = rotation.sine / rotation.cosine;
	return tangent * tangent;
}

/// Returns a squared tangent. Slopes with at least this squared tangent are at least `degrees`
/// steep. The result is infinite if it is unknown.
double tangent_at_least(double degrees) {
	return degrees <= 0.0 ? 0.0 : degrees <= last_tangent ? squared_tangent(degrees) : unlimited;
}

/// Returns a squared tangent. Slopes with at most this squared tangent are at most `degrees` steep.
/// The result is negative if there are none.
double tangent_at_most(double degrees) {
	return degrees < 0.0 ? -1.0 : squared_tangent(std::min(degrees, last_tangent));
}

} // namespace

PreparedRange::PreparedRange(double min, bool has_no_min, double max, bool has_no_max, double falloff) :
		min_(min), max_(max), falloff_(falloff), has_no_min_(has_no_min), has_no_max_(has_no_max) {}

double PreparedRange::density(double value) const {
	const bool inside = (has_no_min_ || value >= min_) && (has_no_max_ || value <= max_);
	if (!inside || std::isnan(value)) {
		return 0.0;
	}
	if (falloff_ <= 0.0) {
		return 1.0;
	}
	const double above = has_no_min_ ? 1.0 : (value - min_) / falloff_;
	const double below = has_no_max_ ? 1.0 : (max_ - value) / falloff_;
	return std::min({above, below, 1.0});
}

SlopeRange::SlopeRange(double min, double max, double falloff, double steepest) :
		PreparedRange(steepest > steepest_top ? min - surface_tolerance : min, min <= 0.0,
				steepest > steepest_top ? max + surface_tolerance : max, max >= steepest, falloff),
		may_point_down_(steepest > steepest_top) {
	const double fading = std::max(falloff, 0.0) + margin;
	if (min > 0.0) {
		all_from_ = tangent_at_least(min + fading);
		none_below_ = min <= margin ? 0.0 : tangent_at_most(min - margin);
	}
	if (max < steepest_top) {
		all_to_ = tangent_at_most(max - fading);
		none_above_ = tangent_at_least(max + margin);
	}
}

} // namespace thicket
