#include "core/base/trigonometry.hpp"
#include "core/rules/prepared_range.hpp"

#include <doctest/doctest.h>

#include <glm/vec3.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <optional>
#include <random>

using namespace thicket;

namespace {

constexpr double radian = std::numbers::pi / 180.0;

/// Returns a normal with a slope of `degrees` that leans toward `heading`, also in degrees.
glm::vec3 inclined(double degrees, double heading, double length = 1.0) {
	const double horizontal = length * std::sin(degrees * radian);
	return {horizontal * std::cos(heading * radian), length * std::cos(degrees * radian),
			horizontal * std::sin(heading * radian)};
}

} // namespace

TEST_CASE("slopes are accurate in degrees") {
	for (double degrees = 0.0; degrees <= 180.0; degrees += 0.25) {
		for (const double heading : {0.0, 77.0, 200.0}) {
			const glm::vec3 normal = inclined(degrees, heading);
			const double exact_degrees =
					std::atan2(std::hypot(double(normal.x), double(normal.z)), double(normal.y)) / radian;
			CHECK(std::abs(slope_degrees(normal) - exact_degrees) < 1e-7);
			CHECK(std::abs(slope_degrees(normal) - degrees) < 1e-4);
		}
	}
	CHECK(slope_degrees({0.0f, 1.0f, 0.0f}) == 0.0);
	CHECK(slope_degrees({1.0f, 1.0f, 0.0f}) == 45.0);
	CHECK(slope_degrees({1.0f, 0.0f, 0.0f}) == 90.0);
	CHECK(slope_degrees({0.0f, -1.0f, 0.0f}) == 180.0);
	CHECK(std::isnan(slope_degrees({0.0f, 0.0f, 0.0f})));
	CHECK(std::isnan(slope_degrees({std::nanf(""), 1.0f, 0.0f})));
}

TEST_CASE("slopes that need no angle have the same density") {
	std::mt19937 random(7); // NOLINT(cert-msc32-c,cert-msc51-cpp): the same slopes in every run.
	std::uniform_real_distribution<double> unit(0.0, 1.0);
	std::size_t known_count = 0;
	std::size_t queried = 0;
	for (int i = 0; i < 400; ++i) {
		const double limit_degrees = i % 7 == 0 ? 0.0 : 90.0 * unit(random);
		const double other = i % 5 == 0 ? 90.0 : i % 11 == 0 ? 90.0 - 1e-4 * unit(random) : 90.0 * unit(random);
		const double falloff = i % 3 == 0 ? 0.0 : 30.0 * unit(random) * unit(random);
		const double low = std::min(limit_degrees, other);
		const double high = std::max(limit_degrees, other);
		const SlopeRange range(low, high, falloff);
		CAPTURE(low);
		CAPTURE(high);
		CAPTURE(falloff);
		for (int j = 0; j < 250; ++j) {
			const std::array<double, 5> edges{low, low + falloff, high - falloff, high, 90.0 * unit(random)};
			// Near the edges between the ranges, and at random slopes.
			const double degrees = std::clamp(
					edges[static_cast<std::size_t>(j % 5)] + (unit(random) - 0.5) * (j % 2 == 0 ? 1e-5 : 1e-2), 0.0,
					89.9999);
			const glm::vec3 normal = inclined(degrees, 360.0 * unit(random), 0.2 + 2.0 * unit(random));
			const double exact = range.density(slope_degrees(normal));
			CHECK(range.density_of(normal) == exact);
			const std::optional<double> without_angle = range.density_without_angle(normal);
			CHECK((!without_angle.has_value() || *without_angle == exact));
			known_count += j % 5 == 4 && without_angle.has_value() ? 1 : 0;
			queried += j % 5 == 4 ? 1 : 0;
		}
	}
	CHECK(static_cast<double>(known_count) > 0.7 * static_cast<double>(queried));
}
