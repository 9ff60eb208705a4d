#pragma once

#include "core/base/status.hpp"
#include "core/placement/layer.hpp"
#include "core/sampling/obstacles.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace thicket {

/// A layer and all layers on which it depends, directly or indirectly, each exactly once. The graph
/// defines their order and margins for all other code. It allocates no memory. The layer must
/// outlive the graph.
class LayerGraph {
public:
	struct Node {
		const LayerSettings *layer = nullptr;
		/// True if an InstanceCache provides the instances of this layer. The graph then contains the
		/// layers on which this one depends only if other layers need them.
		bool is_cached = false;

		/// Largest sum of distances, in meters, on a path to this layer. A rectangle expanded by
		/// this margin contains all points of this layer that affect instances in it.
		double margin = 0.0;
		/// Largest distance in meters at which any layer of the graph depends on this one; 0 for
		/// the layer itself.
		double max_dependent_distance = 0.0;
		/// True if dependent layers measure their distances to this layer in the plane
		/// (`needed_on_plane`) or in space (`needed_in_space`); see distance_in_space.
		bool needed_on_plane = false;
		bool needed_in_space = false;
		/// True if a layer fills gaps around this one. Points of that layer keep their distance
		/// already when they are sampled. Other positions are checked on the plane.
		bool needed_for_filling = false;
		/// True if a layer fills gaps around this one, or around a layer that depends on this one.
		/// The margin is then wide, and the windows of adjacent tiles share much of their area.
		bool is_filled_around = false;
		bool is_host = false;  ///< True if any layer of the graph grows on the models of this one.
		std::size_t depth = 0; ///< Number of steps on the longest path to this layer.
	};

	/// Which layers of a graph an InstanceCache provides.
	enum class Cached : std::uint8_t {
		none,
		chains,  ///< As `earlier`, if any earlier layer fills gaps.
		earlier, ///< Earlier layers that fill gaps, or that others fill around.
		all,     ///< These, and the layer itself.
	};

	/// `fill_margin` is the margin in cells with which filled layers are sampled.
	explicit LayerGraph(
			const LayerSettings &layer, std::int32_t fill_margin = fill_margins.front(), Cached cached = Cached::none);

	/// Returns an error if the graph could not be built because of an invalid neighbor or distance,
	/// too many layers, or too long a path.
	const Status &status() const { return status_; }

	/// Returns the layers. Each comes before all layers that depend on it, so the layer itself is
	/// last. The list is empty if the status is not ok.
	std::span<const Node> nodes() const { return std::span(nodes_).first(status_.ok() ? size_ : 0); }

	/// Returns the index in nodes() of a layer in the graph.
	std::size_t index_of(const LayerSettings *layer) const;

private:
	void add(const LayerSettings &layer, std::size_t depth);
	void add_hosts(const LayerSettings &layer, std::size_t depth);
	void find_margins();
	void use_cache(Cached cached);

	std::int32_t fill_margin_;
	Status status_;
	std::array<Node, max_graph_layers> nodes_;
	std::size_t size_ = 0;
};

/// Returns true if the distance between instances of two layers is measured in space, because at
/// least one of the layers is on surfaces.
inline bool distance_in_space(const LayerSettings &a, const LayerSettings &b) {
	return a.set.on_surface || b.set.on_surface;
}

} // namespace thicket
