#pragma once

#include "core/base/rect.hpp"
#include "core/base/status.hpp"
#include "core/placement/compact_tile.hpp"
#include "core/placement/parallel_tile_builder.hpp"
#include "core/placement/tile_builder.hpp"
#include "core/sampling/block_cache.hpp"
#include "core/state/instance_state.hpp"
#include "nodes/ground/scatter_ground.hpp"

#include <glm/vec2.hpp>

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace thicket {

/// Samples the ground and the density rules at `positions` immediately, on the main thread. Uses
/// `terrain`, a thread-safe snapshot of `ground`. If it is null, samples `ground` itself. Scripts
/// of the ground and of rules may do anything during the call. Replaces `r_answers`. Throws
/// std::bad_alloc.
Status query_synchronously(const Terrain *terrain, const HostedGround &ground, std::span<const glm::dvec2> positions,
		std::span<const GroundQuery> queries, std::vector<Ground> &r_answers);

/// Samples the ground for all steps of an object such as TileBuilder or DensityProbe, after its first
/// one. Replaces `r_answers` with the ground of the last step. Throws std::bad_alloc.
template <class Steps>
Status query_in_steps(
		const Terrain *terrain, const HostedGround &ground, Steps &r_steps, std::vector<Ground> &r_answers) {
	Status status = query_synchronously(terrain, ground, r_steps.positions(), r_steps.queries(), r_answers);
	while (status.ok() && !r_steps.is_complete()) {
		status = r_steps.find_further(r_answers);
		if (status.ok()) {
			status = query_synchronously(terrain, ground, r_steps.positions(), r_steps.queries(), r_answers);
		}
	}
	return status;
}

/// Generates tiles synchronously on the main thread, with the help of worker threads for large
/// rectangles. Keeps its workspace and the points around a tile to speed up the next one.
class SynchronousBuilder {
public:
	/// Generates one tile. Samples the ground as query_synchronously does. If a script samples the
	/// ground, that script may call this function again.
	Status build(const LayerSettings &layer, const Terrain *terrain, const HostedGround &ground, const TileSpace &space,
			TileInstances &r_tile);

	/// Generates several tiles, in parallel if `terrain` is not null and all density rules are
	/// thread-safe. Replaces `r_tiles`. After an error, tiles that were not generated are null or
	/// missing at the end. Returns the error of the first tile that failed.
	Status build_all(std::span<const TileOrder> orders, const Terrain *terrain, const HostedGround &ground,
			std::vector<std::shared_ptr<const CompactTile>> &r_tiles);

	/// Returns the total for all calls; see ParallelTileBuilder::points_computed.
	std::uint64_t points_computed() const { return points_computed_ + parallel_builder_.points_computed(); }

private:
	std::unique_ptr<TileBuilder> take_builder();
	Status build_in_steps(const LayerSettings &layer, const Terrain *terrain, const HostedGround &ground,
			const TileSpace &space, TileInstances &r_tile);

	std::shared_ptr<BlockCache> blocks_ = std::make_shared<BlockCache>();
	std::shared_ptr<InstanceCache> instances_ = std::make_shared<InstanceCache>();
	ParallelTileBuilder parallel_builder_;
	std::uint64_t points_computed_ = 0; ///< The number of points computed for tiles that `build` has generated.
	std::unique_ptr<TileBuilder> spare_builder_; ///< An unused builder. Null before the first tile and during `build`.
};

/// Applies a game's changes to a generated rectangle, as the display does for visible tiles. After
/// an error, the content of the tile is unspecified.
Status apply_state(const LayerSettings &layer, const Rect &rect, const InstanceState &state, CompactTile &r_tile);

} // namespace thicket
