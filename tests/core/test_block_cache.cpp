// Tests that windows filled from cached blocks contain the same points as without a cache. The
// cache must save work, stay within its memory, and support several threads.

#include "core/base/instance_id.hpp"
#include "core/placement/tile_builder.hpp"
#include "core/sampling/block_cache.hpp"
#include "core/sampling/tile_sampler.hpp"
#include "counted_threads.hpp"
#include "short_of_memory.hpp"
#include "tile_fixture.hpp"

#include <doctest/doctest.h>

#include <atomic>
#include <memory>
#include <random>
#include <thread>
#include <vector>

using namespace thicket;
using namespace thicket::test;

namespace {

std::vector<SamplePoint> points_in(TileSampler &sampler, const PointSet &set, const Rect &rect) {
	std::vector<SamplePoint> points;
	REQUIRE(sampler.sample(set, rect, points).ok());
	return points;
}

/// Returns a tile that is `radii` radii wide.
Rect tile_of(const PointSet &set, double radii, int x, int y) {
	const glm::dvec2 corner = radii * set.radius * glm::dvec2(x, y);
	return {corner, corner + radii * set.radius};
}

/// Samples all tiles of a square around a tile, row by row.
void walk(
		TileSampler &sampler, const PointSet &set, double radii, glm::ivec2 center_cell, int reach, const auto &check) {
	for (int y = center_cell.y - reach; y <= center_cell.y + reach; ++y) {
		for (int x = center_cell.x - reach; x <= center_cell.x + reach; ++x) {
			const Rect tile = tile_of(set, radii, x, y);
			check(tile, points_in(sampler, set, tile));
		}
	}
}

} // namespace

TEST_CASE("Windows from cached blocks return the same points in the same order") {
	std::mt19937 random(5); // NOLINT(cert-msc32-c,cert-msc51-cpp): the same windows in every run.
	const auto cache = std::make_shared<BlockCache>(std::size_t{1} << 18);
	TileSampler cached({}, cache);
	TileSampler uncached;
	std::uint64_t taken_count = 0;
	for (const PointSet &set :
			{PointSet{.seed = 1, .radius = 1.0, .levels = 1}, PointSet{.seed = 1, .radius = 1.0, .levels = 4},
					PointSet{.seed = 2, .radius = 3.7, .levels = 1, .layer = 9},
					PointSet{.seed = 2, .radius = 3.7, .levels = 8, .layer = 10}}) {
		std::uniform_real_distribution<double> coordinate(-120.0 * set.radius, 120.0 * set.radius);
		std::uniform_real_distribution<double> size(0.0, 24.0 * set.radius);
		for (int i = 0; i < 150; ++i) {
			const glm::dvec2 corner(coordinate(random), coordinate(random));
			const Rect rect{corner, corner + glm::dvec2(size(random), size(random))};
			CAPTURE(i);
			CHECK(points_in(cached, set, rect) == points_in(uncached, set, rect));
			taken_count += cached.stats().computed == 0 && cached.stats().kept > 0 ? 1 : 0;
		}
	}
	CHECK(taken_count > 100);
}

TEST_CASE("Tiles that touch a cached block are not computed again") {
	const PointSet set{.seed = 7, .radius = 2.0};
	TileSampler cached({}, std::make_shared<BlockCache>());
	TileSampler uncached;
	std::uint64_t computed_with = 0;
	std::uint64_t computed_without = 0;
	walk(cached, set, 10.0, {20, -30}, 16, [&](const Rect &tile, const std::vector<SamplePoint> &points) {
		computed_with += cached.stats().computed;
		CHECK(points == points_in(uncached, set, tile));
		computed_without += uncached.stats().computed;
	});
	CHECK(computed_with < computed_without);
	walk(cached, set, 10.0, {20, -30}, 15, [&](const Rect &, const std::vector<SamplePoint> &points) {
		CHECK(cached.stats().computed == 0);
		CHECK(cached.stats().kept == points.size());
	});
}

TEST_CASE("A single window costs the same as without cached blocks") {
	const PointSet set{.seed = 7, .radius = 2.0};
	TileSampler cached({}, std::make_shared<BlockCache>());
	TileSampler uncached;
	for (int i = 0; i < 10; ++i) {
		const Rect tile = tile_of(set, 16.0, 100 * i, -70 * i);
		CHECK(points_in(cached, set, tile) == points_in(uncached, set, tile));
		CHECK(cached.stats().computed == uncached.stats().computed);
	}
}

