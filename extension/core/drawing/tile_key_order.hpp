#pragma once

#include "core/streaming/tile_streamer.hpp"

namespace thicket {

/// Sorts tiles by layer, then coordinates, then grid. For the same coordinates, the tile with the
/// newer grid, and therefore the current tile size, comes first.
struct TileKeyOrder {
	bool operator()(const TileKey &a, const TileKey &b) const {
		if (a.layer != b.layer) {
			return a.layer < b.layer;
		}
		if (a.tile.x != b.tile.x) {
			return a.tile.x < b.tile.x;
		}
		if (a.tile.y != b.tile.y) {
			return a.tile.y < b.tile.y;
		}
		return a.slab != b.slab ? a.slab < b.slab : a.grid > b.grid;
	}
};

} // namespace thicket
