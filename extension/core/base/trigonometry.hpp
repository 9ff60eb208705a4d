#pragma once

#include <glm/vec3.hpp>

// Angles with the same bits on every machine. The C library's sine, cosine and arc tangent round differently from
// machine to machine. So these functions use polynomials made of additions, multiplications, divisions and square
// roots, which IEEE 754 rounds exactly.

namespace thicket {

/// A rotation in the plane.
struct Rotation {
	double cosine = 1.0;
	double sine = 0.0;
};

/// The rotation by `turns` full turns, in [-2, 2]. Both parts are within 1e-11 of the exact value, and exact at quarter turns.
Rotation rotation_by(double turns);

/// The true angle between a normal and straight up, in degrees: 0 for flat ground, 90 for a wall, up to 180 for a ceiling. The normal need
/// not be of unit length. NAN for NAN and for the zero vector. Within 1e-7 degrees of the exact value, and exact at 0, 45 and 90.
double slope_degrees(glm::vec3 normal);

} // namespace thicket
