#pragma once

#include "core/terrain/surface.hpp"

#include <glm/vec3.hpp>

namespace thicket {

/// A position on a surface.
struct SurfacePosition {
	glm::dvec3 position;
	glm::dvec3 normal; ///< The unit normal on the front of the triangle.
};

/// Returns the position on a surface that is nearest to `position`. If no surface is within
/// `distance` meters, or `position` is not finite, the position is NAN. Throws std::bad_alloc.
SurfacePosition nearest_position(const Surface &surface, const glm::dvec3 &position, double distance);

} // namespace thicket
