#include "core/placement/tile_filter.hpp"

#include "core/placement/host_collector.hpp"
#include "core/placement/source_values.hpp"
#include "core/sampling/obstacles.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace thicket {

void TileFilter::set(const LayerSettings &layer, const Terrain *terrain, double width) {
	layer_ = layer;
	number_ = layer.number.value();
	queries_normals_ = follows_normals(layer);
	attempt_ = 0;
	cached_on_ = instances_ != nullptr && terrain != nullptr && terrain->version() != 0 ? terrain : nullptr;
	// In large tiles of a layer that no chain of filling layers precedes, little of the earlier layers
	// is shared, and a cache of their points (AreaCache) is faster.
	// The cache has no weights of textures for the choice of meshes.
	const auto needs_weights = [&layer](const WorldSource &source) {
		return source.input.kind == WorldInputKind::texture && meshes_use(layer, source.input);
	};
	const bool may_have_tiles = std::ranges::none_of(layer.world_sources, needs_weights);
	cached_ = cached_on_ == nullptr                                    ? LayerGraph::Cached::none
			: may_have_tiles && InstanceCache::has_tiles(layer, width) ? LayerGraph::Cached::all
			: std::isfinite(width)                                     ? LayerGraph::Cached::chains
																	   : LayerGraph::Cached::earlier;
	set_graph();
}

/// Builds the graph of the layer, and prepares the filters of its layers.
void TileFilter::set_graph() {
	graph_ = LayerGraph(layer_, fill_margins[attempt_], cached_);
	while (layers_.size() < size()) {
		layers_.push_back(std::make_unique<LayerFilter>());
	}
	for (std::size_t i = 0; i < size(); ++i) {
		const LayerSettings &settings = *graph_.nodes()[i].layer;
		const std::size_t count = graph_.nodes()[i].is_cached ? 0 : settings.neighbors.size();
		std::array<const LayerFilter *, max_neighbors> neighbors{};
		for (std::size_t n = 0; n < count; ++n) {
			neighbors[n] = layers_[graph_.index_of(settings.neighbors[n].layer.get())].get();
		}
		std::array<const LayerFilter *, max_world_sources> measured{};
		const std::size_t sources = settings.world_sources.size();
		for (std::size_t source = 0; source < sources; ++source) {
			const std::size_t at = graph_.index_of(settings.world_sources[source].layer.get());
			measured[source] = at < size() ? layers_[at].get() : nullptr;
		}
		const bool chooses_meshes = i + 1 == size() || graph_.nodes()[i].is_host;
		layers_[i]->set(
				settings, std::span(neighbors).first(count), std::span(measured).first(sources), chooses_meshes);
	}
}

/// Widens the margins in the graph. The layers and their order stay the same.
void TileFilter::set_fill_margin(std::size_t attempt) {
	if (attempt != attempt_) {
		attempt_ = attempt;
		graph_ = LayerGraph(layer_, fill_margins[attempt], cached_);
	}
}

/// Returns the space in which a layer is sampled. Its margin is expanded by 0.1 %, so that
/// rounding far from the origin excludes no point within the distance.
TileSpace TileFilter::window_of(std::size_t index) const {
	const double margin = 1.001 * graph_.nodes()[index].margin;
	return space_.grown(margin);
}

Status TileFilter::sample_layer(std::size_t index, const std::atomic<bool> *cancel, CallerThreads *threads) {
	LayerFilter &each = *layers_[index];
	stats_ = {};
	if (graph_.nodes()[index].is_cached) {
		return take_cached(index, cancel);
	}
	const bool is_filled = fills(each.settings());
	if (each.settings().hosted || is_filled) {
		each.wait_for_others(window_of(index));
		const bool waits = is_filled || !each.settings().rules.density_rules.empty();
		progress_[index] = waits ? Progress::waiting : Progress::sampled;
		return {};
	}
	progress_[index] = Progress::sampled;
	const WindowUse use = graph_.nodes()[index].is_filled_around ? WindowUse::overlapping : WindowUse::separate;
	const PointSource source{samplers_->plane, samplers_->surfaces, surface_, nullptr, use};
	const Status status = each.sample(source, window_of(index), cancel, threads);
	if (each.settings().set.in_rows) {
		return status; // Rows need no sampler, so there are no statistics.
	}
	if (!each.settings().set.on_surface) {
		stats_ = samplers_->plane.stats();
	} else {
		stats_.computed = samplers_->surfaces.stats().computed;
	}
	return status;
}

/// Sets `r_surface` to the models of a layer's hosts around the tile, or to null if there are none.
/// The hosts must already be filtered. `ground` is the ground for all layers.
Status TileFilter::models_around(std::size_t index, std::span<const Ground> ground, const std::atomic<bool> *cancel,
		std::unique_ptr<const Surface> &r_surface) const {
	const LayerSettings &settings = layer(index).settings();
	HostCollector hosts(settings, window_of(index));
	SourceValues values;
	for (const HostLayer &host : settings.hosts) {
		const std::size_t at = graph_.index_of(host.layer.get());
		const LayerFilter &filter = layer(at);
		PlacedPoints points{filter.positions(), filter.ground_of(ground_at(at, ground)), filter.ids(),
				filter.accepted(), filter.thinning_ranks()};
		Status status = values.find_for_model(*this, filter, ground_at(at, ground), points, cancel);
		if (status.ok()) {
			status = hosts.add(host, points);
		}
		if (!status.ok()) {
			return status;
		}
	}
	return hosts.surface(r_surface);
}

