// Tests guarantee 1 of TileSampler: sampling any rectangle that contains a point of the set returns
// this point, bit for bit.

#include "core/base/instance_id.hpp"
#include "tilings.hpp"

#include <doctest/doctest.h>

#include <glm/common.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <span>

using namespace thicket;
using namespace thicket::tilings;

namespace {

/// Checks that every tiling returns the same points as a single call for the whole region.
void check_tilings(const PointSet &set, const Rect &region, std::span<const Tiling> tilings, std::size_t min_points) {
	const std::vector<SamplePoint> all_points = points_at_once(set, region);
	CHECK(all_points.size() >= min_points);
	for (const Tiling &tiling : tilings) {
		CAPTURE(tiling.name);
		const std::vector<SamplePoint> tiled = points_through(set, region, tiling);
		CHECK(tiled.size() == all_points.size());
		// CHECK on the vectors themselves would print up to a million points.
		const bool identical = tiled == all_points;
		CHECK(identical);
	}
}

/// Returns a rectangle that contains this position and no other double.
Rect only(glm::dvec2 position) {
	return {position, {std::nextafter(position.x, HUGE_VAL), std::nextafter(position.y, HUGE_VAL)}};
}

} // namespace

TEST_CASE("windows: a million points on both sides of the origin, tiles from 1 m to 1 km") {
	const PointSet set{.seed = 11, .radius = 0.25, .levels = 1, .layer = 3};
	const std::array tilings = {
			Tiling{.name = "1 m, two threads, any order", .size{1.0, 1.0}, .threads = 2, .shuffle = 1},
			Tiling{.name = "10 m", .size{10.0, 10.0}},
			Tiling{.name = "3 m x 17 m, offset", .size{3.0, 17.0}, .offset{0.4, -1.7}},
			Tiling{.name = "64 m, any order", .size{64.0, 64.0}, .shuffle = 2},
			Tiling{.name = "33.3 m x 8.1 m, offset, two threads",
					.size{33.3, 8.1},
					.offset{-5.5, 100.25},
					.threads = 2},
			Tiling{.name = "100 m, two threads, any order", .size{100.0, 100.0}, .threads = 2, .shuffle = 3},
			Tiling{.name = "2.5 m x 300 m", .size{2.5, 300.0}},
			Tiling{.name = "1 km x 75 m, offset", .size{1000.0, 75.0}, .offset{-313.0, 20.0}},
	};
	check_tilings(set, {{-170.5, -129.25}, {130.0, 171.0}}, tilings, 1'000'000);
}

TEST_CASE("windows: a million points 5 000 km from the origin, tiles from 1 m to 1 km") {
	const PointSet set{.seed = 12, .radius = 1.0, .levels = 1, .layer = 0};
	const std::array tilings = {
			Tiling{.name = "1 m, two threads, any order", .size{1.0, 1.0}, .threads = 2, .shuffle = 4},
			Tiling{.name = "10 m, two threads, any order", .size{10.0, 10.0}, .threads = 2, .shuffle = 1},
			Tiling{.name = "16 m", .size{16.0, 16.0}},
			Tiling{.name = "12 m x 70 m, offset", .size{12.0, 70.0}, .offset{0.4, -1.7}},
			Tiling{.name = "64 m, any order", .size{64.0, 64.0}, .shuffle = 2},
			Tiling{.name = "133.3 m x 18.1 m, offset, two threads",
					.size{133.3, 18.1},
					.offset{-5.5, 1.25},
					.threads = 2},
			Tiling{.name = "256 m, two threads", .size{256.0, 256.0}, .threads = 2},
			Tiling{.name = "1 km x 20 m", .size{1000.0, 20.0}},
			Tiling{.name = "1 km, offset", .size{1000.0, 1000.0}, .offset{-313.0, 20.0}},
	};
	check_tilings(set, {{5.0e6, -3.0e6}, {5.0e6 + 1203.0, -3.0e6 + 1203.0}}, tilings, 1'000'000);
}

