#include "core/base/tile_grid.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <random>

using namespace thicket;

TEST_CASE("streaming: tiles round down and share their edges") {
	CHECK(tile_at(10.0, {0.0, 9.999}) == glm::ivec2(0, 0));
	CHECK(tile_at(10.0, {-0.001, 10.0}) == glm::ivec2(-1, 1));
	CHECK(tile_at(10.0, {-10.0, -10.001}) == glm::ivec2(-1, -2));
	CHECK(tile_at(64.0, {5e6, -5e6}) == glm::ivec2(78125, -78125));
	CHECK(tile_at(1.0, {1e300, -1e300}) == glm::ivec2(max_tile_coordinate, -max_tile_coordinate));

	std::mt19937_64 random(1);
	std::uniform_real_distribution<double> along(-5e6, 5e6);
	for (const double size : {0.1, 1.0, 33.3, 64.0, 1000.0 / 3.0}) {
		for (int i = 0; i < 2000; ++i) {
			glm::dvec2 position(along(random), along(random));
			glm::ivec2 tile = tile_at(size, position);
			CHECK(tile_rect(size, tile).contains(position));
			CHECK(tile_rect(size, tile).max.x == tile_rect(size, tile + 1).min.x);
			// Positions on an edge belong to the tile that begins there.
			position = tile_rect(size, tile).min;
			CHECK(tile_at(size, position) == tile);
			position.x = std::nextafter(position.x, -1e9);
			CHECK(tile_at(size, position) == glm::ivec2(tile.x - 1, tile.y));
		}
	}
}

TEST_CASE("streaming: the distance to a rectangle is that to its nearest point") {
	const Rect rect{{-1.0, 2.0}, {3.0, 4.0}};
	CHECK(distance_squared(rect, {0.0, 3.0}) == 0.0);
	CHECK(distance_squared(rect, {3.0, 4.0}) == 0.0);
	CHECK(distance_squared(rect, {-3.0, 3.0}) == 4.0);
	CHECK(distance_squared(rect, {6.0, 8.0}) == 25.0);
}

TEST_CASE("base: the tiles in a rectangle are those that contain points of it") {
	CHECK(tiles_in(10.0, {{0.0, 0.0}, {10.0, 10.0}}) == TileRange{{0, 0}, {0, 0}});
	CHECK(tiles_in(10.0, {{-0.1, 9.9}, {10.1, 30.0}}) == TileRange{{-1, 0}, {1, 2}});
	CHECK(tiles_in(10.0, {{0.0, 0.0}, {0.0, 10.0}}).empty());
	CHECK(tiles_in(10.0, {{5.0, 0.0}, {4.0, 10.0}}).empty());

	std::mt19937_64 random(2);
	std::uniform_real_distribution<double> along(-5e6, 5e6);
	for (const double size : {0.7, 33.3, 1000.0 / 3.0}) {
		for (int i = 0; i < 2000; ++i) {
			const glm::dvec2 corner(along(random), along(random));
			Rect rect{corner, corner + 4.0 * size};
			if (i % 2 == 0) { // The end of the rectangle is on a tile edge.
				rect.max = tile_rect(size, tile_at(size, rect.max)).min;
			}
			const TileRange range = tiles_in(size, rect);
			REQUIRE(!range.empty());
			CHECK(!intersection(tile_rect(size, range.first), rect).empty());
			CHECK(!intersection(tile_rect(size, range.last), rect).empty());
			CHECK(intersection(tile_rect(size, range.first - 1), rect).empty());
			CHECK(intersection(tile_rect(size, range.last + 1), rect).empty());
		}
	}
}
