// Tests guarantees 2 and 3 of TileSampler exactly, with integer lattice coordinates, for every
// level of the progressive order. No two points are closer than the radius, even if they are in
// different tiles. No lattice point is left where another point would fit.

#include "tests/analysis/lattice_checks.hpp"
#include "tilings.hpp"

#include <doctest/doctest.h>
#include <glm/common.hpp>

#include <vector>

using namespace thicket;
using namespace thicket::tilings;
using analysis::LatticeCheck;
using analysis::LatticeReport;

namespace {

/// Returns the points of this level and all coarser ones, in units of this level's lattice. The
/// unit is 2^level times the unit of the finest level, so the same check works for every level.
std::vector<glm::i64vec2> lattice_points(
		const PointSet &set, const std::vector<SamplePoint> &points, std::uint32_t level) {
	const std::uint64_t end = level_rank_end(set.levels, level);
	std::vector<glm::i64vec2> lattice;
	std::size_t disagree = 0;
	std::size_t off_lattice = 0;
	for (const SamplePoint &point : points) {
		disagree += (point.rank < end) != (point.level >= level) ? 1 : 0;
		if (point.rank < end) {
			const glm::i64vec2 finest = lattice_position(set, point);
			lattice.emplace_back(finest.x >> level, finest.y >> level);
			off_lattice += lattice.back().x << level != finest.x || lattice.back().y << level != finest.y ? 1 : 0;
		}
	}
	CHECK(disagree == 0);
	CHECK(off_lattice == 0);
	return lattice;
}

/// Returns the cells of a level whose border of three cells is also within `region`.
analysis::CellRect inner_cells(const PointSet &set, const Rect &region, std::uint32_t level) {
	const double cell = lattice_unit(set) * static_cast<double>(1u << (lattice_bits + level));
	const glm::dvec2 first = glm::ceil(region.min / cell);
	const glm::dvec2 last = glm::floor(region.max / cell);
	return {glm::i64vec2(first) + std::int64_t{3}, glm::i64vec2(last) - std::int64_t{3}};
}

/// Checks every level of the set in a region that is assembled from tiles.
void check_region(const PointSet &set, const Rect &region, const Tiling &tiling, std::uint64_t min_points) {
	const std::vector<SamplePoint> points = points_through(set, region, tiling);
	for (std::uint32_t level = 0; level < set.levels; ++level) {
		CAPTURE(level);
		const LatticeReport report =
				LatticeCheck::run(lattice_points(set, points, level), lattice_bits, inner_cells(set, region, level));
		CHECK(report.points >= min_points >> (2 * level));
		CHECK(report.too_close == 0);
		CHECK(report.uncovered == 0);
	}
}

} // namespace

TEST_CASE("lattice: a million points from tiles keep their distance and leave no gap") {
	const PointSet set{.seed = 21, .radius = 1.0, .levels = 1, .layer = 0};
	check_region(set, {{-641.0, -313.0}, {579.0, 907.0}}, {.name = "61 m", .size{61.0, 61.0}, .threads = 2}, 1'000'000);
}

TEST_CASE("lattice: sets at the end of the world are exact, too") {
	const PointSet set{.seed = 22, .radius = 1.0, .levels = 1, .layer = 7};
	check_region(set, {{-5.9e6, 5.9e6}, {-5.9e6 + 200.0, 5.9e6 + 300.0}}, {.name = "17 m x 31 m", .size{17.0, 31.0}},
			38'000);
}

TEST_CASE("lattice: every level of a progressive set is maximal for its radius") {
	for (std::uint32_t levels = 2; levels <= max_levels; ++levels) {
		CAPTURE(levels);
		// Wide enough for a few points of the coarsest level inside the border.
		const double side = 0.5 * 12.0 * static_cast<double>(1u << (levels - 1));
		const PointSet set{.seed = 30 + levels, .radius = 0.5, .levels = levels, .layer = 1};
		const Rect region{{-0.4 * side, 100.0}, {0.6 * side, 100.0 + side}};
		check_region(
				set, region, {.name = "50 m", .size{50.0, 50.0}}, static_cast<std::uint64_t>(side * side * 4.0 * 0.2));
	}
}

TEST_CASE("lattice: the check itself finds a missing point and an extra point") {
	const PointSet set{.seed = 23, .radius = 1.0, .levels = 1, .layer = 0};
	const Rect region{{0.0, 0.0}, {40.0, 40.0}};
	const std::vector<glm::i64vec2> points = lattice_points(set, points_at_once(set, region), 0);
	const analysis::CellRect cells = inner_cells(set, region, 0);
	REQUIRE(LatticeCheck::run(points, lattice_bits, cells).perfect());

	const auto is_inside = [&](glm::i64vec2 point) {
		return cells.contains({point.x >> lattice_bits, point.y >> lattice_bits});
	};
	for (std::size_t i = 0; i < points.size(); i += 29) {
		if (!is_inside(points[i])) {
			continue;
		}
		// Without the point, at least its lattice point is uncovered, because no other point
		// can be closer than the radius.
		std::vector<glm::i64vec2> fewer = points;
		fewer.erase(fewer.begin() + static_cast<std::ptrdiff_t>(i));
		const LatticeReport hole = LatticeCheck::run(fewer, lattice_bits, cells);
		CHECK(hole.uncovered > 0);
		CHECK(hole.too_close == 0);

		std::vector<glm::i64vec2> more_points = points;
		more_points.push_back(points[i] + glm::i64vec2(20000, 3000));
		CHECK(LatticeCheck::run(more_points, lattice_bits, cells).too_close > 0);
	}
}

TEST_CASE("lattice: the check is exact to single lattice points") {
	constexpr int bits = 4;
	const std::int64_t side = 1 << bits;
	// A point in the corner of every cell. Neighbors are one cell width apart, which is too close, but
	// everything is covered.
	std::vector<glm::i64vec2> points;
	for (std::int64_t y = -3; y < 6; ++y) {
		for (std::int64_t x = -3; x < 6; ++x) {
			points.emplace_back(x * side, y * side);
		}
	}
	const analysis::CellRect cells{{0, 0}, {3, 3}};
	const LatticeReport crowded = LatticeCheck::run(points, bits, cells);
	CHECK(crowded.too_close > 0);
	CHECK(crowded.uncovered == 0);

	// One point at the origin, radius^2 = 2 * 16^2 = 512. The cell (1, 0) spans x 16..31, y 0..15.
	const LatticeReport lone = LatticeCheck::run(std::vector{glm::i64vec2(0, 0)}, bits, {{1, 0}, {2, 1}});
	std::uint64_t expected = 0;
	for (std::int64_t y = 0; y < side; ++y) {
		for (std::int64_t x = side; x < 2 * side; ++x) {
			expected += x * x + y * y >= 512 ? 1 : 0;
		}
	}
	CHECK(lone.uncovered == expected);
}
