#pragma once

namespace thicket {

/// Interpolates between the values at four corners: near left, near right, far left, far right. `x` runs from left to right and `y` from
/// near to far, both from 0 to below 1. At a corner, and where all four values are equal, the result is exact.
constexpr double bilinear(double near_left, double near_right, double far_left, double far_right, double x, double y) {
	const double near = near_left + (near_right - near_left) * x;
	const double far = far_left + (far_right - far_left) * x;
	return near + (far - near) * y;
}

} // namespace thicket
