#include "core/rules/slope.hpp"

#include "core/base/floating_point.hpp"

#include <cmath>
#include <numbers>

namespace thicket {

namespace {

/// The arc tangent in radians for |x| <= tan(pi / 8), by its Taylor series. The first term left out, x^21 / 21, is
/// below 5e-10 there.
double arctan_small(double x) {
	const double square = x * x;
	double sum = 1.0 / 19.0;
	sum = 1.0 / 17.0 - square * sum;
	sum = 1.0 / 15.0 - square * sum;
	sum = 1.0 / 13.0 - square * sum;
	sum = 1.0 / 11.0 - square * sum;
	sum = 1.0 / 9.0 - square * sum;
	sum = 1.0 / 7.0 - square * sum;
	sum = 1.0 / 5.0 - square * sum;
	sum = 1.0 / 3.0 - square * sum;
	return x - x * square * sum;
}

} // namespace

double slope_degrees(glm::vec3 normal) {
	constexpr double degrees = 180.0 / std::numbers::pi;
	constexpr double reach = std::numbers::sqrt2 - 1.0; // tan(pi / 8)
	const double x = normal.x;
	const double z = normal.z;
	// From both legs of the triangle: the height alone says little about an angle near 0.
	const double across = std::sqrt(x * x + z * z);
	const double up = std::abs(static_cast<double>(normal.y));
	// atan(across / up) is 0, 45 or 90 degrees, whichever is nearest, and an angle within the reach of the series.
	double base = 45.0;
	double tangent = (across - up) / (across + up);
	if (across <= reach * up) {
		base = 0.0;
		tangent = across / up;
	} else if (up <= reach * across) {
		base = 90.0;
		tangent = -up / across;
	}
	const double slope = base + degrees * arctan_small(tangent);
	return normal.y < 0.0f ? 180.0 - slope : slope;
}

} // namespace thicket
