#pragma once

#include "core/placement/ground_query.hpp"
#include "core/placement/layer_filter.hpp"
#include "core/placement/layer_graph.hpp"

#include <cstddef>
#include <memory>
#include <span>
#include <utility>
#include <vector>

namespace thicket {

/// Decides which points of a layer become instances in a rectangle. The layers that it depends on, directly or through others, are sampled
/// and filtered first, each once, in the order of the LayerGraph. Reuses its memory.
class TileFilter {
public:
	explicit TileFilter(const SampleMargins &margins, std::shared_ptr<BlockCache> cache = nullptr) :
			sampler_(margins, std::move(cache)) {}

	/// Prepares for a layer with valid settings, which it copies.
	void set(const LayerSettings &layer);

	/// Samples all layers, each in the window that `rect` of the layer itself requires. For `threads` see TileSampler::sample.
	Status sample(const Rect &rect, const std::atomic<bool> *cancel, LentThreads *threads = nullptr);

	/// Used instead of `sample`: takes positions from the caller for the layer itself (see LayerFilter::take), and samples the points of
	/// other layers that matter there. `rect` contains all positions.
	Status sample_around(
			std::span<const glm::dvec2> places, const Rect &rect, const std::atomic<bool> *cancel = nullptr);

	/// The approximate number of points of other layers that this samples.
	double points_around(const Rect &rect) const;

	/// The positions at which the ground must be known: those of all layers, one after the other, as tiles need them. Appends to both
	/// lists.
	void add_queries(std::vector<glm::dvec2> &r_positions, std::vector<GroundQuery> &r_queries) const;

	/// The index of the first position of the layer itself.
	std::size_t own_first() const;

	/// Filters all layers. `ground` contains the ground of their positions, one layer after the other.
	Status filter(std::span<const Ground> ground, const std::atomic<bool> *cancel);

	/// Filters all layers except the layer itself.
	Status filter_neighbors(std::span<const Ground> ground, const std::atomic<bool> *cancel = nullptr);

	/// The filters of all layers, in the order of the graph.
	std::size_t size() const { return graph_.nodes().size(); }
	const LayerFilter &layer(std::size_t index) const { return *layers_[index]; }

	/// The filter of a layer that the layer itself depends on.
	const LayerFilter &layer_of(const LayerSettings *settings) const { return layer(graph_.index_of(settings)); }

	/// The filter of the layer itself, which is the last.
	const LayerFilter &own() const { return layer(size() - 1); }

	const SampleStats &sample_stats() const { return sampler_.stats(); }

private:
	Status sample_layer(std::size_t index, const Rect &rect, const std::atomic<bool> *cancel, LentThreads *threads);

	LayerSettings layer_;
	LayerGraph graph_{layer_};
	std::vector<std::unique_ptr<LayerFilter>> layers_; ///< The first size() are in use; the rest keep their memory.
	TileSampler sampler_;
};

} // namespace thicket
