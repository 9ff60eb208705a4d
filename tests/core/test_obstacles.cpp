// Tests sets that fill the gaps between obstacles: which points they have, and that windows of them
// agree.

#include "core/sampling/tile_sampler.hpp"
#include "oracle.hpp"
#include "tests/bench/common/simd_targets.hpp"

#include <doctest/doctest.h>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

using namespace thicket;

namespace {

/// Large enough for every chain in these tests.
constexpr std::int32_t margin = 24;

/// Returns random obstacles of different sizes, in and around a rectangle.
std::vector<Obstacle> random_obstacles(
		std::mt19937_64 &random, const Rect &area, double smallest, double largest, std::size_t count) {
	const auto between = [&](double from, double to) {
		return from + (to - from) * (static_cast<double>(random() >> 11) * 0x1p-53);
	};
	std::vector<Obstacle> obstacles;
	for (std::size_t i = 0; i < count; ++i) {
		obstacles.push_back(
				{{between(area.min.x, area.max.x), between(area.min.y, area.max.y)}, between(smallest, largest)});
	}
	return obstacles;
}

std::vector<SamplePoint> filled(
		const PointSet &set, const Rect &rect, std::span<const Obstacle> disks, std::int32_t cells = margin) {
	TileSampler sampler;
	std::vector<SamplePoint> points;
	const Obstacles obstacles{disks, cells};
	const Status status = sampler.sample(set, rect, points, {}, nullptr, &obstacles);
	REQUIRE_MESSAGE(status.ok(), describe(status));
	return points;
}

bool obstructed(glm::dvec2 position, std::span<const Obstacle> obstacles) {
	return std::ranges::any_of(obstacles, [&](const Obstacle &each) {
		const glm::dvec2 offset = each.center - position;
		return offset.x * offset.x + offset.y * offset.y < each.radius * each.radius;
	});
}

/// Compares the sampler with the oracle on a rectangle of cells.
void check_against_oracle(const PointSet &set, const CellRect &cells, std::span<const Obstacle> obstacles) {
	const double cell = lattice_unit(set) * cell_size;
	const Rect rect{glm::dvec2(cells.min) * cell, glm::dvec2(cells.max) * cell};
	const std::vector<SamplePoint> points = filled(set, rect, obstacles);
	const oracle::Points truth = oracle::points(set, cells, obstacles);
	const auto expected = std::ranges::count_if(
			truth, [&](const auto &each) { return cells.contains({each.first.first, each.first.second}); });
	CHECK(points.size() == static_cast<std::size_t>(expected));
	for (const SamplePoint &point : points) {
		const glm::ivec2 at = unpack(point.id).cell;
		const auto match = truth.find({at.x, at.y});
		REQUIRE(match != truth.end());
		CHECK(match->second.lattice == lattice_position(set, point));
		CHECK(match->second.rank == point.rank);
		CHECK_FALSE(obstructed(point.position, obstacles));
	}
}

} // namespace

TEST_CASE("obstacles: the points of a filled set are those of a strict-time heap that knows the obstacles") {
	std::mt19937_64 random(35);
	for (const std::uint32_t levels : {1u, 3u}) {
		CAPTURE(levels);
		for (int domain = 0; domain < 8; ++domain) {
			CAPTURE(domain);
			const PointSet set{.seed = random(),
					.radius = 0.25 + static_cast<double>(random() % 1000) / 100.0,
					.levels = levels,
					.layer = static_cast<std::uint16_t>(random())};
			const double cell = lattice_unit(set) * cell_size;
			const std::int32_t max_cell = domain < 4 ? 40 : cell_limit - 400;
			const auto within = [&](std::int32_t bound) {
				return static_cast<std::int32_t>(random() % static_cast<std::uint64_t>(2 * bound)) - bound;
			};
			const glm::ivec2 corner(within(max_cell), within(max_cell));
			const CellRect cells{corner, corner + 20};
			// From obstacles that are smaller than a cell to a few that cover many cells.
			const double size = std::array{0.05, 0.7, 1.5, 8.0}[static_cast<std::size_t>(domain) % 4] * set.radius;
			const std::size_t count =
					std::array<std::size_t, 4>{4000, 900, 300, 30}[static_cast<std::size_t>(domain) % 4];
			const CellRect padded = cells.grown(oracle::margin);
			const Rect area{glm::dvec2(padded.min) * cell, glm::dvec2(padded.max) * cell};
			check_against_oracle(set, cells, random_obstacles(random, area, 0.5 * size, size, count));
		}
	}
}

TEST_CASE("obstacles: all instruction sets find the same points") {
	const PointSet set{.seed = 5, .radius = 2.0, .levels = 2};
	std::mt19937_64 random(7);
	const Rect area{{-80.0, -80.0}, {140.0, 140.0}};
	const std::vector<Obstacle> obstacles = random_obstacles(random, area, 0.5, 4.0, 900);
	std::vector<SamplePoint> expected;
	for (const bench::SimdTarget &target : bench::simd_targets()) {
		CAPTURE(target.name);
		const bench::ForcedTarget forced(target);
		const std::vector<SamplePoint> points = filled(set, {{0.0, 0.0}, {60.0, 60.0}}, obstacles);
		expected = expected.empty() ? points : expected;
		CHECK(points == expected);
	}
	CHECK(expected.size() > 100);
}

