#pragma once

#include <glm/vec3.hpp>

// Trigonometric functions whose results are bit-identical on every machine. Rounding in the C
// library's sine, cosine and arctangent differs between machines. These functions use only
// additions, multiplications, divisions and square roots, whose rounding IEEE 754 defines exactly.

namespace thicket {

/// A rotation in the plane, as the sine and cosine of its angle.
struct Rotation {
	double cosine = 1.0;
	double sine = 0.0;
};

/// Returns the rotation by `turns` full turns, which must be in [-2, 2]. Both components are within
/// 1e-11 of the true values, and exact at quarter turns.
Rotation rotation_by(double turns);

/// Returns the angle in degrees, 0 to 180, whose tangent is `across / along`. `across` is 0 or more;
/// if `along` is negative, the angle is above 90. Returns NAN if both are 0 or one is NAN. The result
/// is within 1e-7 degrees of the true value, and exact at 0, 45, 90 and 180.
double angle_degrees(double across, double along);

/// Returns the angle between a normal and the up direction, in degrees: 0 for flat ground, 90 for a
/// wall, 180 for a ceiling. The normal need not be normalized. Returns NAN for the zero vector and
/// for NAN components. The result is within 1e-7 degrees of the true value, and exact at 0, 45 and
/// 90.
double slope_degrees(glm::vec3 normal);

} // namespace thicket
