#pragma once

#include "core/base/status.hpp"
#include "core/placement/layer.hpp"

#include <array>
#include <cstddef>
#include <span>

namespace thicket {

/// A layer and all layers that it depends on, directly or through others. Each appears once, however many paths lead to
/// it. All code that depends on the neighbors of a layer takes their order and margins from this graph. Allocates no
/// memory. The layer must outlive the graph.
class LayerGraph {
public:
	struct Node {
		const LayerSettings *layer = nullptr;

		/// Meters by which a rectangle of the layer itself must be expanded to cover all points of this layer that matter: the largest sum
		/// of distances on a path to it.
		double margin = 0.0;
		/// Meters: the largest distance at which any layer depends on this one; 0 for the layer itself.
		double asked_from = 0.0;
		std::size_t depth = 0; ///< The number of steps on the longest path to it.
	};

	explicit LayerGraph(const LayerSettings &layer);

	/// The reason why no graph exists: an invalid neighbor or distance, too many layers, or too long a path.
	const Status &status() const { return status_; }

	/// Layers come before the layers that depend on them, and the layer itself is last. Empty unless the status is ok.
	std::span<const Node> nodes() const { return std::span(nodes_).first(status_.ok() ? size_ : 0); }

	/// The index in nodes() of a layer that is in the graph.
	std::size_t index_of(const LayerSettings *layer) const;

private:
	void add(const LayerSettings &layer, std::size_t depth);
	void find_margins();

	Status status_;
	std::array<Node, max_graph_layers> nodes_;
	std::size_t size_ = 0;
};

} // namespace thicket
