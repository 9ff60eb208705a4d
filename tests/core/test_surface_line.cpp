// Tests where lines intersect surfaces. The editor's tools use such lines.

#include "core/terrain/surface_line.hpp"
#include "surface_fixture.hpp"

#include <doctest/doctest.h>

#include <glm/geometric.hpp>

#include <cmath>
#include <random>

using namespace thicket;

TEST_CASE("surface line: a line to the center of a sphere meets its front, from every direction") {
	const auto ball = surfaces::sphere(20.0, 60).surface();
	std::mt19937 random(3);
	std::normal_distribution<double> any;
	for (int i = 0; i < 500; ++i) {
		const glm::dvec3 up = glm::normalize(glm::dvec3(any(random), any(random), any(random)));
		const SurfacePosition hit = first_on_line(*ball, 100.0 * up, -100.0 * up);
		REQUIRE(std::isfinite(hit.position.x));
		CHECK(glm::distance(hit.position, glm::length(hit.position) * up) < 1e-9);
		CHECK(glm::length(hit.position) > 19.9);
		CHECK(glm::dot(hit.normal, up) > 0.99);
		// A line that ends before the sphere, and one that starts inside of it, meet no front.
		CHECK(std::isnan(first_on_line(*ball, 100.0 * up, 20.5 * up).position.x));
		CHECK(std::isnan(first_on_line(*ball, 10.0 * up, 100.0 * up).position.x));
	}
}

TEST_CASE("surface line: the first of several surfaces is found, and degenerate lines meet none") {
	surfaces::Triangles floors = surfaces::square(40.0, 10, {-20, 0, -20}, {0, 0, 1}, {1, 0, 0});
	floors.append(surfaces::square(40.0, 10, {-20, 5, -20}, {0, 0, 1}, {1, 0, 0}));
	const auto surface = floors.surface();
	CHECK(glm::distance(first_on_line(*surface, {3, 20, 4}, {3, -20, 4}).position, {3, 5, 4}) < 1e-9);
	CHECK(glm::distance(first_on_line(*surface, {3, 4, 4}, {3, -20, 4}).position, {3, 0, 4}) < 1e-9);
	CHECK(glm::distance(first_on_line(*surface, {-15, 6, 4}, {15, 3, 4}).position, {-5, 5, 4}) < 1e-9);
	CHECK(std::isnan(first_on_line(*surface, {3, -20, 4}, {3, 20, 4}).position.x)); // Only backs.
	CHECK(std::isnan(first_on_line(*surface, {50, 20, 4}, {50, -20, 4}).position.x));
	CHECK(std::isnan(first_on_line(*surface, {3, 20, 4}, {3, 20, 4}).position.x));
	CHECK(std::isnan(first_on_line(*surface, {3, std::nan(""), 4}, {3, 0, 4}).position.x));
	CHECK(std::isnan(first_on_line(*surfaces::Triangles().surface(), {3, 20, 4}, {3, -20, 4}).position.x));
}
