#include "core/base/orientation.hpp"

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <random>
#include <utility>

using namespace thicket;

namespace {

__extension__ using Wide = __int128;

int sign(double value) { return value > 0.0 ? 1 : (value < 0.0 ? -1 : 0); }

/// Returns twice the signed area of a triangle, computed exactly. Its corners are integers below
/// 2^52.
Wide exact(const std::array<std::array<std::int64_t, 2>, 3> &corner) {
	const auto gap = [&](std::size_t i, std::size_t axis) {
		return static_cast<Wide>(corner[i][axis]) - static_cast<Wide>(corner[2][axis]);
	};
	return gap(0, 0) * gap(1, 1) - gap(0, 1) * gap(1, 0);
}

} // namespace

TEST_CASE("orientation: left turns, right turns and collinear points are distinguished") {
	CHECK(orientation({0.0, 0.0}, {1.0, 0.0}, {0.0, 1.0}) == 1.0);
	CHECK(orientation({0.0, 0.0}, {0.0, 1.0}, {1.0, 0.0}) == -1.0);
	CHECK(orientation({1.0, 1.0}, {3.0, 3.0}, {-7.0, -7.0}) == 0.0);
	CHECK(orientation({0.1, 0.1}, {0.3, 0.3}, {0.7, 0.7}) == 0.0);
	CHECK(orientation({2.0, 5.0}, {2.0, 5.0}, {2.0, 5.0}) == 0.0);
	// One ulp of 0.5 away from the line, where a naive determinant returns 0.
	const double tolerance = std::ldexp(1.0, -53);
	CHECK(orientation({0.5, 0.5 + tolerance}, {12.0, 12.0}, {24.0, 24.0}) == 12.0 * tolerance);
	CHECK(orientation({0.5 + tolerance, 0.5}, {12.0, 12.0}, {24.0, 24.0}) == -12.0 * tolerance);
}

TEST_CASE("orientation: the sign is exact and the value accurate, even for the narrowest triangles") {
	std::mt19937_64 random(1);
	int on_line = 0;
	for (int round = 0; round < 20000; ++round) {
		const int bits = 10 + static_cast<int>(random() % 42);
		const auto random_number = [&] {
			return static_cast<std::int64_t>(random() % (std::uint64_t{1} << bits)) - (std::int64_t{1} << (bits - 1));
		};
		std::array<std::array<std::int64_t, 2>, 3> corner{
				{{random_number(), random_number()}, {random_number(), random_number()}, {}}};
		// The third corner is on the line through the other two corners or about one lattice step
		// away from it.
		const auto fraction = static_cast<std::int64_t>(random() % 8);
		for (std::size_t axis = 0; axis < 2; ++axis) {
			corner[2][axis] = corner[0][axis] + (corner[1][axis] - corner[0][axis]) / 7 * fraction +
					static_cast<std::int64_t>(random() % 3) - 1;
		}
		const double scale = std::ldexp(1.0, -static_cast<int>(random() % 60));
		std::array<glm::dvec2, 3> corners;
		for (std::size_t i = 0; i < 3; ++i) {
			corners[i] = scale * glm::dvec2(static_cast<double>(corner[i][0]), static_cast<double>(corner[i][1]));
		}
		const Wide area = exact(corner);
		const double expected = static_cast<double>(area) * scale * scale;
		const double actual = orientation(corners[0], corners[1], corners[2]);
		on_line += area == 0 ? 1 : 0;
		CHECK(sign(actual) == sign(expected));
		CHECK(std::abs(actual - expected) <= std::ldexp(std::abs(expected), -26));
		CHECK(sign(orientation(corners[1], corners[0], corners[2])) == -sign(expected));
		CHECK(sign(orientation(corners[2], corners[0], corners[1])) == sign(expected));
	}
	CHECK(on_line > 100);
}
