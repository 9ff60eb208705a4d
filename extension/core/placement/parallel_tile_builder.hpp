#pragma once

#include "core/base/caller_threads.hpp"
#include "core/base/status.hpp"
#include "core/base/tile_grid.hpp"
#include "core/placement/compact_tile.hpp"
#include "core/placement/instance_cache.hpp"
#include "core/placement/tile_builder.hpp"
#include "core/sampling/block_cache.hpp"
#include "core/terrain/terrain.hpp"

#include <atomic>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace thicket {

/// A request for a tile to generate.
struct TileOrder {
	std::shared_ptr<const LayerSettings> layer; ///< Settings of the tile's layer; valid, never null.
	TileSpace space;
};

/// Generates tiles on all available threads while the caller waits. The builder keeps a workspace
/// for each thread, except after very large tiles. Use a builder on one thread only.
class ParallelTileBuilder {
public:
	/// Replaces `r_tiles` with the generated tiles, in the order of `orders`. Each tile is
	/// identical to the result of TileBuilder. Returns the error of the first tile that failed. The
	/// entries of failed tiles are null. After an error, those of other tiles may be null, too.
	Status build(std::span<const TileOrder> orders, const Terrain &terrain, CallerThreads &threads,
			std::vector<std::shared_ptr<const CompactTile>> &r_tiles);

	/// Returns the total of SampleStats::computed so far, without points of other layers on which
	/// the tiles' layers depend. Points that tiles share through the block cache are counted once.
	std::uint64_t points_computed() const { return points_computed_; }

private:
	struct Worker {
		Worker(const std::shared_ptr<BlockCache> &blocks, const std::shared_ptr<InstanceCache> &instances) :
				builder(SampleMargins{}, blocks, instances) {}

		TileBuilder builder;
		TileInstances tile;
	};

	std::atomic<std::uint64_t> points_computed_ = 0;
	std::shared_ptr<BlockCache> blocks_ = std::make_shared<BlockCache>();
	std::shared_ptr<InstanceCache> instances_ = std::make_shared<InstanceCache>();
	std::vector<std::unique_ptr<Worker>> workers_; ///< One for each thread; null until its first tile.
};

} // namespace thicket
