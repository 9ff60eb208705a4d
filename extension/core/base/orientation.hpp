#pragma once

#include <glm/vec2.hpp>

namespace thicket {

/// Twice the signed area of the triangle a, b, c: above 0 if going around it turns x towards y. The sign is exact, and 0 means that the
/// points lie on one line. The value is accurate to one part in 2^26, however narrow the triangle. Coordinates must be at most 1e100, and
/// either 0 or at least 1e-100 away from 0.
///
/// Uses a quick determinant if the bound on its rounding error settles the sign, else the exact one: J. R. Shewchuk, "Adaptive Precision
/// Floating-Point Arithmetic and Fast Robust Geometric Predicates", Discrete & Computational Geometry 18, 1997, section 4.1 and (for sums
/// and products without loss) section 2.
double orientation(glm::dvec2 a, glm::dvec2 b, glm::dvec2 c);

} // namespace thicket
