#pragma once

#include "core/base/rect.hpp"
#include "core/base/status.hpp"
#include "core/placement/ground_query.hpp"
#include "core/placement/layer.hpp"
#include "core/sampling/tile_sampler.hpp"

#include <glm/vec2.hpp>

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

namespace thicket {

/// The largest number of points of other layers that a probe may read, estimated from the density of their sets.
inline constexpr double max_probed_points = 4e6;

/// Evaluates the density of a layer's rules at any positions, whether or not they are points of its set. Runs the same
/// code as tile generation: a point of the set at such a position would be kept if its rank were below the density.
/// Works in two steps, because the ground may need to be queried on a different thread: call `find`, get the ground for
/// `positions()`, then call `look`. A reusable workspace, like TileBuilder. Not thread safe; use one per thread.
class DensityProbe {
public:
	explicit DensityProbe(const SampleMargins &margins = {});
	~DensityProbe();
	DensityProbe(DensityProbe &&) noexcept;
	DensityProbe &operator=(DensityProbe &&) noexcept;

	/// Takes a layer and some positions (world meters), and finds the points of other layers that its rules depend on
	/// there. The search covers the whole rectangle around the positions, so these should lie close together. Refuses
	/// an invalid layer, positions that are not finite, and, as `rect`, more than max_probed_points. With `explains`,
	/// the ground is queried with its normals, whether or not the rules need them.
	Status find(const LayerSettings &layer, std::span<const glm::dvec2> places, bool explains = false);

	/// The positions at which the ground must be known after `find`, and their groups for queries. Valid until the next
	/// call of `find`.
	std::span<const glm::dvec2> positions() const;
	std::span<const GroundQuery> queries() const;

	/// Takes the ground of all positions. Refuses, as `ground`, any other number of entries, and a call without `find`.
	/// Afterwards, the densities and factors below are available.
	Status look(std::span<const Ground> ground);

	/// After `look`, for one position: its ground, its density from 0 to 1, and all factors whose product is the density (see product_of).
	/// `factors_at` replaces `r_factors`.
	const Ground &ground_at(std::size_t place) const;
	double density_at(std::size_t place) const;
	Status factors_at(std::size_t place, std::vector<RuleFactor> &r_factors) const;

private:
	struct Workspace;
	std::unique_ptr<Workspace> workspace_;
};

} // namespace thicket
