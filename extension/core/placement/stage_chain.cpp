#include "core/placement/stage_chain.hpp"

#include <algorithm>
#include <array>
#include <utility>

namespace thicket {

void StageChain::set(const LayerSettings &layer) {
	size_ = 0;
	layer_ = layer;
	add(layer_);
	find_margins();
}

/// Adds the neighbors first, so that the order of the links is one in which they can be worked off.
const LayerStage *StageChain::add(const LayerSettings &layer) {
	const auto end = links_.begin() + static_cast<std::ptrdiff_t>(size_);
	const auto known = std::find_if(links_.begin(), end, [&layer](const Link &link) { return link.layer == &layer; });
	if (known != end) {
		return known->stage.get();
	}
	std::array<const LayerStage *, max_neighbors> neighbors{};
	for (std::size_t i = 0; i < layer.neighbors.size(); ++i) {
		neighbors[i] = add(*layer.neighbors[i].layer);
	}
	if (size_ == links_.size()) {
		auto stage = std::make_unique<LayerStage>(); // First, so that no link is left without one.
		links_.emplace_back().stage = std::move(stage);
	}
	Link &link = links_[size_++];
	link.layer = &layer;
	link.margin = link.asked_to = 0.0;
	link.stage->set(layer, std::span(neighbors).first(layer.neighbors.size()));
	return link.stage.get();
}

/// From the layer itself back to those that depend on nothing: all that ask a stage come behind it.
void StageChain::find_margins() {
	for (std::size_t at = size_; at-- > 0;) {
		for (const Neighbor &neighbor : links_[at].layer->neighbors) {
			for (std::size_t other = 0; other < at; ++other) {
				if (links_[other].layer == neighbor.layer.get()) {
					links_[other].margin = std::max(links_[other].margin, links_[at].margin + neighbor.distance);
					links_[other].asked_to = std::max(links_[other].asked_to, neighbor.distance);
				}
			}
		}
	}
}

Status StageChain::sample(const Rect &rect, const std::atomic<bool> *cancel) {
	for (std::size_t i = 0; i < size_; ++i) {
		const Link &link = links_[i];
		// A part in a thousand more, so that rounding far from the origin leaves out nobody who is near enough.
		const double margin = 1.001 * link.margin;
		const Rect window{rect.min - margin, rect.max + margin};
		if (const Status status = link.stage->sample(sampler_, window, cancel); !status.ok()) {
			return status;
		}
	}
	return {};
}

Status StageChain::filter(std::span<const Ground> ground, const std::atomic<bool> *cancel) {
	std::size_t first = 0;
	for (std::size_t i = 0; i < size_; ++i) {
		LayerStage &stage = *links_[i].stage;
		const std::size_t count = stage.place_count();
		if (const Status status = stage.filter(ground.subspan(first, count), cancel); !status.ok()) {
			return status;
		}
		if (i + 1 < size_) {
			stage.index_standing(links_[i].asked_to);
		}
		first += count;
	}
	return {};
}

} // namespace thicket
