#pragma once

#include <glm/vec2.hpp>

namespace thicket {

/// Twice the signed area of the triangle a, b, c: above 0 if x turns towards y on the way around it. The sign is exact, 0 means
/// on one line, and the value is right to a part in 2^26, however narrow the triangle. Coordinates of at most 1e100, none but 0
/// nearer to 0 than 1e-100.
///
/// A quick determinant if a bound on its rounding leaves no doubt, else the exact one: J. R. Shewchuk, "Adaptive Precision
/// Floating-Point Arithmetic and Fast Robust Geometric Predicates", Discrete & Computational Geometry 18, 1997, section 4.1 and
/// (for sums and products without loss) section 2.
double orientation(glm::dvec2 a, glm::dvec2 b, glm::dvec2 c);

} // namespace thicket
