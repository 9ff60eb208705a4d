#include "core/placement/rotation.hpp"

#include "core/base/floating_point.hpp"

#include <array>
#include <cstddef>
#include <numbers>

namespace thicket {

namespace {

constexpr std::array<Rotation, 4> quarter_turns{{{1.0, 0.0}, {0.0, 1.0}, {-1.0, 0.0}, {0.0, -1.0}}};

// Taylor series for |x| <= pi / 4. The first terms left out, x^13 / 13! and x^14 / 14!, are below 7e-12 and 4e-13
// there.

double sine_small(double x) {
	const double square = x * x;
	double sum = 1.0 / 39916800.0;
	sum = 1.0 / 362880.0 - square * sum;
	sum = 1.0 / 5040.0 - square * sum;
	sum = 1.0 / 120.0 - square * sum;
	sum = 1.0 / 6.0 - square * sum;
	return x - x * square * sum;
}

double cosine_small(double x) {
	const double square = x * x;
	double sum = 1.0 / 479001600.0;
	sum = 1.0 / 3628800.0 - square * sum;
	sum = 1.0 / 40320.0 - square * sum;
	sum = 1.0 / 720.0 - square * sum;
	sum = 1.0 / 24.0 - square * sum;
	sum = 1.0 / 2.0 - square * sum;
	return 1.0 - square * sum;
}

} // namespace

Rotation rotation_by(double turns) {
	// The nearest quarter; 8 more keep the cast, which cuts towards 0, on the positive side.
	const double quarters = turns * 4.0;
	const int nearest = static_cast<int>(quarters + 8.5) - 8;
	const double rest = (quarters - nearest) * (std::numbers::pi / 2.0);
	const Rotation small{cosine_small(rest), sine_small(rest)};
	const Rotation quarter = quarter_turns[static_cast<std::size_t>(nearest & 3)];
	// Exact, as every factor of the quarter is 0 or 1; a branch here would be guessed wrong three times in four.
	return {small.cosine * quarter.cosine - small.sine * quarter.sine,
			small.sine * quarter.cosine + small.cosine * quarter.sine};
}

} // namespace thicket
