#pragma once

#include <glm/vec2.hpp>

#include <span>
#include <vector>

namespace thicket {

/// Simplifies a polyline: no point of the old line is farther than `tolerance` (meters, 0 or more) from the new one. All points of the
/// new line are points of the old one, including the first and the last. Works forward from the first point, so a change at the end
/// leaves the beginning unchanged. A point that is not finite ends the line before it. Computes at most 128 distances per point.
std::vector<glm::dvec2> simplified(std::span<const glm::dvec2> line, double tolerance);

} // namespace thicket
