#pragma once

#include "core/placement/instance_writer.hpp"
#include "core/placement/tile_filter.hpp"

#include <glm/vec2.hpp>

#include <atomic>
#include <cstddef>
#include <span>
#include <vector>

namespace thicket {

/// Computes the shares of a layer's color and variation sources at the points that become instances. Reuses its memory.
class SourceValues {
public:
	/// Adds the shares of all known sources to `r_points`, which must be the points of the filter's own layer. The
	/// shares are valid until the next call. Returns the error of a noise that fails, or ErrorCode::cancelled when
	/// `cancel` is raised. Throws std::bad_alloc.
	Status find(const TileFilter &filter, StandingPoints &r_points, const std::atomic<bool> *cancel);

private:
	Status find(const InstanceSource &source, const TileFilter &filter, const StandingPoints &points,
			const std::atomic<bool> *cancel, std::vector<float> &r_shares);
	Status measure(const InstanceSource &source, const LayerFilter *other, const StandingPoints &points,
			std::size_t first, std::span<double> r_values);

	std::vector<float> color_;     ///< One for each point; unspecified for points that are not kept.
	std::vector<float> variation_; ///< As above, for the variation.

	// Working memory of a batch.
	std::vector<double> values_;
	std::vector<glm::dvec2> positions_;
	std::vector<float> noise_;
};

} // namespace thicket
