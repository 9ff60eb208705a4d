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

/// The most points of other layers that a probe looks at, by the density of their sets.
inline constexpr double max_probed_points = 4e6;

/// What density a layer's rules give to any places, points of its set or not, by the code that makes tiles: a point of the set at that
/// place would stand if its rank were below. Two steps, because a ground may have to be asked elsewhere: `find`, the ground for
/// `positions()`, then `look`. A reusable workspace, as TileBuilder is. Not thread safe; one per thread.
class DensityProbe {
public:
	explicit DensityProbe(const SampleMargins &margins = {});
	~DensityProbe();
	DensityProbe(DensityProbe &&) noexcept;
	DensityProbe &operator=(DensityProbe &&) noexcept;

	/// Takes a layer and some places (world meters), and finds the points of other layers that its rules look at there: in all of the
	/// rectangle around the places, so they should lie close together. Refuses an invalid layer, places that are not finite, and more than
	/// max_probed_points as `rect`. `explains`: the ground is to be known with its normals, whatever the rules read.
	Status find(const LayerSettings &layer, std::span<const glm::dvec2> places, bool explains = false);

	/// Where the ground has to be known after `find`, and in which portions. Valid until the next call of it.
	std::span<const glm::dvec2> positions() const;
	std::span<const GroundQuery> queries() const;

	/// Takes the ground of all positions; any other length is refused as `ground`, as is a call without `find`. The densities and factors of
	/// places count from then on.
	Status look(std::span<const Ground> ground);

	/// After `look`: of a place, the ground, the density from 0 to 1, and all factors that it is the product of (see product_of). Replaces
	/// `r_factors`.
	const Ground &ground_at(std::size_t place) const;
	double density_at(std::size_t place) const;
	Status factors_at(std::size_t place, std::vector<RuleFactor> &r_factors) const;

private:
	struct Workspace;
	std::unique_ptr<Workspace> workspace_;
};

} // namespace thicket
