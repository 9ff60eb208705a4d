#pragma once

namespace thicket {

/// Interpolates bilinearly between the values at four corners. `x` goes from left to right and `y`
/// from near to far; both are in [0, 1). The result is exact at x = y = 0 and if all four values
/// are equal.
constexpr double bilinear(double near_left, double near_right, double far_left, double far_right, double x, double y) {
	const double near = near_left + (near_right - near_left) * x;
	const double far = far_left + (far_right - far_left) * x;
	return near + (far - near) * y;
}

} // namespace thicket