TEST_CASE("obstacles: no position is left that is open to the set, and no point is in an obstacle") {
	const PointSet set{.seed = 3, .radius = 1.0};
	std::mt19937_64 random(11);
	const Rect area{{-30.0, -30.0}, {60.0, 60.0}};
	const Rect rect{{0.0, 0.0}, {30.0, 30.0}};
	const std::vector<Obstacle> obstacles = random_obstacles(random, area, 0.4, 2.0, 700);
	const std::vector<SamplePoint> points = filled(set, expanded(rect, 2.0), obstacles);
	const double unit = lattice_unit(set);
	int open = 0;
	const auto is_free = [&](glm::dvec2 position) {
		return !obstructed(position, obstacles) && std::ranges::none_of(points, [&](const SamplePoint &point) {
			return glm::distance(point.position, position) < set.radius * (1.0 - 1e-9);
		});
	};
	// The last gaps lie next to the borders of obstacles, so many positions are just outside of them.
	for (const Obstacle &obstacle : obstacles) {
		for (int step = 0; step < 40; ++step) {
			const double angle = step * 0.157079632679;
			const glm::dvec2 border =
					obstacle.center + (obstacle.radius + 2.0 * unit) * glm::dvec2(std::cos(angle), std::sin(angle));
			const glm::dvec2 position = glm::floor(border / unit) * unit;
			open += rect.contains(position) && is_free(position) ? 1 : 0;
		}
	}
	for (int i = 0; i < 40000; ++i) {
		const auto along = [&] {
			return static_cast<double>(random() >> 11) * 0x1p-53 * 30.0;
		};
		const glm::dvec2 position = glm::floor(glm::dvec2(along(), along()) / unit) * unit;
		open += is_free(position) ? 1 : 0;
	}
	CHECK(open == 0);
	for (const SamplePoint &point : points) {
		CHECK_FALSE(obstructed(point.position, obstacles));
	}
}

TEST_CASE("obstacles: windows of a filled set agree, also with wider margins and more obstacles than needed") {
	const PointSet set{.seed = 8, .radius = 1.5, .levels = 3};
	std::mt19937_64 random(3);
	const std::vector<Obstacle> obstacles =
			random_obstacles(random, {{-200.0, -200.0}, {260.0, 260.0}}, 0.5, 3.0, 12000);
	const Rect region{{-7.0, 3.0}, {113.0, 91.0}};
	std::vector<SamplePoint> all_points = filled(set, region, obstacles, 60);
	std::ranges::sort(all_points, {}, &SamplePoint::id);
	CHECK(all_points.size() > 500);
	for (const double side : {10.0, 33.0, 64.0}) {
		std::vector<SamplePoint> parts;
		for (double y = region.min.y; y < region.max.y; y += side) {
			for (double x = region.min.x; x < region.max.x; x += side) {
				const Rect tile{{x, y}, glm::min(glm::dvec2(x, y) + side, region.max)};
				const double fill_radius = fill_distance(set, margin);
				std::vector<Obstacle> near_obstacles;
				for (const Obstacle &each : obstacles) {
					const glm::dvec2 offset = glm::max(tile.min - each.center, each.center - tile.max);
					if (std::max(offset.x, offset.y) < fill_radius + each.radius) {
						near_obstacles.push_back(each);
					}
				}
				std::ranges::shuffle(near_obstacles, random);
				const std::vector<SamplePoint> points = filled(set, tile, near_obstacles);
				parts.insert(parts.end(), points.begin(), points.end());
			}
		}
		std::ranges::sort(parts, {}, &SamplePoint::id);
		CHECK(parts == all_points);
	}
}

TEST_CASE("obstacles: a margin that is too narrow is an error, not a different set") {
	const PointSet set{.seed = 8, .radius = 1.0};
	TileSampler sampler;
	std::vector<SamplePoint> points;
	const std::vector<Obstacle> single_obstacle{{{3.0, 3.0}, 1.0}};
	const Obstacles obstacles{single_obstacle, 0};
	const Status status = sampler.sample(set, {{0.0, 0.0}, {20.0, 20.0}}, points, {}, nullptr, &obstacles);
	CHECK(status.code == ErrorCode::margin_too_wide);
	CHECK(points.empty());
	// The next call without obstacles has the points of the plain set.
	std::vector<SamplePoint> plain;
	REQUIRE(sampler.sample(set, {{0.0, 0.0}, {20.0, 20.0}}, points).ok());
	REQUIRE(TileSampler().sample(set, {{0.0, 0.0}, {20.0, 20.0}}, plain).ok());
	CHECK(points == plain);
}

TEST_CASE("obstacles: without obstacles, a filled set equals the plain set") {
	const PointSet set{.seed = 21, .radius = 1.0, .levels = 2};
	const Rect rect{{-40.0, 5.0}, {60.0, 90.0}};
	std::vector<SamplePoint> plain;
	REQUIRE(TileSampler().sample(set, rect, plain).ok());
	CHECK(filled(set, rect, {}) == plain);
}
