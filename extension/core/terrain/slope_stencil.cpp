#include "core/terrain/slope_stencil.hpp"

#include "core/base/floating_point.hpp"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace thicket {

namespace {

/// Half of the distance over which a slope is measured, in meters.
constexpr double usual_step = 0.5;

double as_float(double value) { return static_cast<double>(static_cast<float>(value)); }

/// Returns the distance in meters from the center to its neighbors along an axis. Far from the
/// origin, the distance is at least four float steps, so that rounding changes it by at most an
/// eighth.
double step_at(double coordinate) {
	return std::max(usual_step, 4.0 * std::abs(coordinate) * std::numeric_limits<float>::epsilon());
}

/// Returns the slope at the middle of three heights in a line.
double rise(double before, double here, double behind, double run_before, double run_behind) {
	if (std::isfinite(before) && std::isfinite(behind)) {
		return (behind - before) / (run_before + run_behind);
	}
	if (std::isfinite(behind)) {
		return (behind - here) / run_behind;
	}
	return std::isfinite(before) ? (here - before) / run_before : 0.0;
}

} // namespace

SlopeStencil::SlopeStencil(glm::dvec2 position) : center_(as_float(position.x), as_float(position.y)) {
	const double step_x = step_at(center_.x);
	const double step_z = step_at(center_.y);
	positions_ = {
			glm::dvec2{as_float(center_.x - step_x), center_.y},
			glm::dvec2{as_float(center_.x + step_x), center_.y},
			glm::dvec2{center_.x, as_float(center_.y - step_z)},
			glm::dvec2{center_.x, as_float(center_.y + step_z)},
	};
}

glm::vec3 SlopeStencil::normal(float here, std::span<const float, 4> around) const {
	const double x = rise(around[0], here, around[1], center_.x - positions_[0].x, positions_[1].x - center_.x);
	const double z = rise(around[2], here, around[3], center_.y - positions_[2].y, positions_[3].y - center_.y);
	return glm::vec3(glm::normalize(glm::dvec3{-x, 1.0, -z}));
}

} // namespace thicket
