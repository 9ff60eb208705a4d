// Tests that tiles built on several threads are the same as on one thread, and that several threads
// do build them.

#include "allocation_count.hpp"
#include "core/placement/parallel_tile_builder.hpp"
#include "tile_fixture.hpp"

#include <doctest/doctest.h>

#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <set>
#include <thread>
#include <vector>

using namespace thicket;
using namespace thicket::test;

namespace {

/// Two threads that complete all available work before the calling thread begins its part.
class EagerThreads final : public CallerThreads {
public:
	std::size_t count() const override { return 2; }
	void run(const std::function<void(std::size_t index)> &work) override {
		std::vector<std::thread> threads;
		for (std::size_t index = 1; index <= count(); ++index) {
			threads.emplace_back([&work, index] { work(index); });
		}
		for (std::thread &thread : threads) {
			thread.join();
		}
		work(0);
	}
};

/// Hills that record the calling threads. Queries fail where x > `east`.
class WatchedHills final : public Terrain {
public:
	Status sample(std::span<const glm::dvec2> positions, std::span<Ground> r_ground) const override {
		{
			const std::lock_guard lock(mutex_);
			threads_.insert(std::this_thread::get_id());
		}
		for (const glm::dvec2 position : positions) {
			if (position.x > east) {
				return {ErrorCode::missing, "ground", position.x > east + 64.0 ? 2.0 : 1.0};
			}
		}
		return hills_.sample(positions, r_ground);
	}

	double east = 1e9;

	std::set<std::thread::id> threads() const { return threads_; }

private:
	Heightfield hills_ = hills();
	mutable std::mutex mutex_;
	mutable std::set<std::thread::id> threads_;
};

std::vector<TileOrder> orders() {
	const auto layer = std::make_shared<const LayerSettings>(rich_layer());
	std::vector<TileOrder> result;
	for (int x = -4; x < 4; ++x) {
		result.push_back({layer, {{32.0 * x, 0.0}, {32.0 * x + 32.0, 32.0}}});
	}
	return result;
}

} // namespace

TEST_CASE("parallel tile builder: tiles equal those of a single builder, in order, and several threads build them") {
	const WatchedHills ground;
	EagerThreads threads;
	ParallelTileBuilder builder;
	std::vector<std::shared_ptr<const CompactTile>> tiles(3);
	for (int round = 0; round < 2; ++round) {
		REQUIRE(builder.build(orders(), ground, threads, tiles).ok());
		REQUIRE(tiles.size() == orders().size());
		for (std::size_t i = 0; i < tiles.size(); ++i) {
			REQUIRE(tiles[i] != nullptr);
			CHECK(digest(expanded(*tiles[i])) == digest(built(rich_layer(), hills(), orders()[i].space)));
		}
	}
	CHECK_FALSE(ground.threads().contains(std::this_thread::get_id()));
}

TEST_CASE("parallel tile builder: the error comes from the first failing tile, and the tiles before it exist") {
	WatchedHills ground;
	ground.east = 0.0; // The fifth tile fails, and the seventh fails with another value.
	EagerThreads threads;
	ParallelTileBuilder builder;
	std::vector<std::shared_ptr<const CompactTile>> tiles;
	const Status status = builder.build(orders(), ground, threads, tiles);
	CHECK(status.code == ErrorCode::missing);
	CHECK(status.value == 1.0);
	REQUIRE(tiles.size() == orders().size());
	for (std::size_t i = 0; i < 3; ++i) {
		CHECK(tiles[i] != nullptr);
	}
	CHECK(tiles[4] == nullptr);
	REQUIRE(builder.build({}, ground, threads, tiles).ok());
	CHECK(tiles.empty());
}

TEST_CASE("parallel tile builder: blocks that neighboring tiles share are computed once for all threads") {
	const auto layer = std::make_shared<const LayerSettings>(rich_layer());
	std::vector<TileOrder> small;
	for (int i = 0; i < 64; ++i) {
		const glm::dvec2 corner(12.0 * (i % 8), 12.0 * (i / 8));
		small.push_back({layer, {corner, corner + 12.0}});
	}
	const Heightfield ground = hills();
	EagerThreads threads;
	ParallelTileBuilder builder;
	std::vector<std::shared_ptr<const CompactTile>> tiles;
	REQUIRE(builder.build(small, ground, threads, tiles).ok());
	CHECK(builder.points_computed() > 1000);
	// The second build generates the blocks that only one tile touches.
	REQUIRE(builder.build(small, ground, threads, tiles).ok());
	const std::uint64_t before = builder.points_computed();
	REQUIRE(builder.build(small, ground, threads, tiles).ok());
	CHECK(builder.points_computed() == before);
	for (std::size_t i = 0; i < tiles.size(); ++i) {
		CHECK(digest(expanded(*tiles[i])) == digest(built(*layer, ground, small[i].space)));
	}
}

TEST_CASE("parallel tile builder: workspaces are kept, except the workspace of a very large tile") {
	class NoThreads final : public CallerThreads {
	public:
		std::size_t count() const override { return 0; }
		void run(const std::function<void(std::size_t index)> &work) override { work(0); }
	};
	NoThreads threads;
	const Heightfield ground = hills();
	const auto layer = std::make_shared<const LayerSettings>(rich_layer());
	LayerSettings dense = rich_layer();
	dense.set.radius = 0.4;
	const auto large = std::make_shared<const LayerSettings>(dense);
	ParallelTileBuilder builder;
	std::vector<std::shared_ptr<const CompactTile>> tiles;
	const auto allocations_of = [&](const TileOrder &order) {
		const std::size_t before = allocation_count();
		REQUIRE(builder.build({&order, 1}, ground, threads, tiles).ok());
		return allocation_count() - before;
	};
	const TileOrder order{layer, {{0.0, 0.0}, {32.0, 32.0}}};
	allocations_of(order);
	allocations_of(order); // The second call caches the tile's block of points as well.
	const std::size_t warm = allocations_of(order);
	CHECK(allocations_of(order) == warm);
	allocations_of({large, {{-100.0, -100.0}, {100.0, 100.0}}});
	CHECK(allocations_of(order) > 2 * warm);
}
