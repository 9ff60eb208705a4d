#pragma once

#include "core/base/lent_threads.hpp"
#include "core/base/rect.hpp"
#include "core/base/status.hpp"
#include "core/placement/compact_tile.hpp"
#include "core/placement/tile_builder.hpp"
#include "core/sampling/block_cache.hpp"
#include "core/terrain/terrain.hpp"

#include <atomic>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace thicket {

/// A tile to generate.
struct TileOrder {
	std::shared_ptr<const LayerSettings> layer; ///< Never null; valid.
	Rect rect;
};

/// Generates tiles for a caller that waits for them, on all available threads. Keeps its workspaces, one for each thread, unless a tile was
/// very large. One call at a time.
class ParallelTileBuilder {
public:
	/// Generates the tiles, each on whichever thread is free, and replaces `r_tiles` by them, in order; null for a tile
	/// that was not generated. Each tile is identical to the result of TileBuilder. Returns the error of the first tile
	/// that failed; after an error, other tiles may be missing, too.
	Status build(std::span<const TileOrder> orders, const Terrain &terrain, LentThreads &threads,
			std::vector<std::shared_ptr<const CompactTile>> &r_tiles);

	/// The points of the tiles' layers that were decided until now, as in SampleStats::computed. Points that tiles share are counted once.
	std::uint64_t points_computed() const { return points_computed_; }

private:
	struct Worker {
		explicit Worker(const std::shared_ptr<BlockCache> &blocks) : builder(SampleMargins{}, blocks) {}

		TileBuilder builder;
		TileInstances tile;
	};

	std::atomic<std::uint64_t> points_computed_ = 0;
	std::shared_ptr<BlockCache> blocks_ = std::make_shared<BlockCache>();
	std::vector<std::unique_ptr<Worker>> workers_; ///< One for each thread; null before its first tile.
};

} // namespace thicket
