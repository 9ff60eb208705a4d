#pragma once

namespace thicket {

/// A rotation in the plane.
struct Rotation {
	double cosine = 1.0;
	double sine = 0.0;
};

/// The rotation by `turns` full turns, in [-2, 2]. Both parts within 1e-11 of the exact value, and exact at quarter
/// turns. The same bits everywhere: additions and multiplications only.
Rotation rotation_by(double turns);

} // namespace thicket
