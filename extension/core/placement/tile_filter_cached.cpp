// The part of TileFilter that takes layers from the cache.

#include "core/placement/tile_filter.hpp"

#include <limits>
#include <utility>

namespace thicket {

namespace {

/// Marks a layer whose ground is never queried, because the cache has its instances.
constexpr std::size_t no_step = std::numeric_limits<std::size_t>::max();

/// Maximum number of blocks from which a window takes instances. In larger windows, little area is
/// shared with other windows.
constexpr double most_blocks = 1024.0;

} // namespace

struct TileFilter::BlockFilter {
	BlockFilter(std::shared_ptr<Samplers> samplers, std::shared_ptr<InstanceCache> cache) :
			filter(std::move(samplers), std::move(cache)) {}

	TileFilter filter;
	std::vector<glm::dvec2> positions;
	std::vector<GroundQuery> queries;
	std::vector<Ground> ground;
	std::vector<glm::dvec2> instances;
	std::vector<CachedPoint> points;
};

TileFilter::TileFilter(
		const SampleMargins &margins, std::shared_ptr<BlockCache> cache, std::shared_ptr<InstanceCache> instances) :
		TileFilter(std::make_shared<Samplers>(margins, std::move(cache)), std::move(instances)) {}

TileFilter::TileFilter(std::shared_ptr<Samplers> samplers, std::shared_ptr<InstanceCache> instances) :
		samplers_(std::move(samplers)), instances_(std::move(instances)) {}

TileFilter::~TileFilter() = default;

/// Takes the points of a layer from the cache, and generates the missing blocks. For other layers,
/// only the instances are needed.
Status TileFilter::take_cached(std::size_t index, const std::atomic<bool> *cancel) {
	const LayerGraph::Node &node = graph_.nodes()[index];
	const bool is_own = index + 1 == size();
	const TileSpace window = window_of(index);
	const TileRange range = window.finite() ? tiles_in(InstanceCache::block_size(*node.layer), window) : TileRange();
	if (!window.finite() || range.count() > most_blocks) {
		return Status::out_of_range("rect", range.count(), at_most(most_blocks, "blocks"), "Use a smaller rectangle");
	}
	if (block_filter_ == nullptr) {
		block_filter_ = std::make_unique<BlockFilter>(samplers_, instances_);
	}
	// Generating a block replaces no member of the block filter that is used here.
	std::vector<glm::dvec2> &instances = block_filter_->instances;
	std::vector<CachedPoint> &points = block_filter_->points;
	instances.clear();
	points.clear();
	std::size_t sampled = 0;
	std::vector<glm::ivec2> in_work;
	std::shared_ptr<const InstanceBlock> block;
	const auto take = [&](glm::ivec2 at, bool may_repeat) {
		const Status status = find_block(index, at, may_repeat, cancel, block);
		if (!status.ok()) {
			return status;
		}
		if (block == nullptr) {
			in_work.push_back(at);
		} else if (is_own) {
			sampled += block->add_points(window, points);
		} else {
			block->add_instances(window, instances);
		}
		return status;
	};
	for (std::int32_t y = range.first.y; y <= range.last.y; ++y) {
		for (std::int32_t x = range.first.x; x <= range.last.x; ++x) {
			if (const Status status = take({x, y}, false); !status.ok()) {
				return status;
			}
		}
	}
	for (const glm::ivec2 at : std::exchange(in_work, {})) {
		if (const Status status = take(at, true); !status.ok()) {
			return status;
		}
	}
	if (is_own) {
		layers_[index]->take_points(points, sampled, window);
	} else {
		layers_[index]->take_instances(instances, window);
		layers_[index]->index_present(node, {}, takes_own_);
	}
	progress_[index] = Progress::filtered;
	step_of_[index] = no_step;
	return {};
}

/// Finds a block, or generates it if it is missing. If a different thread is generating it, returns
/// null, or generates it as well if `may_repeat` is true. Waiting would take about as long.
Status TileFilter::find_block(std::size_t index, glm::ivec2 block, bool may_repeat, const std::atomic<bool> *cancel,
		std::shared_ptr<const InstanceBlock> &r_block) {
	const LayerSettings &layer = *graph_.nodes()[index].layer;
	const std::uint64_t number = index + 1 == size() ? number_ : layer.number.value();
	const InstanceCache::Key key{number, cached_on_->version(), block};
	InstanceCache::Claim claim;
	r_block = instances_->find(key, claim);
	if (r_block != nullptr || !(claim || may_repeat)) {
		return {};
	}
	const Rect rect = tile_rect(InstanceCache::block_size(layer), block);
	const Status status = generate_block(index, rect, cancel, r_block);
	if (status.ok()) {
		instances_->add(key, r_block);
	}
	return status;
}

Status TileFilter::generate_block(std::size_t index, const Rect &rect, const std::atomic<bool> *cancel,
		std::shared_ptr<const InstanceBlock> &r_block) {
	BlockFilter &block_filter = *block_filter_;
	LayerSettings settings = *graph_.nodes()[index].layer;
	const bool has_tiles = fills(settings);
	const bool normals = has_tiles && follows_normals(settings);
	// The appearance and the meshes may depend on other layers, and do not matter here.
	settings.instance_data = {};
	settings.mesh_rules.clear();
	block_filter.filter.set(settings, cached_on_, std::numeric_limits<double>::infinity());
	block_filter.filter.queries_normals_ = normals;
	Status status = block_filter.filter.sample(rect, cached_on_->surface(), cancel);
	if (status.ok()) {
		status = block_filter.filter.complete(
				*cached_on_, block_filter.positions, block_filter.queries, block_filter.ground, cancel);
	}
	if (status.ok()) {
		status = block_filter.filter.filter(block_filter.ground, cancel);
	}
	if (!status.ok()) {
		return status;
	}
	if (index + 1 == size()) {
		stats_.add(block_filter.filter.sample_stats());
	}
	const LayerFilter &own = block_filter.filter.own();
	std::vector<glm::dvec2> instances;
	instances.reserve(own.accepted().size());
	for (const std::uint32_t point : own.accepted()) {
		instances.push_back(own.positions()[point]);
	}
	std::vector<CachedPoint> points;
	std::vector<glm::dvec2> sampled;
	if (has_tiles) {
		const std::span<const Ground> ground = block_filter.filter.own_ground(block_filter.ground);
		points.reserve(own.positions().size());
		for (std::size_t i = 0; i < own.positions().size(); ++i) {
			points.push_back({own.positions()[i], own.ids()[i], ground[i], 0, false});
		}
		for (std::size_t i = 0; i < own.accepted().size(); ++i) {
			points[own.accepted()[i]].is_instance = true;
			points[own.accepted()[i]].thinning_rank = own.thinning_ranks()[i];
		}
		sampled.assign(own.sampled_positions().begin(), own.sampled_positions().end());
	}
	r_block = std::make_shared<const InstanceBlock>(std::move(instances), std::move(points), std::move(sampled));
	return {};
}

} // namespace thicket
