#include "core/placement/tile_builder.hpp"

#include "core/base/guard.hpp"
#include "core/placement/instance_writer.hpp"
#include "core/placement/source_values.hpp"
#include "core/placement/tile_filter.hpp"
#include "core/placement/tile_pieces.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>

namespace thicket {

namespace {

/// The positions from which the height of a tile's origin is computed, as offsets from its center
/// in tile sizes. There are several, because the terrain may have holes.
constexpr std::array<glm::dvec2, 5> origin_probes{
		{{0.0, 0.0}, {-0.25, -0.25}, {0.25, -0.25}, {-0.25, 0.25}, {0.25, 0.25}}};

/// Returns the mean of the finite heights, rounded to whole meters, or 0 if there are none.
double origin_height(std::span<const Ground> ground) {
	double sum = 0.0;
	double count = 0.0;
	for (const Ground &each : ground) {
		if (std::isfinite(each.height)) {
			sum += each.height;
			count += 1.0;
		}
	}
	return count > 0.0 ? std::floor(sum / count + 0.5) : 0.0;
}

/// Replaces `r_probes` with some of the positions. Every prefix of the probes is evenly
/// distributed.
void choose_probes(
		std::span<const glm::dvec2> positions, std::span<const Ground> ground, std::vector<GroundProbe> &r_probes) {
	constexpr std::uint32_t golden = 2654435769; // Multiples of the golden section, modulo 2^32.
	const std::size_t count = std::min(positions.size(), max_ground_probes);
	r_probes.clear();
	for (std::uint32_t i = 0; i < count; ++i) {
		const std::size_t at = positions.size() > count ? (std::uint64_t{golden * i} * positions.size()) >> 32U : i;
		r_probes.push_back({positions[at], ground[at].height});
	}
}

} // namespace

/// Data passed between the steps, and memory reused between tiles.
struct TileBuilder::Workspace {
	Workspace(const SampleMargins &p_margins, std::shared_ptr<BlockCache> p_cache,
			std::shared_ptr<InstanceCache> p_instances) :
			margins(p_margins), cache(std::move(p_cache)), instances(std::move(p_instances)),
			filter(margins, cache, instances) {}

	SampleMargins margins;
	std::shared_ptr<BlockCache> cache;
	std::shared_ptr<InstanceCache> instances;
	TileFilter filter;
	SourceValues fractions;
	InstanceWriter writer;

	// True after a successful `find_points` or `find_further`.
	bool found = false;
	TileSpace space;
	/// Positions of all layers, followed by those for the tile's origin.
	std::vector<glm::dvec2> positions;
	std::vector<GroundQuery> queries;

	std::vector<GroundProbe> probes;
	std::vector<Ground> ground; ///< Used by `build`, which queries the terrain itself.
	SampleStats stats;          ///< Statistics of the last sampling.

