#pragma once

#include "core/terrain/nearest_position.hpp"
#include "core/terrain/surface.hpp"

#include <glm/vec3.hpp>

#include <array>

namespace thicket {

/// Returns the distance from `from` along the unit vector `direction` to a triangle whose front faces
/// in this direction. It is negative if the triangle lies on the other side of `from`, and NAN if the
/// line misses the triangle or meets its back.
double distance_along(const std::array<glm::dvec3, 3> &corners, const glm::dvec3 &from, const glm::dvec3 &direction);

/// Returns the first position at which the line from `from` to `to` enters a surface through the front
/// of a triangle. The position is NAN if there is none, or if an end is not finite. Throws
/// std::bad_alloc.
SurfacePosition first_on_line(const Surface &surface, const glm::dvec3 &from, const glm::dvec3 &to);

} // namespace thicket
