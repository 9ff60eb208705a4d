#pragma once

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include <cmath>

namespace thicket {

/// Two unit vectors that span the plane across a direction.
struct TangentAxes {
	glm::dvec3 along;
	glm::dvec3 across;
};

/// Returns axes across the unit vector `up`, so that `along`, `up` and `across` are right-handed. If
/// `up` is the world's y axis, they are the world's x and z axes.
inline TangentAxes tangent_axes(const glm::dvec3 &up) {
	const glm::dvec3 start = std::abs(up.x) < 0.9 ? glm::dvec3(1.0, 0.0, 0.0) : glm::dvec3(0.0, 0.0, 1.0);
	const glm::dvec3 along = glm::normalize(start - up * glm::dot(up, start));
	return {along, glm::cross(along, up)};
}

} // namespace thicket