/// Samples a layer on the models of its hosts, under the conditions of models_around.
Status TileFilter::sample_on_hosts(std::size_t index, std::span<const Ground> ground, const std::atomic<bool> *cancel) {
	std::unique_ptr<const Surface> surface;
	Status status = models_around(index, ground, cancel, surface);
	if (status.ok()) {
		const PointSource source{samplers_->plane, samplers_->hosts, surface.get()};
		status = layers_[index]->sample(source, window_of(index), cancel, nullptr);
		stats_ = {};
		stats_.computed = samplers_->hosts.stats().computed;
	}
	return status;
}

/// Samples a layer that waits for others, which must already be filtered. A layer on models waits if
/// it has density rules, because these are queried like the ground.
Status TileFilter::sample_waiting(
		std::size_t index, std::span<const Ground> ground, const std::atomic<bool> *cancel, CallerThreads *threads) {
	const Status status = layer(index).settings().hosted ? sample_on_hosts(index, ground, cancel)
														 : sample_filled(index, cancel, threads);
	progress_[index] = Progress::sampled;
	step_of_[index] = step_;
	return status;
}

/// Samples a layer that fills gaps. Its neighbors must already be filtered.
Status TileFilter::sample_filled(std::size_t index, const std::atomic<bool> *cancel, CallerThreads *threads) {
	const LayerSettings &settings = layer(index).settings();
	const TileSpace window = window_of(index);
	const double around = fill_distance(settings.set, fill_margins[attempt_]);
	obstacles_.clear();
	for (const Neighbor &neighbor : settings.neighbors) {
		if (fills_around(settings, neighbor)) {
			const Rect near = window.grown(1.001 * (around + neighbor.distance));
			for (const std::uint32_t point : layer_of(neighbor.layer.get()).accepted()) {
				const glm::dvec2 position = layer_of(neighbor.layer.get()).positions()[point];
				if (near.contains(position)) {
					obstacles_.push_back({position, neighbor.distance});
				}
			}
		}
	}
	const Obstacles obstacles{obstacles_, fill_margins[attempt_]};
	const Status status = layers_[index]->sample(
			{samplers_->plane, samplers_->surfaces, surface_, &obstacles}, window, cancel, threads);
	stats_ = samplers_->plane.stats();
	return status;
}

/// Starts the first step. Blocks of the cache reach beyond the tile. If one fails, the step starts
/// again without the cache, so that only errors within the tile and its margins are reported.
Status TileFilter::start(const std::atomic<bool> *cancel, CallerThreads *threads) {
	const Status status = start_all(cancel, threads);
	if (status.ok() || status.code == ErrorCode::cancelled || cached_on_ == nullptr) {
		return status;
	}
	cached_on_ = nullptr;
	cached_ = LayerGraph::Cached::none;
	set_graph();
	return start_all(cancel, threads);
}

/// Samples all layers whose points do not depend on other instances.
Status TileFilter::start_all(const std::atomic<bool> *cancel, CallerThreads *threads) {
	step_ = 0;
	earlier_ground_.clear();
	progress_.assign(size(), Progress::waiting);
	step_of_.assign(size(), 0);
	for (std::size_t i = 0; i < size(); ++i) {
		if (takes_own_ && i + 1 == size()) {
			progress_[i] = Progress::sampled;
		} else if (const Status status = sample_layer(i, cancel, threads); !status.ok()) {
			return status;
		}
	}
	return {};
}

Status TileFilter::sample(
		const TileSpace &space, const Surface *surface, const std::atomic<bool> *cancel, CallerThreads *threads) {
	space_ = space;
	surface_ = surface;
	takes_own_ = false;
	set_fill_margin(0);
	return start(cancel, threads);
}

Status TileFilter::sample_around(std::span<const glm::dvec2> positions, std::span<const Ground> on_surface,
		const TileSpace &space, const Surface *surface, const Surface *grown) {
	space_ = space;
	surface_ = surface;
	takes_own_ = true;
	set_fill_margin(0);
	const Status status = start(nullptr, nullptr);
	return status.ok() ? layers_[size() - 1]->take(positions, space, on_surface, grown) : status;
}

bool TileFilter::is_complete() const { return std::ranges::find(progress_, Progress::waiting) == progress_.end(); }

