// Tests the tile cache of a world: missing tiles are generated once, and unused ones are evicted a
// few at a time.

#include "core/query/instance_world.hpp"
#include "flat_world.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

using namespace thicket;
using namespace thicket::test;

namespace {

std::vector<QueryLayer> layers_of(std::uint64_t seed) {
	QueryLayer layer;
	layer.set.seed = seed;
	layer.tile_size = 10.0;
	return {layer};
}

std::shared_ptr<const CompactTile> tile_of(std::size_t instances) {
	TileInstances tile;
	tile.meshes.resize(1);
	tile.meshes[0].resize(instances);
	return std::make_shared<const CompactTile>(tile, nullptr);
}

} // namespace

TEST_CASE("instance world: the least recently used tiles are evicted, a few for each new tile") {
	constexpr std::size_t instances = 1000; // Instances per tile.
	constexpr int tiles = 3000;
	InstanceWorld world;
	world.set_layers(layers_of(1));
	std::vector<std::weak_ptr<const CompactTile>> generated;
	std::vector<std::shared_ptr<const CompactTile>> visible;
	const auto forgotten = [&generated] {
		return std::ranges::count_if(generated, [](const auto &tile) { return tile.expired(); });
	};
	const auto is_known = [&world](int x) {
		return world.find({0, {x, 0}}) != nullptr;
	};
	std::ptrdiff_t before = 0;
	std::ptrdiff_t max_tiles = 0;
	for (int x = 0; x < tiles; ++x) {
		auto tile = tile_of(instances);
		generated.emplace_back(tile);
		if (x < 50) {
			visible.push_back(tile);
		}
		world.keep({0, {x, 0}}, std::move(tile));
		for (const auto &dropped : world.take_forgotten()) {
			CHECK(dropped.use_count() == 1);
		}
		REQUIRE(is_known(60) == (x >= 60)); // This tile is requested in every step.
		max_tiles = std::max(max_tiles, forgotten() - before);
		before = forgotten();
	}
	CHECK(max_tiles == 2);
	const auto idle = static_cast<std::size_t>(tiles - before) - visible.size();
	CHECK(idle * instances > InstanceWorld::max_idle_instances / 2);
	CHECK(idle * instances < InstanceWorld::max_idle_instances * 3 / 2);
	CHECK(is_known(0));
	CHECK(is_known(49));
	CHECK_FALSE(is_known(50));
	CHECK_FALSE(is_known(1000));
	for (int x = tiles - 200; x < tiles; ++x) {
		CHECK(is_known(x));
	}
}

TEST_CASE("instance world: cleared and unwanted tiles may be evicted at any time") {
	InstanceWorld world;
	for (int round = 0; round < 3; ++round) {
		world.set_layers(layers_of(1));
		for (int x = 0; x < 700; ++x) {
			auto tile = tile_of(1000);
			world.keep({0, {x, round}}, std::move(tile));
			if (x == 450 && round == 1) {
				world.clear();
			}
			if (x == 650 && round == 2) {
				world.set_layers(layers_of(2));
			}
		}
		CHECK(world.find({0, {699, round}}) != nullptr);
	}
}

TEST_CASE("instance world: the missing tiles of a query are generated together, and once") {
	FlatWorld flat;
	std::vector<std::size_t> calls;
	flat.world.set_maker(
			[&](std::span<const WorldTile> tiles, std::vector<std::shared_ptr<const CompactTile>> &r_tiles) -> Status {
				calls.push_back(tiles.size());
				r_tiles.clear();
				for (const WorldTile &tile : tiles) {
					r_tiles.push_back(flat.make(tile.tile));
				}
				return {};
			});
	flat.world.keep({0, {0, 0}}, flat.make({0, 0}));
	std::vector<PlacedInstance> first;
	std::vector<PlacedInstance> second;
	for (std::vector<PlacedInstance> *results : {&first, &second}) {
		CHECK(flat.world.answer([&](const InstanceQuery &query) {
							return query.in_sphere({0.0, 0.0, 0.0}, 20.0, {}, *results);
						})
						.ok());
	}
	REQUIRE(calls.size() == 1);
	CHECK(calls[0] >= 3);
	CHECK(first.size() > 100);
	CHECK(first.size() == second.size());
}

TEST_CASE("instance world: a tile that was generated while the layers changed is not cached") {
	FlatWorld flat;
	int generated = 0;
	bool change_layers = true;
	flat.world.set_maker(
			[&](std::span<const WorldTile> tiles, std::vector<std::shared_ptr<const CompactTile>> &r_tiles) -> Status {
				++generated;
				r_tiles = {flat.make(tiles.front().tile)};
				if (change_layers) {
					flat.set_layers();
				}
				return {};
			});
	const auto answer = [&flat] {
		std::vector<PlacedInstance> results;
		CHECK(flat.world.answer([&](const InstanceQuery &query) {
							return query.in_rect({{4.0, 4.0}, {8.0, 8.0}}, {}, results);
						})
						.ok());
		CHECK(results.size() > 1);
	};
	answer();
	CHECK(generated == 1);
	change_layers = false;
	answer();
	CHECK(generated == 2);
	// Now the tile is cached.
	answer();
	CHECK(generated == 2);
}

TEST_CASE("instance world: an edit keeps the tiles that it does not touch") {
	FlatWorld flat;
	flat.load(1);
	const std::uint64_t version = flat.world.version();
	flat.world.invalidate(0, {});
	CHECK(flat.world.version() == version); // Systems that track nearby instances need not check them again.
	flat.world.invalidate(0, {.everywhere = false, .areas = {{{5.0, 5.0}, {9.0, 9.0}}}});
	CHECK(flat.world.version() != version);
	for (int y = -1; y <= 1; ++y) {
		for (int x = -1; x <= 1; ++x) {
			CHECK((flat.world.find({0, {x, y}}) == nullptr) == (x == 0 && y == 0));
		}
	}
}
