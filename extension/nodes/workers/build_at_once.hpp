#pragma once

#include "core/base/rect.hpp"
#include "core/base/status.hpp"
#include "core/placement/compact_tile.hpp"
#include "core/placement/tile_builder.hpp"
#include "core/placement/parallel_tile_builder.hpp"
#include "core/sampling/block_cache.hpp"
#include "core/state/instance_state.hpp"
#include "nodes/ground/scatter_ground.hpp"

#include <glm/vec2.hpp>

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace thicket {

/// Samples the ground at some positions on the calling thread, which is the main thread. `terrain` is the snapshot of
/// `ground` for workers. If it is null, samples `ground` itself immediately; its script may do anything in the
/// meantime. Replaces `r_answers`. Throws std::bad_alloc.
Status ask_at_once(const Terrain *terrain, const HostedGround &ground, std::span<const glm::dvec2> positions,
		std::span<const GroundQuery> queries, std::vector<Ground> &r_answers);

/// Generates tiles for a caller on the main thread that waits for them. The engine's workers help with large
/// rectangles. Keeps its memory and the surrounding points, because the next tile can use them.
class AtOnceBuilder {
public:
	/// Runs all steps of one tile, with the ground as in ask_at_once. A script that is called for the ground may call
	/// this again.
	Status build(const LayerSettings &layer, const Terrain *terrain, const HostedGround &ground, const Rect &rect,
			TileInstances &r_tile);

	/// Runs all steps of several tiles, in order; on all available threads if any thread may sample the ground.
	/// Replaces `r_tiles`, with null for each tile that was not generated. Returns the error of the first tile that
	/// failed.
	Status build_all(std::span<const TileOrder> orders, const Terrain *terrain, const HostedGround &ground,
			std::vector<std::shared_ptr<const CompactTile>> &r_tiles);

	/// As ParallelTileBuilder::points_computed, for all calls.
	std::uint64_t points_computed() const { return points_computed_ + parallel_builder_.points_computed(); }

private:
	std::unique_ptr<TileBuilder> take_builder();
	Status build_in_steps(const LayerSettings &layer, const Terrain *terrain, const HostedGround &ground,
			const Rect &rect, TileInstances &r_tile);

	std::shared_ptr<BlockCache> blocks_ = std::make_shared<BlockCache>();
	ParallelTileBuilder parallel_builder_;
	std::uint64_t points_computed_ = 0;  ///< For tiles that were generated one by one.
	std::unique_ptr<TileBuilder> spare_; ///< Null before the first tile, and while a tile is being generated.
};

/// Applies a game's changes to a finished rectangle, as the display does. After an error, the content of the tile is
/// unspecified.
Status lay_over(const LayerSettings &layer, const Rect &rect, const InstanceState &state, CompactTile &r_tile);

} // namespace thicket
