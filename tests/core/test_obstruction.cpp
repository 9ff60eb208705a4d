#include "core/near/obstruction.hpp"

#include <doctest/doctest.h>

#include <glm/ext/matrix_transform.hpp>
#include <glm/geometric.hpp>
#include <glm/mat4x4.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <random>

using namespace thicket;

namespace {

constexpr NavigationAgent agent{.height = 1.5, .max_slope = 45.0, .cell_size = 0.25, .cell_height = 0.2};
constexpr double half_diagonal = 0.25 * std::numbers::sqrt2 / 2.0;

/// Returns the depth of a position inside a convex outline in meters, negative outside.
double depth(const Obstruction &obstruction, glm::dvec2 position) {
	double min_distance = std::numeric_limits<double>::infinity();
	const std::size_t count = obstruction.outline.size();
	for (std::size_t i = 0; i < count; ++i) {
		const glm::dvec2 from = obstruction.outline[i];
		const glm::dvec2 edge = obstruction.outline[(i + 1) % count] - from;
		const glm::dvec2 offset = position - from;
		if (glm::length(edge) > 1e-12) {
			min_distance = std::min(min_distance, (edge.x * offset.y - edge.y * offset.x) / glm::length(edge));
		}
	}
	return min_distance;
}

glm::dmat3 leaning(double degrees, double turn, double scale) {
	const glm::dmat4 turned = glm::rotate(glm::dmat4(1.0), turn, glm::dvec3(0.0, 1.0, 0.0));
	const double angle = degrees * std::numbers::pi / 180.0;
	return glm::dmat3(glm::rotate(turned, angle, glm::dvec3(1.0, 0.0, 0.0))) * scale;
}

} // namespace

TEST_CASE("obstruction: covers every cell that an upright cylinder touches, and hardly more") {
	Obstruction obstruction;
	for (const double radius : {0.01, 0.3, 0.5, 2.0, 9.0}) {
		REQUIRE(obstruct(leaning(0.0, 0.7, 2.0), {5.0, 3.0, -4.0}, {radius, 4.0}, agent, obstruction));
		const double min_distance = 2.0 * radius + half_diagonal;
		double farthest = 0.0;
		for (const glm::dvec2 corner : obstruction.outline) {
			farthest = std::max(farthest, glm::length(corner - glm::dvec2(5.0, -4.0)));
		}
		CHECK(depth(obstruction, {5.0, -4.0}) >= min_distance - 1e-9);
		CHECK(farthest <= std::max(min_distance + 0.5 * agent.cell_size, 1.04 * min_distance));
		CHECK(farthest <= obstruction_reach({radius, 4.0}, 2.0, agent));
	}
}

TEST_CASE("obstruction: heights are those at which an agent collides with the cylinder") {
	Obstruction obstruction;
	REQUIRE(obstruct(glm::dmat3(1.0), {0.0, 10.0, 0.0}, {0.5, 6.0}, agent, obstruction));
	CHECK(obstruction.bottom == doctest::Approx(10.0 - 1.5 - 0.2));
	CHECK(obstruction.top == doctest::Approx(16.0 + 0.2));
	// A wide cylinder, on ground that falls by the cylinder's radius on one side and rises on the
	// other.
	REQUIRE(obstruct(glm::dmat3(1.0), {0.0, 10.0, 0.0}, {4.0, 1.0}, agent, obstruction));
	CHECK(obstruction.bottom == doctest::Approx(10.0 - 4.0 - 0.2));
	CHECK(obstruction.top == doctest::Approx(14.0 + 0.2));
	// An instance that is upside down.
	glm::dmat3 hanging(1.0);
	hanging[1] = -hanging[1];
	REQUIRE(obstruct(hanging, {0.0, 10.0, 0.0}, {0.5, 6.0}, agent, obstruction));
	CHECK(obstruction.bottom == doctest::Approx(4.0 - 1.5 - 0.2));
	// Agents that climb the steepest slope possible.
	NavigationAgent climber = agent;
	climber.max_slope = 90.0;
	REQUIRE(obstruct(glm::dmat3(1.0), {0.0, 0.0, 0.0}, {1.0, 1.0}, climber, obstruction));
	CHECK(obstruction.bottom > -4.0);
}

TEST_CASE("obstruction: a leaning cylinder obstructs only up to the height of an agent") {
	std::mt19937_64 random(5);
	std::uniform_real_distribution<double> any(0.0, 1.0);
	Obstruction obstruction;
	for (int i = 0; i < 300; ++i) {
		const glm::dmat3 basis = leaning(80.0 * any(random), 6.3 * any(random), 0.5 + any(random));
		const InstanceShape shape{0.1 + any(random), 8.0 * any(random)};
		REQUIRE(obstruct(basis, {1.0, 0.0, 2.0}, shape, agent, obstruction));
		const double radius = shape.radius * glm::length(basis[0]);
		const glm::dvec3 axis = basis[1] * shape.height;
		for (int step = 0; step <= 10; ++step) {
			const glm::dvec3 at = axis * (step / 10.0);
			const double inner_depth = depth(obstruction, {1.0 + at.x, 2.0 + at.z});
			if (at.y <= agent.height) {
				CHECK(inner_depth >= radius + half_diagonal - 1e-9);
			}
		}
		for (const glm::dvec2 corner : obstruction.outline) {
			CHECK(glm::length(corner - glm::dvec2(1.0, 2.0)) <= obstruction_reach(shape, glm::length(basis[1]), agent));
		}
		// A crown higher than any agent may hang over a path.
		if (axis.y > 2.0 * (agent.height + radius) && glm::length(glm::dvec2(axis.x, axis.z)) > 8.0 * (radius + 0.25)) {
			CHECK(depth(obstruction, {1.0 + axis.x, 2.0 + axis.z}) < 0.0);
		}
	}
}

TEST_CASE("obstruction: flat or non-finite instances cause no obstruction") {
	Obstruction obstruction;
	CHECK_FALSE(obstruct(glm::dmat3(0.0), glm::dvec3(0.0), {0.5, 2.0}, agent, obstruction));
	glm::dmat3 broken(1.0);
	broken[1].y = std::numeric_limits<double>::quiet_NaN();
	CHECK_FALSE(obstruct(broken, glm::dvec3(0.0), {0.5, 2.0}, agent, obstruction));
	const double infinity = std::numeric_limits<double>::infinity();
	CHECK_FALSE(obstruct(glm::dmat3(1.0), {infinity, 0.0, 0.0}, {0.5, 2.0}, agent, obstruction));
}
