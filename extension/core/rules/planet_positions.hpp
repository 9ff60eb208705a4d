#pragma once

#include "core/base/check.hpp"
#include "core/base/planet.hpp"
#include "core/base/status.hpp"
#include "core/rules/density_field.hpp"

#include <glm/vec3.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace thicket {

// Limits of a planet's radius in meters, for scripts that pass one.
inline constexpr double min_planet_radius = 1e-3;
inline constexpr double max_planet_radius = 1e6;

/// Returns true if the direction of a position from a planet's center can be computed: all components
/// are finite and their squares do not overflow.
inline bool has_direction(const glm::dvec3 &from_center) {
	return std::isfinite(from_center.x * from_center.x + from_center.y * from_center.y + from_center.z * from_center.z);
}

/// Returns an error unless a planet has a valid radius and a position is in some direction from its
/// center. The properties in the error are "planet_radius" and "from_center".
inline Status check_direction(double planet_radius, const glm::dvec3 &from_center) {
	const double length = std::abs(from_center.x) + std::abs(from_center.y) + std::abs(from_center.z);
	if (!std::isfinite(length)) {
		return {ErrorCode::not_finite, "from_center", length};
	}
	return first_failure(check_range("planet_radius", planet_radius, min_planet_radius, max_planet_radius),
			check_positive("from_center", length));
}

/// Returns a position of a batch relative to the center of a planet, in meters. Positions without a
/// height are on the planet's sphere as seen from above or, beside it, at the height of its center.
inline glm::dvec3 from_planet_center(const Planet &planet, const PositionBatch &batch, std::size_t i) {
	if (batch.in_space()) {
		return batch.in_space(i) - planet.center;
	}
	const glm::dvec2 from = batch.positions[i] - glm::dvec2(planet.center.x, planet.center.z);
	const double squared = planet.radius * planet.radius - (from.x * from.x + from.y * from.y);
	return {from.x, std::sqrt(std::max(squared, 0.0)), from.y};
}

} // namespace thicket
