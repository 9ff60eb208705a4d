#pragma once

#include <glm/vec3.hpp>

namespace thicket {

/// The true angle between a normal and straight up, in degrees: 0 flat, 45, 90 a wall, up to 180 for a ceiling. The
/// normal need not be of unit length; NAN for NAN and for the zero vector. Within 1e-7 degrees of the exact value and
/// exact at 0, 45 and 90. The same bits everywhere: arithmetic and square roots only.
double slope_degrees(glm::vec3 normal);

} // namespace thicket
