#include "core/base/trigonometry.hpp"

#include "core/base/floating_point.hpp"

#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>

namespace thicket {

namespace {

/// Evaluates the series c0 - c1 x^2 + c2 x^4 - ... by Horner's rule. `square` is x^2.
template <std::size_t Terms>
double alternating_series(double square, const std::array<double, Terms> &coefficients) {
	double sum = coefficients[Terms - 1];
	for (std::size_t term = Terms - 1; term-- > 0;) {
		sum = coefficients[term] - square * sum;
	}
	return sum;
}

// Return the sine and cosine for |x| <= pi / 4. The first omitted terms, x^13 / 13! and x^14 / 14!,
// are below 7e-12 and 4e-13.

double sine_small(double x) {
	constexpr std::array coefficients{1.0 / 6.0, 1.0 / 120.0, 1.0 / 5040.0, 1.0 / 362880.0, 1.0 / 39916800.0};
	const double square = x * x;
	return x - x * square * alternating_series(square, coefficients);
}

double cosine_small(double x) {
	constexpr std::array coefficients{
			1.0 / 2.0, 1.0 / 24.0, 1.0 / 720.0, 1.0 / 40320.0, 1.0 / 3628800.0, 1.0 / 479001600.0};
	const double square = x * x;
	return 1.0 - square * alternating_series(square, coefficients);
}

/// Returns the arctangent, in radians, for |x| <= tan(pi / 8). The first omitted term, x^21 / 21,
/// is below 5e-10.
double arc_tangent_small(double x) {
	constexpr std::array coefficients{
			1.0 / 3.0, 1.0 / 5.0, 1.0 / 7.0, 1.0 / 9.0, 1.0 / 11.0, 1.0 / 13.0, 1.0 / 15.0, 1.0 / 17.0, 1.0 / 19.0};
	const double square = x * x;
	return x - x * square * alternating_series(square, coefficients);
}

constexpr std::array<Rotation, 4> quarter_turns{{{1.0, 0.0}, {0.0, 1.0}, {-1.0, 0.0}, {0.0, -1.0}}};

} // namespace

Rotation rotation_by(double turns) {
	// Finds the nearest quarter turn. The cast truncates, so adding 8 first keeps its argument
	// positive.
	const double quarters = turns * 4.0;
	const int nearest = static_cast<int>(quarters + 8.5) - 8;
	const double rest = (quarters - nearest) * (std::numbers::pi / 2.0);
	const Rotation small{cosine_small(rest), sine_small(rest)};
	const Rotation quarter = quarter_turns[static_cast<std::size_t>(nearest & 3)];
	// These products are exact, because the factors of a quarter turn are 0, 1 or -1. A branch
	// would be mispredicted three times out of four.
	return {small.cosine * quarter.cosine - small.sine * quarter.sine,
			small.sine * quarter.cosine + small.cosine * quarter.sine};
}

double angle_degrees(double across, double along) {
	constexpr double degrees = 180.0 / std::numbers::pi;
	constexpr double reach = std::numbers::sqrt2 - 1.0; // tan(pi / 8)
	const double up = std::abs(along);
	// atan(across / up) is split into the nearest of 0, 45 and 90 degrees, and an angle within the
	// range of the series.
	double base = 45.0;
	double tangent = (across - up) / (across + up);
	if (across <= reach * up) {
		base = 0.0;
		tangent = across / up;
	} else if (up <= reach * across) {
		base = 90.0;
		tangent = -up / across;
	}
	const double angle = base + degrees * arc_tangent_small(tangent);
	return along < 0.0 ? 180.0 - angle : angle;
}

double slope_degrees(glm::vec3 normal) {
	const double x = normal.x;
	const double z = normal.z;
	// The slope is computed from both the horizontal and the vertical component, because the
	// vertical one alone is inaccurate for small angles.
	return angle_degrees(std::sqrt(x * x + z * z), normal.y);
}

} // namespace thicket
