#pragma once

#include "core/base/status.hpp"
#include "core/placement/layer.hpp"

#include <array>
#include <cstddef>
#include <span>

namespace thicket {

/// A layer and all layers that it looks at, directly or through others, each of them once however many paths lead to it.
/// Everything that depends on the neighbors of a layer takes its order and its margins from here. Allocates no memory; the
/// layer must live as long.
class LayerGraph {
public:
	struct Node {
		const LayerSettings *layer = nullptr;

		/// Meters around a rectangle of the layer itself in which this one has to be known: the largest sum of distances on a
		/// path to it.
		double margin = 0.0;
		double asked_from =
				0.0; ///< Meters: the largest distance from which a layer looks at this one; 0 for the layer itself.
		std::size_t depth = 0; ///< The most steps on a path to it.
	};

	explicit LayerGraph(const LayerSettings &layer);

	/// Why there is no such graph: a neighbor or a distance that is refused, too many of them, too long a path.
	const Status &status() const { return status_; }

	/// Layers that are looked at stand before those that look at them; the layer itself is the last. Empty unless ok.
	std::span<const Node> nodes() const { return std::span(nodes_).first(status_.ok() ? size_ : 0); }

	/// The index in nodes() of a layer that is there.
	std::size_t index_of(const LayerSettings *layer) const;

private:
	void add(const LayerSettings &layer, std::size_t depth);
	void find_margins();

	Status status_;
	std::array<Node, max_graph_layers> nodes_;
	std::size_t size_ = 0;
};

} // namespace thicket
