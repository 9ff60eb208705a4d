#pragma once

#include "core/base/rect.hpp"
#include "core/base/status.hpp"
#include "core/placement/kept_tile.hpp"
#include "core/placement/tile_builder.hpp"
#include "core/placement/tile_crew.hpp"
#include "core/sampling/block_cache.hpp"
#include "core/state/instance_state.hpp"
#include "nodes/ground/scatter_ground.hpp"

#include <glm/vec2.hpp>

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace thicket {

/// The ground of some positions on this thread, the main one. `terrain` is what `ground` gave for workers; where it is null, `ground`
/// itself is asked, there and then: a script may do anything meanwhile. Replaces `r_answers`. Throws std::bad_alloc.
Status ask_at_once(const Terrain *terrain, const HostedGround &ground, std::span<const glm::dvec2> positions,
		std::span<const GroundQuery> queries, std::vector<Ground> &r_answers);

/// Makes tiles for a caller on the main thread, who waits for them; the engine's workers share what a large rectangle
/// takes. What the next tile can use stays: memory, and the points around.
class AtOnceBuilder {
public:
	/// All steps of a tile; the ground as above. A script that is asked for it may call this again.
	Status build(const LayerSettings &layer, const Terrain *terrain, const HostedGround &ground, const Rect &rect,
			TileInstances &r_tile);

	/// All steps of several, in order, on all threads there are where the ground may be asked on any. Replaces `r_tiles`: null for one
	/// that was not made. The error is that of the first tile which has one.
	Status build_all(std::span<const TileOrder> orders, const Terrain *terrain, const HostedGround &ground,
			std::vector<std::shared_ptr<const KeptTile>> &r_tiles);

	/// As TileCrew::points_computed, of all calls.
	std::uint64_t points_computed() const { return points_computed_ + crew_.points_computed(); }

private:
	std::unique_ptr<TileBuilder> take_builder();
	Status build_in_steps(const LayerSettings &layer, const Terrain *terrain, const HostedGround &ground,
			const Rect &rect, TileInstances &r_tile);

	std::shared_ptr<BlockCache> blocks_ = std::make_shared<BlockCache>();
	TileCrew crew_;
	std::uint64_t points_computed_ = 0;  ///< Of tiles that were made one by one.
	std::unique_ptr<TileBuilder> spare_; ///< Null before the first tile, and while one is made.
};

/// Lays over a finished rectangle what a game has changed there, as in the picture. After an error the tile is unspecified.
Status lay_over(const LayerSettings &layer, const Rect &rect, const InstanceState &state, KeptTile &r_tile);

} // namespace thicket
