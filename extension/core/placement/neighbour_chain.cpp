#include "core/placement/neighbour_chain.hpp"

#include "core/base/check.hpp"

#include <algorithm>

namespace thicket {

namespace {

Status check(const Neighbour &neighbour) {
	if (neighbour.layer == nullptr) {
		return {ErrorCode::missing, "neighbours", 0.0};
	}
	return first_failure(check_positive("neighbour distance", neighbour.distance),
			check_range("neighbour distance", neighbour.distance, 0.0, max_neighbour_distance));
}

Status too_deep(std::size_t depth) {
	return {ErrorCode::out_of_range, "depth of neighbours", static_cast<double>(depth)};
}

} // namespace

NeighbourChain::NeighbourChain(const LayerSettings &layer) {
	add(layer, 0);
	if (status_.ok()) {
		find_margins();
	}
}

NeighbourChain::Link *NeighbourChain::find(const LayerSettings *layer) {
	Link *const end = links_.data() + size_;
	Link *const found = std::find_if(links_.data(), end, [layer](const Link &link) { return link.layer == layer; });
	return found != end ? found : nullptr;
}

/// Adds the layer behind those that it looks at.
void NeighbourChain::add(const LayerSettings &layer, std::size_t depth) {
	if (!status_.ok() || find(&layer) != nullptr) {
		return;
	}
	if (depth > max_neighbour_depth) {
		status_ = too_deep(depth);
	} else if (layer.neighbours.size() > max_neighbours) {
		status_ = {ErrorCode::out_of_range, "neighbours", static_cast<double>(layer.neighbours.size())};
	}
	for (std::size_t i = 0; status_.ok() && i < layer.neighbours.size(); ++i) {
		status_ = check(layer.neighbours[i]);
		if (status_.ok()) {
			add(*layer.neighbours[i].layer, depth + 1);
		}
	}
	if (status_.ok() && size_ == links_.size()) {
		status_ = {ErrorCode::out_of_range, "neighbours of neighbours", static_cast<double>(size_ + 1)};
	}
	if (status_.ok()) {
		links_[size_++].layer = &layer;
	}
}

void NeighbourChain::find_margins() {
	for (std::size_t at = size_; at-- > 0;) {
		const Link &link = links_[at];
		if (link.depth > max_neighbour_depth) {
			status_ = too_deep(link.depth);
			return;
		}
		for (const Neighbour &neighbour : link.layer->neighbours) {
			Link &other = *find(neighbour.layer.get());
			other.margin = std::max(other.margin, link.margin + neighbour.distance);
			other.depth = std::max(other.depth, link.depth + 1);
		}
	}
}

} // namespace thicket
