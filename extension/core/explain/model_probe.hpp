#pragma once

#include "core/placement/tile_filter.hpp"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <memory>
#include <span>
#include <vector>

namespace thicket {

/// Finds the models on which a layer grows near a position, in two steps, like DensityProbe.
class ModelProbe {
public:
	/// Finds the points of the hosts around a position in world meters. The layer must be valid and
	/// hosted. `surface` is the surface of the ground, or null if there is none.
	Status find(const LayerSettings &layer, const glm::dvec3 &position, const Surface *surface);

	/// These functions continue `find` with the ground at positions(); see
	/// TileBuilder::find_further.
	bool is_complete() const { return filter_.is_complete(); }
	Status find_further(std::span<const Ground> ground);

	/// These functions return the positions at which the next call needs the ground, and the queries
	/// for these positions.
	std::span<const glm::dvec2> positions() const { return positions_; }
	std::span<const GroundQuery> queries() const { return queries_; }

	/// Sets `r_models` to the surface of the models, or to null if there are none. The models in
	/// the settings must outlive this surface. `ground` contains the ground at all positions().
	Status models(std::span<const Ground> ground, std::unique_ptr<const Surface> &r_models);

private:
	void gather_positions();

	TileFilter filter_{SampleMargins()};
	std::vector<glm::dvec2> positions_;
	std::vector<GroundQuery> queries_;
};

} // namespace thicket
