#include "core/base/tile_grid.hpp"
#include "core/streaming/tile_disc.hpp"
#include "core/streaming/tile_queue.hpp"
#include "core/streaming/tile_table.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <set>
#include <tuple>
#include <utility>
#include <vector>

using namespace thicket;

namespace {

std::set<std::pair<int, int>> tiles_without(const TileDisc &disc, const TileDisc &other) {
	std::set<std::pair<int, int>> tiles;
	disc.visit_without(other, [&](glm::ivec2 at) { CHECK(tiles.emplace(at.x, at.y).second); });
	return tiles;
}

} // namespace

TEST_CASE("tile disc: a disc contains the tiles that touch it, and lists those that another disc lacks") {
	std::mt19937_64 random(3);
	std::uniform_real_distribution<double> unit(-1.0, 1.0);
	for (int round = 0; round < 60; ++round) {
		const double size = 4.0 + 3.0 * unit(random);
		const double far_away = round % 2 == 0 ? 1e6 : 10.0;
		const glm::dvec2 center = glm::dvec2(unit(random), unit(random)) * far_away;
		const double radius = 40.0 * std::abs(unit(random));
		TileDisc disc;
		disc.set(size, center, radius);
		TileDisc other;
		other.set(size, center + glm::dvec2(unit(random), unit(random)) * 60.0, 30.0);
		const auto all = tiles_without(disc, TileDisc());
		const auto remaining = tiles_without(disc, other);
		const glm::ivec2 middle = tile_at(size, center);
		for (int y = middle.y - 25; y <= middle.y + 25; ++y) {
			for (int x = middle.x - 25; x <= middle.x + 25; ++x) {
				const double distance = std::sqrt(distance_squared(tile_rect(size, {x, y}), center));
				const bool in = all.contains({x, y});
				// Rounding may decide distances this close to the reach.
				CHECK((std::abs(distance - radius) < 1e-6 || in == (distance <= radius)));
				CHECK(disc.contains({x, y}) == in);
				CHECK(remaining.contains({x, y}) == (in && !other.contains({x, y})));
			}
		}
	}
}

TEST_CASE("tile table: a table behaves like a map, and its slots are stable") {
	std::mt19937_64 random(4);
	TileTable table;
	std::map<std::tuple<int, int, int>, std::uint32_t> expected;
	CHECK(table.find({0, 0, 0}) == TileTable::none);
	for (int step = 0; step < 20000; ++step) {
		const glm::ivec3 at(static_cast<int>(random() % 20) - 10, static_cast<int>(random() % 20) - 10,
				random() % 2 == 0 ? all_slabs : static_cast<int>(random() % 4) - 2);
		const auto match = expected.find({at.x, at.y, at.z});
		CHECK(table.find(at) == (match != expected.end() ? match->second : TileTable::none));
		if (random() % 2 == 0) {
			const std::uint32_t slot = table.find_or_add(at);
			CHECK((match == expected.end() || match->second == slot));
			CHECK(table[slot].at == at);
			expected[{at.x, at.y, at.z}] = slot;
		} else if (match != expected.end()) {
			table.erase(match->second);
			CHECK_FALSE(table[match->second].exists);
			expected.erase(match);
		}
		CHECK(table.size() == expected.size());
	}
	table.clear();
	CHECK(table.size() == 0);
	CHECK(table.find({1, 1, 1}) == TileTable::none);
}

TEST_CASE("tile queue: the nearest suitable tile, for any movement of the viewer") {
	std::mt19937_64 random(9);
	std::uniform_real_distribution<double> unit(-1.0, 1.0);
	TileQueue queue;
	std::vector<glm::ivec3> tiles; // The tile of each slot, including tiles that were removed.
	std::vector<bool> in;
	glm::dvec2 position{0.0};
	const auto squared = [&](std::uint32_t slot) {
		const glm::dvec2 offset = glm::dvec2(tiles[slot]) - position;
		return offset.x * offset.x + offset.y * offset.y;
	};
	const auto measure = [&](TileQueue::Entry &entry) {
		entry.distance_squared = squared(entry.slot);
		return bool{in[entry.slot]};
	};
	for (int step = 0; step < 2000; ++step) {
		for (std::uint64_t insert_count = random() % 8 + (step == 500 ? 3000 : 0); insert_count > 0; --insert_count) {
			tiles.emplace_back(static_cast<int>(200.0 * unit(random)), static_cast<int>(200.0 * unit(random)), 0);
			in.push_back(true);
			queue.add(static_cast<std::uint32_t>(tiles.size() - 1), tiles.back());
			// Adds an entry again, or an entry with an existing slot and a wrong tile.
			queue.add(static_cast<std::uint32_t>(random() % tiles.size()), tiles.back());
		}
		if (random() % 3 == 0) {
			const glm::dvec2 offset = glm::dvec2(unit(random), unit(random)) * 4.0;
			position += offset;
			queue.move(std::sqrt(offset.x * offset.x + offset.y * offset.y));
		}
		for (int taken_count = 0; taken_count < 5; ++taken_count) {
			const TileQueue::Entry *entry = queue.first(
					0,
					[&](TileQueue::Entry &candidate) {
						return candidate.at == tiles[candidate.slot] && measure(candidate);
					},
					[&](const TileQueue::Entry &candidate) { return bool{in[candidate.slot]}; });
			double nearest = 1e300;
			for (std::uint32_t slot = 0; slot < tiles.size(); ++slot) {
				nearest = in[slot] ? std::min(nearest, squared(slot)) : nearest;
			}
			REQUIRE((entry != nullptr) == (nearest < 1e300));
			if (entry != nullptr) {
				CHECK(entry->distance_squared == nearest);
				in[entry->slot] = false;
			}
		}
	}
}

TEST_CASE("tile queue: few of many tiles are measured, and no tile twice while nothing moves") {
	TileQueue queue;
	double position = 0.0;
	int measured = 0;
	int tested = 0;
	const auto measure = [&](TileQueue::Entry &entry) {
		++measured;
		entry.distance_squared = (entry.at.x - position) * (entry.at.x - position);
		return true;
	};
	constexpr int tiles = 10'000;
	for (int x = 0; x < tiles; ++x) {
		queue.add(static_cast<std::uint32_t>(x), {x, 0, 0});
	}
	const auto first_from = [&](int lowest) {
		measured = tested = 0;
		return queue
				.first(0, measure,
						[&](const TileQueue::Entry &entry) {
							++tested;
							return entry.at.x >= lowest;
						})
				->at.x;
	};
	CHECK(first_from(20) == 20);
	CHECK(measured == tiles);
	CHECK(first_from(20) == 20);
	CHECK(measured == 0);
	CHECK(tested == 1); // The entries before it were found unsuitable earlier.
	CHECK(first_from(25) == 25);
	CHECK(tested == 6);
	position = 2.0;
	queue.move(2.0);
	CHECK(first_from(20) == 20);
	CHECK(measured < 300);
	queue.add(tiles, {-1, 0, 0});
	CHECK(first_from(-1) == 2);
	CHECK(measured < 300);
	CHECK(first_from(tiles - 1) == tiles - 1); // The search checks all entries.
	CHECK(measured >= tiles);
}
