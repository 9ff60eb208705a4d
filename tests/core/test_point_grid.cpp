// Compares the nearest of many points with the result of a scan of all points.

#include "core/placement/point_grid.hpp"
#include "rounding.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <random>
#include <vector>

using namespace thicket;
using test::rounds;

namespace {

double nearest_of_all(const std::vector<glm::dvec2> &points, glm::dvec2 position, double distance) {
	double nearest = distance * distance;
	for (const glm::dvec2 point : points) {
		const glm::dvec2 offset = point - position;
		nearest = std::min(nearest, offset.x * offset.x + offset.y * offset.y);
	}
	return nearest;
}

std::vector<glm::dvec2> scattered(std::mt19937 &random, const Rect &area, int count) {
	std::uniform_real_distribution<double> x(area.min.x, area.max.x);
	std::uniform_real_distribution<double> y(area.min.y, area.max.y);
	std::vector<glm::dvec2> points;
	for (int i = 0; i < count; ++i) {
		points.emplace_back(x(random), y(random));
	}
	return points;
}

} // namespace

TEST_CASE("point grid: the nearest of many points is bit-identical, at any distance and density") {
	std::mt19937 random(3);
	PointGrid<glm::dvec2> grid;
	for (const Rect &area : {Rect{{-50.0, -20.0}, {70.0, 110.0}}, Rect{{1e6, 1e6}, {1e6 + 400.0, 1e6 + 9.0}},
				 Rect{{-5e6, 5e6}, {-5e6 + 60.0, 5e6 + 60.0}}}) {
		for (const int count : {0, 1, 7, 300, 5000}) {
			std::vector<glm::dvec2> points = scattered(random, area, count);
			// Repeats the points in a corner of the area, at a hundredth of their spacing.
			for (int i = 0; i < count; ++i) {
				points.push_back(area.min + (points[static_cast<std::size_t>(i)] - area.min) * 0.01);
			}
			for (const double cell : {0.5, 20.0, 1000.0}) {
				grid.set(points, area, cell);
				for (const glm::dvec2 position :
						scattered(random, {area.min - 3.0 * cell / 20.0, area.max + 3.0 * cell / 20.0}, 40)) {
					for (const double distance : {0.1 * cell, cell}) {
						REQUIRE(grid.nearest_squared(position, distance) == nearest_of_all(points, position, distance));
					}
				}
			}
		}
	}
}

TEST_CASE("point grid: only points that may be the nearest are measured") {
	// The near points and the position have integer coordinates, also in cell units. The squared
	// distances of far points would be rounded.
	std::vector<glm::dvec2> points{{5.0, 4.0}, {8.0, 8.0}};
	for (int i = 0; i < 1022; ++i) {
		points.emplace_back(40.1 + 0.2 * (i % 50), 35.7 + 0.7 * (i / 50 % 20));
	}
	PointGrid<glm::dvec2> grid;
	double nearest = 0.0;
	for (const double cell : {1.0, 64.0}) { // With so many points, the grid uses smaller cells than requested.
		grid.set(points, {{0.0, 0.0}, {64.0, 64.0}}, cell);
		CHECK_FALSE(rounds([&] { nearest = grid.nearest_squared({4.0, 4.0}, 4.0); }));
		CHECK(nearest == 1.0);
		CHECK_FALSE(rounds(
				// The search proceeds outward until it finds a point.
				[&] { nearest = grid.nearest_squared({4.0, 4.0}, 60.0); }));
		CHECK(nearest == 1.0);
		CHECK(rounds([&] { nearest = grid.nearest_squared({36.0, 35.0}, 60.0); }));
	}
}