TEST_CASE("A block next to a cached block is generated for the first window that touches it") {
	const PointSet set{.seed = 7, .radius = 2.0};
	TileSampler cached({}, std::make_shared<BlockCache>());
	TileSampler uncached;
	const double block = SettledBlock::width * static_cast<double>(cell_size) * lattice_unit(set);
	const auto window = [&](double x, double y) {
		const glm::dvec2 corner(block * x, block * y);
		return Rect{corner, corner + 0.1 * block};
	};
	const auto is_settled = [&](const Rect &rect) {
		CHECK(points_in(cached, set, rect) == points_in(uncached, set, rect));
		return cached.stats().computed != uncached.stats().computed;
	};
	CHECK_FALSE(is_settled(window(0.5, 0.5)));
	// An adjacent block was requested only once, so it has not been generated.
	CHECK_FALSE(is_settled(window(1.5, 0.5)));
	CHECK(is_settled(window(0.5, 0.7)));
	CHECK(is_settled(window(0.5, 1.5)));
	CHECK(cached.stats().computed > 0);
	CHECK(is_settled(window(0.7, 1.7)));
	CHECK(cached.stats().computed == 0);
	CHECK_FALSE(is_settled(window(2.5, 2.5))); // This window touches other windows only at a corner.
}

TEST_CASE("Cached blocks stay within the memory limit, and the most recently used blocks remain") {
	const std::size_t limit = std::size_t{1} << 18;
	const auto cache = std::make_shared<BlockCache>(limit);
	TileSampler sampler({}, cache);
	const PointSet set{.seed = 3, .radius = 1.0};
	std::size_t max_bytes = 0;
	walk(sampler, set, 10.0, {0, 0}, 17,
			[&](const Rect &, const std::vector<SamplePoint> &) { max_bytes = std::max(max_bytes, cache->bytes()); });
	CHECK(max_bytes <= limit);
	CHECK(max_bytes > limit / 2);
	points_in(sampler, set, tile_of(set, 10.0, 17, 17));
	CHECK(sampler.stats().computed == 0);
	points_in(sampler, set, tile_of(set, 10.0, -17, -17));
	CHECK(sampler.stats().computed > 0);
}

TEST_CASE("Windows at the set's last cells are filled from blocks, too") {
	const PointSet set{.seed = 11, .radius = 1.0};
	TileSampler cached({}, std::make_shared<BlockCache>());
	TileSampler uncached;
	const double end = cell_limit * cell_size * lattice_unit(set);
	for (const double low : {-end, end - 16.0}) {
		const Rect rect{{low, low}, {low + 16.0, low + 16.0}};
		for (int i = 0; i < 3; ++i) {
			CHECK(points_in(cached, set, rect) == points_in(uncached, set, rect));
		}
		CHECK(cached.stats().computed == 0);
	}
}

TEST_CASE("After a canceled window, the next window can generate its blocks") {
	const PointSet set{.seed = 4, .radius = 1.0};
	TileSampler sampler({}, std::make_shared<BlockCache>());
	const Rect rect{{10.0, 10.0}, {26.0, 26.0}};
	points_in(sampler, set, rect);
	std::atomic<bool> cancel = true;
	std::vector<SamplePoint> points;
	CHECK(sampler.sample(set, rect, points, {.cancel = &cancel, .report = {}}).code == ErrorCode::cancelled);
	points_in(sampler, set, rect);
	CHECK(sampler.stats().computed > 0);
	points_in(sampler, set, rect);
	CHECK(sampler.stats().computed == 0);
}

TEST_CASE("Threads that share blocks get the same points") {
	const PointSet set{.seed = 8, .radius = 1.0, .levels = 2};
	const auto cache = std::make_shared<BlockCache>(std::size_t{1} << 17);
	std::vector<std::vector<std::vector<SamplePoint>>> found(4);
	{
		std::vector<std::jthread> threads;
		for (std::vector<std::vector<SamplePoint>> &points : found) {
			threads.emplace_back([&] {
				TileSampler sampler({}, cache);
				for (int i = 0; i < 300; ++i) {
					points.emplace_back();
					static_cast<void>(sampler.sample(set, tile_of(set, 15.0, i % 10, i / 10 % 10), points.back()));
				}
			});
		}
	}
	TileSampler uncached;
	for (int i = 0; i < 300; ++i) {
		const std::vector<SamplePoint> expected = points_in(uncached, set, tile_of(set, 15.0, i % 10, i / 10 % 10));
		for (const auto &points : found) {
			CHECK(points[static_cast<std::size_t>(i)] == expected);
		}
	}
}

