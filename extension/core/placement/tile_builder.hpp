#pragma once

#include "core/base/rect.hpp"
#include "core/base/status.hpp"
#include "core/placement/mesh_choice.hpp"
#include "core/placement/placement.hpp"
#include "core/placement/tile_instances.hpp"
#include "core/rules/rules.hpp"
#include "core/sampling/point_set.hpp"
#include "core/sampling/tile_sampler.hpp"
#include "core/terrain/terrain.hpp"

#include <glm/vec2.hpp>

#include <atomic>
#include <memory>
#include <span>
#include <vector>

namespace thicket {

/// All that makes a layer: one species or family.
struct LayerSettings {
	PointSet set;
	Rules rules;
	Placement placement;
	/// A weight for each mesh, finite and not negative, not all 0; an instance gets a mesh with a chance proportional
	/// to the weight, from its own hash. None means one mesh. At most max_meshes.
	std::vector<float> mesh_weights;

	friend bool operator==(const LayerSettings &, const LayerSettings &) = default;
};

/// Refuses a layer of which any part is refused.
Status validate(const LayerSettings &layer);

/// Makes tiles: sample, filter, place. The object is a reusable workspace: once it and the tile handed in are warm,
/// nothing is allocated. Results do not depend on what it did before. Not thread safe; one per thread.
///
/// `build` does all in one call. A terrain that may only be asked on one thread takes the same road in two steps:
/// `find_points` on a worker, the ground for `positions()` wherever it can be had, then `place` on a worker again.
class TileBuilder {
public:
	TileBuilder();
	~TileBuilder();
	TileBuilder(TileBuilder &&) noexcept;
	TileBuilder &operator=(TileBuilder &&) noexcept;

	/// Replaces `r_tile` by what stands in the half-open `rect` (world metres; see TileSampler::sample for what is
	/// refused). The result is a function of the arguments, to the bit. After an error `r_tile` is as it was; after
	/// ErrorCode::cancelled, which follows within about a millisecond of raising `cancel`, it is valid but unspecified.
	Status build(const LayerSettings &layer, const Terrain &terrain, const Rect &rect, TileInstances &r_tile,
			const std::atomic<bool> *cancel = nullptr);

	/// The first step: the points that the density lets pass.
	Status find_points(const LayerSettings &layer, const Rect &rect, const std::atomic<bool> *cancel = nullptr);

	/// Where the ground has to be known after `find_points`; a few more places than points. Valid until the next call.
	std::span<const glm::dvec2> positions() const;

	/// The second step: filters and places the points of `find_points`. `ground[i]` belongs to `positions()[i]`; any
	/// other length is refused as `ground`, and so is a call without points found before. May be repeated.
	Status place(std::span<const Ground> ground, TileInstances &r_tile, const std::atomic<bool> *cancel = nullptr);

	/// What the sampler did last.
	const SampleStats &sample_stats() const;

private:
	struct Workspace;
	std::unique_ptr<Workspace> workspace_;
};

} // namespace thicket