/// Returns true if all layers are filtered on whose instances a layer's own instances depend.
bool TileFilter::is_ready(std::size_t index) const {
	const LayerSettings &settings = layer(index).settings();
	const auto is_filtered = [this](const auto &other) {
		return progress_[graph_.index_of(other.layer.get())] == Progress::filtered;
	};
	const auto has_scale = [&is_filtered](const HostLayer &host) {
		const ScaleSource &scale = host.layer->instance_data.scale;
		return scale.kind != SourceKind::distance || !scale.known() || is_filtered(scale);
	};
	const auto is_measured = [&is_filtered, &settings](const WorldSource &source) {
		return source.layer == nullptr || !rules_use(settings, source.input) || is_filtered(source);
	};
	const auto has_meshes = [&is_filtered](const HostLayer &host) {
		return std::ranges::all_of(host.layer->world_sources, [&](const WorldSource &source) {
			return source.layer == nullptr || !meshes_use(*host.layer, source.input) || is_filtered(source);
		});
	};
	return std::ranges::all_of(settings.neighbors, is_filtered) && std::ranges::all_of(settings.hosts, is_filtered) &&
			std::ranges::all_of(settings.hosts, has_scale) && std::ranges::all_of(settings.hosts, has_meshes) &&
			std::ranges::all_of(settings.world_sources, is_measured);
}

Status TileFilter::sample_further(
		std::span<const Ground> ground, const std::atomic<bool> *cancel, CallerThreads *threads) {
	for (std::size_t i = 0; i + 1 < size(); ++i) {
		if (progress_[i] == Progress::sampled && is_ready(i)) {
			if (const Status status = filter_neighbor(i, ground, cancel); !status.ok()) {
				return status;
			}
			progress_[i] = Progress::filtered;
		}
	}
	earlier_ground_.emplace_back(ground.begin(), ground.end());
	++step_;
	for (std::size_t i = 0; i < size(); ++i) {
		if (progress_[i] != Progress::waiting || !is_ready(i)) {
			continue;
		}
		const Status status = sample_waiting(i, ground, cancel, threads);
		const bool is_filled = !layer(i).settings().hosted;
		if (is_filled && status.code == ErrorCode::margin_too_wide && attempt_ + 1 < fill_margins.size()) {
			set_fill_margin(attempt_ + 1);
			return start(cancel, threads);
		}
		if (!status.ok()) {
			return status;
		}
	}
	return {};
}

Status TileFilter::complete(const Terrain &terrain, std::vector<glm::dvec2> &r_positions,
		std::vector<GroundQuery> &r_queries, std::vector<Ground> &r_ground, const std::atomic<bool> *cancel) {
	while (true) {
		r_positions.clear();
		r_queries.clear();
		add_queries(r_positions, r_queries);
		r_ground.assign(r_positions.size(), Ground{});
		Status status = query_ground(terrain, r_positions, r_queries, r_ground, cancel);
		if (!status.ok() || is_complete()) {
			return status;
		}
		status = sample_further(r_ground, cancel);
		if (!status.ok()) {
			return status;
		}
	}
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
		if (progress_[i] == Progress::waiting || step_of_[i] != step_) {
			continue;
		}
		const LayerGraph::Node &node = graph_.nodes()[i];
		const bool normals = i + 1 == size() ? queries_normals_ : node.is_host && follows_normals(*node.layer);
		layer(i).add_queries(normals, r_positions, r_queries);
	}
}

/// Returns the ground at the positions of a layer. `ground` is the ground of the current step.
std::span<const Ground> TileFilter::ground_at(std::size_t index, std::span<const Ground> ground) const {
	std::size_t first = 0;
	for (std::size_t i = 0; i < index; ++i) {
		first += step_of_[i] == step_of_[index] ? layer(i).position_count() : 0;
	}
	const std::span<const Ground> of_step =
			step_of_[index] < step_ ? std::span<const Ground>(earlier_ground_[step_of_[index]]) : ground;
	return of_step.subspan(first, layer(index).position_count());
}

Status TileFilter::filter_layer(std::size_t index, std::span<const Ground> ground, const std::atomic<bool> *cancel) {
	if (layers_[index]->settings().hosted && layers_[index]->settings().rules.density_rules.empty()) {
		if (const Status status = sample_on_hosts(index, ground, cancel); !status.ok()) {
			return status;
		}
	}
	return layers_[index]->filter(ground_at(index, ground), cancel);
}

/// Filters a layer on which others depend, and indexes its instances.
Status TileFilter::filter_neighbor(std::size_t index, std::span<const Ground> ground, const std::atomic<bool> *cancel) {
	const Status status = filter_layer(index, ground, cancel);
	if (status.ok()) {
		layers_[index]->index_present(graph_.nodes()[index], ground_at(index, ground), takes_own_);
	}
	return status;
}

Status TileFilter::filter_neighbors(std::span<const Ground> ground, const std::atomic<bool> *cancel) {
	for (std::size_t i = 0; i + 1 < size(); ++i) {
		if (progress_[i] == Progress::filtered) {
			continue;
		}
		if (const Status status = filter_neighbor(i, ground, cancel); !status.ok()) {
			return status;
		}
	}
	return {};
}

Status TileFilter::filter(std::span<const Ground> ground, const std::atomic<bool> *cancel) {
	const Status status = filter_neighbors(ground, cancel);
	const bool is_filtered = progress_[size() - 1] == Progress::filtered;
	return status.ok() && !is_filtered ? filter_layer(size() - 1, ground, cancel) : status;
}

} // namespace thicket
