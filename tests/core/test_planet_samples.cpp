// Tests the search for the ground of a planet on any of its sides.

#include "core/explain/planet_samples.hpp"
#include "surface_fixture.hpp"

#include <doctest/doctest.h>

#include <glm/geometric.hpp>

#include <cmath>
#include <initializer_list>
#include <memory>
#include <vector>

using namespace thicket;

namespace {

const Planet planet{glm::dvec3(0.0), 20.0};

std::shared_ptr<const Surface> ground() { return surfaces::sphere(20.0, 60).surface(); }

} // namespace

TEST_CASE("planet samples: the ground as seen from above; positions beside the planet are left out") {
	const std::shared_ptr<const Surface> surface = ground();
	PlanetSamples samples;
	samples.find_on_top(*surface, planet, std::vector<glm::dvec2>{{3.0, 4.0}, {30.0, 0.0}, {-12.0, 9.0}});
	REQUIRE(samples.indices == std::vector<std::size_t>{0, 2});
	CHECK(samples.positions[1] == glm::dvec2(-12.0, 9.0));
	CHECK(samples.ground[0].height == doctest::Approx(std::sqrt(400.0 - 25.0)).epsilon(0.01));
	CHECK(samples.ground[1].height == doctest::Approx(std::sqrt(400.0 - 225.0)).epsilon(0.01));
	CHECK(samples.slope(planet, 1) < 4.0F); // The normal of a triangle differs from up by 1.5 degrees on average.
}

TEST_CASE("planet samples: the ground at positions on all sides") {
	const std::shared_ptr<const Surface> surface = ground();
	std::vector<glm::dvec3> positions;
	for (const glm::dvec3 direction :
			{glm::dvec3(0.2, -1.0, 0.1), glm::dvec3(1.0, 0.1, 0.2), glm::dvec3(-0.3, 0.2, -1.0)}) {
		positions.push_back(20.5 * glm::normalize(direction));
	}
	positions.push_back(2.0 * positions[0]); // Too far from the ground.
	PlanetSamples samples;
	samples.find_at(*surface, planet, positions);
	REQUIRE(samples.indices == std::vector<std::size_t>{0, 1, 2});
	for (std::size_t i = 0; i < 3; ++i) {
		const glm::dvec3 on_ground(samples.positions[i].x, samples.ground[i].height, samples.positions[i].y);
		CHECK(glm::distance(on_ground, positions[i]) < 0.6);
		CHECK(samples.slope(planet, i) < 4.0F);
	}
}

TEST_CASE("planet samples: the ground toward a direction") {
	const std::shared_ptr<const Surface> surface = ground();
	const glm::dvec3 below = glm::normalize(glm::dvec3(0.1, -1.0, 0.2)); // The sphere has a tiny hole at its pole.
	CHECK(glm::distance(planet_ground_toward(*surface, planet, below), 20.0 * below) < 0.05);
	CHECK(std::isnan(planet_ground_toward(*surface, {{100.0, 0.0, 0.0}, 20.0}, {1.0, 0.0, 0.0}).x));
}
