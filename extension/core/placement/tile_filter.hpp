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

/// Finds out which points of a layer stand in a rectangle. The layers that it looks at, directly or through others, are
/// sampled and filtered first, each once, in the order of the LayerGraph. Keeps its memory.
class TileFilter {
public:
	explicit TileFilter(const SampleMargins &margins, std::shared_ptr<BlockCache> cache = nullptr) :
			sampler_(margins, std::move(cache)) {}

	/// Prepares for a layer of valid settings, which is copied.
	void set(const LayerSettings &layer);

	/// Samples all layers, each in the window that `rect` of the layer itself needs. For `threads` see TileSampler::sample.
	Status sample(const Rect &rect, const std::atomic<bool> *cancel, LentThreads *threads = nullptr);

	/// In place of `sample`: places of the caller's for the layer itself (see LayerFilter::take), and the points of the others that
	/// matter there. `rect` holds all places.
	Status sample_around(
			std::span<const glm::dvec2> places, const Rect &rect, const std::atomic<bool> *cancel = nullptr);

	/// About how many points of other layers that is.
	double points_around(const Rect &rect) const;

	/// Where the ground has to be known: the positions of all layers, one after the other, as tiles need it. Adds to both.
	void add_queries(std::vector<glm::dvec2> &r_positions, std::vector<GroundQuery> &r_queries) const;

	/// Where among these the positions of the layer itself begin.
	std::size_t own_first() const;

	/// Filters all layers; `ground` holds the ground of their positions, one layer after the other.
	Status filter(std::span<const Ground> ground, const std::atomic<bool> *cancel);

	/// All but the layer itself.
	Status filter_neighbors(std::span<const Ground> ground, const std::atomic<bool> *cancel = nullptr);

	/// The filters of all layers, in the order of the graph.
	std::size_t size() const { return graph_.nodes().size(); }
	const LayerFilter &layer(std::size_t index) const { return *layers_[index]; }

	/// That of a layer which the layer itself looks at.
	const LayerFilter &layer_of(const LayerSettings *settings) const { return layer(graph_.index_of(settings)); }

	/// That of the layer itself: the last.
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
