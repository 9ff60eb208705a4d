#pragma once

#include "core/placement/ground_query.hpp"
#include "core/placement/instance_cache.hpp"
#include "core/placement/layer_filter.hpp"
#include "core/placement/layer_graph.hpp"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

namespace thicket {

/// Determines which points of a layer become instances in a tile. It first samples and filters
/// the layers on which this layer depends, directly or indirectly, each once, in the order of the
/// LayerGraph. A filter reuses its memory.
///
/// Layers that fill gaps need the instances of their neighbors before they can be sampled, and these
/// need the ground. The work therefore has steps: call `sample`, query the ground at the positions of
/// `add_queries`, and call `sample_further` with it until `is_complete` is true. Then call `filter`
/// with the ground of the last step. Without such layers, the first step is the last one.
class TileFilter {
public:
	/// The caches may be null. They affect only the amount of work.
	explicit TileFilter(const SampleMargins &margins, std::shared_ptr<BlockCache> cache = nullptr,
			std::shared_ptr<InstanceCache> instances = nullptr);
	~TileFilter();

	/// Copies the settings of the layer, which must be valid. If `terrain` is not null, it is the
	/// ground of the next tile, and may provide layers from the cache. `width` is the larger side of
	/// the tile, or infinite for a block of the cache.
	void set(const LayerSettings &layer, const Terrain *terrain = nullptr, double width = 0.0);

	/// Samples all layers, each in `space` expanded by its margin. `surface` is the surface of the
	/// ground. If it is null, layers on surfaces have no points. It must outlive all steps. For
	/// `threads`, see TileSampler::sample. Layers on the models of hosts are sampled by `filter`
	/// instead, because it first determines the instances of the hosts. Layers that fill gaps, and
	/// layers on models that have density rules, are sampled by `sample_further`.
	Status sample(const TileSpace &space, const Surface *surface, const std::atomic<bool> *cancel,
			CallerThreads *threads = nullptr);

	/// Evaluates the layer at arbitrary positions (see LayerFilter::take) and samples the other
	/// layers around them. This call replaces `sample`. `space` must contain all positions. `grown` is
	/// the surface on which the layer itself grows, if the positions are on surfaces.
	Status sample_around(std::span<const glm::dvec2> positions, std::span<const Ground> on_surface,
			const TileSpace &space, const Surface *surface, const Surface *grown);

	/// Returns true if all layers are sampled, so that `filter` can be called.
	bool is_complete() const;

	/// Samples the next layers that wait for others. `ground` contains the ground at the positions of this
	/// step. If the margin of a layer turns out to be too narrow, the first step starts again with a
	/// wider margin.
	Status sample_further(std::span<const Ground> ground, const std::atomic<bool> *cancel = nullptr,
			CallerThreads *threads = nullptr);

	/// Performs all steps except `filter`, and replaces the lists. `r_ground` is the ground of the
	/// last step. Exceptions of the terrain are passed on.
	Status complete(const Terrain &terrain, std::vector<glm::dvec2> &r_positions, std::vector<GroundQuery> &r_queries,
			std::vector<Ground> &r_ground, const std::atomic<bool> *cancel);

	/// Returns the approximate number of points of other layers that `sample_around` samples.
	double points_around(const Rect &rect) const;

	/// Appends the positions at which this step needs the ground, layer by layer in the order of the
	/// graph, and their queries.
	void add_queries(std::vector<glm::dvec2> &r_positions, std::vector<GroundQuery> &r_queries) const;

	/// Returns the ground at all queried positions of the layer itself, including its edge probes.
	/// `ground` is the same as for `filter`.
	std::span<const Ground> all_own_ground(std::span<const Ground> ground) const {
		return own().position_count() > 0 ? ground_at(size() - 1, ground) : std::span<const Ground>();
	}

	/// Returns the ground at the points of the layer itself.
	std::span<const Ground> own_ground(std::span<const Ground> ground) const {
		return own().ground_of(all_own_ground(ground));
	}

	/// Filters all layers. `ground` contains the ground at the positions of the last step.
	Status filter(std::span<const Ground> ground, const std::atomic<bool> *cancel);

	/// Filters the layers on which the layer itself depends, with the same `ground`.
	Status filter_neighbors(std::span<const Ground> ground, const std::atomic<bool> *cancel = nullptr);

	/// Sets `r_surface` to the surface of the models on which the layer itself grows, or to null if
	/// there are none around the tile. The layer must be hosted. Call this function after
	/// `filter_neighbors`, with the same `ground`. The models in the settings must outlive the
	/// surface.
	Status models_around(std::span<const Ground> ground, std::unique_ptr<const Surface> &r_surface) const {
		return models_around(size() - 1, ground, nullptr, r_surface);
	}

