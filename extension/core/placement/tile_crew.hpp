#pragma once

#include "core/base/lent_threads.hpp"
#include "core/base/rect.hpp"
#include "core/base/status.hpp"
#include "core/placement/kept_tile.hpp"
#include "core/placement/tile_builder.hpp"
#include "core/sampling/block_cache.hpp"
#include "core/terrain/terrain.hpp"

#include <atomic>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace thicket {

/// A tile to be made.
struct TileOrder {
	std::shared_ptr<const LayerSettings> layer; ///< Never null; valid.
	Rect rect;
};

/// Makes tiles for somebody who waits for them, on all threads that there are. Keeps its workspaces, one for each thread, unless a tile was
/// very large. One call at a time.
class TileCrew {
public:
	/// Makes the tiles, each by whoever is free, and replaces `r_tiles` by them, in order; null for one that was not made. Each is what
	/// TileBuilder makes of it. After an error, that of the first tile which has one, some others may be missing, too.
	Status build(std::span<const TileOrder> orders, const Terrain &terrain, LentThreads &threads,
			std::vector<std::shared_ptr<const KeptTile>> &r_tiles);

	/// Points of the tiles' layers that were decided so far, as SampleStats::computed has them: what tiles share is counted once.
	std::uint64_t points_computed() const { return points_computed_; }

private:
	struct Worker {
		explicit Worker(const std::shared_ptr<BlockCache> &blocks) : builder(SampleMargins{}, blocks) {}

		TileBuilder builder;
		TileInstances tile;
	};

	/// Points of a tile whose workspace is kept.
	static constexpr std::size_t most_points_kept = 1 << 16;

	std::atomic<std::uint64_t> points_computed_ = 0;
	std::shared_ptr<BlockCache> blocks_ = std::make_shared<BlockCache>();
	std::vector<std::unique_ptr<Worker>> workers_; ///< By thread; null before its first tile.
};

} // namespace thicket
