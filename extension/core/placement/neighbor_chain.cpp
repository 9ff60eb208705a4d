#include "core/placement/neighbor_chain.hpp"

#include "core/base/check.hpp"

#include <algorithm>

namespace thicket {

namespace {

Status check(const Neighbor &neighbor) {
	if (neighbor.layer == nullptr) {
		return {ErrorCode::missing, "neighbors", 0.0};
	}
	return first_failure(check_positive("neighbor distance", neighbor.distance),
			check_range("neighbor distance", neighbor.distance, 0.0, max_neighbor_distance));
}

Status too_deep(std::size_t depth) {
	return {ErrorCode::out_of_range, "depth of neighbors", static_cast<double>(depth)};
}

} // namespace

NeighborChain::NeighborChain(const LayerSettings &layer) {
	add(layer, 0);
	if (status_.ok()) {
		find_margins();
	}
}

NeighborChain::Link *NeighborChain::find(const LayerSettings *layer) {
	Link *const end = links_.data() + size_;
	Link *const found = std::find_if(links_.data(), end, [layer](const Link &link) { return link.layer == layer; });
	return found != end ? found : nullptr;
}

/// Adds the layer behind those that it looks at.
void NeighborChain::add(const LayerSettings &layer, std::size_t depth) {
	if (!status_.ok() || find(&layer) != nullptr) {
		return;
	}
	if (depth > max_neighbor_depth) {
		status_ = too_deep(depth);
	} else if (layer.neighbors.size() > max_neighbors) {
		status_ = {ErrorCode::out_of_range, "neighbors", static_cast<double>(layer.neighbors.size())};
	}
	for (std::size_t i = 0; status_.ok() && i < layer.neighbors.size(); ++i) {
		status_ = check(layer.neighbors[i]);
		if (status_.ok()) {
			add(*layer.neighbors[i].layer, depth + 1);
		}
	}
	if (status_.ok() && size_ == links_.size()) {
		status_ = {ErrorCode::out_of_range, "neighbors of neighbors", static_cast<double>(size_ + 1)};
	}
	if (status_.ok()) {
		links_[size_++].layer = &layer;
	}
}

void NeighborChain::find_margins() {
	for (std::size_t at = size_; at-- > 0;) {
		const Link &link = links_[at];
		if (link.depth > max_neighbor_depth) {
			status_ = too_deep(link.depth);
			return;
		}
		for (const Neighbor &neighbor : link.layer->neighbors) {
			Link &other = *find(neighbor.layer.get());
			other.margin = std::max(other.margin, link.margin + neighbor.distance);
			other.depth = std::max(other.depth, link.depth + 1);
		}
	}
}

} // namespace thicket
