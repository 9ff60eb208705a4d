#pragma once

#include "core/placement/instance_writer.hpp"
#include "core/placement/tile_filter.hpp"

#include <glm/vec2.hpp>

#include <atomic>
#include <cstddef>
#include <span>
#include <vector>

namespace thicket {

/// What the sources of a layer's colors and variations say at the points that stand. Keeps its memory.
class SourceShares {
public:
	/// Completes `r_points`, those of the filter's own layer: gives them the shares of the sources that are known. They are valid
	/// until the next call. Fails as a noise does, or with ErrorCode::cancelled when `cancel` is raised; throws std::bad_alloc.
	Status find(const TileFilter &filter, StandingPoints &r_points, const std::atomic<bool> *cancel);

private:
	Status find(const InstanceSource &source, const TileFilter &filter, const StandingPoints &points,
			const std::atomic<bool> *cancel, std::vector<float> &r_shares);
	Status measure(const InstanceSource &source, const LayerFilter *other, const StandingPoints &points,
			std::size_t first, std::span<double> r_values);

	std::vector<float> color_;     ///< For each point; of those that do not stand anything.
	std::vector<float> variation_; ///< The same.

	// Working memory of a batch.
	std::vector<double> values_;
	std::vector<glm::dvec2> positions_;
	std::vector<float> noise_;
};

} // namespace thicket
