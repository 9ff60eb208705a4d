#pragma once

#include "core/base/ground_probe.hpp"
#include "core/base/status.hpp"
#include "core/base/tile_grid.hpp"
#include "core/placement/ground_query.hpp"
#include "core/placement/instance_cache.hpp"
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

/// Generates tiles in three steps: samples points, filters them by the rules, and places instances.
/// The layers on which a layer depends are sampled and filtered for each tile, including its
/// surroundings, so that no tile depends on other tiles. A BlockCache may provide their points. A
/// builder reuses its memory: once it and the output tile are large enough, it allocates none.
/// Results do not depend on earlier calls. Each thread needs its own builder.
///
/// `build` does everything in one call. If a terrain can be queried only on a certain thread, split
/// the work. Call `find_points` on a worker thread, query the ground at `positions()` on the
/// terrain's thread, then call `place` on a worker thread. Layers that fill gaps need the ground in
/// several steps: while `is_complete` is false, call `find_further` with the ground instead, and
/// query the new `positions()`.
class TileBuilder {
public:
	/// After a tile with more points than this, callers should discard the builder to free its
	/// memory.
	static constexpr std::size_t max_kept_points = 1 << 16;

	/// The arguments affect only the amount of work, never the result. The caches may be null or
	/// shared with other builders. Only `build` uses `instances`.
	explicit TileBuilder(const SampleMargins &margins = {}, std::shared_ptr<BlockCache> cache = nullptr,
			std::shared_ptr<InstanceCache> instances = nullptr);
	~TileBuilder();
	TileBuilder(TileBuilder &&) noexcept;
	TileBuilder &operator=(TileBuilder &&) noexcept;

	/// Replaces `r_tile` with the instances in `space` (world meters). Rectangles that
	/// TileSampler::sample rejects are errors here, too. The result depends only on the arguments,
	/// bit for bit. After an error, `r_tile` is unchanged. About a millisecond after `cancel` is
	/// set, the call returns ErrorCode::cancelled; `r_tile` is then valid but its content is
	/// unspecified.
	///
	/// If `threads` is not null, they share the work for a large rectangle (see TilePieces). They
	/// do not affect the result.
	Status build(const LayerSettings &layer, const Terrain &terrain, const TileSpace &space, TileInstances &r_tile,
			const std::atomic<bool> *cancel = nullptr, CallerThreads *threads = nullptr);

	/// Performs the first step of `build`: finds the points that pass the rules that depend only on
	/// the position, such as masks and noise. After an error during sampling, `place` fails. If
	/// `threads` is not null, they share the sampling of a large rectangle. Layers on surfaces have
	/// points only if `surface`, the surface of the ground, is not null.
	Status find_points(const LayerSettings &layer, const TileSpace &space, const std::atomic<bool> *cancel = nullptr,
			CallerThreads *threads = nullptr, const Surface *surface = nullptr);

	/// Returns true if `place` can be called with the ground at positions(). If false, `find_further`
	/// must be called first.
	bool is_complete() const;

	/// Continues the first step with the ground at positions(), and replaces positions() and
	/// queries(). Errors are as in `find_points` and `place`.
	Status find_further(std::span<const Ground> ground, const std::atomic<bool> *cancel = nullptr,
			CallerThreads *threads = nullptr);

	/// Returns the positions at which the next call needs the ground: the points of the layer and of
	/// its neighbors, and a few positions for the origin of a tile that covers all heights. If a
	/// layer has an edge feather, the list also contains the edge probes around each of its points.
	/// It is valid after `find_points` or `find_further` until the next call.
	std::span<const glm::dvec2> positions() const;

	/// Returns the ranges of positions for which the same properties of the ground are needed. They
	/// are valid as long as `positions()`.
	std::span<const GroundQuery> queries() const;

	/// Performs the second step of `build`: filters the points from `find_points` and places
	/// instances. `ground[i]` is the ground at `positions()[i]`. A wrong number of entries is an
	/// error that names `ground`. A call without a successful `find_points`, or before is_complete()
	/// is true, is an error that names `points`. May be called repeatedly. Other errors are as in `build`.
	Status place(std::span<const Ground> ground, TileInstances &r_tile, const std::atomic<bool> *cancel = nullptr);

	/// Returns some of the layer's own positions, distributed over the tile, with the heights from
	/// which the tile was generated. They are available after `place`, or after `build` without
	/// `threads`, until the next call. The list is empty if there are no points, or if the layer is
	/// on surfaces.
	std::span<const GroundProbe> probes() const;

	/// Returns statistics of the last sampling.
	const SampleStats &sample_stats() const;

private:
	struct Workspace;
	std::unique_ptr<Workspace> workspace_;
};

} // namespace thicket
