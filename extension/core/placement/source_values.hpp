#pragma once

#include "core/placement/instance_writer.hpp"
#include "core/placement/tile_filter.hpp"

#include <glm/vec2.hpp>

#include <atomic>
#include <cstddef>
#include <span>
#include <vector>

namespace thicket {

/// Computes the SourceFractions of a layer at the points that become instances. An object of this
/// class reuses its memory. `filter` has filtered the layer itself and those on which it depends.
class SourceValues {
public:
	/// Sets the fractions and the world values in `r_points`, which must be the points of the filter's
	/// own layer. `ground` is the ground at all positions of this layer (TileFilter::all_own_ground). The
	/// spans are valid until the next call. If a noise field fails, returns its error. Returns
	/// ErrorCode::cancelled if `cancel` is set. Throws std::bad_alloc.
	Status find(const TileFilter &filter, std::span<const Ground> ground, PlacedPoints &r_points,
			const std::atomic<bool> *cancel);

	/// Sets only the fractions for scales and the world values, under the same conditions. `layer` is the
	/// layer of the points: any layer of the filter that is not cached.
	Status find_for_model(const TileFilter &filter, const LayerFilter &layer, std::span<const Ground> ground,
			PlacedPoints &r_points, const std::atomic<bool> *cancel);

private:
	/// A layer whose sources are evaluated.
	struct Layer {
		const TileFilter &all; ///< Provides the layers of distance sources.
		const LayerFilter &own;
	};

	Status find(const InstanceSource &source, const Layer &layer, const PlacedPoints &points,
			const std::atomic<bool> *cancel, std::vector<float> &r_fractions);
	Status measure(const InstanceSource &source, const Layer &layer, const PlacedPoints &points, std::size_t first,
			std::span<double> r_values);
	Status find_world_values(const LayerFilter &layer, std::span<const Ground> ground, PlacedPoints &r_points,
			const std::atomic<bool> *cancel);
	std::span<const float> heights_of(const PlacedPoints &points, std::span<const std::uint32_t> accepted);

	std::vector<float> color_;     ///< One entry per point; unspecified for points that are not kept.
	std::vector<float> variation_; ///< The variation of each point, under the same conditions.
	std::vector<float> scale_;     ///< The scale's fraction of each point, under the same conditions.
	std::vector<float> world_;     ///< One entry per world source for each point, under the same conditions.

	// Working memory for one batch of points.
	std::vector<double> values_;
	std::vector<glm::dvec2> positions_;
	std::vector<float> heights_; ///< World meters.
	std::vector<float> noise_;
};

} // namespace thicket
