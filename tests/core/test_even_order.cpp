// Tests PointSet::even_order: it changes ranks only, identically in all windows, and spaces every prefix evenly.

#include "core/base/caller_threads.hpp"
#include "core/sampling/block_cache.hpp"
#include "core/sampling/rank.hpp"
#include "core/sampling/tile_sampler.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <vector>

using namespace thicket;

namespace {

std::vector<SamplePoint> sampled(TileSampler &sampler, const PointSet &set, const Rect &rect) {
	std::vector<SamplePoint> points;
	REQUIRE(sampler.sample(set, rect, points).ok());
	return points;
}

std::vector<SamplePoint> sampled(const PointSet &set, const Rect &rect) {
	TileSampler sampler;
	return sampled(sampler, set, rect);
}

/// Returns the squared distance of two points in lattice units of the finest level.
std::int64_t squared_distance(glm::i64vec2 a, glm::i64vec2 b) {
	const glm::i64vec2 offset = a - b;
	return offset.x * offset.x + offset.y * offset.y;
}

/// Returns the least distance of the points below a rank, in radii of a maximal set of equal density.
double relative_radius(const PointSet &set, const std::vector<SamplePoint> &points, double fraction) {
	std::vector<glm::i64vec2> prefix;
	for (const SamplePoint &point : points) {
		if (point.rank < fraction * 0x1p32) {
			prefix.push_back(lattice_position(set, point));
		}
	}
	std::ranges::sort(prefix, {}, [](glm::i64vec2 point) { return point.x; });
	std::int64_t min_squared = std::int64_t{1} << 60;
	for (std::size_t i = 0; i < prefix.size(); ++i) {
		for (std::size_t j = i + 1; j < prefix.size(); ++j) {
			const std::int64_t dx = prefix[j].x - prefix[i].x;
			if (dx * dx >= min_squared) {
				break;
			}
			min_squared = std::min(min_squared, squared_distance(prefix[i], prefix[j]));
		}
	}
	const double density = fraction * point_density(set);
	const double maximal = std::sqrt(point_density({.radius = 1.0}) / density);
	return std::sqrt(static_cast<double>(min_squared)) * lattice_unit(set) / maximal;
}

} // namespace

TEST_CASE("even order: only ranks differ, and each stays within the ranks of its level") {
	for (const std::uint32_t levels : {1u, 2u, 5u, 8u}) {
		CAPTURE(levels);
		PointSet set{.seed = 3, .radius = 0.7, .levels = levels};
		const Rect rect{{-40.0, 7.0}, {61.0, 90.0}};
		const std::vector<SamplePoint> unordered = sampled(set, rect);
		set.even_order = true;
		const std::vector<SamplePoint> even = sampled(set, rect);
		REQUIRE(even.size() == unordered.size());
		std::size_t moved_count = 0;
		for (std::size_t i = 0; i < even.size(); ++i) {
			SamplePoint expected = unordered[i];
			expected.rank = even[i].rank;
			REQUIRE(even[i] == expected);
			REQUIRE(level_of_rank(levels, even[i].rank) == unordered[i].level);
			REQUIRE((unordered[i].level + 1 < levels || even[i].rank == unordered[i].rank));
			moved_count += even[i].rank != unordered[i].rank;
		}
		CHECK((moved_count > 0) == (levels > 1));
	}
}

TEST_CASE("even order: ranks are the same in all windows, with threads and with a cache") {
	for (const std::uint32_t levels : {2u, 4u, 8u}) {
		CAPTURE(levels);
		const PointSet set{.seed = 11, .levels = levels, .even_order = true};
		const Rect rect{{-150.0, -70.0}, {60.0, 131.0}};
		std::map<std::uint64_t, SamplePoint> whole_region;
		for (const SamplePoint &point : sampled(set, rect)) {
			whole_region[point.id] = point;
		}
		for (const double tile : {7.3, 16.0, 55.0}) {
			CAPTURE(tile);
			TileSampler sampler({}, std::make_shared<BlockCache>());
			std::size_t found_count = 0;
			for (double y = rect.min.y; y < rect.max.y; y += tile) {
				for (double x = rect.min.x; x < rect.max.x; x += tile) {
					const Rect tile_rect{{x, y}, glm::min(glm::dvec2(x + tile, y + tile), rect.max)};
					for (const SamplePoint &point : sampled(sampler, set, tile_rect)) {
						REQUIRE(whole_region.at(point.id) == point);
						++found_count;
					}
				}
			}
			CHECK(found_count == whole_region.size());
		}
	}
}

TEST_CASE("even order: a narrow margin is widened") {
	const PointSet set{.seed = 11, .levels = 4, .even_order = true};
	const Rect rect{{-20.0, -20.0}, {20.0, 20.0}};
	TileSampler narrow({.first = 1});
	CHECK(sampled(narrow, set, rect) == sampled(set, rect));
}

TEST_CASE("even order: ranks follow the spacing, as compared with all points") {
	const PointSet set{.seed = 5, .levels = 2, .even_order = true};
	constexpr double border = 4.0;
	const std::vector<SamplePoint> points = sampled(set, {{-border, -border}, {24.0 + border, 24.0 + border}});
	const std::int64_t widest = std::int64_t{8} << (2 * lattice_bits); // The squared radius of level 1.
	std::vector<glm::i64vec2> at;
	for (const SamplePoint &point : points) {
		at.push_back(lattice_position(set, point));
	}
	std::vector<std::int64_t> clearance(points.size(), widest);
	for (std::size_t i = 0; i < points.size(); ++i) {
		for (std::size_t j = 0; j < points.size(); ++j) {
			if (points[i].level == 0 && points[j].level == 1) {
				clearance[i] = std::min(clearance[i], squared_distance(at[i], at[j]));
			}
		}
	}
	std::map<std::uint32_t, std::int64_t> spacing_by_rank;
	for (std::size_t i = 0; i < points.size(); ++i) {
		std::int64_t spacing = clearance[i];
		for (std::size_t j = 0; j < points.size(); ++j) {
			if (i != j && points[j].level == 0 && clearance[j] > clearance[i]) {
				spacing = std::min(spacing, squared_distance(at[i], at[j]));
			}
		}
		const glm::dvec2 position = points[i].position;
		if (points[i].level == 0 && std::min(position.x, position.y) >= 0.0 &&
				std::max(position.x, position.y) < 24.0) {
			spacing_by_rank[points[i].rank] = spacing;
		}
	}
	REQUIRE(spacing_by_rank.size() > 200);
	std::int64_t before = widest;
	for (const auto &[rank, spacing] : spacing_by_rank) {
		CHECK(spacing <= before);
		before = spacing;
	}
}

TEST_CASE("even order: every prefix from the coarsest level on keeps its distance") {
	PointSet set{.seed = 8, .levels = 4};
	const Rect rect{{0.0, 0.0}, {160.0, 160.0}};
	const std::vector<SamplePoint> expected = sampled(set, rect);
	set.even_order = true;
	const std::vector<SamplePoint> even = sampled(set, rect);
	double least_usual = 1.0;
	double least_even = 1.0;
	for (double fraction = 1.0 / 64.0; fraction <= 1.0; fraction *= 1.03) {
		least_usual = std::min(least_usual, relative_radius(set, expected, fraction));
		least_even = std::min(least_even, relative_radius(set, even, fraction));
	}
	CHECK(least_even > 0.75);
	// The usual order only keeps the radius of the finer level between two levels.
	CHECK(least_usual > 0.49);
	CHECK(least_usual < 0.55);
}