TEST_CASE("windows: a million points of a progressive set, four levels, tiles from 8 m to 1 km") {
	const PointSet set{.seed = 13, .radius = 1.0, .levels = 4, .layer = 65535};
	const std::array tilings = {
			Tiling{.name = "20 m, two threads, any order", .size{20.0, 20.0}, .threads = 2, .shuffle = 1},
			Tiling{.name = "8 m x 300 m, offset", .size{8.0, 300.0}, .offset{0.4, -1.7}},
			Tiling{.name = "64 m, any order", .size{64.0, 64.0}, .shuffle = 2},
			Tiling{.name = "133.3 m x 38.1 m, offset, two threads",
					.size{133.3, 38.1},
					.offset{-5.5, 1.25},
					.threads = 2},
			Tiling{.name = "200 m", .size{200.0, 200.0}},
			Tiling{.name = "256 m, two threads, any order", .size{256.0, 256.0}, .threads = 2, .shuffle = 3},
			Tiling{.name = "1 km x 50 m", .size{1000.0, 50.0}},
			Tiling{.name = "1 km, offset", .size{1000.0, 1000.0}, .offset{-313.0, 20.0}},
	};
	check_tilings(set, {{-703.0, -499.0}, {491.0, 695.0}}, tilings, 1'000'000);
}

TEST_CASE("windows: all levels return the same points through small tiles") {
	for (std::uint32_t levels = 1; levels <= max_levels; ++levels) {
		CAPTURE(levels);
		const PointSet set{.seed = levels, .radius = 2.0, .levels = levels, .layer = 9};
		const std::array tilings = {
				Tiling{.name = "9 m, any order", .size{9.0, 9.0}, .shuffle = 1},
				Tiling{.name = "40 m x 11 m, two threads", .size{40.0, 11.0}, .offset{0.1, 0.2}, .threads = 2},
		};
		check_tilings(set, {{-60.0, 20.0}, {0.0, 80.0}}, tilings, 500);
	}
}

TEST_CASE("windows: where the margin was too small at first, the points are the same") {
	// About one cell in a million depends on a chain that leaves the initial margin. In a wide
	// window, most chains are well inside. In strips one cell wide, all cells are at the border, so
	// such chains are found quickly.
	for (const std::uint32_t levels : {1u, max_levels}) {
		CAPTURE(levels);
		const PointSet set{.seed = 17, .radius = 1.0, .levels = levels, .layer = 2};
		TileSampler sampler;
		std::vector<SamplePoint> points;
		int widened = 0;
		for (int strip = 0; strip < 30'000 && widened < 4; ++strip) {
			const glm::dvec2 corner(90.0 * (strip % 20), 0.7 * (strip / 20) - 500.0);
			const Rect rect{corner, corner + glm::dvec2(90.0, 0.7)};
			REQUIRE(sampler.sample(set, rect, points).ok());
			if (sampler.stats().retries == 0) {
				continue;
			}
			++widened;
			std::vector<SamplePoint> expected = points_at_once(set, expanded(rect, 40.0));
			std::erase_if(expected, [&](const SamplePoint &point) { return !rect.contains(point.position); });
			std::sort(points.begin(), points.end(),
					[](const SamplePoint &a, const SamplePoint &b) { return a.id < b.id; });
			CHECK(points == expected);
		}
		CHECK(widened == 4);
	}
}

TEST_CASE("windows: rectangles are half-open, exactly") {
	for (const std::uint32_t levels : {1u, 3u}) {
		const PointSet set{.seed = 14, .radius = 1.7, .levels = levels, .layer = 1};
		TileSampler sampler;
		std::vector<SamplePoint> points;
		for (const glm::dvec2 corner : {glm::dvec2(-10.0), glm::dvec2(4.9e6, -4.9e6)}) {
			for (const SamplePoint &point : points_at_once(set, {corner, corner + 20.0})) {
				REQUIRE(sampler.sample(set, only(point.position), points).ok());
				REQUIRE(points.size() == 1);
				CHECK(points.front() == point);
				const Rect up_to{point.position - 0.5, point.position};
				REQUIRE(sampler.sample(set, up_to, points).ok());
				CHECK(points.empty());
				const Rect after{{std::nextafter(point.position.x, HUGE_VAL), point.position.y}, point.position + 0.5};
				REQUIRE(sampler.sample(set, after, points).ok());
				CHECK(points.empty());
			}
		}
	}
}

