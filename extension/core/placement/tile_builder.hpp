#pragma once

#include "core/base/ground_probe.hpp"
#include "core/base/rect.hpp"
#include "core/base/status.hpp"
#include "core/placement/ground_query.hpp"
#include "core/placement/layer.hpp"
#include "core/placement/tile_instances.hpp"
#include "core/sampling/tile_sampler.hpp"
#include "core/terrain/terrain.hpp"

#include <glm/vec2.hpp>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace thicket {

/// Generates tiles: sample, filter, place. The layers that the layer's rules depend on are sampled and filtered again for each tile, in the
/// surroundings that matter, so that no tile depends on other tiles. A BlockCache may provide their points. The object is a reusable
/// workspace: once it and the given tile have been used, it allocates nothing. Results do not depend on earlier calls. Not thread safe; use
/// one per thread.
///
/// `build` does everything in one call. For a terrain that may be queried on one thread only, the same work takes two steps: call
/// `find_points` on a worker, get the ground for `positions()` wherever it is available, then call `place` on a worker.
class TileBuilder {
public:
	/// The largest number of points in a tile after which a caller keeps the builder for later tiles. So the memory of
	/// large rectangles is freed.
	static constexpr std::size_t most_points_kept = 1 << 16;

	/// `margins` and `cache` change how much is computed, never the result. `cache` may be shared with other builders.
	explicit TileBuilder(const SampleMargins &margins = {}, std::shared_ptr<BlockCache> cache = nullptr);
	~TileBuilder();
	TileBuilder(TileBuilder &&) noexcept;
	TileBuilder &operator=(TileBuilder &&) noexcept;

	/// Replaces `r_tile` by the instances in the half-open `rect` (world meters; see TileSampler::sample for rectangles that are refused).
	/// The result is a function of the arguments, bit for bit. After an error, `r_tile` is unchanged. ErrorCode::cancelled follows within
	/// about a millisecond of raising `cancel`; after it, `r_tile` is valid but unspecified.
	///
	/// `threads`, if there are any, share all the work for a large rectangle (see TilePieces) and do not change the result.
	Status build(const LayerSettings &layer, const Terrain &terrain, const Rect &rect, TileInstances &r_tile,
			const std::atomic<bool> *cancel = nullptr, LentThreads *threads = nullptr);

	/// The first step: finds the points that pass the rules of position (masks, noise, shapes seen from above). After
	/// ErrorCode::cancelled or ErrorCode::out_of_memory, no points are found. `threads`, if there are any, share the
	/// points of a large rectangle.
	Status find_points(const LayerSettings &layer, const Rect &rect, const std::atomic<bool> *cancel = nullptr,
			LentThreads *threads = nullptr);

	/// The positions at which the ground must be known after `find_points`: the points of the layer and of its
	/// neighbors, the surroundings of each point if a layer checks for its edge, and a few positions for the tile's
	/// origin. Valid until the next call.
	std::span<const glm::dvec2> positions() const;

	/// All positions, in order, grouped by the ground textures that matter for them. Valid as long as `positions()`.
	std::span<const GroundQuery> queries() const;

	/// The second step: filters and places the points of `find_points`. `ground[i]` belongs to `positions()[i]`. Any other length is
	/// refused as `ground`, and so is a call without points found before. May be repeated. The same errors as `build`.
	Status place(std::span<const Ground> ground, TileInstances &r_tile, const std::atomic<bool> *cancel = nullptr);

	/// After `build` or `place` without `threads`: some of the layer's own positions, spread over the tile, with the heights that the tile
	/// was generated with; none if there is nothing to place. Valid until the next call.
	std::span<const GroundProbe> probes() const;

	/// Statistics of the sampler's last run.
	const SampleStats &sample_stats() const;

private:
	struct Workspace;
	std::unique_ptr<Workspace> workspace_;
};

} // namespace thicket
