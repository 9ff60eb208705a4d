#include "core/placement/tile_filter.hpp"

#include "core/placement/host_collector.hpp"

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

/// Returns the space in which a layer is sampled. Its margin is expanded by 0.1 %, so that
/// rounding far from the origin excludes no point within the distance.
TileSpace TileFilter::window_of(std::size_t index) const {
	const double margin = 1.001 * graph_.nodes()[index].margin;
	return space_.grown(margin);
}

Status TileFilter::sample_layer(
		std::size_t index, const Surface *surface, const std::atomic<bool> *cancel, CallerThreads *threads) {
	LayerFilter &each = *layers_[index];
	stats_ = {};
	if (each.settings().hosted) {
		each.wait_for_hosts(window_of(index));
		return {};
	}
	const Status status = each.sample({sampler_, surface_sampler_, surface}, window_of(index), cancel, threads);
	if (!each.settings().set.on_surface) {
		stats_ = sampler_.stats();
	} else {
		stats_.computed = surface_sampler_.stats().computed;
	}
	return status;
}

/// Sets `r_surface` to the models of a layer's hosts around the tile, or to null if there are none.
/// The hosts must already be filtered. `ground` is the ground for all layers.
Status TileFilter::models_around(
		std::size_t index, std::span<const Ground> ground, std::unique_ptr<const Surface> &r_surface) const {
	const LayerSettings &settings = layer(index).settings();
	HostCollector hosts(settings, window_of(index));
	for (const HostLayer &host : settings.hosts) {
		const std::size_t at = graph_.index_of(host.layer.get());
		if (const Status status = hosts.add(host, layer(at), ground_at(at, ground)); !status.ok()) {
			return status;
		}
	}
	return hosts.surface(r_surface);
}

/// Samples a layer on the models of its hosts, under the conditions of models_around.
Status TileFilter::sample_on_hosts(std::size_t index, std::span<const Ground> ground, const std::atomic<bool> *cancel) {
	std::unique_ptr<const Surface> surface;
	Status status = models_around(index, ground, surface);
	if (status.ok()) {
		const PointSource source{sampler_, host_sampler_, surface.get()};
		status = layers_[index]->sample(source, window_of(index), cancel, nullptr);
		stats_ = {};
		stats_.computed = host_sampler_.stats().computed;
	}
	return status;
}

Status TileFilter::sample(
		const TileSpace &space, const Surface *surface, const std::atomic<bool> *cancel, CallerThreads *threads) {
	space_ = space;
	for (std::size_t i = 0; i < size(); ++i) {
		if (const Status status = sample_layer(i, surface, cancel, threads); !status.ok()) {
			return status;
		}
	}
	return {};
}

Status TileFilter::sample_around(std::span<const glm::dvec2> places, std::span<const Ground> on_surface,
		const TileSpace &space, const Surface *surface, const Surface *grown) {
	space_ = space;
	for (std::size_t i = 0; i + 1 < size(); ++i) {
		if (const Status status = sample_layer(i, surface, nullptr, nullptr); !status.ok()) {
			return status;
		}
	}
	return layers_[size() - 1]->take(places, space, on_surface, grown);
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

/// Returns the part of `ground` at the positions of a layer.
std::span<const Ground> TileFilter::ground_at(std::size_t index, std::span<const Ground> ground) const {
	std::size_t first = 0;
	for (std::size_t i = 0; i < index; ++i) {
		first += layer(i).position_count();
	}
	return ground.subspan(first, layer(index).position_count());
}

std::span<const Ground> TileFilter::own_ground(std::span<const Ground> ground) const {
	return own().ground_of(ground_at(size() - 1, ground));
}

Status TileFilter::filter_layer(std::size_t index, std::span<const Ground> ground, const std::atomic<bool> *cancel) {
	if (layers_[index]->settings().hosted) {
		if (const Status status = sample_on_hosts(index, ground, cancel); !status.ok()) {
			return status;
		}
	}
	return layers_[index]->filter(ground_at(index, ground), cancel);
}

Status TileFilter::filter_neighbors(std::span<const Ground> ground, const std::atomic<bool> *cancel) {
	for (std::size_t i = 0; i + 1 < size(); ++i) {
		if (const Status status = filter_layer(i, ground, cancel); !status.ok()) {
			return status;
		}
		layers_[i]->index_standing(graph_.nodes()[i], ground_at(i, ground));
	}
	return {};
}

Status TileFilter::filter(std::span<const Ground> ground, const std::atomic<bool> *cancel) {
	const Status status = filter_neighbors(ground, cancel);
	return status.ok() ? filter_layer(size() - 1, ground, cancel) : status;
}

} // namespace thicket
