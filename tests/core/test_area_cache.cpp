// Tests that large windows filled from cached areas contain the same points as without a cache. The
// cache must save work, stay within its memory, and support several threads.

#include "core/base/instance_id.hpp"
#include "core/sampling/block_cache.hpp"
#include "core/sampling/tile_sampler.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <atomic>
#include <memory>
#include <random>
#include <thread>
#include <vector>

using namespace thicket;

namespace {

std::vector<SamplePoint> points_in(
		TileSampler &sampler, const PointSet &set, const Rect &rect, WindowUse use = WindowUse::overlapping) {
	std::vector<SamplePoint> points;
	REQUIRE(sampler.sample(set, rect, points, {}, nullptr, nullptr, use).ok());
	return points;
}

/// Returns the window of a tile that is 64 radii wide, with a margin of 10 radii.
Rect window_of(const PointSet &set, int x, int y) {
	const glm::dvec2 corner = 64.0 * set.radius * glm::dvec2(x, y);
	return {corner - 10.0 * set.radius, corner + 74.0 * set.radius};
}

} // namespace

TEST_CASE("area cache: windows of any size have the same points in the same order") {
	std::mt19937 random(5); // NOLINT(cert-msc32-c,cert-msc51-cpp): the same windows in every run.
	const auto cache = std::make_shared<BlockCache>(std::size_t{1} << 20);
	TileSampler cached({}, cache);
	TileSampler uncached;
	std::uint64_t taken_count = 0;
	for (const PointSet &set :
			{PointSet{.seed = 1, .radius = 1.0, .levels = 1}, PointSet{.seed = 1, .radius = 1.0, .levels = 4},
					PointSet{.seed = 2, .radius = 3.7, .levels = 1, .layer = 9}}) {
		std::uniform_real_distribution<double> coordinate(-150.0 * set.radius, 150.0 * set.radius);
		std::uniform_real_distribution<double> size(0.0, 160.0 * set.radius);
		for (int i = 0; i < 40; ++i) {
			const glm::dvec2 corner(coordinate(random), coordinate(random));
			const Rect rect{corner, corner + glm::dvec2(size(random), size(random))};
			CAPTURE(i);
			CHECK(points_in(cached, set, rect) == points_in(uncached, set, rect));
			taken_count += cached.stats().computed == 0 && cached.stats().kept > 0 ? 1 : 0;
		}
	}
	CHECK(taken_count > 10);
}

TEST_CASE("area cache: the windows of adjacent tiles share their points") {
	const PointSet set{.seed = 7, .radius = 2.0};
	TileSampler cached({}, std::make_shared<BlockCache>());
	TileSampler uncached;
	std::uint64_t computed_with = 0;
	std::uint64_t computed_without = 0;
	for (int y = 0; y < 5; ++y) {
		for (int x = 0; x < 5; ++x) {
			const Rect window = window_of(set, x, y);
			CHECK(points_in(cached, set, window) == points_in(uncached, set, window));
			computed_with += cached.stats().computed;
			computed_without += uncached.stats().computed;
		}
	}
	CHECK(static_cast<double>(computed_with) < 0.8 * static_cast<double>(computed_without));
	points_in(cached, set, window_of(set, 2, 2));
	CHECK(cached.stats().computed == 0);
}

TEST_CASE("area cache: only windows that overlap use it") {
	const PointSet set{.seed = 7, .radius = 2.0};
	const auto cache = std::make_shared<BlockCache>();
	TileSampler cached({}, cache);
	for (int i = 0; i < 3; ++i) {
		points_in(cached, set, window_of(set, 0, 0), WindowUse::separate);
		CHECK(cached.stats().computed > 0);
	}
	CHECK(cache->areas().bytes() == 0);
	// A window that is too wide is sampled directly.
	points_in(cached, set, {{0.0, 0.0}, {(AreaWindow::widest + 2) * set.radius, 10.0}});
	CHECK(cache->areas().bytes() == 0);
	points_in(cached, set, window_of(set, 0, 0));
	CHECK(cache->areas().bytes() > 0);
}

TEST_CASE("area cache: it stays within its memory, and the most recently used areas remain") {
	const PointSet set{.seed = 3, .radius = 1.0};
	const std::size_t limit = std::size_t{1} << 19;
	const auto cache = std::make_shared<BlockCache>(limit / 4);
	TileSampler sampler({}, cache);
	std::size_t max_bytes = 0;
	for (int x = 0; x < 40; ++x) {
		points_in(sampler, set, window_of(set, x, 0));
		max_bytes = std::max(max_bytes, cache->areas().bytes());
	}
	CHECK(max_bytes <= limit);
	CHECK(max_bytes > limit / 2);
	points_in(sampler, set, window_of(set, 39, 0));
	CHECK(sampler.stats().computed == 0);
	points_in(sampler, set, window_of(set, 0, 0));
	CHECK(sampler.stats().computed > 0);
}

TEST_CASE("area cache: windows at the set's last cells have the same points") {
	const PointSet set{.seed = 11, .radius = 1.0};
	TileSampler cached({}, std::make_shared<BlockCache>());
	TileSampler uncached;
	const double end = cell_limit * cell_size * lattice_unit(set);
	for (const double size : {60.0, 3.0}) {
		for (const Rect &rect :
				{Rect{glm::dvec2(-end), glm::dvec2(size - end)}, Rect{glm::dvec2(end - size), glm::dvec2(end)}}) {
			CHECK(points_in(cached, set, rect) == points_in(uncached, set, rect));
		}
	}
}

TEST_CASE("area cache: a canceled window leaves nothing behind") {
	const PointSet set{.seed = 11, .radius = 1.0};
	const auto cache = std::make_shared<BlockCache>();
	TileSampler cached({}, cache);
	TileSampler uncached;
	std::vector<SamplePoint> points;
	const std::atomic<bool> cancel = true;
	const Progress progress{.cancel = &cancel, .report = {}};
	const Rect window = window_of(set, 0, 0);
	CHECK(cached.sample(set, window, points, progress, nullptr, nullptr, WindowUse::overlapping).code ==
			ErrorCode::cancelled);
	CHECK(cache->areas().bytes() == 0);
	CHECK(points_in(cached, set, window) == points_in(uncached, set, window));
}

TEST_CASE("area cache: several threads take the same points from one cache") {
	const PointSet set{.seed = 13, .radius = 1.0};
	const auto cache = std::make_shared<BlockCache>(std::size_t{1} << 17);
	std::atomic<int> different = 0;
	std::vector<std::thread> threads;
	for (int thread = 0; thread < 4; ++thread) {
		threads.emplace_back([&, thread] {
			TileSampler cached({}, cache);
			TileSampler uncached;
			std::vector<SamplePoint> points, expected;
			for (int i = 0; i < 24; ++i) {
				const Rect window = window_of(set, (i * (thread + 1)) % 5, i % 3);
				const bool ok = cached.sample(set, window, points, {}, nullptr, nullptr, WindowUse::overlapping).ok() &&
						uncached.sample(set, window, expected).ok();
				different += ok && points == expected ? 0 : 1;
			}
		});
	}
	for (std::thread &each : threads) {
		each.join();
	}
	CHECK(different == 0);
}
