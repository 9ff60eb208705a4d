#pragma once

namespace thicket {

/// Between the values at four corners: near left, near right, far left, far right; `x` from left to right and `y` from near
/// to far, 0 to below 1. At a corner, and where all are equal, exactly that value.
constexpr double bilinear(double near_left, double near_right, double far_left, double far_right, double x, double y) {
	const double near = near_left + (near_right - near_left) * x;
	const double far = far_left + (far_right - far_left) * x;
	return near + (far - near) * y;
}

} // namespace thicket
