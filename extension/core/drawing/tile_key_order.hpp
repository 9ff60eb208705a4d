#pragma once

#include "core/streaming/tile_streamer.hpp"

namespace thicket {

/// Sorts tiles by layer, then by position, then by grid, the newest first. So the tiles of a layer stay together. Of
/// two tiles at the same position, the tile with the current tile size comes first.
struct TileKeyOrder {
	bool operator()(const TileKey &a, const TileKey &b) const {
		if (a.layer != b.layer) {
			return a.layer < b.layer;
		}
		if (a.tile.x != b.tile.x) {
			return a.tile.x < b.tile.x;
		}
		return a.tile.y != b.tile.y ? a.tile.y < b.tile.y : a.grid > b.grid;
	}
};

} // namespace thicket