TEST_CASE("windows: a strip of 900 km") {
	const PointSet set{.seed = 15, .radius = 1.0, .levels = 1, .layer = 0};
	const std::vector<SamplePoint> strip = points_at_once(set, {{-450'000.0, 3.0}, {450'000.0, 4.0}});
	CHECK(static_cast<double>(strip.size()) == doctest::Approx(900'000.0 * point_density(set)).epsilon(0.01));
	for (const double x : {-450'000.0, -0.5, 449'000.0}) {
		CAPTURE(x);
		const Rect window{{x, 3.0}, {x + 1000.0, 4.0}};
		std::vector<SamplePoint> inner_points;
		std::copy_if(strip.begin(), strip.end(), std::back_inserter(inner_points),
				[&](const SamplePoint &point) { return window.contains(point.position); });
		CHECK((inner_points == points_at_once(set, window)));
	}
}

TEST_CASE("windows: tiles at the corners of the world return the same points") {
	const PointSet set{.seed = 15, .radius = 0.5, .levels = 2, .layer = 1};
	const double limit = lattice_unit(set) * 16384.0 * cell_limit;
	for (const glm::dvec2 side :
			{glm::dvec2(-1.0, -1.0), glm::dvec2(1.0, -1.0), glm::dvec2(-1.0, 1.0), glm::dvec2(1.0, 1.0)}) {
		const glm::dvec2 outer = side * limit;
		const glm::dvec2 inner = side * (limit - 12.0);
		const Rect region{glm::min(outer, inner), glm::max(outer, inner)};
		const std::vector<SamplePoint> all_points = points_at_once(set, region);
		CHECK(all_points.size() > 350);
		std::vector<SamplePoint> parts;
		for (int quarter_index = 0; quarter_index < 4; ++quarter_index) {
			const glm::dvec2 middle = region.center();
			const Rect quarter{
					{quarter_index & 1 ? middle.x : region.min.x, quarter_index & 2 ? middle.y : region.min.y},
					{quarter_index & 1 ? region.max.x : middle.x, quarter_index & 2 ? region.max.y : middle.y}};
			const std::vector<SamplePoint> quarter_points = points_at_once(set, quarter);
			parts.insert(parts.end(), quarter_points.begin(), quarter_points.end());
		}
		std::sort(parts.begin(), parts.end(), [](const SamplePoint &a, const SamplePoint &b) { return a.id < b.id; });
		CHECK(parts == all_points);
		for (const SamplePoint &point : all_points) {
			const glm::ivec2 cell = unpack(point.id).cell;
			CHECK(glm::min(cell.x, cell.y) >= -cell_limit);
			CHECK(glm::max(cell.x, cell.y) < cell_limit);
		}
	}
}

TEST_CASE("windows: an ID identifies the layer and the cell that contains its point") {
	const PointSet set{.seed = 16, .radius = 3.0, .levels = 1, .layer = 40000};
	for (const SamplePoint &point : points_at_once(set, {{-200.0, -100.0}, {100.0, 300.0}})) {
		const InstanceId id = unpack(point.id);
		CHECK(id.layer == set.layer);
		const glm::i64vec2 lattice = lattice_position(set, point);
		CHECK(id.cell.x == lattice.x >> lattice_bits);
		CHECK(id.cell.y == lattice.y >> lattice_bits);
		CHECK(point.position.x == static_cast<double>(lattice.x) * lattice_unit(set));
		CHECK(point.position.y == static_cast<double>(lattice.y) * lattice_unit(set));
	}
}
