#include "core/rules/planet_map.hpp"

#include "core/base/tangent_axes.hpp"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>

namespace thicket {

namespace {

/// Minimum denominator of the projection. Directions below it are nearly opposite the middle, and
/// have no exact map position.
constexpr double min_denominator = 1e-6;

} // namespace

PlanetMap::PlanetMap(const Planet &planet, const glm::dvec3 &middle) :
		planet_(planet), distance_(glm::length(middle - planet.center)) {
	const glm::dvec3 up = planet.up_at(middle);
	const TangentAxes tangent = tangent_axes(up);
	axes_ = {tangent.along, up, tangent.across};
}

glm::dvec2 PlanetMap::at(const glm::dvec3 &position) const {
	const glm::dvec3 up = planet_.up_at(position);
	const double denominator = 1.0 + glm::dot(up, axes_[1]);
	if (!(denominator > min_denominator)) {
		return {2.0 * radii_across * planet_.radius, 0.0}; // An arbitrary position outside the map.
	}
	return 2.0 * planet_.radius / denominator * glm::dvec2(glm::dot(up, axes_[0]), glm::dot(up, axes_[2]));
}

glm::dvec3 PlanetMap::direction(glm::dvec2 map_position) const {
	const glm::dvec2 tangent = map_position / (2.0 * planet_.radius); // The tangent of half the angle from the middle.
	const double squared = tangent.x * tangent.x + tangent.y * tangent.y;
	return (2.0 * (tangent.x * axes_[0] + tangent.y * axes_[2]) + (1.0 - squared) * axes_[1]) / (1.0 + squared);
}

double PlanetMap::scale(glm::dvec2 map_position) const {
	return 1.0 +
			(map_position.x * map_position.x + map_position.y * map_position.y) /
			(4.0 * planet_.radius * planet_.radius);
}

bool PlanetMap::contains(glm::dvec2 map_position) const {
	const double farthest = radii_across * planet_.radius;
	return map_position.x * map_position.x + map_position.y * map_position.y <= farthest * farthest;
}

glm::dvec3 PlanetMap::at_middle(const glm::dvec3 &position) const {
	const glm::dvec3 up = planet_.up_at(position);
	return distance_ * glm::dvec3(glm::dot(up, axes_[0]), glm::dot(up, axes_[1]), glm::dot(up, axes_[2]));
}

glm::dvec3 PlanetMap::direction_at_middle(glm::dvec2 place) const {
	const double length = std::max(distance_, std::sqrt(place.x * place.x + place.y * place.y));
	const glm::dvec2 sine = place / length;
	const double cosine = std::sqrt(std::max(0.0, 1.0 - (sine.x * sine.x + sine.y * sine.y)));
	return sine.x * axes_[0] + cosine * axes_[1] + sine.y * axes_[2];
}

} // namespace thicket
