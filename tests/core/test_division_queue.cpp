#include "core/drawing/division_queue.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cstdint>
#include <map>
#include <random>
#include <vector>

using namespace thicket;

namespace {

TileKey key_of(int x) { return {0, 1, {x, 0}}; }

/// A row of tiles with one multimesh per cell.
class Row : public DivisionQueue::Tiles {
public:
	struct Tile {
		double distance = 0.0;
		std::uint32_t wanted = 1;
		std::uint32_t displayed = 1;
	};
	std::map<int, Tile> tiles;
	DivisionQueue queue;
	std::uint64_t limit = 1000;
	std::vector<int> begun; ///< The x of every divided tile, in order. Negative for a tile that became whole again.

	double distance(const TileKey &key) const override { return at(key).distance; }
	std::uint32_t displayed_division(const TileKey &key) const override { return at(key).displayed; }
	std::uint32_t wanted_division(const TileKey &key) const override { return at(key).wanted; }
	std::uint64_t multimeshes(const TileKey &key) const override {
		return multimesh_bound(key, displayed_division(key));
	}
	std::uint64_t multimesh_bound(const TileKey & /*key*/, std::uint32_t cells_per_edge) const override {
		return std::uint64_t{cells_per_edge} * cells_per_edge;
	}

	DivisionQueue::Multimeshes all() const {
		std::uint64_t count = 0;
		for (const auto &[x, tile] : tiles) {
			count += std::uint64_t{tile.displayed} * tile.displayed;
		}
		return {count, limit};
	}

	void add(int x, double distance, std::uint32_t wanted, std::uint32_t displayed = 1) {
		tiles[x] = {distance, wanted, displayed};
		queue.show(key_of(x), displayed);
		choose(x);
	}

	void choose(int x) { queue.choose(key_of(x), tiles.at(x).displayed, tiles.at(x).wanted); }

	/// Simulates a change in the distance between a tile and the viewers.
	void move(int x, double distance, std::uint32_t wanted) {
		tiles[x].distance = distance;
		tiles[x].wanted = wanted;
		choose(x);
	}

	/// Performs one division. Returns false if none is due.
	bool step() {
		const auto division = queue.begin(*this, all());
		if (!division) {
			return false;
		}
		Tile &tile = tiles.at(division->key.tile.x);
		const bool shrinks = division->cells_per_edge < tile.displayed;
		REQUIRE(division->cells_per_edge != tile.displayed);
		begun.push_back(division->cells_per_edge == 1 ? -division->key.tile.x : division->key.tile.x);
		tile.displayed = division->cells_per_edge;
		queue.finish();
		choose(division->key.tile.x); // Each visit of a tile makes this call.
		if (shrinks) {
			queue.capacity_gained(*this);
		}
		return true;
	}

	void run() {
		std::size_t steps = 0;
		while (step()) {
			REQUIRE(++steps < 10000);
		}
	}

private:
	const Tile &at(const TileKey &key) const { return tiles.at(key.tile.x); }
};

} // namespace

TEST_CASE("division queue: the nearest waiting tile is divided first, at its distance now") {
	Row row;
	row.add(1, 30.0, 4);
	row.add(2, 10.0, 4);
	row.add(3, 20.0, 4);
	row.add(4, 5.0, 1); // Tile 4 is already divided as requested.
	CHECK(row.queue.has_work(row.all()));
	REQUIRE(row.step());
	row.move(1, 15.0, 8); // The tile comes nearer while it waits, so it now needs smaller cells.
	row.run();
	CHECK(row.begun == std::vector{2, 1, 3});
	CHECK(row.tiles[1].displayed == 8);
	CHECK_FALSE(row.queue.has_work(row.all()));
	row.move(2, 200.0, 1);
	row.run();
	CHECK(row.begun.back() == -2);
}

TEST_CASE("division queue: a tile whose division is correct again stops waiting") {
	Row row;
	row.add(1, 30.0, 4);
	row.move(1, 300.0, 1);
	CHECK(row.queue.has_work(row.all()));
	CHECK_FALSE(row.step());
	CHECK_FALSE(row.queue.has_work(row.all()));
}

TEST_CASE("division queue: farther tiles yield, the farthest first, and are not divided again") {
	Row row;
	row.limit = 40;
	row.add(5, 50.0, 4);
	row.add(6, 60.0, 4);
	row.run();
	CHECK(row.begun == std::vector{5, 6}); // The two tiles have 32 multimeshes.
	row.begun.clear();
	row.add(1, 10.0, 4);
	row.run();
	CHECK(row.begun == std::vector{-6, 1}); // 16 + 1 + 16 multimeshes.
	CHECK(row.all().count <= row.limit);
	row.begun.clear();
	row.add(2, 11.0, 5);
	row.run(); // 25 + 16 + 2 multimeshes: tile 5 would have to yield. Tile 1 does not, because it is nearer.
	CHECK_MESSAGE(row.begun.empty(), "dividing tile 2 would need 43 multimeshes, even without the cells of tile 5");
	row.limit = 44;
	row.move(2, 11.0, 5);
	row.run();
	CHECK(row.begun == std::vector{-5, 2});
}

TEST_CASE("division queue: a tile yields only to a tile that is much nearer") {
	Row row;
	row.limit = 18;
	row.add(1, 109.0, 4);
	row.run();
	row.add(2, 100.0, 4);
	row.run();
	CHECK(row.begun == std::vector{1});
	row.move(1, 109.0, 4);
	row.move(2, 99.0, 4); // 1.1 times 99 m is 108.9 m.
	row.run();
	CHECK(row.begun == std::vector{1, -1, 2});
	// The tiles move back and forth by a tenth of the distance, and neither yields to the other.
	for (int time = 0; time < 10; ++time) {
		row.move(1, time % 2 == 0 ? 100.0 : 109.0, 4);
		row.move(2, time % 2 == 0 ? 109.0 : 100.0, 4);
		row.run();
	}
	CHECK(row.begun == std::vector{1, -1, 2});
}

