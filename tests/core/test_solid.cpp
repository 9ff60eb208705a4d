// Tests the triangles of simple solids: they are closed, face outward and have the requested size.

#include "core/terrain/solid.hpp"

#include <doctest/doctest.h>
#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <map>
#include <utility>
#include <vector>

using namespace thicket;

namespace {

constexpr double pi = 3.14159265358979323846;

/// Returns the volume inside clockwise triangles. It is negative if their fronts face inward.
double volume_of(const std::vector<glm::vec3> &corners) {
	double sum = 0.0;
	for (std::size_t index = 0; index < corners.size(); index += 3) {
		const std::array<glm::dvec3, 3> at{
				glm::dvec3(corners[index]), glm::dvec3(corners[index + 1]), glm::dvec3(corners[index + 2])};
		sum -= glm::dot(at[0], glm::cross(at[1], at[2]));
	}
	return sum / 6.0;
}

/// Returns true if each edge belongs to two triangles that traverse it in opposite directions.
bool is_closed(const std::vector<glm::vec3> &corners) {
	using Point = std::array<float, 3>;
	std::map<std::pair<Point, Point>, int> edges;
	const auto point = [](const glm::vec3 &at) {
		return Point{at.x, at.y, at.z};
	};
	for (std::size_t index = 0; index < corners.size(); index += 3) {
		for (std::size_t corner = 0; corner < 3; ++corner) {
			const Point from = point(corners[index + corner]);
			const Point target = point(corners[index + (corner + 1) % 3]);
			++edges[{from, target}];
		}
	}
	return std::ranges::all_of(edges, [&](const auto &edge) {
		const auto opposite = edges.find({edge.first.second, edge.first.first});
		return edge.second == 1 && opposite != edges.end() && opposite->second == 1;
	});
}

glm::vec3 extent_of(const std::vector<glm::vec3> &corners) {
	glm::vec3 most(0.0F);
	for (const glm::vec3 &corner : corners) {
		most = glm::max(most, corner);
	}
	return most;
}

} // namespace

TEST_CASE("solid: a box has the requested size, and its front faces point outward") {
	std::vector<glm::vec3> corners;
	append_box({2.0, 3.0, 4.0}, corners);
	CHECK(corners.size() == 36);
	CHECK(is_closed(corners));
	CHECK(volume_of(corners) == doctest::Approx(24.0));
	CHECK(extent_of(corners) == glm::vec3(1.0F, 1.5F, 2.0F));
}

TEST_CASE("solid: cylinders, capsules and spheres are closed, and as large as requested") {
	for (const double radius : {0.05, 1.0, 30.0, 2000.0}) {
		CAPTURE(radius);
		const double loss = 1.0 -
				20.0 /
						(sides_of(radius) *
								sides_of(
										radius)); // A lower bound for the fraction of the volume that flat sides leave.
		std::vector<glm::vec3> cylinder;
		append_cylinder(radius, 3.0 * radius, cylinder);
		CHECK(is_closed(cylinder));
		CHECK(volume_of(cylinder) <= pi * 3.0 * std::pow(radius, 3));
		CHECK(volume_of(cylinder) >= loss * pi * 3.0 * std::pow(radius, 3));
		for (const double height : {2.0 * radius, 5.0 * radius}) {
			std::vector<glm::vec3> capsule;
			append_capsule(radius, height, capsule);
			const double full = pi * radius * radius * (height - 2.0 * radius) + 4.0 / 3.0 * pi * std::pow(radius, 3);
			CHECK(is_closed(capsule));
			CHECK(volume_of(capsule) <= full);
			CHECK(volume_of(capsule) >= loss * full);
			CHECK(extent_of(capsule).x == doctest::Approx(radius));
			CHECK(extent_of(capsule).y == doctest::Approx(0.5 * height));
		}
	}
}

TEST_CASE("solid: the sides of a circle stay within 5 mm of it") {
	for (const double radius : {0.01, 1.0, 10.0, 100.0, 265.0}) {
		const int sides = sides_of(radius);
		CHECK(radius * (1.0 - std::cos(pi / sides)) <= 0.005);
		CHECK((sides == 16 || radius * (1.0 - std::cos(2.0 * pi / sides)) > 0.005));
	}
	CHECK(sides_of(1e6) == 512);
}
