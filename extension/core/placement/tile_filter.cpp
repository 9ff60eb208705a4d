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

Status TileFilter::sample_layer(
		std::size_t index, const Rect &rect, const std::atomic<bool> *cancel, LentThreads *threads) {
	// Expanded by one part in a thousand, so that rounding far from the origin excludes no point that is near enough.
	const double margin = 1.001 * graph_.nodes()[index].margin;
	return layers_[index]->sample(sampler_, {rect.min - margin, rect.max + margin}, cancel, threads);
}

Status TileFilter::sample(const Rect &rect, const std::atomic<bool> *cancel, LentThreads *threads) {
	for (std::size_t i = 0; i < size(); ++i) {
		if (const Status status = sample_layer(i, rect, cancel, threads); !status.ok()) {
			return status;
		}
	}
	return {};
}

Status TileFilter::sample_around(
		std::span<const glm::dvec2> places, const Rect &rect, const std::atomic<bool> *cancel) {
	for (std::size_t i = 0; i + 1 < size(); ++i) {
		if (const Status status = sample_layer(i, rect, cancel, nullptr); !status.ok()) {
			return status;
		}
	}
	return layers_[size() - 1]->take(places, rect);
}

double TileFilter::points_around(const Rect &rect) const {
	double points = 0.0;
	for (const LayerGraph::Node &node : graph_.nodes().first(size() - 1)) {
		const glm::dvec2 sides = rect.size() + 2.0 * node.margin;
		points += sides.x * sides.y * point_density(node.layer->set);
	}
	return points;
}

void TileFilter::add_queries(std::vector<glm::dvec2> &r_positions, std::vector<GroundQuery> &r_queries) const {
	for (std::size_t i = 0; i < size(); ++i) {
		const bool placed = i + 1 == size() && follows_normals(layer_);
		layer(i).add_queries(placed, r_positions, r_queries);
	}
}

std::size_t TileFilter::own_first() const {
	std::size_t first = 0;
	for (std::size_t i = 0; i + 1 < size(); ++i) {
		first += layer(i).position_count();
	}
	return first;
}

Status TileFilter::filter_neighbors(std::span<const Ground> ground, const std::atomic<bool> *cancel) {
	std::size_t first = 0;
	for (std::size_t i = 0; i + 1 < size(); ++i) {
		LayerFilter &each = *layers_[i];
		const std::size_t count = each.position_count();
		if (const Status status = each.filter(ground.subspan(first, count), cancel); !status.ok()) {
			return status;
		}
		each.index_standing(graph_.nodes()[i].asked_from);
		first += count;
	}
	return {};
}

Status TileFilter::filter(std::span<const Ground> ground, const std::atomic<bool> *cancel) {
	if (const Status status = filter_neighbors(ground, cancel); !status.ok()) {
		return status;
	}
	return layers_[size() - 1]->filter(ground.subspan(own_first(), own().position_count()), cancel);
}

} // namespace thicket
