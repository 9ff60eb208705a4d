// Tests that threads which the caller lends to a build share a large rectangle. The tile and the
// errors must be the same as without them.

#include "core/terrain/flat_terrain.hpp"
#include "counted_threads.hpp"
#include "tile_fixture.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <set>
#include <thread>
#include <utility>

using namespace thicket;
using namespace thicket::test;

namespace {

constexpr Rect wide{{-200.0, -190.0}, {200.0, 190.0}};

/// Hills that block the first call, for up to 20 s, until a second thread samples them.
class BlockingHills final : public Terrain {
public:
	Status sample(std::span<const glm::dvec2> positions, std::span<Ground> r_ground) const override {
		std::unique_lock lock(mutex_);
		threads_.insert(std::this_thread::get_id());
		met_.notify_all();
		met_.wait_for(lock, std::chrono::seconds(20), [this] { return threads_.size() > 1; });
		lock.unlock();
		return hills_.sample(positions, r_ground);
	}

	std::size_t threads() const { return threads_.size(); }

private:
	Heightfield hills_ = hills();
	mutable std::mutex mutex_;
	mutable std::condition_variable met_;
	mutable std::set<std::thread::id> threads_;
};

/// Ground that fails after `calls` calls.
class Broken final : public Terrain {
public:
	explicit Broken(int calls) : calls_(calls) {}

	Status sample(std::span<const glm::dvec2> positions, std::span<Ground> r_ground) const override {
		return calls_so_far_++ < calls_ ? flat_.sample(positions, r_ground)
										: Status{ErrorCode::missing, "heights", 3.0};
	}

private:
	FlatTerrain flat_{1.0f};
	mutable std::atomic<int> calls_so_far_ = 0;
	int calls_;
};

} // namespace

TEST_CASE("tile: lent threads share points and ground, and the result is bit-identical") {
	const Heightfield terrain = hills();
	const LayerSettings layer = rich_layer();
	const TileInstances alone = built(layer, terrain, wide);
	CHECK(size_of(alone) > 5000);
	for (const std::size_t count : {0u, 1u, 3u}) {
		CAPTURE(count);
		CountedThreads threads(count);
		TileBuilder builder;
		TileInstances tile;
		REQUIRE(builder.build(layer, terrain, wide, tile, nullptr, &threads).ok());
		CHECK(digest(tile) == digest(alone));
		CHECK(threads.runs == (count > 0 ? 4 : 0)); // The four steps filter, gather, sort and write instances.
		CHECK(tile.counts.sampled == alone.counts.sampled);
		CHECK(tile.counts.dense == alone.counts.dense);
		CHECK(tile.counts.placed == alone.counts.placed);
		for (std::size_t mesh = 0; mesh < tile.meshes.size(); ++mesh) {
			CHECK(tile.meshes[mesh].min == alone.meshes[mesh].min);
			CHECK(tile.meshes[mesh].max == alone.meshes[mesh].max);
			CHECK(tile.meshes[mesh].max_scale == alone.meshes[mesh].max_scale);
			CHECK(tile.meshes[mesh].normals == alone.meshes[mesh].normals);
		}
	}
	// A small tile uses no lent thread.
	CountedThreads threads(3);
	TileBuilder builder;
	TileInstances tile;
	REQUIRE(builder.build(layer, terrain, tile_of_hills, tile, nullptr, &threads).ok());
	CHECK(threads.runs == 0);
}

