#pragma once

#include <glm/vec2.hpp>

#include <span>
#include <vector>

namespace thicket {

/// A polyline with fewer points: no point of the old line is farther than `tolerance` (meters, 0 or more) from the new
/// one, whose points are all points of the old one, the first and the last among them. Works from the first point on,
/// so a change at the end of a line leaves the beginning as it was. Points that are not finite end the line before
/// them. Costs at most 128 distances a point.
std::vector<glm::dvec2> simplified(std::span<const glm::dvec2> line, double tolerance);

} // namespace thicket
