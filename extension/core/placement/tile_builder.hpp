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

/// Makes tiles: sample, filter, place. The layers that the layer's rules look at are sampled and filtered in as much of
/// their surroundings as that takes, anew for each tile, so that no tile depends on another; a BlockCache may have their
/// points. The object is a reusable workspace: once it and the tile handed in are warm, nothing is allocated. Results do not
/// depend on what it did before. Not thread safe; one per thread.
///
/// `build` does all in one call. A terrain that may only be asked on one thread takes the same road in two steps:
/// `find_points` on a worker, the ground for `positions()` wherever it can be had, then `place` on a worker again.
class TileBuilder {
public:
	/// `margins` and `cache`, which may serve other builders too, change how much is computed, never what comes out.
	explicit TileBuilder(const SampleMargins &margins = {}, std::shared_ptr<BlockCache> cache = nullptr);
	~TileBuilder();
	TileBuilder(TileBuilder &&) noexcept;
	TileBuilder &operator=(TileBuilder &&) noexcept;

	/// Replaces `r_tile` by what stands in the half-open `rect` (world meters; see TileSampler::sample for what is
	/// refused). The result is a function of the arguments, to the bit. After an error `r_tile` is as it was; after
	/// ErrorCode::cancelled, which follows within about a millisecond of raising `cancel`, it is valid but unspecified.
	///
	/// `threads`, if there are any, share all that a large rectangle takes (see TilePieces), for the same tile.
	Status build(const LayerSettings &layer, const Terrain &terrain, const Rect &rect, TileInstances &r_tile,
			const std::atomic<bool> *cancel = nullptr, LentThreads *threads = nullptr);

	/// The first step: the points that the rules of position (masks, noise, shapes seen from above) let pass. There are none
	/// after ErrorCode::cancelled or ErrorCode::out_of_memory. `threads`, if there are any, share the points of a large rectangle.
	Status find_points(const LayerSettings &layer, const Rect &rect, const std::atomic<bool> *cancel = nullptr,
			LentThreads *threads = nullptr);

	/// Where the ground has to be known after `find_points`: the layer's points and those of its neighbors, the surroundings
	/// of each if a layer looks at its edge, and a few positions for the tile's origin. Valid until the next call.
	std::span<const glm::dvec2> positions() const;

	/// All of them, in order, by the textures that count there. Valid as long.
	std::span<const GroundQuery> queries() const;

	/// The second step: filters and places the points of `find_points`. `ground[i]` belongs to `positions()[i]`; any
	/// other length is refused as `ground`, and so is a call without points found before. May be repeated. Errors as `build`.
	Status place(std::span<const Ground> ground, TileInstances &r_tile, const std::atomic<bool> *cancel = nullptr);

	/// After `build` or `place` without `threads`: some of the layer's own positions, spread over the tile, with the heights that the
	/// tile was made with; none where there is nothing to place. Valid until the next call.
	std::span<const GroundProbe> probes() const;

	/// What the sampler did last.
	const SampleStats &sample_stats() const;

private:
	struct Workspace;
	std::unique_ptr<Workspace> workspace_;
};

} // namespace thicket
