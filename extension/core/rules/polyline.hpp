#pragma once

#include <glm/vec2.hpp>

#include <span>
#include <vector>

namespace thicket {

/// Simplifies a polyline so that none of its points is farther than `tolerance` (meters, 0 or more)
/// from the result. The result is a subset of the points that includes the first and the last. The
/// algorithm works forward from the first point, so appending points leaves the beginning of the
/// result unchanged. A point that is not finite ends the line before it. At most 128 distances are
/// computed per point.
std::vector<glm::dvec2> simplified(std::span<const glm::dvec2> line, double tolerance);

} // namespace thicket