	/// Return the number of layers, and their filters in the order of the graph.
	std::size_t size() const { return graph_.nodes().size(); }
	const LayerFilter &layer(std::size_t index) const { return *layers_[index]; }

	/// Returns the filter of a layer on which the layer itself depends.
	const LayerFilter &layer_of(const LayerSettings *settings) const { return layer(graph_.index_of(settings)); }

	/// Returns the filter of the layer itself, which is the last one.
	const LayerFilter &own() const { return layer(size() - 1); }

	/// Returns the sampler's statistics for the layer itself.
	const SampleStats &sample_stats() const { return stats_; }

private:
	/// The samplers, which the filters of blocks share.
	struct Samplers {
		Samplers(const SampleMargins &margins, std::shared_ptr<BlockCache> cache) :
				plane(margins, std::move(cache)), surfaces(margins), hosts(host_margins) {}

		TileSampler plane;
		SurfaceSampler surfaces;
		SurfaceSampler hosts; ///< For layers on the models of hosts.
	};

	/// The filter that generates missing blocks of the cache, and its working memory.
	struct BlockFilter;

	TileFilter(std::shared_ptr<Samplers> samplers, std::shared_ptr<InstanceCache> instances);

	/// How far the work on a layer is.
	enum class Progress : std::uint8_t { waiting, sampled, filtered };

	bool is_ready(std::size_t index) const;
	void set_graph();
	void set_fill_margin(std::size_t attempt);
	Status start(const std::atomic<bool> *cancel, CallerThreads *threads);
	Status start_all(const std::atomic<bool> *cancel, CallerThreads *threads);
	Status take_cached(std::size_t index, const std::atomic<bool> *cancel);
	Status find_block(std::size_t index, glm::ivec2 block, bool may_repeat, const std::atomic<bool> *cancel,
			std::shared_ptr<const InstanceBlock> &r_block);
	Status generate_block(std::size_t index, const Rect &rect, const std::atomic<bool> *cancel,
			std::shared_ptr<const InstanceBlock> &r_block);
	Status sample_waiting(
			std::size_t index, std::span<const Ground> ground, const std::atomic<bool> *cancel, CallerThreads *threads);
	Status sample_filled(std::size_t index, const std::atomic<bool> *cancel, CallerThreads *threads);
	Status filter_neighbor(std::size_t index, std::span<const Ground> ground, const std::atomic<bool> *cancel);
	TileSpace window_of(std::size_t index) const;
	Status sample_layer(std::size_t index, const std::atomic<bool> *cancel, CallerThreads *threads);
	Status models_around(std::size_t index, std::span<const Ground> ground, const std::atomic<bool> *cancel,
			std::unique_ptr<const Surface> &r_surface) const;
	Status sample_on_hosts(std::size_t index, std::span<const Ground> ground, const std::atomic<bool> *cancel);
	Status filter_layer(std::size_t index, std::span<const Ground> ground, const std::atomic<bool> *cancel);
	std::span<const Ground> ground_at(std::size_t index, std::span<const Ground> ground) const;

	LayerSettings layer_;
	LayerGraph graph_{layer_};
	/// The first size() filters are in use. The remaining ones are kept for later layers.
	std::vector<std::unique_ptr<LayerFilter>> layers_;
	std::shared_ptr<Samplers> samplers_;
	std::shared_ptr<InstanceCache> instances_;
	const Terrain *cached_on_ = nullptr; ///< The ground of the cached blocks; null if the cache is not used.
	LayerGraph::Cached cached_ = LayerGraph::Cached::none;
	std::uint64_t number_ = 0;     ///< LayerSettings::number of the original settings of the layer itself.
	bool queries_normals_ = false; ///< True if the layer itself needs the normals of the ground.
	std::unique_ptr<BlockFilter> block_filter_;
	TileSpace space_; ///< The space of the last call of `sample` or `sample_around`.
	const Surface *surface_ = nullptr;
	bool takes_own_ = false;  ///< True after `sample_around`: the layer itself has its positions already.
	std::size_t attempt_ = 0; ///< Index of the current margin in fill_margins.
	std::size_t step_ = 0;
	std::vector<Progress> progress_;                  ///< For each layer.
	std::vector<std::size_t> step_of_;                ///< For each layer, the step in which its ground is queried.
	std::vector<std::vector<Ground>> earlier_ground_; ///< The ground of all steps before the current one.
	std::vector<Obstacle> obstacles_;
	SampleStats stats_;
};

} // namespace thicket
