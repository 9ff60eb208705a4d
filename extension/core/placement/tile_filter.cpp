#include "core/placement/tile_filter.hpp"

#include <array>

namespace thicket {

void TileFilter::set(const LayerSettings &layer) {
	layer_ = layer;
	graph_ = LayerGraph(layer_);
	while (layers_.size() < size()) {
		layers_.push_back(std::make_unique<LayerFilter>());
	}
	for (std::size_t i = 0; i < size(); ++i) {
		const LayerSettings &settings = *graph_.nodes()[i].layer;
		std::array<const LayerFilter *, max_neighbors> neighbors{};
		for (std::size_t n = 0; n < settings.neighbors.size(); ++n) {
			neighbors[n] = layers_[graph_.index_of(settings.neighbors[n].layer.get())].get();
		}
		layers_[i]->set(settings, std::span(neighbors).first(settings.neighbors.size()));
	}
}

Status TileFilter::sample(const Rect &rect, const std::atomic<bool> *cancel) {
	for (std::size_t i = 0; i < size(); ++i) {
		// A part in a thousand more, so that rounding far from the origin leaves out nobody who is near enough.
		const double margin = 1.001 * graph_.nodes()[i].margin;
		const Rect window{rect.min - margin, rect.max + margin};
		if (const Status status = layers_[i]->sample(sampler_, window, cancel); !status.ok()) {
			return status;
		}
	}
	return {};
}

Status TileFilter::filter(std::span<const Ground> ground, const std::atomic<bool> *cancel) {
	std::size_t first = 0;
	for (std::size_t i = 0; i < size(); ++i) {
		LayerFilter &layer = *layers_[i];
		const std::size_t count = layer.position_count();
		if (const Status status = layer.filter(ground.subspan(first, count), cancel); !status.ok()) {
			return status;
		}
		if (i + 1 < size()) {
			layer.index_standing(graph_.nodes()[i].asked_from);
		}
		first += count;
	}
	return {};
}

} // namespace thicket