TEST_CASE("division queue: a rejected tile waits again once multimeshes are freed") {
	Row row;
	row.limit = 20;
	row.add(1, 10.0, 4);
	row.add(2, 20.0, 4);
	row.run();
	CHECK(row.begun == std::vector{1});
	CHECK_FALSE(row.queue.has_work(row.all()));
	row.move(1, 500.0, 1); // The cells of tile 1 are freed, which makes room for tile 2.
	row.run();
	CHECK(row.begun == std::vector{1, -1, 2});
	row.add(3, 30.0, 4);
	row.run();
	CHECK(row.begun == std::vector{1, -1, 2});
	row.queue.remove(key_of(2)); // The tile is dropped with its cells.
	row.tiles.erase(2);
	row.queue.capacity_gained(row);
	row.run();
	CHECK(row.begun == std::vector{1, -1, 2, 3});
	CHECK_MESSAGE(row.queue.has_work({100, 20}), "tile 3 is divided into cells");
	row.add(4, 40.0, 4);
	row.run();
	CHECK(row.begun.size() == 4); // Tile 4 was rejected and is dropped before there is room.
	for (const int x : {3, 4}) {
		row.queue.remove(key_of(x));
		row.tiles.erase(x);
	}
	row.queue.capacity_gained(row);
	CHECK_FALSE(row.queue.has_work({100, 20}));
}

TEST_CASE("division queue: above a lowered limit, the farthest tiles become whole before anything else") {
	Row row;
	for (int x = 1; x <= 5; ++x) {
		row.add(x, 10.0 * x, 4);
	}
	row.run();
	row.begun.clear();
	row.limit = 50;
	row.add(9, 1.0, 2);
	row.run();
	// The number of multimeshes falls from 81 to 66, 51 and 36. The near tile needs 3 more.
	CHECK(row.begun == std::vector{-5, -4, -3, 9});
	CHECK(row.all().count <= row.limit);
	row.limit = 0; // The limit is too low even for whole tiles, so all tiles become whole.
	row.run();
	CHECK(std::ranges::all_of(row.tiles, [](const auto &tile) { return tile.second.displayed == 1; }));
	CHECK_FALSE(row.queue.has_work(row.all()));
}

TEST_CASE("division queue: a canceled division leaves the queue in order and may be chosen again") {
	Row row;
	row.add(1, 10.0, 4);
	row.add(2, 20.0, 4);
	REQUIRE(row.queue.begin(row, row.all())->key == key_of(1));
	CHECK(row.queue.is_current(key_of(1)));
	row.choose(1); // A visit of a tile while it is divided does not queue the tile a second time.
	row.queue.cancel();
	CHECK_FALSE(row.queue.current());
	row.run();
	CHECK(row.begun == std::vector{2});
	row.move(1, 10.0, 4);
	row.run();
	CHECK(row.begun == std::vector{2, 1});
	row.add(3, 10.0, 4);
	row.queue.clear();
	CHECK_FALSE(row.queue.has_work(row.all()));
}

TEST_CASE("division queue: a new tile is uploaded in cells if the limits and the waiting tiles permit it") {
	const auto first = [](std::uint64_t previous, bool replaces, bool others_wait) {
		return DivisionQueue::first_division(8, {previous, 100}, replaces, others_wait);
	};
	CHECK(first(100, false, false) == 8);
	CHECK(first(101, false, false) == 1);
	CHECK(first(100, false, true) == 1); // Showing the other tiles comes first.
	CHECK(first(100, true, true) == 8);  // The tile replaces one that is already visible.
	CHECK(first(101, true, false) == 1);
}

TEST_CASE("division queue: after random moves, the limit is respected, no work is left, and no near tile waits for a "
		  "far tile") {
	std::mt19937 random(7);
	std::uniform_real_distribution<double> any(0.0, 100.0);
	Row row;
	row.limit = 200;
	const auto wanted_at = [](double distance) -> std::uint32_t {
		return distance < 20.0 ? 8 : distance < 50.0 ? 4 : distance < 80.0 ? 2 : 1;
	};
	for (int x = 0; x < 30; ++x) {
		const double distance = any(random);
		row.add(x, distance, wanted_at(distance));
	}
	for (int round = 0; round < 200; ++round) {
		for (const auto &[x, tile] : row.tiles) {
			const double step = random() % 4 == 0 ? 0.2 * (any(random) - 50.0) : 0.0;
			const double distance = std::clamp(tile.distance + step, 0.0, 100.0);
			row.move(x, distance, wanted_at(distance));
		}
		std::size_t steps = 0;
		while (row.step()) {
			REQUIRE(row.all().count <= row.limit);
			REQUIRE(++steps < 1000);
		}
		for (const auto &[x, tile] : row.tiles) {
			if (tile.wanted <= tile.displayed) {
				CHECK(tile.wanted == tile.displayed);
				continue;
			}
			// The tile was rejected, so it would exceed the limit even if all farther tiles were
			// whole.
			std::uint64_t minimum = std::uint64_t{tile.wanted} * tile.wanted;
			for (const auto &[y, other] : row.tiles) {
				const bool yields = other.distance > yield_factor * tile.distance;
				minimum += y == x ? 0 : yields ? 1 : std::uint64_t{other.displayed} * other.displayed;
			}
			CHECK(minimum > row.limit);
		}
	}
	CHECK(std::ranges::count_if(row.begun, [](int x) { return x < 0; }) > 20);
}