	Status find_points(const LayerSettings &layer, const TileSpace &space, const Terrain *terrain,
			const Surface *surface, const std::atomic<bool> *cancel, CallerThreads *threads);
	Status find_further(std::span<const Ground> known, const std::atomic<bool> *cancel, CallerThreads *threads);
	Status check_ground(std::span<const Ground> known) const;
	Status place(std::span<const Ground> known, TileInstances &r_tile, const std::atomic<bool> *cancel);
	void gather_positions();
	void add_origin_probes();
	glm::dvec3 origin(std::span<const Ground> known) const;
	Status build_together(const LayerSettings &layer, const Terrain &terrain, const TileSpace &space,
			const PieceGrid &grid, TileInstances &r_tile, const std::atomic<bool> *cancel, CallerThreads &threads);
};

/// Adds the positions from which the height of the tile's origin is computed. A tile with a limited
/// height needs none, because its origin is at its center.
void TileBuilder::Workspace::add_origin_probes() {
	if (!space.covers_all_heights()) {
		return;
	}
	queries.push_back({positions.size(), origin_probes.size(), {.textures = {}, .normals = false}});
	for (const glm::dvec2 probe : origin_probes) {
		positions.push_back(space.center() + probe * space.size());
	}
}

/// Returns the origin of the tile. If the tile covers all heights, `known` ends with the ground at
/// the origin probes.
glm::dvec3 TileBuilder::Workspace::origin(std::span<const Ground> known) const {
	const glm::dvec2 center = space.center();
	const double height = space.covers_all_heights() ? origin_height(known.last(origin_probes.size()))
													 : std::floor(0.5 * (space.bottom + space.top) + 0.5);
	return {center.x, height, center.y};
}

void TileBuilder::Workspace::gather_positions() {
	positions.clear();
	queries.clear();
	filter.add_queries(positions, queries);
	if (filter.is_complete()) {
		add_origin_probes();
	}
}

/// Runs all steps on all threads.
Status TileBuilder::Workspace::build_together(const LayerSettings &layer, const Terrain &terrain,
		const TileSpace &p_space, const PieceGrid &grid, TileInstances &r_tile, const std::atomic<bool> *cancel,
		CallerThreads &threads) {
	found = false;
	space = p_space;
	probes.clear();
	positions.clear();
	queries.clear();
	add_origin_probes();
	ground.assign(positions.size(), Ground{});
	TilePieces pieces(margins, cache, instances);
	Status status = query_ground(terrain, positions, queries, ground, cancel);
	if (status.ok()) {
		status = pieces.find(layer, terrain, grid, cancel, threads);
	}
	stats = pieces.sample_stats();
	if (!status.ok()) {
		return status;
	}
	InstanceWriter large_writer; // Local, so that its memory is freed along with the pieces.
	status = large_writer.write(layer, pieces.points(), origin(ground), r_tile, cancel, &threads);
	if (status.ok()) {
		r_tile.counts = pieces.counts();
	}
	return status;
}

/// `terrain` is null if only the caller can query the ground.
Status TileBuilder::Workspace::find_points(const LayerSettings &layer, const TileSpace &p_space, const Terrain *terrain,
		const Surface *surface, const std::atomic<bool> *cancel, CallerThreads *threads) {
	found = false;
	filter.set(layer, terrain, std::max(p_space.size().x, p_space.size().y));
	const Status status = filter.sample(p_space, surface, cancel, threads);
	stats = filter.sample_stats();
	if (!status.ok()) {
		return status;
	}
	space = p_space;
	gather_positions();
	found = true;
	return {};
}

Status TileBuilder::Workspace::find_further(
		std::span<const Ground> known, const std::atomic<bool> *cancel, CallerThreads *threads) {
	found = false;
	const Status status = filter.sample_further(known, cancel, threads);
	stats = filter.sample_stats();
	if (status.ok()) {
		gather_positions();
		found = true;
	}
	return status;
}

/// Returns an error unless `known` is the ground at the positions.
Status TileBuilder::Workspace::check_ground(std::span<const Ground> known) const {
	if (!found) {
		return {ErrorCode::missing, "points", 0.0};
	}
	return thicket::check_ground(known, positions.size());
}

Status TileBuilder::Workspace::place(
		std::span<const Ground> known, TileInstances &r_tile, const std::atomic<bool> *cancel) {
	probes.clear();
	if (const Status status = filter.filter(known, cancel); !status.ok()) {
		return status;
	}
	stats = filter.sample_stats();
	const LayerFilter &own = filter.own();
	PlacedPoints points{own.positions(), filter.own_ground(known), own.ids(), own.accepted(), own.thinning_ranks()};
	if (!own.settings().set.on_surface) {
		choose_probes(points.positions, points.ground, probes);
	}
	Status status = fractions.find(filter, filter.all_own_ground(known), points, cancel);
	if (status.ok()) {
		status = writer.write(own.settings(), points, origin(known), r_tile, cancel);
	}
	if (status.ok()) {
		r_tile.counts = {own.sampled(), own.positions().size(), own.accepted().size()};
	}
	return status;
}

TileBuilder::TileBuilder(
		const SampleMargins &margins, std::shared_ptr<BlockCache> cache, std::shared_ptr<InstanceCache> instances) :
		workspace_(std::make_unique<Workspace>(margins, std::move(cache), std::move(instances))) {}
TileBuilder::~TileBuilder() = default;
TileBuilder::TileBuilder(TileBuilder &&) noexcept = default;
TileBuilder &TileBuilder::operator=(TileBuilder &&) noexcept = default;

Status TileBuilder::build(const LayerSettings &layer, const Terrain &terrain, const TileSpace &space,
		TileInstances &r_tile, const std::atomic<bool> *cancel, CallerThreads *threads) {
	if (const Status status = validate(layer); !status.ok()) {
		return status;
	}
	if (threads != nullptr && threads->count() > 0) {
		if (const PieceGrid grid(space, LayerGraph(layer)); grid.count() > 1) {
			// The pieces are generated on all threads, with the same result.
			return guarded("tile", std::max(space.size().x, space.size().y),
					[&] { return workspace_->build_together(layer, terrain, space, grid, r_tile, cancel, *threads); });
		}
	}
	const Status sampled = guarded("tile", std::max(space.size().x, space.size().y),
			[&] { return workspace_->find_points(layer, space, &terrain, terrain.surface(), cancel, threads); });
	if (!sampled.ok()) {
		return sampled;
	}
	while (true) {
		const Status status = guarded("ground", static_cast<double>(workspace_->positions.size()), [&] {
			workspace_->ground.assign(workspace_->positions.size(), Ground{});
			return query_ground(terrain, workspace_->positions, workspace_->queries, workspace_->ground, cancel);
		});
		if (!status.ok()) {
			return status;
		}
		if (is_complete()) {
			return place(workspace_->ground, r_tile, cancel);
		}
		if (const Status next_status = find_further(workspace_->ground, cancel, threads); !next_status.ok()) {
			return next_status;
		}
	}
}

Status TileBuilder::find_points(const LayerSettings &layer, const TileSpace &space, const std::atomic<bool> *cancel,
		CallerThreads *threads, const Surface *surface) {
	if (const Status status = validate(layer); !status.ok()) {
		return status;
	}
	return guarded("tile", std::max(space.size().x, space.size().y),
			[&] { return workspace_->find_points(layer, space, nullptr, surface, cancel, threads); });
}

bool TileBuilder::is_complete() const { return workspace_->filter.is_complete(); }

Status TileBuilder::find_further(
		std::span<const Ground> ground, const std::atomic<bool> *cancel, CallerThreads *threads) {
	if (const Status status = workspace_->check_ground(ground); !status.ok()) {
		return status;
	}
	return guarded("tile", std::max(workspace_->space.size().x, workspace_->space.size().y),
			[&] { return workspace_->find_further(ground, cancel, threads); });
}

std::span<const glm::dvec2> TileBuilder::positions() const { return workspace_->positions; }

std::span<const GroundQuery> TileBuilder::queries() const { return workspace_->queries; }

Status TileBuilder::place(std::span<const Ground> ground, TileInstances &r_tile, const std::atomic<bool> *cancel) {
	Status status = workspace_->check_ground(ground);
	if (status.ok() && !is_complete()) {
		status = {ErrorCode::missing, "points", 0.0};
	}
	if (!status.ok()) {
		return status;
	}
	return guarded("tile", std::max(workspace_->space.size().x, workspace_->space.size().y),
			[&] { return workspace_->place(ground, r_tile, cancel); });
}

std::span<const GroundProbe> TileBuilder::probes() const { return workspace_->probes; }

const SampleStats &TileBuilder::sample_stats() const { return workspace_->stats; }

} // namespace thicket
