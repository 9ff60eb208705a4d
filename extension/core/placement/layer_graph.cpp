#include "core/placement/layer_graph.hpp"

#include "core/base/check.hpp"
#include "core/placement/edge_probes.hpp"
#include "core/sampling/obstacles.hpp"

#include <algorithm>
#include <array>
#include <cstddef>

namespace thicket {

namespace {

Status check(const Neighbor &neighbor) {
	if (neighbor.layer == nullptr) {
		return {ErrorCode::missing, "neighbors", 0.0};
	}
	return first_failure(check_positive("neighbor distance", neighbor.distance),
			check_range("neighbor distance", neighbor.distance, 0.0, max_neighbor_distance));
}

/// Returns the sources of a layer that depend on distances to other layers; the others are null. At
/// a depth above 0, only the source of the scale counts, because other layers may grow on the models
/// of this one. Colors and variations matter only for the layer itself.
std::array<const InstanceSource *, 3> distance_sources_at(const LayerSettings &layer, std::size_t depth) {
	auto sources = distance_sources(layer.instance_data);
	if (depth > 0) {
		std::fill(sources.begin() + 1, sources.end(), nullptr);
	}
	return sources;
}

/// Return the layers that must be filtered in order to sample and filter a layer.
std::span<const Neighbor> neighbors_of(const LayerGraph::Node &node) {
	return node.is_cached ? std::span<const Neighbor>() : node.layer->neighbors;
}
std::span<const HostLayer> hosts_of(const LayerGraph::Node &node) {
	return node.is_cached ? std::span<const HostLayer>() : node.layer->hosts;
}

std::array<const InstanceSource *, 3> sources_of(const LayerGraph::Node &node) {
	return node.is_cached && node.depth > 0 ? std::array<const InstanceSource *, 3>{}
											: distance_sources_at(*node.layer, node.depth);
}

/// Return true if the expressions of a layer's rules or meshes need the distance to a source's layer.
/// Meshes matter only for the layer itself and for hosts.
bool rules_measure(const LayerGraph::Node &node, const WorldSource &source) {
	return !node.is_cached && source.layer != nullptr && rules_use(*node.layer, source.input);
}
bool measures(const LayerGraph::Node &node, const WorldSource &source) {
	return rules_measure(node, source) ||
			(source.layer != nullptr && (node.depth == 0 || node.is_host) && meshes_use(*node.layer, source.input));
}

Status too_deep(std::size_t depth) {
	return Status::out_of_range("length of the chain of layers", depth,
			at_most(max_neighbor_depth, "layers that refer to each other"),
			"Remove spacing, proximity_layer, surface_layers, scale_value, color_value or distance() from a layer of "
			"the chain");
}

} // namespace

LayerGraph::LayerGraph(const LayerSettings &layer, std::int32_t fill_margin, Cached cached) :
		fill_margin_(fill_margin) {
	add(layer, 0);
	if (status_.ok()) {
		find_margins();
	}
	if (status_.ok() && cached != Cached::none) {
		use_cache(cached);
	}
}

std::size_t LayerGraph::index_of(const LayerSettings *layer) const {
	const auto known = nodes_.begin() + static_cast<std::ptrdiff_t>(size_);
	const auto found = std::find_if(nodes_.begin(), known, [layer](const Node &node) { return node.layer == layer; });
	return static_cast<std::size_t>(found - nodes_.begin());
}

/// Adds a layer after the layers that it depends on.
void LayerGraph::add(const LayerSettings &layer, std::size_t depth) {
	if (!status_.ok() || index_of(&layer) < size_) {
		return;
	}
	if (depth > max_neighbor_depth) {
		status_ = too_deep(depth);
	} else if (layer.neighbors.size() > max_neighbors) {
		status_ = Status::out_of_range(
				"neighbors", layer.neighbors.size(), at_most(max_neighbors), "Remove entries of spacing");
	}
	for (std::size_t i = 0; status_.ok() && i < layer.neighbors.size(); ++i) {
		status_ = check(layer.neighbors[i]);
		if (status_.ok()) {
			add(*layer.neighbors[i].layer, depth + 1);
		}
	}
	add_hosts(layer, depth);
	for (const InstanceSource *source : distance_sources_at(layer, depth)) {
		if (status_.ok() && source != nullptr) {
			add(*source->layer, depth + 1);
		}
	}
	for (const WorldSource &source : layer.world_sources) {
		if (status_.ok() && source.layer != nullptr &&
				(rules_use(layer, source.input) || meshes_use(layer, source.input))) {
			add(*source.layer, depth + 1);
		}
	}
	if (status_.ok() && size_ == nodes_.size()) {
		status_ = Status::out_of_range("number of layers that this one depends on", size_ + 1,
				at_most(nodes_.size(), "including itself"),
				"Remove entries of spacing from the layers that this one refers to");
	}
	if (status_.ok()) {
		nodes_[size_++].layer = &layer;
	}
}

void LayerGraph::add_hosts(const LayerSettings &layer, std::size_t depth) {
	if (status_.ok() && layer.hosts.size() > max_hosts) {
		status_ = Status::out_of_range(
				"surface_layers", layer.hosts.size(), at_most(max_hosts), "Remove entries of surface_layers");
	}
	for (const HostLayer &host : layer.hosts) {
		if (status_.ok() && (host.layer == nullptr || host.models == nullptr)) {
			status_ = {ErrorCode::missing, "surface_layers", 0.0};
		}
		if (status_.ok()) {
			add(*host.layer, depth + 1);
		}
	}
}

/// Computes the margins backward from the layer itself, because all layers that depend on a layer
/// come after it.
void LayerGraph::find_margins() {
	for (std::size_t index = size_; index-- > 0;) {
		const Node &node = nodes_[index];
		if (node.depth > max_neighbor_depth) {
			status_ = too_deep(node.depth);
			return;
		}
		const auto extend = [this, &node](const LayerSettings *layer, double distance) -> Node & {
			Node &other = nodes_[index_of(layer)];
			other.margin = std::max(other.margin, node.margin + distance);
			other.depth = std::max(other.depth, node.depth + 1);
			other.is_filled_around = other.is_filled_around || node.is_filled_around;
			return other;
		};
		const auto include = [&extend, &node](
									 const LayerSettings *layer, double distance, double extra_distance = 0.0) {
			Node &other = extend(layer, distance + extra_distance);
			other.max_dependent_distance = std::max(other.max_dependent_distance, distance);
			(distance_in_space(*node.layer, *layer) ? other.needed_in_space : other.needed_on_plane) = true;
		};
		for (const HostLayer &host : hosts_of(node)) {
			extend(host.layer.get(), host_distance(*node.layer, reach_of(host))).is_host = true;
		}
		for (const Neighbor &neighbor : neighbors_of(node)) {
			if (!fills_around(*node.layer, neighbor)) {
				include(neighbor.layer.get(), neighbor.distance);
				continue;
			}
			const double around = fill_distance(node.layer->set, fill_margin_);
			Node &other = extend(neighbor.layer.get(), neighbor.distance + around);
			other.max_dependent_distance = std::max(other.max_dependent_distance, neighbor.distance);
			other.needed_for_filling = other.is_filled_around = true;
		}
		for (const InstanceSource *source : sources_of(node)) {
			if (source != nullptr) {
				include(source->layer.get(), source->max);
			}
		}
		for (const WorldSource &source : node.layer->world_sources) {
			if (measures(node, source)) {
				// Edge probes evaluate the expression of the rules, too.
				const double extra_distance = rules_measure(node, source)
						? edge_reach(node.layer->rules.edge_feather, node.layer->set.on_surface)
						: 0.0;
				include(source.layer.get(), source.input.max_distance, extra_distance);
			}
		}
	}
}

/// Finds the layers that the cache provides, and removes layers on which only these depend. The
/// cache has no heights and no models for other layers.
void LayerGraph::use_cache(Cached cached) {
	const auto fills_gaps = [](const Node &node) {
		return fills(*node.layer);
	};
	if (cached == Cached::chains && std::ranges::none_of(std::span(nodes_).first(size_ - 1), fills_gaps)) {
		return;
	}
	std::array<bool, max_graph_layers> needed{};
	needed[size_ - 1] = true;
	for (std::size_t index = size_; index-- > 0;) {
		Node &node = nodes_[index];
		node.is_cached = index + 1 == size_ ? cached == Cached::all
											: (node.is_filled_around || fills(*node.layer)) &&
						!node.layer->set.on_surface && !node.needed_in_space && !node.is_host;
		if (!needed[index]) {
			continue;
		}
		for (const Neighbor &neighbor : neighbors_of(node)) {
			needed[index_of(neighbor.layer.get())] = true;
		}
		for (const HostLayer &host : hosts_of(node)) {
			needed[index_of(host.layer.get())] = true;
		}
		for (const InstanceSource *source : sources_of(node)) {
			if (source != nullptr) {
				needed[index_of(source->layer.get())] = true;
			}
		}
		for (const WorldSource &source : node.layer->world_sources) {
			if (measures(node, source)) {
				needed[index_of(source.layer.get())] = true;
			}
		}
	}
	std::size_t kept_count = 0;
	for (std::size_t index = 0; index < size_; ++index) {
		if (needed[index]) {
			// The margins are computed again, because they included those of cached layers.
			nodes_[kept_count] = {.layer = nodes_[index].layer, .is_cached = nodes_[index].is_cached};
			++kept_count;
		}
	}
	size_ = kept_count;
	find_margins();
}

} // namespace thicket
