#pragma once

#include <glm/vec2.hpp>

namespace thicket {

/// Returns twice the signed area of the triangle a, b, c. It is positive if the triangle turns from
/// x toward y. The sign is exact, and 0 means that the points are collinear. The relative error of
/// the value is at most 2^-26, even for very narrow triangles. The magnitude of each coordinate
/// must be 0 or between 1e-100 and 1e100.
///
/// The function evaluates the determinant in doubles if the bound on its rounding error permits,
/// and otherwise exactly. Source: J. R. Shewchuk, "Adaptive Precision Floating-Point Arithmetic and
/// Fast Robust Geometric Predicates", Discrete & Computational Geometry 18, 1997, section 4.1, and
/// section 2 for exact sums and products.
double orientation(glm::dvec2 a, glm::dvec2 b, glm::dvec2 c);

} // namespace thicket