TEST_CASE("tile: lent threads share layers with spacing, feathered edges and sources") {
	LayerSettings layer = rich_layer();
	auto trees = std::make_shared<LayerSettings>(rich_layer());
	trees->set = {.seed = 5, .radius = 4.0, .levels = 1, .layer = 9};
	layer.neighbors = {{trees, 2.5, nullptr}};
	layer.rules.edge_feather = 3.0;
	layer.instance_data.use_colors = true;
	layer.instance_data.colors = std::make_shared<const ColorTable>(16, glm::vec4(0.25f, 0.5f, 0.75f, 1.0f));
	layer.instance_data.color.kind = SourceKind::distance;
	layer.instance_data.color.layer = trees;
	layer.instance_data.color.max = 6.0;
	layer.instance_data.use_custom_data = true;
	layer.instance_data.variation.kind = SourceKind::height;
	layer.instance_data.variation.max = 90.0;
	const Heightfield terrain = hills();
	const TileInstances alone = built(layer, terrain, wide);
	CHECK(size_of(alone) > 1000);
	CountedThreads threads(2);
	TileBuilder builder;
	TileInstances tile;
	REQUIRE(builder.build(layer, terrain, wide, tile, nullptr, &threads).ok());
	CHECK(threads.runs == 4);
	CHECK(digest(tile) == digest(alone));
	for (std::size_t mesh = 0; mesh < tile.meshes.size(); ++mesh) {
		CHECK(std::ranges::equal(tile.meshes[mesh].fractions, alone.meshes[mesh].fractions,
				[](const SourceFractions &a, const SourceFractions &b) {
					return a.color == b.color && a.variation == b.variation;
				}));
	}
}

TEST_CASE("tile: with few or no instances, lent threads build the same tile") {
	LayerSettings layer = rich_layer();
	const Heightfield terrain = hills();
	layer.rules.density = 1e-4; // Only a few instances remain.
	LayerSettings no_meshes = rich_layer();
	no_meshes.rules.min_height = 500.0;
	for (const LayerSettings &each : {layer, no_meshes}) {
		const TileInstances alone = built(each, terrain, wide);
		CHECK(size_of(alone) < 20);
		CountedThreads threads(3);
		TileBuilder builder;
		TileInstances tile;
		REQUIRE(builder.build(each, terrain, wide, tile, nullptr, &threads).ok());
		CHECK(digest(tile) == digest(alone));
	}
}

TEST_CASE("tile: the error for a large rectangle is the same with lent threads") {
	LayerSettings dense = rich_layer();
	auto dust = std::make_shared<LayerSettings>(rich_layer());
	dust->set = {.seed = 5, .radius = 0.001, .levels = 1, .layer = 9};
	dense.neighbors = {{dust, 2.5, nullptr}};
	const std::array<std::pair<LayerSettings, Rect>, 4> rejected_inputs{{
			{rich_layer(), {{-1e9, -10.0}, {200.0, 10.0}}},
			{rich_layer(), {{-1e5, -1e5}, {1e5, 1e5}}},
			{rich_layer(), {{200.0, 0.0}, {-200.0, 400.0}}},
			{dense, wide},
	}};
	for (const auto &[layer, rect] : rejected_inputs) {
		CountedThreads threads(2);
		TileBuilder builder;
		TileInstances tile;
		const Status alone = builder.build(layer, hills(), rect, tile);
		const Status status = builder.build(layer, hills(), rect, tile, nullptr, &threads);
		CHECK(!alone.ok());
		CHECK(status.code == alone.code);
		CHECK(status.value == alone.value);
	}
}

TEST_CASE("tile: lent threads sample the ground concurrently") {
	const LayerSettings layer = rich_layer();
	const BlockingHills terrain;
	CountedThreads threads(1);
	TileBuilder builder;
	TileInstances tile;
	REQUIRE(builder.build(layer, terrain, wide, tile, nullptr, &threads).ok());
	CHECK(terrain.threads() == 2);
}

TEST_CASE("tile: failing ground and cancellation end the tile in the same way with lent threads") {
	const LayerSettings layer = rich_layer();
	for (const int calls : {0, 3}) {
		CAPTURE(calls);
		CountedThreads threads(2);
		TileBuilder builder;
		TileInstances tile;
		const Status status = builder.build(layer, Broken(calls), wide, tile, nullptr, &threads);
		CHECK(status.code == ErrorCode::missing);
		CHECK(status.value == 3.0);
		CHECK(tile.meshes.empty());
	}
	CountedThreads threads(2);
	TileBuilder builder;
	TileInstances tile;
	const std::atomic<bool> cancel = true;
	CHECK(builder.build(layer, hills(), wide, tile, &cancel, &threads).code == ErrorCode::cancelled);
}
