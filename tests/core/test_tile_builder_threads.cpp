// A large rectangle of instances is shared by threads that the caller lends: the same tile, and the same errors, as alone.

#include "core/terrain/flat_terrain.hpp"
#include "counted_threads.hpp"
#include "tile_fixture.hpp"

#include <doctest/doctest.h>

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <set>
#include <thread>

using namespace thicket;
using namespace thicket::test;

namespace {

constexpr Rect wide{{-200.0, -190.0}, {200.0, 190.0}};

/// Hills that wait, once, until two threads ask for their ground.
class Meeting final : public Terrain {
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

/// No ground from some call on.
class Broken final : public Terrain {
public:
	explicit Broken(int calls) : calls_(calls) {}

	Status sample(std::span<const glm::dvec2> positions, std::span<Ground> r_ground) const override {
		return asked_++ < calls_ ? flat_.sample(positions, r_ground) : Status{ErrorCode::missing, "heights", 3.0};
	}

private:
	FlatTerrain flat_{1.0f};
	mutable std::atomic<int> asked_ = 0;
	int calls_;
};

} // namespace

TEST_CASE("tile: lent threads share points and ground, and change no bit") {
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
		CHECK((threads.runs > 1) == (count > 0)); // Once for points, once for the ground.
	}
	// What is small wakes nobody.
	CountedThreads threads(3);
	TileBuilder builder;
	TileInstances tile;
	REQUIRE(builder.build(layer, terrain, tile_of_hills, tile, nullptr, &threads).ok());
	CHECK(threads.runs == 0);
}

TEST_CASE("tile: lent threads ask for the ground at the same time") {
	const LayerSettings layer = rich_layer();
	const Meeting terrain;
	CountedThreads threads(1);
	TileBuilder builder;
	TileInstances tile;
	REQUIRE(builder.build(layer, terrain, wide, tile, nullptr, &threads).ok());
	CHECK(terrain.threads() == 2);
}

TEST_CASE("tile: with lent threads a ground that fails, or a cancel, ends the tile as alone") {
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
