// Tests the baseline after Jones (2006): the free area of a cell must be exact, and the sets must
// match dart throwing. Cross compilers may lack CGAL, so these tests are skipped without it. On the
// native platform, the benchmark itself does not build without CGAL.
#if __has_include(<CGAL/version.h>)

#include "tests/analysis/baseline_check.hpp"
#include "tests/bench/baselines/voronoi_darts.hpp"

#include <doctest/doctest.h>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <vector>

using namespace thicket;
using bench::FreeCell;
using bench::VoronoiDarts;
using bench::Xoroshiro;

namespace {

/// A cell with every kind of edge: outside the disk, tangent to it, and crossing it at one end or
/// at both.
const std::vector<glm::dvec2> all_kinds = {{2.0, 0.0}, {0.9, 1.6}, {-0.5, 1.1}, {-2.4, 0.2}, {-0.4, -1.2}, {1.3, -1.9}};

/// Returns the extent of the cell in a direction, computed from the definition of a Voronoi cell.
double reach(const std::vector<glm::dvec2> &neighbors, double angle) {
	const glm::dvec2 direction(std::cos(angle), std::sin(angle));
	double min_distance = 1e9;
	for (const glm::dvec2 neighbor : neighbors) {
		const double towards = glm::dot(direction, neighbor);
		min_distance =
				towards > 0.0 ? std::min(min_distance, 0.5 * glm::dot(neighbor, neighbor) / towards) : min_distance;
	}
	return min_distance;
}

/// Returns the free area between two directions, integrated over thin sectors.
double free_area(const std::vector<glm::dvec2> &neighbors, double from, double end) {
	constexpr int sectors = 100000;
	const double step = (end - from) / sectors;
	double area = 0.0;
	for (int i = 0; i < sectors; ++i) {
		const double r = reach(neighbors, from + (i + 0.5) * step);
		area += 0.5 * std::max(r * r - 1.0, 0.0) * step;
	}
	return area;
}

std::vector<glm::dvec2> sample(double side, std::uint64_t seed) {
	std::vector<glm::dvec2> points;
	VoronoiDarts().sample(side, seed, points);
	return points;
}

} // namespace

TEST_CASE("jones: free areas of cells are exact, even the smallest") {
	FreeCell cell;
	cell.assign({{2.0, 0.0}, {0.0, 2.0}, {-2.0, 0.0}, {0.0, -2.0}});
	CHECK(std::abs(cell.area() - (4.0 - std::numbers::pi)) < 1e-15);

	cell.assign({{1.2, 0.0}, {0.6, 1.1}, {-0.6, 1.1}, {-1.2, 0.0}, {-0.6, -1.1}, {0.6, -1.1}});
	CHECK(cell.area() == 0.0);

	cell.assign(all_kinds);
	CHECK(std::abs(cell.area() - free_area(all_kinds, 0.0, 2.0 * std::numbers::pi)) < 1e-8);

	// A square whose corners are barely outside the disk. Each free corner is nearly a right
	// triangle whose legs lie on two edges of the square.
	for (const double excess : {1e-4, 1e-6, 1e-8}) {
		const double distance = std::numbers::sqrt2 * (1.0 + excess);
		cell.assign({{distance, 0.0}, {0.0, distance}, {-distance, 0.0}, {0.0, -distance}});
		const double expected = 4.0 * excess * excess;
		CHECK(std::abs(cell.area() / expected - 1.0) < 2.0 * excess + 1e-7);
	}
}

TEST_CASE("jones: darts in a cell are uniform over its free area") {
	constexpr int darts = 40000;
	constexpr std::size_t sectors = 24;
	FreeCell cell;
	cell.assign(all_kinds);
	Xoroshiro random(1);
	std::array<int, sectors> inner{}; // Darts in the half of the sector's area next to the disk.
	std::array<int, sectors> outer{};
	int outside_count = 0;
	for (int i = 0; i < darts; ++i) {
		const glm::dvec2 dart = cell.draw(random);
		const double turn = std::atan2(dart.y, dart.x) / (2.0 * std::numbers::pi);
		const double edge = reach(all_kinds, std::atan2(dart.y, dart.x));
		const double squared = glm::dot(dart, dart);
		outside_count += squared < 1.0 - 1e-15 || squared > edge * edge + 1e-12 ? 1 : 0;
		const auto sector = static_cast<std::size_t>((turn + 1.0) * sectors) % sectors;
		++(2.0 * squared < 1.0 + edge * edge ? inner : outer)[sector];
	}
	CHECK(outside_count == 0);
	for (std::size_t i = 0; i < sectors; ++i) {
		CAPTURE(i);
		const double width = 2.0 * std::numbers::pi / sectors;
		const double from = static_cast<double>(i) * width;
		const double expected = 0.5 * darts * free_area(all_kinds, from, from + width) / cell.area();
		CHECK(std::abs(inner[i] - expected) <= 4.0 * std::sqrt(expected) + 1e-3);
		CHECK(std::abs(outer[i] - expected) <= 4.0 * std::sqrt(expected) + 1e-3);
	}
}

TEST_CASE("jones: on tori of any width, points keep their distance and leave no gap") {
	for (const double side : {4.0, 4.7, 6.0, 9.99, 25.3, 120.0}) {
		CAPTURE(side);
		const std::vector<glm::dvec2> points = sample(side, 11);
		const analysis::BaselineReport report = analysis::BaselineCheck::run(
				points, {.size = glm::dvec2(side), .toroidal = true, .tolerance = 2.0 * FreeCell::tolerance});
		CHECK(report.outside == 0);
		CHECK(report.too_close == 0);
		CHECK(report.gaps == 0);
	}
}

TEST_CASE("jones: the seed determines the set") {
	VoronoiDarts darts;
	std::vector<glm::dvec2> points;
	darts.sample(20.0, 5, points);
	const std::vector<glm::dvec2> first = points;
	darts.sample(31.0, 6, points);
	darts.sample(20.0, 5, points);
	CHECK(points == first);
	CHECK(sample(20.0, 6) != first);
}

TEST_CASE("jones: the second dart is uniform outside of the first disk") {
	constexpr double side = 4.0;
	constexpr double ring = 1.6;
	constexpr int sets = 1500;
	int near_count = 0;
	for (std::uint64_t seed = 0; seed < sets; ++seed) {
		const std::vector<glm::dvec2> points = sample(side, seed);
		const glm::dvec2 straight = points[1] - points[0];
		const glm::dvec2 offset = straight - side * glm::round(straight / side);
		near_count += glm::dot(offset, offset) < ring * ring ? 1 : 0;
	}
	const double expected = std::numbers::pi * (ring * ring - 1.0) / (side * side - std::numbers::pi);
	const double error = std::sqrt(expected * (1.0 - expected) / sets);
	CHECK(std::abs(static_cast<double>(near_count) / sets - expected) < 4.0 * error);
}

TEST_CASE("jones: coverage matches dart throwing") {
	constexpr double side = 60.0;
	constexpr int sets = 24;
	double sum = 0.0;
	double sum_of_squares = 0.0;
	for (std::uint64_t seed = 0; seed < sets; ++seed) {
		const double coverage =
				static_cast<double>(sample(side, seed).size()) * 0.25 * std::numbers::pi / (side * side);
		sum += coverage;
		sum_of_squares += coverage * coverage;
	}
	const double mean = sum / sets;
	const double error = std::sqrt((sum_of_squares / sets - mean * mean) / (sets - 1));
	CAPTURE(mean);
	CAPTURE(error);
	CHECK(error < 0.001);
	CHECK(std::abs(mean - 0.547070) < 4.0 * error);
}

#endif
