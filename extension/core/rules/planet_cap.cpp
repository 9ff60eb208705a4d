#include "core/rules/planet_cap.hpp"

#include "core/base/floating_point.hpp"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace thicket {

namespace {

/// Margin for rounding, as a fraction of the planet's radius.
constexpr double rounding = 1e-9;

/// Returns the largest cosine between a direction and the directions of a cap. `along` is the cosine
/// between the direction and the middle of the cap.
double largest_cosine(double along, double sine, double cosine) {
	if (along >= cosine) {
		// The cap contains the direction.
		return 1.0;
	}
	return along * cosine + std::sqrt(std::max(0.0, 1.0 - along * along)) * sine;
}

} // namespace

PlanetCap cap_within(const glm::dvec3 &middle, double distance) {
	const double squared = distance * distance;
	// Beyond a quarter turn, the sine decreases again.
	return {middle, squared < 2.0 ? distance * std::sqrt(1.0 - 0.25 * squared) : 1.0};
}

PlanetCap cap_around(const Planet &planet, const TileSpace &space) {
	const glm::dvec3 min = glm::dvec3(space.min.x, space.bottom, space.min.y) - planet.center;
	const glm::dvec3 max = glm::dvec3(space.max.x, space.top, space.max.y) - planet.center;
	const glm::dvec3 middle = 0.5 * (min + max);
	const double distance = glm::length(middle);
	const double reach = glm::length(0.5 * (max - min));
	if (!(reach < distance)) { // This includes tiles that cover all heights.
		return {};
	}
	return {middle / distance, reach / distance + rounding};
}

Rect shadow_of(const Planet &planet, const PlanetCap &cap) {
	constexpr double infinity = std::numeric_limits<double>::infinity();
	if (cap.is_whole()) {
		return {glm::dvec2(-infinity), glm::dvec2(infinity)};
	}
	const double sine = cap.sine + rounding;
	const double cosine = std::sqrt(std::max(0.0, 1.0 - sine * sine));
	const double up = std::abs(cap.middle.y);
	// The smallest vertical component of a direction in the cap; 0 or less if the cap is partly level.
	const double rise = up * cosine - std::sqrt(std::max(0.0, 1.0 - up * up)) * sine - rounding;
	const auto reach = [&](double along) {
		const double part = largest_cosine(along, sine, cosine) + rounding;
		if (!(part > 0.0)) {
			return 0.0;
		}
		return rise > 0.0 ? Planet::radii_around * planet.radius * part / rise : infinity;
	};
	const glm::dvec2 center(planet.center.x, planet.center.z);
	const double margin = rounding * (planet.radius + std::max(std::abs(center.x), std::abs(center.y)));
	return {center - margin - glm::dvec2(reach(-cap.middle.x), reach(-cap.middle.z)),
			center + margin + glm::dvec2(reach(cap.middle.x), reach(cap.middle.z))};
}

} // namespace thicket