TEST_CASE("Without memory for a block, a window fails or is sampled directly, and the cache stays usable") {
	const PointSet set{.seed = 6, .radius = 1.0};
	const Rect rect{{60.0, 60.0}, {75.0, 75.0}};
	struct Job {
		TileSampler sampler{{}, std::make_shared<BlockCache>()};
		std::vector<SamplePoint> points;
	};
	TileSampler uncached;
	const std::vector<SamplePoint> expected = points_in(uncached, set, rect);
	fail_every_request(
			"rect",
			[&] {
				Job job;
				points_in(job.sampler, set, rect); // The second request generates the blocks.
				return job;
			},
			[&](Job &job) { return job.sampler.sample(set, rect, job.points); },
			[](const Job &job) { CHECK(job.points.empty()); }, [&](const Job &job) { CHECK(job.points == expected); });
}

TEST_CASE("Whole tiles are the same with cached blocks, even if layers depend on each other") {
	LayerSettings trees = rich_layer();
	trees.set = {.seed = 3, .radius = 6.0, .layer = 1};
	LayerSettings plants = rich_layer();
	plants.set = {.seed = 4, .radius = 2.0, .layer = 2};
	plants.neighbors = {{std::make_shared<LayerSettings>(trees), 5.0, nullptr}};
	TileBuilder caching_builder({}, std::make_shared<BlockCache>());
	TileBuilder plain_builder;
	TileInstances cached, alone;
	const Heightfield ground = hills();
	for (int i = 0; i < 64; ++i) {
		const Rect tile = tile_of(plants.set, 12.0, i % 8, i / 8);
		REQUIRE(caching_builder.build(plants, ground, tile, cached).ok());
		REQUIRE(plain_builder.build(plants, ground, tile, alone).ok());
		REQUIRE(cached.meshes.size() == alone.meshes.size());
		for (std::size_t mesh = 0; mesh < cached.meshes.size(); ++mesh) {
			CHECK(cached.meshes[mesh].buffer == alone.meshes[mesh].buffer);
			CHECK(cached.meshes[mesh].ids == alone.meshes[mesh].ids);
			CHECK(cached.meshes[mesh].ranks == alone.meshes[mesh].ranks);
		}
	}
}

TEST_CASE("Whole tiles take the points of their layer and of neighbor layers from cached blocks") {
	LayerSettings trees = rich_layer();
	trees.set = {.seed = 3, .radius = 6.0, .layer = 1};
	LayerSettings plants = rich_layer();
	plants.set = {.seed = 4, .radius = 2.0, .layer = 2};
	const auto cache = std::make_shared<BlockCache>();
	TileBuilder cached({}, cache);
	TileInstances tile;
	const Heightfield ground = hills();
	const auto build = [&](double x) {
		REQUIRE(cached.build(plants, ground, {{x, 0.0}, {x + 12.0, 12.0}}, tile).ok());
		return cached.sample_stats().computed;
	};
	CHECK(build(0.0) > 0);
	CHECK(build(12.0) > 0);
	CHECK(build(24.0) == 0);
	const std::size_t plants_alone = cache->bytes();
	plants.neighbors = {{std::make_shared<LayerSettings>(trees), 5.0, nullptr}};
	CHECK(build(0.0) == 0);
	CHECK(build(12.0) == 0);
	CHECK(cache->bytes() > plants_alone);
}

TEST_CASE("Pieces of a large rectangle take the points of neighbor layers from cached blocks") {
	LayerSettings trees = rich_layer();
	trees.set = {.seed = 3, .radius = 12.0, .layer = 1};
	LayerSettings plants = rich_layer();
	plants.neighbors = {{std::make_shared<LayerSettings>(trees), 2.0, nullptr}};
	const auto cache = std::make_shared<BlockCache>();
	TileBuilder builder({}, cache);
	TileInstances tile;
	CountedThreads threads(1);
	REQUIRE(builder.build(plants, hills(), {{-200.0, -200.0}, {200.0, 200.0}}, tile, nullptr, &threads).ok());
	CHECK(threads.runs > 0);
	CHECK(cache->bytes() > 0);
}
