#pragma once

#include "allocation_count.hpp"
#include "tile_fixture.hpp"

#include <doctest/doctest.h>

namespace thicket::test {

/// Checks that a builder allocates nothing for a tile that it has built before.
inline void check_repeated_builds_allocate_nothing(const LayerSettings &layer, const Terrain &terrain) {
	TileBuilder builder;
	TileInstances tile;
	for (int repeat = 0; repeat < 2; ++repeat) {
		REQUIRE(builder.build(layer, terrain, tile_of_hills, tile).ok());
	}
	const std::size_t before = allocation_count();
	const Status status = builder.build(layer, terrain, tile_of_hills, tile);
	const std::size_t after = allocation_count();
	CHECK(status.ok());
	CHECK(after == before);
}

} // namespace thicket::test
