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

/// Maximum number of points of other layers that a probe may read, estimated from the density of
/// their sets.
inline constexpr double max_probed_points = 4e6;

/// Evaluates the density of a layer's rules at arbitrary positions, with the same code as tile
/// generation. A point of the set at such a position would become an instance if its rank were
/// below the density. A probe works in two steps, because the ground may have to be queried on
/// another thread. Call `find`, query the ground at `positions()`, then call `evaluate`. If other
/// layers fill gaps, call `find_further` until is_complete(), as for TileBuilder. Probes can be
/// reused, like a TileBuilder, and each thread needs its own.
class DensityProbe {
public:
	explicit DensityProbe(const SampleMargins &margins = {});
	~DensityProbe();
	DensityProbe(DensityProbe &&) noexcept;
	DensityProbe &operator=(DensityProbe &&) noexcept;

	/// Prepares a probe of a layer at some positions (world meters) and finds the points of other
	/// layers on which its rules depend there. The search covers the bounding rectangle of the
	/// positions, so these should be close together. Returns an error for an invalid layer, an
	/// empty list, and positions that are not finite. If the search would find more than
	/// max_probed_points, the error names `rect`. If `for_explanation` is true, the queries include
	/// the ground's normals even if the rules do not need them. `surface` is the surface of the
	/// ground; without it, layers on surfaces have no points. The positions are on the top of the
	/// ground, unless `on_surface` contains the ground at each of them. `host_surface` is then the
	/// surface on which the layer grows; without it, the probe ignores the edge feather.
	Status find(const LayerSettings &layer, std::span<const glm::dvec2> positions, bool for_explanation = false,
			const Surface *surface = nullptr, std::span<const Ground> on_surface = {},
			const Surface *host_surface = nullptr);

	/// These functions continue `find` with the ground at positions(); see
	/// TileBuilder::find_further.
	bool is_complete() const;
	Status find_further(std::span<const Ground> ground);

	/// These functions return the positions at which the next call needs the ground, and the queries
	/// that group these positions. Both lists are valid until that call.
	std::span<const glm::dvec2> positions() const;
	std::span<const GroundQuery> queries() const;

	/// Evaluates the rules with the ground at all positions. The functions below can be called
	/// afterward. A wrong number of entries is an error that names `ground`. A call without a
	/// successful `find` is an error that names `positions`.
	Status evaluate(std::span<const Ground> ground);

	/// These functions return the ground at one position, the density there (0 to 1), and all
	/// factors of the density (see product_of). `index` is the position's index in the call to
	/// `find`. A successful `evaluate` is required. `factors_at` replaces the content of
	/// `r_factors`.
	const Ground &ground_at(std::size_t index) const;
	double density_at(std::size_t index) const;
	Status factors_at(std::size_t index, std::vector<RuleFactor> &r_factors) const;

	/// Replaces `r_values` with the values of LayerSettings::world_sources at a position, under the
	/// same conditions. Values that no mesh uses are 0. `find` must have been called with
	/// `for_explanation`.
	Status world_values_at(std::size_t index, std::vector<float> &r_values) const;

private:
	struct Workspace;
	std::unique_ptr<Workspace> workspace_;
};

} // namespace thicket
