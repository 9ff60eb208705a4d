#include "core/sampling/tile_sampler.hpp"

#include <doctest/doctest.h>
#include <glm/geometric.hpp>

#include <array>
#include <vector>

using namespace thicket;

TEST_CASE("every point is in the rectangle that its ID identifies, at all levels, near the origin and far away") {
	const std::array<PointSet, 3> sets{{{.seed = 1, .radius = 1.5, .levels = 1},
			{.seed = 2, .radius = 0.37, .levels = 4, .layer = 9}, {.seed = 3, .radius = 40.0, .levels = 2}}};
	for (const PointSet &set : sets) {
		CAPTURE(set.radius);
		for (const glm::dvec2 corner : {glm::dvec2(-20.0, 7.0), glm::dvec2(-4e6, 3e6), glm::dvec2(-8.3e6, -8.3e6)}) {
			TileSampler sampler;
			std::vector<SamplePoint> points;
			const glm::dvec2 from = corner * set.radius * 0.7;
			REQUIRE(sampler.sample(set, {from, from + 30.0 * set.radius}, points).ok());
			REQUIRE(points.size() > 400);
			for (const SamplePoint &point : points) {
				const Rect rect = cell_rect(set, point.id);
				CHECK(rect.contains(point.position));
				CHECK(glm::length(rect.size()) < 1.001 * set.radius);
			}
		}
	}
}
